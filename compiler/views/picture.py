"""What a view draws: nodes and edges in a fixed order, without a word of any drawing program."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal, TypeAlias

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
