"""A document of titled sections, written as plain text or as LaTeX that loads amsmath."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import groupby
from typing import TypeAlias

Pieces: TypeAlias = Sequence[tuple[bool, str]]
"""The summands of an expression: whether each is subtracted, and its text."""


@dataclass(frozen=True, slots=True)
class Remark:
    """A line of text."""

    text: str


@dataclass(frozen=True, slots=True)
class Fact:
    """A row of a table with two columns."""

    name: str
    text: str


@dataclass(frozen=True, slots=True)
class Entry:
    """A symbol, plain and in LaTeX, with its meaning and what is known about its value."""

    symbol: tuple[str, str]
    meaning: str
    bounds: str


@dataclass(frozen=True, slots=True)
class Equation:
    """``left = sum of pieces``, each plain and in LaTeX."""

    left: tuple[str, str]
    right: tuple[Pieces, Pieces]


Item: TypeAlias = Remark | Fact | Entry | Equation


@dataclass(frozen=True, slots=True)
class Section:
    """A title and the items below it."""

    title: str
    items: tuple[Item, ...]


def section_of_lines(title: str, lines: Sequence[str]) -> Section:
    """A section of plain lines."""
    return Section(title, tuple(Remark(line) for line in lines))


TEXT_WIDTH = 96
INDENT = "  "


def to_text(sections: Sequence[Section]) -> str:
    """Sections with underlined titles, aligned columns, and long sums broken before an operator."""
    return "\n".join("\n".join(_text_section(section)) + "\n" for section in sections)


def _text_section(section: Section) -> list[str]:
    lines = [section.title, "-" * len(section.title)]
    names = [item.name for item in section.items if isinstance(item, Fact)]
    names += [item.symbol[0] for item in section.items if isinstance(item, Entry)]
    meanings = [item.meaning for item in section.items if isinstance(item, Entry)]
    widths = max(map(len, names), default=0), max(map(len, meanings), default=0)
    for item in section.items:
        lines += _text_item(item, *widths)
    return lines


def _text_item(item: Item, first: int, second: int) -> list[str]:
    match item:
        case Remark(text):
            return [text]
        case Fact(name, text):
            return [f"{name:<{first}}  {text}"]
        case Entry((symbol, _), meaning, bounds):
            return [f"{symbol:<{first}}  {meaning:<{second}}  {bounds}".rstrip()]
        case Equation((left, _), (right, _)):
            return _broken_text(left, right)


def _broken_text(left: str, right: Pieces) -> list[str]:
    """An equation in lines of at most ``TEXT_WIDTH`` characters, if its summands allow it."""
    lines = [f"{left} ="]
    for number, (negative, text) in enumerate(right):
        sign = ("-" if negative else "") if number == 0 else ("- " if negative else "+ ")
        if number and len(lines[-1]) + len(sign) + len(text) + 1 > TEXT_WIDTH:
            lines.append(INDENT * 2 + sign + text)
        else:
            lines[-1] += f" {sign}{text}"
    return lines


LATEX_WIDTH = 140
SPECIAL = {
    "\\": r"\textbackslash{}", "{": r"\{", "}": r"\}", "_": r"\_", "&": r"\&", "%": r"\%",
    "$": r"\$", "#": r"\#", "^": r"\textasciicircum{}", "~": r"\textasciitilde{}",
    "<": r"\textless{}", ">": r"\textgreater{}", "|": r"\textbar{}",
}  # fmt: skip


def to_latex(sections: Sequence[Section]) -> str:
    """Sections without numbers, with their tables and aligned equations."""
    lines = ["% needs \\usepackage{amsmath}"]
    for section in sections:
        lines.append(rf"\section*{{{escaped(section.title)}}}")
        for kind, group in groupby(section.items, key=type):
            lines += _block(kind, list(group))
    return "\n".join(lines) + "\n"


def escaped(text: str) -> str:
    """Plain text, escaped for LaTeX."""
    return "".join(SPECIAL.get(character, character) for character in text)


def _block(kind: type, items: Sequence[Item]) -> list[str]:
    if kind is Remark:
        return [rf"{_remark(item.text)}\par" for item in items if isinstance(item, Remark)]
    if kind is Equation:
        return _align([item for item in items if isinstance(item, Equation)])
    rows = [_row(item) for item in items]
    columns = "ll" if kind is Fact else "lll"
    return [rf"\noindent\begin{{tabular}}{{{columns}}}", *rows, r"\end{tabular}\par"]


def _remark(text: str) -> str:
    """A remark, with text in backticks set in typewriter face."""
    return re.sub(r"`([^`]*)`", r"\\texttt{\1}", escaped(text))


def _row(item: Item) -> str:
    match item:
        case Fact(name, text):
            return rf"{escaped(name)} & {escaped(text)} \\"
        case Entry((_, symbol), meaning, bounds):
            return rf"${symbol}$ & {escaped(meaning)} & {escaped(bounds)} \\"
        case _:
            raise TypeError(f"no row of a table: {item}")


def _align(equations: Sequence[Equation]) -> list[str]:
    rows = [
        line
        for equation in equations
        for line in _broken_latex(equation.left[1], equation.right[1])
    ]
    return [r"\begin{align*}", *(rf"{row} \\" for row in rows[:-1]), rows[-1], r"\end{align*}"]


def _broken_latex(left: str, right: Pieces) -> list[str]:
    lines = [f"{left} &="]
    for number, (negative, text) in enumerate(right):
        sign = ("-" if negative else "") if number == 0 else ("- " if negative else "+ ")
        if number and len(lines[-1]) + len(text) > LATEX_WIDTH:
            lines.append(rf"&\quad {{}} {sign}{text}")
        else:
            lines[-1] += f" {sign}{text}"
    return lines
