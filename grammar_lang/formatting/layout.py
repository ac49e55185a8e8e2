"""The canonical lines of a parsed text.

Bodies of grammars, semantics, workspaces, tasks and missions have one statement per line.  Bodies
of modules, semantic blocks and polytopes have that only if they do not fit on one line or hold a
comment.

A line is broken where its rank is lowest, at the last such place within 100 columns.  This is
greedy, so the time is linear.  A line is never broken next to a comment unless it was broken there
before.  So the places do not depend on earlier breaks, and formatting again changes nothing.

Statements and bodies form a tree of braces and semicolons, at most four deep (item, block,
statement, inequality), whatever the text.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from typing import NamedTuple

from grammar_lang.formatting.comments import Boundary, Comment, Written, boundary
from grammar_lang.formatting.spacing import NEVER, Spacing, spacing

INDENT = 2
ALIGNED_WIDTH = 72
"""Comments at line ends are aligned if the code of their lines is at most this wide."""

_OPENING = frozenset({"(", "["})
_CLOSING = frozenset({")", "]", ",", ";"})


def _blank_line() -> Line:
    return Line(0, "")


def _write(lines: list[Line], border: Boundary, indent: int) -> None:
    """Add the comments between two statements, except those that lead the next one."""
    if border.trailing:
        lines[-1].trailing = border.trailing
    for blank, text in border.above:
        if blank:
            lines.append(_blank_line())
        lines.append(Line(indent, text))
    if border.blank:
        lines.append(_blank_line())


@dataclass(frozen=True, slots=True)
class _Layout:
    written: Written
    spacing: Spacing

    def file(self) -> list[Line]:
        """The lines of all items; an item of several lines has blank lines around it."""
        lines: list[Line] = []
        gaps = self.written.gaps
        items = outline(self.written.kinds)
        long_before = False
        for k, item in enumerate(items):
            border = boundary(gaps[item.first], follows=k > 0, first=k == 0, last=False)
            made = self._statement(item, 0, border.leading)
            is_long = len(made) > 1 or "\n" in made[0].code
            if k > 0 and (is_long or long_before):
                border = border.parted()
            _write(lines, border, 0)
            lines += made
            long_before = is_long
        end = boundary(gaps[-1], follows=bool(items), first=not items, last=True)
        _write(lines, end, 0)
        return lines

    def _statement(self, statement: Statement, indent: int, leading: Sequence[str]) -> list[Line]:
        before = [Atom(text, blank=True) for text in leading]
        if statement.opens < 0:
            atoms = before + self._atoms(statement.first, statement.stop)
            return broken(atoms, indent)
        if (one_line := self._on_one_line(statement, indent, before)) is not None:
            return [one_line]
        head = self._atoms(statement.first, statement.opens + 1)
        lines = broken(before + head, indent)
        self._body(statement, indent + INDENT, lines)
        return lines + broken(self._atoms(statement.closes, statement.stop), indent)

    def _body(self, outer: Statement, indent: int, lines: list[Line]) -> None:
        gaps = self.written.gaps
        for k, statement in enumerate(outer.body):
            border = boundary(gaps[statement.first], follows=True, first=k == 0, last=False)
            _write(lines, border, indent)
            lines += self._statement(statement, indent, border.leading)
        empty = not outer.body
        border = boundary(gaps[outer.closes], follows=True, first=empty, last=True)
        _write(lines, border, indent)

    def _on_one_line(self, statement: Statement, indent: int, before: list[Atom]) -> Line | None:
        """A statement with its body on one line; None if that is not allowed or does not fit."""
        if statement.spread and statement.body:
            return None
        texts, gaps = self.written.texts, self.written.gaps
        width = indent
        for i in range(statement.first, statement.stop):
            width += len(texts[i])
            if width > WIDTH or (i > statement.first and gaps[i].comments):
                return None
        code = flat(before + self._atoms(statement.first, statement.stop))
        return Line(indent, code) if indent + len(code) <= WIDTH else None

    def _atoms(self, first: int, stop: int) -> list[Atom]:
        """The tokens of a range, with the comments between them."""
        texts, gaps = self.written.texts, self.written.gaps
        blanks, ranks = self.spacing.blanks, self.spacing.ranks
        atoms = [Atom(texts[first], blank=True)]
        for i in range(first + 1, stop):
            if gaps[i].comments:
                self._commented(i, atoms)
            else:
                atoms.append(Atom(texts[i], blanks[i], ranks[i]))
        return atoms

    def _commented(self, here: int, atoms: list[Atom]) -> None:
        """Add the comments before a token, and the token."""
        gap = self.written.gaps[here]
        blank = atoms[-1].text not in _OPENING
        before: Comment | None = None
        for comment in gap.comments:
            starts = comment.breaks > 0 or (before is not None and before.of_lines)
            atoms.append(Atom(comment.text, blank, starts=starts, ends=comment.to_line_end))
            blank, before = True, comment
        starts = gap.breaks > 0 or gap.comments[-1].of_lines
        text = self.written.texts[here]
        atoms.append(Atom(text, text not in _CLOSING, starts=starts))


def _align(lines: Sequence[Line]) -> list[int]:
    """For each line, the column at which its trailing comment begins.

    In consecutive lines of the same indentation they begin at the same column.
    """
    columns = [line.indent + len(line.code) + 2 for line in lines]
    begin = 0
    while begin < len(lines):
        stop = begin + 1
        if _alignable(lines[begin]):
            indent = lines[begin].indent
            while stop < len(lines) and lines[stop].indent == indent and _alignable(lines[stop]):
                stop += 1
            columns[begin:stop] = [max(columns[begin:stop])] * (stop - begin)
        begin = stop
    return columns


def _alignable(line: Line) -> bool:
    if not line.trailing or "\n" in line.trailing or "\n" in line.code:
        return False
    return line.indent + len(line.code) <= ALIGNED_WIDTH


def _text(line: Line, column: int) -> str:
    code = " " * line.indent + line.code if line.code else ""
    return code.ljust(column) + line.trailing if line.trailing else code


def lay_out(written: Written) -> str:
    """The canonical text of a parsed text."""
    lines = _Layout(written, spacing(written.kinds)).file()
    columns = _align(lines)
    return "".join(f"{_text(line, column)}\n" for line, column in zip(lines, columns, strict=True))


# --- line breaks ------------------------------------------------------------------------------


WIDTH = 100
CONTINUATION = 4


class Atom(NamedTuple):
    """A token or a comment in a statement.

    Attributes:
        text: its text.
        blank: whether a space goes before it, unless it begins a line.
        rank: the rank of a line break before it.
        starts: whether it always begins a line.
        ends: whether it is a ``//`` comment, so that what follows begins a line.
    """

    text: str
    blank: bool
    rank: int = NEVER
    starts: bool = False
    ends: bool = False


@dataclass(slots=True)
class Line:
    """A line of the canonical text; a comment in it may span further lines."""

    indent: int
    code: str
    trailing: str = ""


def _column(column: int, text: str) -> int:
    """The column at which a text ends; only its first line counts."""
    return column + len(text.partition("\n")[0])


def _first_line(atoms: Sequence[Atom], begin: int, indent: int) -> int:
    """The index of the first atom that is not on the line beginning with atom ``begin``."""
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
    """All atoms on one line."""
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
    """Split the atoms where a line always begins."""
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


# --- statements -------------------------------------------------------------------------------


_SPREAD = frozenset({"grammar", "semantics", "workspace", "task", "mission"})


@dataclass(slots=True)
class Statement:
    """The tokens ``first <= i < stop``, with a body between the braces ``opens`` and ``closes``.

    Without a body ``opens`` is -1.  A ``spread`` body always has one statement per line.
    """

    first: int
    stop: int = -1
    opens: int = -1
    closes: int = -1
    spread: bool = False
    body: list[Statement] = field(default_factory=list["Statement"])


def outline(kinds: Sequence[str]) -> list[Statement]:
    """The items of a text without errors, given as its terminals."""
    stack = [Statement(0)]
    first = 0
    ended: Statement | None = None
    """The statement whose body has ended and whose ``;`` is still to come."""
    choices = False
    for here, kind in enumerate(kinds):
        if kind == "{":
            if kinds[here - 1] == "in":
                choices = True
                continue
            spread = len(stack) == 1 and kinds[first] in _SPREAD
            stack.append(Statement(first, opens=here, spread=spread))
            first = here + 1
        elif kind == ";":
            done = ended or Statement(first)
            done.stop = first = here + 1
            stack[-1].body.append(done)
            ended = None
        elif kind == "}" and choices:
            choices = False
        elif kind == "}":
            closed = stack.pop()
            if first < here:
                closed.body.append(Statement(first, here))
            closed.closes = here
            if kinds[closed.opens - 1] == "polytope":
                ended = closed
            else:
                closed.stop = here + 1
                stack[-1].body.append(closed)
            first = here + 1
    return stack[0].body
