"""What can go wrong."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Diagnostic:
    """What the program says about a place in a description."""

    severity: str
    """`error`, `warning` or `note`."""
    code: str
    """A short name that does not change, e.g. `missing-key`."""
    message: str
    file: str | None
    line: int | None
    """Counted from 1."""
    column: int | None
    help: str | None
    """What to do."""
    text: str
    """All of it as the program prints it, with the line of the file."""

    def __str__(self) -> str:
        return self.text


class GelenkError(Exception):
    """Something that this package could not do."""


class DescriptionError(GelenkError):
    """A description is at fault: `diagnostics` says where and what to do."""

    def __init__(self, diagnostics: tuple[Diagnostic, ...]):
        super().__init__("\n\n".join(each.text for each in diagnostics))
        self.diagnostics = diagnostics


class DescriptionWarning(UserWarning):
    """A description is read, but something in it is doubtful."""


class ProgramError(GelenkError):
    """The program `gelenk` is missing, or it ended without a result."""


class CompilerError(GelenkError):
    """There is no C compiler, or it refused the module."""


class CacheError(GelenkError):
    """The folder of the cache is not the user's own."""
