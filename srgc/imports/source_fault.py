"""Faults in files of other tools: where in the file, what is wrong, and what to do."""

from __future__ import annotations

from pathlib import Path

from grammar_lang.diagnostics.diagnostic import Code, Diagnostic, Severity
from grammar_lang.diagnostics.render import to_text
from grammar_lang.source import Source, Span
from srgc.faults import UsageFault

WHOLE = Span(0, 0)


class SourceFault(UsageFault):
    """A file that cannot be imported; as text it looks like a finding of ``srgc check``.

    Attributes:
        message: what is wrong, without the place.
        source: the file; its text is empty if no line of it is shown.
        span: where in the text; its beginning if the fault concerns the whole file.
    """

    def __init__(
        self,
        code: Code,
        message: str,
        source: Source,
        span: Span = WHOLE,
        hint: str | None = None,
    ) -> None:
        super().__init__(message, code=code, hint=hint)
        self.message, self.source, self.span = message, source, span
        self._code = code

    def __str__(self) -> str:
        return self.finding()

    def finding(self, *, colour: bool = False) -> str:
        """The place, the message, the line with carets, and the hint."""
        found = Diagnostic(self._code, Severity.ERROR, self.message, self.span, self.hint)
        return to_text([found], [self.source], colour=colour).rstrip("\n")

    def in_python(self) -> str:
        """The place and the message, without the line and the hint."""
        return self.finding().split("\n", 1)[0]


def file_fault(
    path: Path | str, message: str, hint: str | None = None, code: Code = Code.FOREIGN_FILE
) -> SourceFault:
    """A fault that concerns a whole file."""
    return SourceFault(code, message, Source(str(path), ""), hint=hint)


def line_span(text: str, number: int) -> Span:
    """The line ``number`` of a text, counted from 1, without blanks at its ends."""
    start = 0
    for _ in range(number - 1):
        start = text.index("\n", start) + 1
    end = text.find("\n", start)
    line = text[start : len(text) if end < 0 else end]
    begin = start + len(line) - len(line.lstrip())
    return Span(begin, begin + max(1, len(line.strip())))
