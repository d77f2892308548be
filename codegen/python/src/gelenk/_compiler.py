"""The C compiler at hand."""

from __future__ import annotations

import functools
import os
import platform
import shlex
import shutil
import subprocess
import sys
from pathlib import Path

from .errors import CompilerError

CANDIDATES = (("cc",), ("gcc",), ("clang",), ("zig", "cc"), (sys.executable, "-m", "ziglang", "cc"))
"""Commands that are tried where `CC` names none."""

FLAGS = ("-std=c99", "-O2", "-fPIC", "-shared", "-fno-math-errno")
NATIVE = "-march=native"
"""Instructions of this processor. Bits do not depend on it: modules keep compilers from contracting."""

LIBRARY = {"win32": "module.dll", "darwin": "module.dylib"}.get(sys.platform, "module.so")


@functools.cache
def find(named: str | None) -> tuple[tuple[str, ...], str]:
    """The command of a compiler, and what it says about its version.

    - `named`: the value of the environment variable `CC`

    Raises `CompilerError` where there is none.
    """
    commands = [tuple(shlex.split(named))] if named else CANDIDATES
    for command in commands:
        version = _version(command)
        if version is not None:
            return command, version
    if named:
        raise CompilerError(f"CC names `{named}`, which does not run: name a C compiler, or unset CC")
    tried = ", ".join(" ".join(command) for command in CANDIDATES)
    raise CompilerError(
        f"there is no C compiler (tried: {tried}). Install one: `apt install gcc`, `xcode-select --install`, or "
        "`pip install ziglang` on any platform; or name it in the environment variable CC"
    )


def identity() -> list[str]:
    """What tells one compiler, its flags and its processor from others."""
    command, version = find(os.environ.get("CC"))
    return [*command, version, *FLAGS, platform.node(), platform.machine(), platform.processor()]


def compile(folder: Path, sources: list[str]) -> None:
    """Makes the shared library of sources in a folder.

    Raises `CompilerError` with what the compiler said.
    """
    command, _ = find(os.environ.get("CC"))
    words = [*command, *FLAGS, *sources, "-o", LIBRARY, *([] if sys.platform == "win32" else ["-lm"])]
    # Not every compiler knows the processor that it runs on.
    native = subprocess.run([*words, NATIVE], cwd=folder, capture_output=True, encoding="utf-8", errors="replace")
    if native.returncode == 0:
        return
    plain = subprocess.run(words, cwd=folder, capture_output=True, encoding="utf-8", errors="replace")
    if plain.returncode != 0:
        raise CompilerError(f"`{' '.join(words)}` refused the module:\n{plain.stderr.strip() or native.stderr.strip()}")


def _version(command: tuple[str, ...]) -> str | None:
    if shutil.which(command[0]) is None:
        return None
    words = [*command, "--version"]
    done = subprocess.run(words, capture_output=True, encoding="utf-8", errors="replace")
    return done.stdout if done.returncode == 0 else None
