"""Diagnostics are values: collected while compiling, rendered elsewhere."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field
from enum import Enum

from grammar_lang.diagnostics.codes import Code
from grammar_lang.source import Span


class Severity(Enum):
    """An error stops the compilation; a warning does not, and a note is no fault at all."""

    ERROR = "error"
    WARNING = "warning"
    NOTE = "note"


@dataclass(frozen=True, slots=True)
class Diagnostic:
    """One finding: a one-line message, where, and what to do about it."""

    code: Code
    severity: Severity
    message: str
    span: Span
    hint: str | None = None
    notes: tuple[tuple[Span, str], ...] = ()


@dataclass(slots=True)
class Sink:
    """Collects diagnostics; passed to every pass that may find something.

    ``comparisons`` are how many names may still be compared for hints: a file full of unknown
    names would keep the search for similar ones busy for minutes.
    """

    found: list[Diagnostic] = field(default_factory=list[Diagnostic])
    comparisons: int = 50_000

    def error(
        self,
        code: Code,
        message: str,
        span: Span,
        hint: str | None = None,
        notes: Iterable[tuple[Span, str]] = (),
    ) -> None:
        """Record an error."""
        self.found.append(Diagnostic(code, Severity.ERROR, message, span, hint, tuple(notes)))

    def warning(
        self,
        code: Code,
        message: str,
        span: Span,
        hint: str | None = None,
        notes: Iterable[tuple[Span, str]] = (),
    ) -> None:
        """Record a warning."""
        self.found.append(Diagnostic(code, Severity.WARNING, message, span, hint, tuple(notes)))

    def note(
        self,
        code: Code,
        message: str,
        span: Span,
        hint: str | None = None,
        notes: Iterable[tuple[Span, str]] = (),
    ) -> None:
        """Record something worth knowing that is no fault."""
        self.found.append(Diagnostic(code, Severity.NOTE, message, span, hint, tuple(notes)))

    @property
    def has_errors(self) -> bool:
        """Whether at least one error was recorded."""
        return any(d.severity is Severity.ERROR for d in self.found)

    def sorted(self) -> tuple[Diagnostic, ...]:
        """All findings in the order of their positions."""
        return tuple(sorted(self.found, key=lambda d: (d.span.file, d.span, d.code.value)))
