"""Warnings of what an import leaves out, with its place in the file, as ``srgc check`` has them."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from grammar_lang.diagnostics.diagnostic import Code, Diagnostic, Severity
from grammar_lang.diagnostics.render import to_text
from grammar_lang.source import Source, Span


@dataclass(frozen=True, slots=True)
class SourceWarning:
    """A part of a file that is not carried over; ``message`` says which, without the place."""

    message: str
    source: Source
    span: Span
    hint: str | None = None

    def finding(self, *, colour: bool = False) -> str:
        """The place, the message, the line with carets, and the hint."""
        found = Diagnostic(
            Code.FOREIGN_LEFT_OUT, Severity.WARNING, self.message, self.span, self.hint
        )
        return to_text([found], [self.source], colour=colour).rstrip("\n")

    def in_comment(self) -> str:
        """The message, preceded by the name of the file and the line."""
        line, _ = self.source.position(self.span.start)
        return f"{Path(self.source.name).name}:{line}: {self.message}"
