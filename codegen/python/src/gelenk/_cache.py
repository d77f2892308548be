"""Modules that were generated and compiled before, in the user's folder of caches.

A module is known by its content: by the bytes of the description and of all files that it reads, by the options, and
by the program that generates. A compiled library is known by the module's text and by the compiler. Nothing in the
folder is ever changed: entries are made next to it and renamed, so that two processes may make the same one at once.

What lies here is executed. So the folders have to be the user's own, and each entry has the checksums of its files: one
that a crash of the machine left half-written is made again.
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
"""The file of an entry with the checksums of the others."""

VARIABLE = "GELENK_CACHE"
"""The environment variable that names the folder."""


def folder() -> Path:
    """The folder of the cache, which may not exist yet."""
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
    """A name for values that JSON can hold."""
    text = json.dumps(parts, sort_keys=True)
    return hashlib.sha256(text.encode()).hexdigest()[:32]


def fingerprint(path: str | Path) -> str | None:
    """The content of a file; none where it cannot be read."""
    try:
        return hashlib.sha256(Path(path).read_bytes()).hexdigest()
    except OSError:
        return None


def kind_folder(kind: str) -> Path:
    """The folder of all entries of a kind, which is made where it is missing.

    Raises `CacheError` where another user owns it, or may write into it.
    """
    return _own(_own(folder()) / kind)


def find(kind: str, name: str) -> Path | None:
    """The folder of this name; none where it is missing, or where its files are not those that were written."""
    place = kind_folder(kind) / name
    if not place.is_dir():
        return None
    try:
        checksums = json.loads((_own(place) / CHECKSUMS).read_text("utf-8"))
    except (OSError, ValueError):
        return None
    return place if all(fingerprint(place / file) == checksum for file, checksum in checksums.items()) else None


def entry(kind: str, name: str, make: Callable[[Path], None]) -> Path:
    """The folder of this name, which `make` fills where it cannot be found."""
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
    """A value that was kept; none where there is none."""
    try:
        return json.loads((kind_folder(kind) / f"{name}.json").read_text("utf-8"))
    except (OSError, ValueError):
        return None


def write_json(kind: str, name: str, value: Any) -> None:
    """Keeps a value."""
    place = kind_folder(kind) / f"{name}.json"
    handle, new = tempfile.mkstemp(prefix=".new-", dir=place.parent)
    with os.fdopen(handle, "w", encoding="utf-8") as file:
        json.dump(value, file)
    os.replace(new, place)


def _own(place: Path) -> Path:
    place.mkdir(parents=True, exist_ok=True, mode=0o700)
    found = place.stat()
    # Windows gives each user a folder of caches, and has no such owners.
    if hasattr(os, "geteuid") and (found.st_uid != os.geteuid() or found.st_mode & 0o022):
        raise CacheError(
            f"{place} belongs to another user, or others may write into it, and libraries in it would be executed: "
            f"`chmod go-w` it where it is yours, or name a folder of your own in {VARIABLE}"
        )
    return place
