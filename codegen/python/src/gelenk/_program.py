"""The program `gelenk`: where it is, and how it is run."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
import sysconfig
from pathlib import Path
from typing import Any, Iterable, Mapping

from .errors import DescriptionError, Diagnostic, ProgramError

VARIABLE = "GELENK_PROGRAM"
"""The environment variable that names the program, before all other places."""


def find() -> Path:
    """The program that came with this package, else the one on the path.

    Raises `ProgramError` where there is none.
    """
    named = os.environ.get(VARIABLE)
    if named:
        if not Path(named).is_file():
            raise ProgramError(f"{VARIABLE} names {named}, which is no file")
        return Path(named)
    name = "gelenk.exe" if sys.platform == "win32" else "gelenk"
    schemes = [sysconfig.get_path("scripts")]
    user = sysconfig.get_preferred_scheme("user")
    schemes.append(sysconfig.get_path("scripts", scheme=user))
    for folder in schemes:
        if folder and (Path(folder) / name).is_file():
            return Path(folder) / name
    found = shutil.which(name)
    if found is None:
        raise ProgramError(
            "there is no program `gelenk`: install this package with pip, or the program with "
            f"`cargo install --path codegen`, or name it in {VARIABLE}"
        )
    return Path(found)


def identity(program: Path) -> list[Any]:
    """What tells one build of the program from another."""
    found = program.resolve().stat()
    return [str(program.resolve()), found.st_size, found.st_mtime_ns]


def run(words: Iterable[str | os.PathLike[str]], *, may_fail: bool = False, folder: Path | None = None) -> Any:
    """Runs the program; what it prints as JSON.

    - `folder`: where it runs; by default the current one
    - `may_fail`: whether a result with exit code 1 is one, as that of a page with a failed self-check

    Raises `DescriptionError` where a description is at fault, `ValueError` for words that the program refuses, and
    `ProgramError` for all else.
    """
    command = [str(find().absolute()), "--format", "json", *[os.fspath(word) for word in words]]
    done = subprocess.run(command, cwd=folder, capture_output=True, encoding="utf-8", errors="replace")
    result = _json(done.stdout)
    if done.returncode == 0 and result is not None:
        return result
    if isinstance(result, dict) and "diagnostics" in result:
        raise DescriptionError(diagnostics(result["diagnostics"]))
    if may_fail and result is not None:
        return result
    message = _message(done.stderr)
    if done.returncode == 2:
        raise ValueError(message)
    raise ProgramError(message or f"{command[0]} ended with exit code {done.returncode} and said nothing")


def diagnostics(entries: Iterable[Mapping[str, Any]]) -> tuple[Diagnostic, ...]:
    """Diagnostics from what the program prints."""
    keys = Diagnostic.__dataclass_fields__
    return tuple(Diagnostic(**{key: entry[key] for key in keys}) for entry in entries)


def switches(options: Mapping[str, Any]) -> list[str]:
    """Words of the command line from keyword arguments: `no_friction=True` is `--no-friction`.

    `None`, `False` and empty lists say nothing. Patterns of `hold` are a switch each.
    """
    words: list[str] = []
    for name, value in options.items():
        switch = "--" + name.rstrip("_").replace("_", "-")
        if value is None or value is False:
            continue
        if name == "hold":
            words.extend(f"{switch}={pattern}" for pattern in _held(value))
            continue
        if value is True:
            words.append(switch)
        elif isinstance(value, (str, os.PathLike)):
            words.append(f"{switch}={os.fspath(value)}")
        elif isinstance(value, (int, float)):
            words.append(f"{switch}={value!r}")
        elif listed := ",".join(os.fspath(each) for each in value):
            words.append(f"{switch}={listed}")
    return words


def _held(hold: Mapping[str, float] | str | Iterable[str]) -> Iterable[str]:
    if isinstance(hold, Mapping):
        return [f"{pattern}={position}" for pattern, position in hold.items()]
    return [hold] if isinstance(hold, str) else hold


def _json(text: str) -> Any:
    try:
        return json.loads(text)
    except ValueError:
        return None


def _message(text: str) -> str:
    """What the program says, without the lines about its progress."""
    lines = [line for line in text.splitlines() if not line.startswith("gelenk: ")]
    message = "\n".join(lines).strip()
    message = message.removeprefix("error: ")
    return message.removesuffix("For more information, try '--help'.").strip()
