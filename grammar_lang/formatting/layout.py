"""The canonical lines of a parsed text.

Bodies of grammars, semantics, workspaces and tasks have one statement a line; those of modules,
semantic blocks and polytopes only where they do not fit on one line or hold a comment.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from grammar_lang.formatting.comments import Boundary, Comment, Written, boundary
from grammar_lang.formatting.line_breaking import WIDTH, Atom, Line, broken, flat
from grammar_lang.formatting.outline import Statement, outline
from grammar_lang.formatting.spacing import Spacing, spacing

INDENT = 2
ALIGNED_WIDTH = 72
"""Comments at the ends of lines are aligned where the code of the lines is no wider."""

_OPENING = frozenset({"(", "["})
_CLOSING = frozenset({")", "]", ",", ";"})


def _blank_line() -> Line:
    return Line(0, "")


def _write(lines: list[Line], border: Boundary, indent: int) -> None:
    """The comments between two statements, but for those that lead the next."""
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
        """Every item; around those of several lines are blank lines."""
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
        """A statement with its body, if it may be one line and fits."""
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
        """Tokens with the comments between them."""
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
        """The comments before a token, and the token."""
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
    """Per line the column at which its trailing comment begins.

    Those of consecutive lines of the same indentation begin at the same column.
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
