"""The cells of a workspace as a DOT graph: nodes where cells are, edges where they are adjacent.

Source: Section 3, W = (P, H, N); the DOT language, graphviz.org.  Positions are pinned, so
``neato -n2`` and ``layout=neato`` draw the workspace as it lies; space is drawn obliquely.
"""

from __future__ import annotations

from typing import assert_never

from compiler.geometry.abstraction import Abstraction, CellKind
from compiler.geometry.double_description import Point
from grammar_lang.ir import Workspace

WIDTH_INCHES = 9.0
OBLIQUE = 0.4


def workspace_dot(abstraction: Abstraction, workspace: Workspace) -> str:
    """An undirected graph; the same abstraction gives the same text."""
    centres = [_drawn(cell.polytope.centre) for cell in abstraction.cells]
    corners = [_drawn(v) for cell in abstraction.cells for v in cell.polytope.vertices]
    extent = max(max(axis) - min(axis) for axis in zip(*corners, strict=True))
    scale = WIDTH_INCHES / extent
    lines = [
        f"graph {_quoted(workspace.name)} {{",
        "  graph [layout=neato, splines=line];",
        '  node [shape=box, style=filled, fontname="sans-serif", fontsize=10];',
    ]
    for cell, (x, y) in zip(abstraction.cells, centres, strict=True):
        attributes = [
            f'pos="{scale * x:.4f},{scale * y:.4f}!"',
            f'fillcolor="{_colour(cell.kind)}"',
            f"tooltip={_quoted(', '.join(cell.polytope.inequalities()))}",
        ]
        lines.append(f"  {_quoted(cell.name)} [{', '.join(attributes)}];")
    for i, j in abstraction.adjacency:
        first, second = abstraction.cells[i].name, abstraction.cells[j].name
        lines.append(f"  {_quoted(first)} -- {_quoted(second)};")
    return "\n".join([*lines, "}", ""])


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


def _quoted(text: str) -> str:
    """A DOT string: quote, backslash and line break are escaped."""
    escaped = text.replace("\\", "\\\\").replace('"', '\\"').replace("\n", "\\n")
    return f'"{escaped}"'
