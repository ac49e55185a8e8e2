"""Findings that only follow from a syntax error, and therefore say nothing new.

A statement that cannot be read is dropped; whoever then misses a name that stands in it, or a
clause of its item, is not told so.
"""

from __future__ import annotations

import re
from bisect import bisect_right
from collections.abc import Iterable, Sequence

from grammar_lang.findings.codes import Code
from grammar_lang.findings.diagnostics import Diagnostic
from grammar_lang.source import Span
from grammar_lang.syntax_tasks import File

_WORD = re.compile(r"[A-Za-z_][A-Za-z0-9_]*")
_QUOTED = re.compile(r"`([^`]*)`")

_MISSING = frozenset(
    {
        Code.MISSING_CLAUSE,
        Code.MISSING_START,
        Code.MISSING_BLOCK,
        Code.BAD_DOF_USE,
        Code.UNDEFINED_ATTRIBUTE,
        Code.BAD_DYNAMICS,
    }
)
_NAMED = _MISSING | {Code.UNKNOWN_NAME, Code.UNUSED_NAME, Code.UNUSED_SYMBOL, Code.UNUSED_OBSTACLE}


class Spans:
    """Disjoint spans, asked which of them covers a place."""

    def __init__(self, spans: Iterable[Span]) -> None:
        self._spans = sorted(spans, key=lambda span: (span.file, span))
        self._starts = [(span.file, span.start) for span in self._spans]

    def covering(self, place: Span) -> Span | None:
        """The span in which, or right after which, ``place`` begins."""
        index = bisect_right(self._starts, (place.file, place.start)) - 1
        if index < 0:
            return None
        found = self._spans[index]
        return found if found.file == place.file and place.start <= found.end else None


def without_followers(
    found: Sequence[Diagnostic], file: File, *, complete: bool = True
) -> tuple[Diagnostic, ...]:
    """The findings that do not merely follow from the syntax errors of a file.

    Args:
        found: all findings.
        file: its syntax, with what could not be read.
        complete: whether all files that it includes were found; if not, no name is unknown.
    """
    if complete and not file.broken:
        return tuple(found)
    broken = Spans(file.broken)

    def follows(diagnostic: Diagnostic) -> bool:
        if diagnostic.code in _MISSING and broken.covering(diagnostic.span):
            return True
        if diagnostic.code not in _NAMED:
            return False
        if not complete:
            return True
        quoted = " ".join(_QUOTED.findall(diagnostic.message))
        return any(word in file.skipped for word in _WORD.findall(quoted))

    return tuple(d for d in found if not follows(d))
