"""Source texts and positions in them."""

from __future__ import annotations

import re
from bisect import bisect_right
from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property
from itertools import accumulate
from typing import NamedTuple

_BLANK = re.compile(r"(?:\s|//[^\n]*|/\*(?:[^*]|\*(?!/))*\*/)+")
"""Blanks and comments."""


class Span(NamedTuple):
    """Half-open range of character offsets into the source number ``file``."""

    start: int
    end: int
    file: int = 0

    def to(self, other: Span) -> Span:
        """The smallest span that covers both."""
        return Span(min(self.start, other.start), max(self.end, other.end), self.file)


@dataclass(frozen=True)
class Source:
    """A file or a text; lines and columns count from 1, columns in code points.

    ``name`` is what diagnostics call it, ``path`` where it lies below the folder of the main file
    (with ``/``), ``data`` its bytes.  The text of an image is empty.  ``twin`` is the path under
    which the same file was read before, where two names lead to one file.
    """

    name: str
    text: str = field(repr=False)
    path: str = ""
    data: bytes = field(default=b"", repr=False)
    twin: str | None = None

    @cached_property
    def _line_starts(self) -> list[int]:
        lines = self.text.split("\n")
        return list(accumulate((len(line) + 1 for line in lines[:-1]), initial=0))

    def position(self, offset: int) -> tuple[int, int]:
        """Line and column of a character offset."""
        line = bisect_right(self._line_starts, offset)
        return line, offset - self._line_starts[line - 1] + 1

    def line(self, number: int) -> str:
        """The text of line ``number`` without its line break."""
        start = self._line_starts[number - 1]
        end = self._line_starts[number] if number < len(self._line_starts) else len(self.text)
        return self.text[start:end].rstrip("\r\n")


def written(span: Span, sources: Sequence[Source]) -> str | None:
    """A statement as it is written, on one line, without comments and the semicolon at its end.

    None where its text is not known.
    """
    if span.file >= len(sources) or span.start >= span.end:
        return None
    text = _BLANK.sub(" ", sources[span.file].text[span.start : span.end]).strip()
    return text.removesuffix(";").rstrip() or None
