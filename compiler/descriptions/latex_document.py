"""Documents as LaTeX, to be included in a document that loads amsmath."""

from __future__ import annotations

import re
from collections.abc import Sequence
from itertools import groupby

from compiler.descriptions.document import Entry, Equation, Fact, Item, Pieces, Remark, Section

WIDTH = 140
SPECIAL = {
    "\\": r"\textbackslash{}", "{": r"\{", "}": r"\}", "_": r"\_", "&": r"\&", "%": r"\%",
    "$": r"\$", "#": r"\#", "^": r"\textasciicircum{}", "~": r"\textasciitilde{}",
    "<": r"\textless{}", ">": r"\textgreater{}", "|": r"\textbar{}",
}  # fmt: skip


def to_latex(sections: Sequence[Section]) -> str:
    """Sections without numbers, their tables and aligned equations."""
    lines = ["% needs \\usepackage{amsmath}"]
    for section in sections:
        lines.append(rf"\section*{{{escaped(section.title)}}}")
        for kind, group in groupby(section.items, key=type):
            lines += _block(kind, list(group))
    return "\n".join(lines) + "\n"


def escaped(text: str) -> str:
    """Plain text in LaTeX."""
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
    """A remark, with what is quoted by backticks in a typewriter face."""
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
    rows = [line for equation in equations for line in _broken(equation.left[1], equation.right[1])]
    return [r"\begin{align*}", *(rf"{row} \\" for row in rows[:-1]), rows[-1], r"\end{align*}"]


def _broken(left: str, right: Pieces) -> list[str]:
    lines = [f"{left} &="]
    for number, (negative, text) in enumerate(right):
        sign = ("-" if negative else "") if number == 0 else ("- " if negative else "+ ")
        if number and len(lines[-1]) + len(text) > WIDTH:
            lines.append(rf"&\quad {{}} {sign}{text}")
        else:
            lines[-1] += f" {sign}{text}"
    return lines
