"""What a view draws: nodes and edges in a fixed order, without a word of any drawing program."""

from __future__ import annotations

from collections.abc import Container, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Literal, TypeAlias

from compiler.words.pushdown_automaton import Pda, Transition
from compiler.words.pushdown_runs import accepting_run

Shape: TypeAlias = Literal["circle", "ellipse", "box", "plaintext"]


@dataclass(frozen=True, slots=True)
class Node:
    """A node; ``double`` draws its outline twice, ``highlighted`` in colour.

    ``data`` is what the node stands for, for programs; it is not drawn.  ``place`` pins the centre,
    in inches, x to the right and y up; ``fill`` is a colour as ``#rrggbb``; ``hint`` is shown where
    a drawing can be pointed at.
    """

    key: str
    label: str
    shape: Shape = "circle"
    double: bool = False
    highlighted: bool = False
    data: Mapping[str, object] = field(default_factory=dict)
    place: tuple[float, float] | None = None
    fill: str | None = None
    hint: str | None = None


@dataclass(frozen=True, slots=True)
class Edge:
    """An edge between the nodes with these keys; ``lines`` are the lines of its label."""

    tail: str
    head: str
    lines: tuple[str, ...] = ()
    highlighted: bool = False
    data: Mapping[str, object] = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class Arrow:
    """An arrow from nowhere to an initial node."""

    head: str
    label: str = ""
    highlighted: bool = False


@dataclass(frozen=True, slots=True)
class Picture:
    """A graph; ``shape`` is that of most of its nodes, ``title`` is written above it."""

    name: str
    shape: Shape
    nodes: tuple[Node, ...]
    edges: tuple[Edge, ...]
    initial: tuple[Arrow, ...] = ()
    title: str = ""
    directed: bool = True


# --- The runs that views show in colour, and what is said where there is none ---------------------


class HighlightError(ValueError):
    """A word that cannot be highlighted, with the reason."""


def refuse_unknown(word: Sequence[str], alphabet: Container[str]) -> None:
    """Refuse a word with a token that is no symbol.

    Raises:
        HighlightError: there is one; it is named.
    """
    for token in word:
        if token not in alphabet:
            raise HighlightError(f"`{token}` is no symbol of the words")


def not_accepted(word: Sequence[str]) -> HighlightError:
    """The fault of a word over the right symbols."""
    return HighlightError(f"the word `{' '.join(word)}` is not accepted")


def run_of(pda: Pda, word: Sequence[str]) -> tuple[Transition, ...]:
    """The transitions of an accepting run of a word.

    Raises:
        HighlightError: an unknown symbol, or the word is not accepted.
    """
    refuse_unknown(word, pda.alphabet)
    run = accepting_run(pda, word)
    if run is None:
        raise not_accepted(word)
    return run
