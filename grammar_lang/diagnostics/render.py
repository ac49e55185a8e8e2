"""Diagnostics as text with the source line and a caret, and as JSON for programs."""

from __future__ import annotations

import json
import re
from collections.abc import Iterable, Sequence

from grammar_lang.diagnostics.diagnostic import Diagnostic, Severity
from grammar_lang.source import Source, Span

_RESET = "\033[0m"
_BOLD = "\033[1m"
_COLOUR = {
    Severity.ERROR: "\033[1;31m",
    Severity.WARNING: "\033[1;33m",
    Severity.NOTE: "\033[1;36m",
}
_FAINT = "\033[36m"

_QUOTED = re.compile(r"`([^`]{60})[^`]+`")
_BY_SEVERITY = {severity: rank for rank, severity in enumerate(Severity)}

MAX_LINE = 160
"""The most characters of a source line that are shown."""


def _paint(text: str, code: str, *, colour: bool) -> str:
    return f"{code}{text}{_RESET}" if colour else text


def _shown(text: str) -> str:
    """The text with each non-printable character but the tab replaced; columns stay the same."""
    return "".join(c if c.isprintable() or c == "\t" else "\N{REPLACEMENT CHARACTER}" for c in text)


def _brief(text: str) -> str:
    """The text for one line, with very long names in it shortened."""
    return _shown(_QUOTED.sub(r"`\1…`", text) if len(text) > MAX_LINE else text)


def _window(text: str, column: int) -> tuple[str, int]:
    """The part of a long line around a column, and the column within that part."""
    if len(text) <= MAX_LINE:
        return text, column
    start = max(0, min(column - 1 - MAX_LINE // 3, len(text) - MAX_LINE))
    part = text[start : start + MAX_LINE]
    if start:
        part = f"…{part[1:]}"
    if start + MAX_LINE < len(text):
        part = f"{part[:-1]}…"
    return part, column - start


def _excerpt(source: Source, span: Span, paint: str, *, colour: bool) -> list[str]:
    """The source line with carets under it; tabs are kept so that they align.

    Empty if the file is empty or could not be read.
    """
    if not source.text:
        return []
    line, column = source.position(span.start)
    part, column = _window(source.line(line), column)
    text = _shown(part)
    width = max(1, min(span.end - span.start, len(text) - column + 1))
    margin = "".join(c if c == "\t" else " " for c in text[: column - 1])
    gutter = f"{line:>5} | "
    carets = _paint("^" * width, paint, colour=colour)
    return [f"{gutter}{text}", f"{' ' * 5} | {margin}{carets}"]


def _place(source: Source, span: Span) -> str:
    line, column = source.position(span.start)
    return f"{_shown(source.name)}:{line}:{column}"


def _foremost(diagnostics: Sequence[Diagnostic], most: int) -> list[Diagnostic]:
    """At most ``most`` diagnostics in their order, the most severe ones."""
    ranks = [_BY_SEVERITY[found.severity] for found in diagnostics]
    chosen = sorted(range(len(ranks)), key=ranks.__getitem__)[:most]
    return [diagnostics[index] for index in sorted(chosen)]


def marked_line(
    sources: Sequence[Source], span: Span, text: str, *, colour: bool = False
) -> list[str]:
    """A text at a place in a source: the place with the text, then the source line and carets."""
    source = sources[span.file]
    excerpt = _excerpt(source, span, _FAINT, colour=colour)
    return [f"{_place(source, span)}: {text}", *excerpt]


def to_text(
    diagnostics: Sequence[Diagnostic],
    sources: Sequence[Source],
    *,
    colour: bool = False,
    most: int | None = None,
) -> str:
    """Every diagnostic with its place, source line, caret and hint; ends with a line break.

    Args:
        diagnostics: the diagnostics.
        sources: ``sources[span.file]`` is the text that a span points into.
        colour: whether the output is a terminal with colours.
        most: the most that are shown, errors first; the rest are counted.
    """
    lines: list[str] = []
    left_out = 0 if most is None else max(0, len(diagnostics) - most)
    shown = diagnostics if most is None or not left_out else _foremost(diagnostics, most)
    for found in shown:
        source, paint = sources[found.span.file], _COLOUR[found.severity]
        kind = _paint(f"{found.severity.value}[{found.code.value}]", paint, colour=colour)
        message = _paint(_brief(found.message), _BOLD, colour=colour)
        lines.append(f"{_place(source, found.span)}: {kind}: {message}")
        lines += _excerpt(source, found.span, paint, colour=colour)
        for span, text in found.notes:
            note = _paint("note", _FAINT, colour=colour)
            lines += marked_line(sources, span, f"{note}: {_brief(text)}", colour=colour)
        if found.hint is not None:
            lines.append(f"  {_paint('hint', _FAINT, colour=colour)}: {_brief(found.hint)}")
    if left_out:
        lines.append(f"and {left_out:,} more; `srgc check --json` prints them all")
    return "".join(f"{line}\n" for line in lines)


def records(
    diagnostics: Iterable[Diagnostic], sources: Sequence[Source]
) -> list[dict[str, str | int | None]]:
    """The diagnostics as the list of objects that ``srgc check --json`` prints."""
    found: list[dict[str, str | int | None]] = []
    for diagnostic in diagnostics:
        source = sources[diagnostic.span.file]
        line, column = source.position(diagnostic.span.start)
        end_line, end_column = source.position(diagnostic.span.end)
        found.append(
            {
                "code": diagnostic.code.value,
                "severity": diagnostic.severity.value,
                "message": _brief(diagnostic.message),
                "file": source.name,
                "line": line,
                "column": column,
                "end_line": end_line,
                "end_column": end_column,
                "hint": None if diagnostic.hint is None else _brief(diagnostic.hint),
            }
        )
    return found


def to_json(diagnostics: Iterable[Diagnostic], sources: Sequence[Source]) -> str:
    """The JSON list of :func:`records`, ending with a line break."""
    return json.dumps(records(diagnostics, sources), indent=2, ensure_ascii=False) + "\n"
