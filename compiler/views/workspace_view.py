"""The cells of a workspace as a picture: nodes where cells are, edges where they are adjacent.

Source: Section 3, W = (P, H, N).  Space is seen obliquely.
"""

from __future__ import annotations

from typing import assert_never

from compiler.geometry.abstraction import Abstraction, CellKind
from compiler.geometry.double_description import Point
from compiler.views.picture import Edge, Node, Picture
from grammar_lang.ir import Workspace

WIDTH_INCHES = 9.0
OBLIQUE = 0.4


def workspace_view(abstraction: Abstraction, workspace: Workspace) -> Picture:
    """An undirected picture, drawn to scale; the hint of a cell is its inequalities."""
    corners = [_drawn(v) for cell in abstraction.cells for v in cell.polytope.vertices]
    extent = max(max(axis) - min(axis) for axis in zip(*corners, strict=True))
    scale = WIDTH_INCHES / extent
    nodes: list[Node] = []
    for cell in abstraction.cells:
        x, y = _drawn(cell.polytope.centre)
        nodes.append(
            Node(
                cell.name,
                cell.name,
                "box",
                data={"cell": cell},
                place=(scale * x, scale * y),
                fill=_colour(cell.kind),
                hint=", ".join(cell.polytope.inequalities()),
            )
        )
    edges = tuple(
        Edge(abstraction.cells[i].name, abstraction.cells[j].name) for i, j in abstraction.adjacency
    )
    return Picture(workspace.name, "box", tuple(nodes), edges, directed=False)


def _drawn(point: Point) -> tuple[float, float]:
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
