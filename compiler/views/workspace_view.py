"""The cells of a workspace as a picture: nodes where cells are, edges where they are adjacent.

Source: Section 3, W = (P, H, N).  Space is seen obliquely.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import SupportsFloat, assert_never

from compiler.views.picture import Edge, Node, Picture
from compiler.workspaces.abstraction import Abstraction, Cell, CellKind
from grammar_lang.ir import Workspace

WIDTH_INCHES = 9.0
CELL_INCHES = 1.1
"""Of many cells the picture grows, so that on average each has so much room to a side."""
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
    """The name, and below it the propositions of a cell that is in other regions too."""
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
