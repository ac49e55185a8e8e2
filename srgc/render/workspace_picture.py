"""A workspace as a picture: cells by kind, their names, adjacency, and paths through them.

Source: Section 3, W = (P, H, N), and the figures of the case study.  Space is seen obliquely.
"""

from __future__ import annotations

from collections.abc import Container, Sequence

import numpy as np

from compiler.arrays import Array
from compiler.views.workspace_view import cell_label
from compiler.workspaces.abstraction import Abstraction, Cell
from grammar_lang.ir import Workspace
from srgc.render.html_text import name_in_picture, text
from srgc.render.svg import SAMPLE, SHAPES, View, document, fitted, line_path, moved, place
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

NARROWEST, WIDEST, PER_CELL = 560.0, 1200.0, 40.0
"""The width of the picture: the last times the root of the number of cells, within the others."""
LARGEST, SMALLEST = 12.0, 4.5
"""Sizes of a name in units of the picture; where it would have to be smaller, it is left out."""
LETTER, LINE = 0.68, 1.35
"""Width of a letter and height of a line, in multiples of the size of the font."""
MOST_NAMES = 60
"""Of regions in space."""


def workspace_svg(
    abstraction: Abstraction,
    workspace: Workspace,
    paths: Sequence[Sequence[int]] = (),
    title: str | None = None,
) -> str:
    """The picture as SVG.

    Args:
        abstraction: the cells.
        workspace: what they are of.
        paths: indices of cells; two in a row are neighbours, or the same.
        title: above the picture; by default the name of the workspace.

    Raises:
        KeyError: a path goes between cells that are no neighbours.
    """
    cells, plane = abstraction.cells, workspace.dimension == 2
    shapes = [cell_shape(cell) for cell in _ordered(cells)]
    bounds = workspace_shapes(workspace, ())[:1]
    width = float(np.clip(PER_CELL * len(cells) ** 0.5, NARROWEST, WIDEST))
    view = fitted([bounds[0].corners, *(each.corners for each in shapes)], turning=False)
    view = view.scaled(width)
    lines = [(number, cell_path(abstraction, path)) for number, path in enumerate(paths) if path]
    marks = shape_marks([*shapes, *bounds], view)
    ends = {path[k] for path in paths if path for k in (0, -1)}
    if plane:
        marks = plane_axes(view) + marks + _adjacency(abstraction, view)
        marks += _names(cells, view, ends)
    else:
        marks += triad(view) + _names_in_space(cells, view, ends)
    for number, line in lines:
        marks += _path_marks(view.project(line), number, len(paths))
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
        workspace.name if title is None else title,
        legend,
    )


def _ordered(cells: Sequence[Cell]) -> list[Cell]:
    """Free cells first, whose edges may not hide those of others; in space from far to near."""
    depth = (
        [0.0] * len(cells)
        if cells[0].polytope.dimension == 2
        else [-float(cell.polytope.centre[1]) for cell in cells]
    )
    order = sorted(range(len(cells)), key=lambda i: (cells[i].kind != "free", depth[i], i))
    return [cells[i] for i in order]


def _adjacency(abstraction: Abstraction, view: View) -> str:
    """Thin lines from middle to middle through the middles of the facets."""
    data = "".join(
        line_path(view.project(cell_path(abstraction, [i, j]))) for i, j in abstraction.adjacency
    )
    return f'<path class="link" d="{data}"/>'


def _names(cells: Sequence[Cell], view: View, ends: Container[int]) -> str:
    """The names that fit, beside the mark where a path ends."""
    found = []
    for number, cell in enumerate(cells):
        says = cell_label(cell)
        size, upright = _room(cell, says, view.scale)
        if size < SMALLEST:
            says = cell.name
            size, upright = _room(cell, says, view.scale)
        if size < SMALLEST:
            continue
        x, y = view.project(np.array(cell.polytope.centre, dtype=float))
        size = min(size, LARGEST)
        turned = ' transform="rotate(-90)"' if upright else ""
        if number in ends:
            x, y, turned = x - 8, y - 8, ' class="aside"'
        lines = says.split("\n")
        middle = (len(lines) - 1) / 2
        rows = "".join(
            f'<tspan x="0" y="{place(LINE * size * (k - middle))}">{text(line)}</tspan>'
            for k, line in enumerate(lines)
        )
        found.append(moved(x, y, f'<text font-size="{size:.1f}"{turned}>{rows}</text>'))
    return f'<g class="fitted">{"".join(found)}</g>'


def _room(cell: Cell, says: str, scale: float) -> tuple[float, bool]:
    """The size at which a text fits into a cell about its middle, and whether upright."""
    lines = says.split("\n")
    across = LETTER * max(map(len, lines)) / 2
    high = LINE * len(lines) / 2
    slack = cell.polytope.b - cell.polytope.A @ np.array(cell.polytope.centre, dtype=float)
    normals = np.abs(cell.polytope.A)
    flat, upright = (
        float((slack / (normals @ np.array(half))).min()) * scale
        for half in ((across, high), (high, across))
    )
    return (flat, False) if flat >= min(upright, LARGEST) else (upright, True)


def _names_in_space(cells: Sequence[Cell], view: View, ends: Container[int]) -> str:
    """The names of the cells of regions, unless there are many."""
    named = [number for number, cell in enumerate(cells) if cell.kind != "free"]
    if len(named) > MOST_NAMES:
        return ""
    found = []
    for number in named:
        x, y = view.project(np.array(cells[number].polytope.centre, dtype=float))
        if number in ends:
            x, y, aside = x - 8, y - 8, ' class="aside"'
        else:
            aside = ""
        name = text(name_in_picture(cells[number].name))
        found.append(moved(x, y, f'<text font-size="11"{aside}>{name}</text>'))
    return f'<g class="fitted">{"".join(found)}</g>'


def _series(number: int) -> str:
    return f"series-{number % 6 + 1}"


def _path_marks(line: Array, number: int, count: int) -> str:
    """From a dot to a star.

    Of several the earlier are broader, so that one that goes the same way does not hide them.
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
