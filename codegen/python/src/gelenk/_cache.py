"""Modules that were generated and compiled before, in the user's folder of caches.

A module is known by its content: by the bytes of the description and of all files that it reads, by the options, and
by the program that generates. A compiled library is known by the module's text and by the compiler. Nothing in the
folder is ever changed: entries are made beside it and renamed, so that two processes may make the same one at once.
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

VARIABLE = "GELENK_CACHE"
"""The environment variable that names the folder."""


def folder() -> Path:
    """The folder of the cache, which may not exist yet."""
    named = os.environ.get(VARIABLE)
    if named:
        return Path(named)
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


def entry(kind: str, name: str, make: Callable[[Path], None]) -> Path:
    """The folder of this name, which `make` fills where it is not there yet."""
    place = folder() / kind / name
    if place.is_dir():
        return place
    place.parent.mkdir(parents=True, exist_ok=True, mode=0o700)
    new = Path(tempfile.mkdtemp(prefix=".new-", dir=place.parent))
    try:
        make(new)
        os.replace(new, place)
    except OSError:
        # Another process was faster.
        if not place.is_dir():
            raise
    finally:
        shutil.rmtree(new, ignore_errors=True)
    return place


def read_json(kind: str, name: str) -> Any:
    """A value that was kept; none where there is none."""
    try:
        return json.loads((folder() / kind / f"{name}.json").read_text("utf-8"))
    except (OSError, ValueError):
        return None


def write_json(kind: str, name: str, value: Any) -> None:
    """Keeps a value."""
    place = folder() / kind / f"{name}.json"
    place.parent.mkdir(parents=True, exist_ok=True, mode=0o700)
    handle, new = tempfile.mkstemp(prefix=".new-", dir=place.parent)
    with os.fdopen(handle, "w", encoding="utf-8") as file:
        json.dump(value, file)
    os.replace(new, place)
