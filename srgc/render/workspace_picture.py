"""A workspace as a picture: cells by kind, their names, adjacency, and paths through them.

Source: Section 3, W = (P, H, N), and the figures of the case study.  Space is seen obliquely.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from compiler.arrays import Array
from compiler.workspaces.abstraction import Abstraction, Cell
from grammar_lang.ir import Workspace
from srgc.render.cell_names import CellNames
from srgc.render.html_text import many
from srgc.render.svg import PADDING, SAMPLE, SHAPES, View, document, fitted, line_path, moved, place
from srgc.render.workspace_drawing import (
    AXES_ROOM,
    KIND_SAMPLES,
    cell_path,
    cell_shape,
    plane_axes,
    shape_marks,
    triad,
    workspace_shapes,
)

NARROWEST, WIDEST, PER_CELL = 560.0, 1180.0, 60.0
"""The width of the picture: the last times the root of the number of cells, within the others."""
TALLEST = 1.3
"""The largest height of the picture, as a multiple of that width."""
MOST_LINKED = 100
"""With more cells, adjacency is not drawn: its lines hide names, and cells that touch show it."""
IN_SPACE = 11.0
"""The size of names in space."""


def workspace_svg(
    abstraction: Abstraction,
    workspace: Workspace,
    paths: Sequence[Sequence[int]] = (),
    title: str | None = None,
) -> str:
    """The picture as SVG.

    Args:
        abstraction: the cells.
        workspace: the workspace of the cells.
        paths: indices of cells; a path is straight between cells that are not neighbours.
        title: the text above the picture; by default the name of the workspace.
    """
    cells, plane = abstraction.cells, workspace.dimension == 2
    shapes = [cell_shape(cell) for cell in _ordered(cells)]
    bounds = workspace_shapes(workspace, ())[:1]
    width = float(np.clip(PER_CELL * len(cells) ** 0.5, NARROWEST, WIDEST))
    view = fitted([bounds[0].corners, *(each.corners for each in shapes)], turning=False)
    view = _filled(view, np.concatenate([each.corners for each in (*bounds, *shapes)]), width)
    lines = [(number, cell_path(abstraction, path)) for number, path in enumerate(paths) if path]
    marks = shape_marks([*shapes, *bounds], view)
    names = CellNames(cells, view, [view.project(line) for _, line in lines])
    if plane:
        links = _adjacency(abstraction, view) if len(cells) <= MOST_LINKED else ""
        written, unnamed = names.in_plane({cell for path in paths for cell in path})
        marks = plane_axes(view) + marks + links
    else:
        written, unnamed = names.in_space(IN_SPACE)
        marks += triad(view)
    for number, line in lines:
        marks += _path_marks(view.project(line), number, len(paths))
    marks += written
    left, below = AXES_ROOM if plane else (0.0, 0.0)
    present = {cell.kind for cell in cells}
    legend: list[tuple[str, str]] = [
        (sample, kind) for kind, sample in KIND_SAMPLES.items() if kind in present
    ]
    legend += [
        (
            f'<path class="path {_series(number)}" stroke-width="3" d="M0 6h{SAMPLE:g}"/>',
            "path" if len(paths) == 1 else f"path {number + 1}",
        )
        for number, _ in lines
    ]
    return document(
        moved(left, 0, marks),
        (left + view.width, view.height + below),
        "scene" if plane else "scene space",
        f"{workspace.name if title is None else title}{_said(unnamed)}",
        legend,
    )


def _filled(view: View, points: Array, width: float) -> View:
    """The view scaled so that points (m, d) fill the width, or less if it would be too tall."""
    size = np.ptp(view.project(points), axis=0) + 2 * PADDING
    factor = min(width / size[0], TALLEST * width / size[1])
    return View(view.axes, view.centre, view.scale * factor, *(float(s * factor) for s in size))


def _ordered(cells: Sequence[Cell]) -> list[Cell]:
    """Free cells first, so that their edges hide no others; in space, from far to near."""
    depth = (
        [0.0] * len(cells)
        if cells[0].polytope.dimension == 2
        else [-float(cell.polytope.centre[1]) for cell in cells]
    )
    order = sorted(range(len(cells)), key=lambda i: (cells[i].kind != "free", depth[i], i))
    return [cells[i] for i in order]


def _adjacency(abstraction: Abstraction, view: View) -> str:
    """Thin lines between the centres of adjacent cells, through the centres of their facets."""
    data = "".join(
        line_path(view.project(cell_path(abstraction, [i, j]))) for i, j in abstraction.adjacency
    )
    return f'<path class="link" d="{data}"/>'


def _said(unnamed: int) -> str:
    """A line about the cells whose names are omitted."""
    if not unnamed:
        return ""
    return f"\n{many(unnamed, 'cell')} too small for a name: point at a cell to read its name"


def _series(number: int) -> str:
    return f"series-{number % 6 + 1}"


def _path_marks(line: Array, number: int, count: int) -> str:
    """A path from a disc to a star.

    Of several paths, earlier ones are broader, so that a later one on the same way does not hide
    them.
    """
    below = count - 1 - number
    (x0, y0), (x1, y1) = line[0], line[-1]
    ends = "".join(
        f'<path class="stop" d="{SHAPES[shape]}" transform="translate({place(x)} {place(y)}) '
        f'scale({1 + 0.6 * below:g})"/>'
        for shape, x, y in (("disc", x0, y0), ("star", x1, y1))
    )
    return (
        f'<g class="{_series(number)}"><path class="path" stroke-width="{3 + 3.5 * below:g}" '
        f'd="{line_path(line)}"/>{ends}</g>'
    )
