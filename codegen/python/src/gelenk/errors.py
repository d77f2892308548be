"""Errors, warnings and diagnostics of this package."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Diagnostic:
    """A message of the program about a place in a description."""

    severity: str
    """`error`, `warning` or `note`."""
    code: str
    """Short fixed name of the kind of message, for example `missing-key`."""
    message: str
    """Description of the problem."""
    file: str | None
    """Path of the file; `None` without a place."""
    line: int | None
    """Line, counted from 1."""
    column: int | None
    """Column, counted from 1."""
    help: str | None
    """Remedy."""
    text: str
    """Complete text that the program prints, with the line of the file."""

    def __str__(self) -> str:
        return self.text


class GelenkError(Exception):
    """Base class of all errors of this package."""


class DescriptionError(GelenkError):
    """A description has errors. `diagnostics` has their places and remedies."""

    def __init__(self, diagnostics: tuple[Diagnostic, ...]):
        super().__init__("\n\n".join(each.text for each in diagnostics))
        self.diagnostics = diagnostics


class DescriptionWarning(UserWarning):
    """A description is usable, but probably contains a mistake."""


class ProgramError(GelenkError):
    """The program `gelenk` is missing, or it ended without a result."""


class CompilerError(GelenkError):
    """There is no C compiler, or the compiler rejected the module."""


class CacheError(GelenkError):
    """The cache folder belongs to another user, or other users can write to it."""
