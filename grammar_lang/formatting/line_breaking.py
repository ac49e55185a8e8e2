"""Statements as lines of at most 100 columns.

A line is broken where its rank is lowest, at the last such place that fits: greedily, so the time
is linear.  A line is never broken beside a comment, unless it was: so the places do not depend on
earlier breaks, and what was broken once is broken the same way again.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import NamedTuple

from grammar_lang.formatting.spacing import NEVER

WIDTH = 100
CONTINUATION = 4


class Atom(NamedTuple):
    """A token or a comment in a statement.

    Attributes:
        text: its text.
        blank: whether a blank goes before it, where it does not begin a line.
        rank: of a line break before it.
        starts: whether it begins a line in any case.
        ends: whether it is a ``//`` comment; what follows then begins a line.
    """

    text: str
    blank: bool
    rank: int = NEVER
    starts: bool = False
    ends: bool = False


@dataclass(slots=True)
class Line:
    """A line of the canonical text; a comment in it may have further lines of its own."""

    indent: int
    code: str
    trailing: str = ""


def _column(column: int, text: str) -> int:
    """Where a text ends that begins at a column; only its first line counts."""
    return column + len(text.partition("\n")[0])


def _first_line(atoms: Sequence[Atom], begin: int, indent: int) -> int:
    """Where the line that begins with an atom stops."""
    column = indent
    best, lowest = 0, NEVER
    for i in range(begin, len(atoms)):
        text, blank, rank, _, ends = atoms[i]
        if i > begin and rank <= lowest and rank != NEVER and column <= WIDTH:
            best, lowest = i, rank
        if ends:
            continue
        column = _column(column + (blank and i > begin), text)
        if column > WIDTH and best:
            return best
        if column > WIDTH and i > begin and rank != NEVER:
            return i
    return len(atoms)


def flat(atoms: Iterable[Atom]) -> str:
    """All on one line."""
    parts: list[str] = []
    for atom in atoms:
        if parts and atom.blank:
            parts.append(" ")
        parts.append(atom.text)
    return "".join(parts)


def _line(atoms: Sequence[Atom], indent: int) -> Line:
    if len(atoms) > 1 and atoms[-1].ends:
        return Line(indent, flat(atoms[:-1]), atoms[-1].text)
    return Line(indent, flat(atoms))


def _segments(atoms: Sequence[Atom]) -> Iterable[Sequence[Atom]]:
    """Cut where a line begins in any case."""
    begin = 0
    for i in range(1, len(atoms)):
        if atoms[i].starts or atoms[i - 1].ends:
            yield atoms[begin:i]
            begin = i
    yield atoms[begin:]


def broken(atoms: Sequence[Atom], indent: int) -> list[Line]:
    """The lines of a statement: the first at ``indent``, the others further in."""
    lines: list[Line] = []
    column = indent
    for segment in _segments(atoms):
        begin = 0
        while begin < len(segment):
            stop = _first_line(segment, begin, column)
            lines.append(_line(segment[begin:stop], column))
            begin, column = stop, indent + CONTINUATION
    return lines
