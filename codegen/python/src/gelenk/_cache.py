"""Cache of generated and compiled modules, in the user's cache folder.

The key of a module depends on the contents of the description and of all files that it reads, on the options, and on the
program. The key of a compiled library depends on the text of the module and on the compiler. Entries are never changed.
A new entry is made in a temporary folder and then renamed, so two processes may make the same entry at once.

Libraries in the cache are executed. Therefore the folders must belong to the user, and each entry has the checksums of its
files. An entry that a crash of the machine left incomplete is made again.
"""

from __future__ import annotations

import hashlib
import json
import os
import shutil
import sys
import tempfile
from pathlib import Path
from typing import Any, Callable

from .errors import CacheError

CHECKSUMS = "checksums.json"
"""File of an entry with the checksums of its other files."""

VARIABLE = "GELENK_CACHE"
"""Environment variable with the path of the cache folder."""


def folder() -> Path:
    """Returns the cache folder. It may not exist yet."""
    named = os.environ.get(VARIABLE)
    if named:
        return Path(named).absolute()
    if sys.platform == "win32":
        base = os.environ.get("LOCALAPPDATA") or Path.home() / "AppData/Local"
    elif sys.platform == "darwin":
        base = Path.home() / "Library/Caches"
    else:
        base = os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache"
    return Path(base) / "gelenk"


def key(*parts: Any) -> str:
    """Returns a hash of values that JSON can represent, as the key of a cache entry."""
    text = json.dumps(parts, sort_keys=True)
    return hashlib.sha256(text.encode()).hexdigest()[:32]


def fingerprint(path: str | Path) -> str | None:
    """Returns a hash of the content of a file; `None` if the file cannot be read."""
    try:
        return hashlib.sha256(Path(path).read_bytes()).hexdigest()
    except OSError:
        return None


def kind_folder(kind: str) -> Path:
    """Returns the folder of all entries of a kind. The folder is made if it is missing.

    Raises `CacheError` if another user owns the folder or can write to it.
    """
    return _own(_own(folder()) / kind)


def find(kind: str, name: str) -> Path | None:
    """Returns the folder of an entry; `None` if it is missing or its files have wrong checksums."""
    place = kind_folder(kind) / name
    if not place.is_dir():
        return None
    try:
        checksums = json.loads((_own(place) / CHECKSUMS).read_text("utf-8"))
    except (OSError, ValueError):
        return None
    return place if all(fingerprint(place / file) == checksum for file, checksum in checksums.items()) else None


def entry(kind: str, name: str, make: Callable[[Path], None]) -> Path:
    """Returns the folder of an entry. If it is missing, `make` fills a new folder."""
    place = find(kind, name)
    if place is not None:
        return place
    place = kind_folder(kind) / name
    new = Path(tempfile.mkdtemp(prefix=".new-", dir=place.parent))
    try:
        make(new)
        checksums = {file.name: fingerprint(file) for file in new.iterdir() if file.name != CHECKSUMS}
        (new / CHECKSUMS).write_text(json.dumps(checksums), "utf-8")
        # Another process may have been faster.
        if find(kind, name) is None:
            shutil.rmtree(place, ignore_errors=True)
            os.replace(new, place)
    except OSError:
        if find(kind, name) is None:
            raise
    finally:
        shutil.rmtree(new, ignore_errors=True)
    return place


def read_json(kind: str, name: str) -> Any:
    """Reads a JSON value from the cache; `None` if it is missing or damaged."""
    try:
        return json.loads((kind_folder(kind) / f"{name}.json").read_text("utf-8"))
    except (OSError, ValueError):
        return None


def write_json(kind: str, name: str, value: Any) -> None:
    """Writes a JSON value to the cache."""
    place = kind_folder(kind) / f"{name}.json"
    handle, new = tempfile.mkstemp(prefix=".new-", dir=place.parent)
    with os.fdopen(handle, "w", encoding="utf-8") as file:
        json.dump(value, file)
    os.replace(new, place)


def _own(place: Path) -> Path:
    place.mkdir(parents=True, exist_ok=True, mode=0o700)
    found = place.stat()
    # Windows has a cache folder per user, but no owners and permission bits of this kind.
    if hasattr(os, "geteuid") and (found.st_uid != os.geteuid() or found.st_mode & 0o022):
        raise CacheError(
            f"{place} belongs to another user, or other users can write to it, so its libraries are not executed: "
            f"run `chmod go-w {place}` if the folder is yours, or set {VARIABLE} to a folder of your own"
        )
    return place
