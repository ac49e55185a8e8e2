"""Source texts, positions in them, and the base of all syntax and IR nodes."""

from __future__ import annotations

import re
from bisect import bisect_right
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, fields
from functools import cached_property
from itertools import accumulate
from operator import attrgetter
from typing import Any, NamedTuple, TypeVar, dataclass_transform

# --- Source texts and positions in them -----------------------------------------------------------


_BLANK = re.compile(r"(?:\s|//[^\n]*|/\*(?:[^*]|\*(?!/))*\*/)+")
"""Whitespace and comments."""


class Span(NamedTuple):
    """A half-open range of character offsets in the source number ``file``."""

    start: int
    end: int
    file: int = 0

    def to(self, other: Span) -> Span:
        """The smallest span that covers both."""
        return Span(min(self.start, other.start), max(self.end, other.end), self.file)


@dataclass(frozen=True)
class Source:
    """A file or a text; lines and columns count from 1, and columns count code points.

    ``name`` is what diagnostics call it, ``path`` is its path below the folder of the main file
    (with ``/``), and ``data`` is its bytes.  The text of an image is empty.  If two names lead to
    one file, ``twin`` is the path under which that file was read first.
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
        """The line and column of a character offset."""
        line = bisect_right(self._line_starts, offset)
        return line, offset - self._line_starts[line - 1] + 1

    def line(self, number: int) -> str:
        """The text of line ``number`` without its line break."""
        start = self._line_starts[number - 1]
        end = self._line_starts[number] if number < len(self._line_starts) else len(self.text)
        return self.text[start:end].rstrip("\r\n")


def written(span: Span, sources: Sequence[Source]) -> str | None:
    """A statement as it is written, on one line, without comments and the final semicolon.

    None if its text is not known.
    """
    if span.file >= len(sources) or span.start >= span.end:
        return None
    text = _BLANK.sub(" ", sources[span.file].text[span.start : span.end]).strip()
    return text.removesuffix(";").rstrip() or None


# --- Nodes of trees: immutable values with slots; equality ignores their places in the text -------
#
# Every command first creates about two hundred of these classes.  ``dataclass(frozen=True)``
# generates and compiles six methods for each, which took a third of the time of a ``check``; here
# only ``__init__`` is compiled.  The type checker ensures that nodes are never changed.


Node = TypeVar("Node")


def _key(names: list[str]) -> Callable[[Any], object]:
    return attrgetter(*names) if names else lambda _: ()


@dataclass_transform(frozen_default=True, field_specifiers=(field,))
def node(cls: type[Node]) -> type[Node]:
    """Turn a class into a node: a dataclass that compares all fields but ``compare=False`` ones."""
    made: Any = dataclass(slots=True, eq=False, repr=False)(cls)
    shown = [f.name for f in fields(made) if f.repr]
    compared = _key([f.name for f in fields(made) if f.compare])

    def equal(self: object, other: object) -> Any:
        if self is other:
            return True
        if other.__class__ is not made:
            return NotImplemented
        return compared(self) == compared(other)

    def hashed(self: object) -> int:
        return hash(compared(self))

    def text(self: object) -> str:
        values = (f"{name}={getattr(self, name)!r}" for name in shown)
        return f"{made.__name__}({', '.join(values)})"

    made.__eq__, made.__hash__, made.__repr__ = equal, hashed, text
    found: type[Node] = made
    return found
