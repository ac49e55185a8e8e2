"""The cells of a workspace as a picture, and the runs that views highlight."""

from __future__ import annotations

from collections.abc import Container, Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Literal, SupportsFloat, TypeAlias, assert_never

from compiler.words.pushdown_automaton import Pda, Transition, accepting_run
from grammar_lang.ir import Workspace

if TYPE_CHECKING:  # the views of families do not need numpy
    from compiler.workspaces.abstraction import Abstraction, Cell, CellKind

# --------------------------------------------------------------------------------------------------
# The cells of a workspace as a picture: nodes where cells are, edges where they are adjacent.
#
# Source: Section 3, W = (P, H, N). Space is drawn in oblique projection.


WIDTH_INCHES = 9.0
CELL_INCHES = 1.1
"""The average side length available to a cell; the picture grows with the number of cells."""
OBLIQUE = 0.4


def workspace_view(abstraction: Abstraction, workspace: Workspace) -> Picture:
    """An undirected picture, drawn to scale; the hint of a cell is its size and inequalities."""
    corners = [drawn(v) for cell in abstraction.cells for v in cell.polytope.vertices]
    extent = max(max(axis) - min(axis) for axis in zip(*corners, strict=True))
    scale = max(WIDTH_INCHES, CELL_INCHES * len(abstraction.cells) ** 0.5) / extent
    nodes: list[Node] = []
    for cell in abstraction.cells:
        x, y = drawn(cell.polytope.centre)
        nodes.append(
            Node(
                cell.name,
                cell_label(cell),
                "box",
                data={"cell": cell},
                place=(scale * x, scale * y),
                fill=_colour(cell.kind),
                hint=_hint(cell),
            )
        )
    edges = tuple(
        Edge(abstraction.cells[i].name, abstraction.cells[j].name) for i, j in abstraction.adjacency
    )
    return Picture(workspace.name, "box", tuple(nodes), edges, directed=False)


def cell_label(cell: Cell) -> str:
    """The name of a cell and, if it lies in other regions too, its propositions below it."""
    others = cell.propositions - {cell.region}
    return f"{cell.name}\n{{{', '.join(sorted(cell.propositions))}}}" if others else cell.name


def _hint(cell: Cell) -> str:
    unit = "m^2" if cell.polytope.dimension == 2 else "m^3"
    return f"{float(cell.volume):.6g} {unit}: {', '.join(cell.polytope.inequalities())}"


def drawn(point: Sequence[SupportsFloat]) -> tuple[float, float]:
    """Where a point is drawn: x to the right and y up; in space z up and y into the page."""
    if len(point) == 2:
        return float(point[0]), float(point[1])
    x, y, z = (float(coordinate) for coordinate in point)
    return x + OBLIQUE * y, z + OBLIQUE * y


def _colour(kind: CellKind) -> str:
    match kind:
        case "obstacle":
            return "#e0897e"
        case "target":
            return "#8fc98b"
        case "region":
            return "#8db7dd"
        case "free":
            return "#f7f7f7"
        case _:
            assert_never(kind)


# --------------------------------------------------------------------------------------------------
# The elements of a view: nodes and edges in a fixed order, independent of any drawing program.


Shape: TypeAlias = Literal["circle", "ellipse", "box", "plaintext"]


@dataclass(frozen=True, slots=True)
class Node:
    """A node; ``double`` draws its outline twice, ``highlighted`` in colour.

    ``data`` says for programs what the node stands for; it is not drawn. ``place`` fixes the
    centre, in inches, x to the right and y up; ``fill`` is a colour as ``#rrggbb``; ``hint`` is
    shown where a drawing supports tooltips.
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
    """A graph; ``shape`` is the shape of most of its nodes, ``title`` is written above it.

    The lines of ``caption`` are written below it.
    """

    name: str
    shape: Shape
    nodes: tuple[Node, ...]
    edges: tuple[Edge, ...]
    initial: tuple[Arrow, ...] = ()
    title: str = ""
    directed: bool = True
    caption: tuple[str, ...] = ()


# --- The runs that views highlight, and the error if there is none --------------------------------


class HighlightError(ValueError):
    """A word cannot be highlighted; the message gives the reason."""


def refuse_unknown(word: Sequence[str], alphabet: Container[str]) -> None:
    """Reject a word with a token that is not a symbol.

    Raises:
        HighlightError: there is such a token; the message names it.
    """
    for token in word:
        if token not in alphabet:
            raise HighlightError(f"`{token}` is not a symbol of the words")


def not_accepted(word: Sequence[str]) -> HighlightError:
    """The error for a word that is not accepted."""
    said = f"the word `{' '.join(word)}`" if word else "the empty word"
    return HighlightError(f"{said} is not accepted")


def run_of(pda: Pda, word: Sequence[str]) -> tuple[Transition, ...]:
    """The transitions of an accepting run of a word.

    Raises:
        HighlightError: a symbol is unknown, or the word is not accepted.
    """
    refuse_unknown(word, pda.alphabet)
    run = accepting_run(pda, word)
    if run is None:
        raise not_accepted(word)
    return run
