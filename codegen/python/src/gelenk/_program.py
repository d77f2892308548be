"""Finds and runs the program `gelenk`."""

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
"""Environment variable with the path of the program. It precedes all other places."""


def find() -> Path:
    """Returns the path of the program: the program of this package, otherwise the program on the PATH.

    Raises `ProgramError` if no program is found.
    """
    named = os.environ.get(VARIABLE)
    if named:
        if not Path(named).is_file():
            raise ProgramError(f"{VARIABLE} names {named}, which is not a file")
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
    """Returns values that distinguish builds of the program: path, size and time of the file."""
    found = program.resolve().stat()
    return [str(program.resolve()), found.st_size, found.st_mtime_ns]


def run(words: Iterable[str | os.PathLike[str]], *, may_fail: bool = False, folder: Path | None = None) -> Any:
    """Runs the program and returns its JSON output.

    - `words`: arguments of the command line
    - `folder`: working directory; by default the current directory
    - `may_fail`: whether an output with exit code 1 is accepted, for example a page with a failed self-check

    Raises `DescriptionError` if a description has errors, `ValueError` for arguments that the program rejects, and
    `ProgramError` for all other failures.
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
    raise ProgramError(message or f"{command[0]} ended with exit code {done.returncode} and without a message")


def diagnostics(entries: Iterable[Mapping[str, Any]]) -> tuple[Diagnostic, ...]:
    """Converts entries of the program's JSON output to diagnostics."""
    keys = Diagnostic.__dataclass_fields__
    return tuple(Diagnostic(**{key: entry[key] for key in keys}) for entry in entries)


def switches(options: Mapping[str, Any]) -> list[str]:
    """Converts keyword arguments to options of the command line: `no_friction=True` becomes `--no-friction`.

    `None`, `False` and empty lists give no option. Each pattern of `hold` gives one option.
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
    """Returns the error message in the output of the program, without progress lines."""
    lines = [line for line in text.splitlines() if not line.startswith("gelenk: ")]
    message = "\n".join(lines).strip()
    message = message.removeprefix("error: ")
    return message.removesuffix("For more information, try '--help'.").strip()
