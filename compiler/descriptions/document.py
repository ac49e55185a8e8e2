"""A document of titled sections, to be written as plain text or as LaTeX."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TypeAlias

Pieces: TypeAlias = Sequence[tuple[bool, str]]
"""The summands of an expression: whether each is subtracted, and its text."""


@dataclass(frozen=True, slots=True)
class Remark:
    """A line of text."""

    text: str


@dataclass(frozen=True, slots=True)
class Fact:
    """A line of a table of two columns."""

    name: str
    text: str


@dataclass(frozen=True, slots=True)
class Entry:
    """A symbol, plain and in LaTeX, with what it stands for and what is known of its value."""

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
    """A title and what stands below it."""

    title: str
    items: tuple[Item, ...]


def section_of_lines(title: str, lines: Sequence[str]) -> Section:
    """A section of plain lines."""
    return Section(title, tuple(Remark(line) for line in lines))
