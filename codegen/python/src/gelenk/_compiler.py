"""Finds and runs a C compiler of the system."""

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
"""Commands that are tried if `CC` is not set."""

FLAGS = ("-std=c99", "-O2", "-fPIC", "-shared", "-fno-math-errno")
NATIVE = "-march=native"
"""Flag for the instructions of this processor. Results do not depend on it, because modules forbid contraction to FMA."""

LIBRARY = {"win32": "module.dll", "darwin": "module.dylib"}.get(sys.platform, "module.so")


@functools.cache
def find(named: str | None) -> tuple[tuple[str, ...], str]:
    """Returns the command of a compiler, and the output of its option `--version`.

    - `named`: the value of the environment variable `CC`

    Raises `CompilerError` if no compiler is found.
    """
    commands = [tuple(shlex.split(named))] if named else CANDIDATES
    for command in commands:
        version = _version(command)
        if version is not None:
            return command, version
    if named:
        raise CompilerError(f"CC names `{named}`, which does not run: set CC to a C compiler, or unset it")
    tried = ", ".join(" ".join(command) for command in CANDIDATES)
    raise CompilerError(
        f"there is no C compiler (tried: {tried}). Install one: `apt install gcc`, `xcode-select --install`, or "
        "`pip install ziglang` on any platform; or set the environment variable CC to it"
    )


def identity() -> list[str]:
    """Returns values that distinguish compilers, flags and processors, for the key of a compiled library."""
    command, version = find(os.environ.get("CC"))
    return [*command, version, *FLAGS, platform.node(), platform.machine(), platform.processor()]


def compile(folder: Path, sources: list[str]) -> None:
    """Compiles sources in a folder to a shared library.

    Raises `CompilerError` with the message of the compiler.
    """
    command, _ = find(os.environ.get("CC"))
    words = [*command, *FLAGS, *sources, "-o", LIBRARY, *([] if sys.platform == "win32" else ["-lm"])]
    # Not every compiler supports the option for the processor on which it runs.
    native = subprocess.run([*words, NATIVE], cwd=folder, capture_output=True, encoding="utf-8", errors="replace")
    if native.returncode == 0:
        return
    plain = subprocess.run(words, cwd=folder, capture_output=True, encoding="utf-8", errors="replace")
    if plain.returncode != 0:
        raise CompilerError(f"`{' '.join(words)}` rejected the module:\n{plain.stderr.strip() or native.stderr.strip()}")


def _version(command: tuple[str, ...]) -> str | None:
    if shutil.which(command[0]) is None:
        return None
    words = [*command, "--version"]
    done = subprocess.run(words, capture_output=True, encoding="utf-8", errors="replace")
    return done.stdout if done.returncode == 0 else None
