"""Converts between offsets in a text and positions of the Language Server Protocol.

Source: *Language Server Protocol 3.17*, sections "Position" and "Text Documents": a line ends with
LF, CR LF or CR; characters count in code units of the encoding that client and server have agreed
on, by default UTF-16.
"""

from __future__ import annotations

import re
from bisect import bisect_right

from lsprotocol import types as lsp

from grammar_lang.source import Span

UTF8, UTF16, UTF32 = "utf-8", "utf-16", "utf-32"
_END = re.compile(r"\r\n|\n|\r")


def units(text: str, encoding: str) -> int:
    """The number of code units of a text."""
    if encoding == UTF32 or text.isascii():
        return len(text)
    if encoding == UTF8:
        return len(text.encode("utf-8", "surrogatepass"))
    return len(text) + sum(character > "\uffff" for character in text)


class LineMap:
    """The lines of a text; every position that a client may send has an offset."""

    def __init__(self, text: str, encoding: str = UTF16) -> None:
        self.text = text
        self._encoding = encoding
        self._plain = encoding == UTF32 or text.isascii()
        ends = [(found.start(), found.end()) for found in _END.finditer(text)]
        self._starts = [0, *(end for _, end in ends)]
        self._stops = [*(start for start, _ in ends), len(text)]

    def position(self, offset: int) -> lsp.Position:
        """The position of an offset, or of the nearest valid offset."""
        offset = min(max(offset, 0), len(self.text))
        line = bisect_right(self._starts, offset) - 1
        start = self._starts[line]
        offset = max(min(offset, self._stops[line]), start)
        if self._plain:
            return lsp.Position(line, offset - start)
        return lsp.Position(line, units(self.text[start:offset], self._encoding))

    def offset(self, position: lsp.Position) -> int:
        """The offset of a position; beyond the end of a line or the text, that of the end."""
        if position.line < 0:
            return 0
        if position.line >= len(self._starts):
            return len(self.text)
        start, stop = self._starts[position.line], self._stops[position.line]
        if self._plain:
            return min(start + max(position.character, 0), stop)
        left = position.character
        for here in range(start, stop):
            left -= units(self.text[here], self._encoding)
            if left < 0:
                return here
        return stop

    def range(self, span: Span) -> lsp.Range:
        """The range of a span of this text."""
        return lsp.Range(self.position(span.start), self.position(span.end))

    @property
    def whole(self) -> lsp.Range:
        """The range from the first character to the last."""
        return lsp.Range(lsp.Position(0, 0), self.position(len(self.text)))
