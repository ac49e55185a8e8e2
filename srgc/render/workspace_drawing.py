"""The drawing of a workspace: its sets as corners and edges, their marks, scales and directions."""

from __future__ import annotations

from collections.abc import Container, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from math import floor, log10
from typing import Literal

import numpy as np

from compiler.arrays import Array
from compiler.workspaces.abstraction import Abstraction, Cell
from compiler.workspaces.hull import around, turn
from compiler.workspaces.polytope import Polytope, polytope_of
from grammar_lang.ir import Workspace
from srgc.render.axes import Plot, Scale, axes, labelled, titles
from srgc.render.html_text import number, text
from srgc.render.svg import PADDING, View, closed_path, line_path
from srgc.render.text_size import block_size

ShapeKind = Literal["bounds", "cell", "region", "obstacle", "target"]


@dataclass(frozen=True, slots=True)
class WorkspaceShape:
    """A convex polytope to draw.

    ``corners`` has shape (m, d), in the plane ordered around it; ``edges`` are pairs of corners.
    ``label`` is empty for all pieces of a map but the first.  A cell is ``covered`` if it lies in a
    region, which is drawn upon it.
    """

    kind: ShapeKind
    name: str
    label: str
    corners: Array
    edges: tuple[tuple[int, int], ...]
    covered: bool = False


def workspace_shapes(workspace: Workspace, cells: Iterable[Cell]) -> tuple[WorkspaceShape, ...]:
    """The shapes of the bounds, the given cells and the regions, in the order of drawing.

    Of an unbounded region, the part within the bounds; empty and flat regions are omitted.
    """
    bounds = polytope_of(workspace.bounds.shape, workspace.dimension)
    found = [_shape("bounds", "bounds", "", bounds)]
    found += [
        replace(_shape("cell", cell.name, "", cell.polytope), covered=cell.kind != "free")
        for cell in cells
    ]
    found += _regions(workspace, bounds)
    return tuple(found)


def _regions(workspace: Workspace, bounds: Polytope) -> Iterator[WorkspaceShape]:
    named: set[str] = set()
    for region in workspace.regions:
        polytope = polytope_of(region.shape, workspace.dimension)
        if not polytope.is_bounded:
            polytope = polytope.intersection(bounds)
        if polytope.is_empty or not polytope.has_interior:
            continue
        name = region.name.partition(".")[0]
        yield _shape(region.kind, region.name, "" if name in named else name, polytope)
        named.add(name)


def cell_shape(cell: Cell) -> WorkspaceShape:
    """The shape of a cell, with the kind of its region, or the kind ``cell`` if it is free."""
    kind: ShapeKind = "cell" if cell.kind == "free" else cell.kind
    return _shape(kind, cell.name, cell.name, cell.polytope)


def cell_path(cells: Abstraction, path: Sequence[int]) -> Array:
    """A path of cells as a line (m, d) from the first centre through the facets to the last centre.

    It is straight between cells that are not neighbours, as when a motion passes cells within a
    step.
    """
    way = [cell for k, cell in enumerate(path) if k == 0 or cell != path[k - 1]]
    middles = {cell: np.array(cells.cells[cell].polytope.centre, dtype=float) for cell in way}
    stops = [middles[way[0]]]
    for before, after in pairwise(way):
        if after not in cells.neighbours[before]:
            stops += [middles[before], middles[after]]
            continue
        crossing = np.array(cells.facet_centre(before, after), dtype=float)
        if np.array_equal(crossing, stops[-1]):
            stops.append(middles[before])  # entered and left through the same facet
        stops.append(crossing)
    return np.array([*stops, middles[way[-1]]])


def _shape(kind: ShapeKind, name: str, label: str, polytope: Polytope) -> WorkspaceShape:
    corners = polytope.vertices
    places = {corner: number for number, corner in enumerate(corners)}
    if polytope.dimension == 2:
        rims = [corners]
    else:
        whole = polytope.irredundant()
        rims = [around([vertex.point() for vertex in whole.face(i)]) for i in whole.facets]
    edges = {
        (min(places[a], places[b]), max(places[a], places[b]))
        for rim in rims
        for a, b in pairwise((*rim, rim[0]))
    }
    return WorkspaceShape(kind, name, label, np.array(corners, dtype=float), tuple(sorted(edges)))


# --- Marks ----------------------------------------------------------------------------------------


def outline(points: Array) -> Array:
    """The corners of the convex hull of points (m, 2), in order (Andrew's monotone chain)."""
    ordered = sorted({(float(x), float(y)) for x, y in points})
    if len(ordered) < 3:
        return np.array(ordered)
    return np.array(_half(ordered)[:-1] + _half(ordered[::-1])[:-1])


def _half(ordered: Sequence[tuple[float, float]]) -> list[tuple[float, float]]:
    chain: list[tuple[float, float]] = []
    for p in ordered:
        while len(chain) > 1 and turn(chain[-2], chain[-1], p) <= 0:
            chain.pop()
        chain.append(p)
    return chain


def shape_path(shape: WorkspaceShape, view: View) -> str:
    """A set as the data of one path: its outline, or in space its edges."""
    corners = view.project(shape.corners)
    if view.axes.shape[1] == 3:
        return "".join(line_path(corners[[a, b]]) for a, b in shape.edges)
    return closed_path(outline(corners))


def shape_marks(shapes: Sequence[WorkspaceShape], view: View, here: Container[str] = ()) -> str:
    """The marks of all sets; the pieces of a map, of which there may be thousands, are one mark.

    ``here`` names the cells that are highlighted.
    """
    groups: list[list[WorkspaceShape]] = []
    for shape in shapes:
        if groups and shape.kind not in ("bounds", "cell") and not shape.label:
            groups[-1].append(shape)
        else:
            groups.append([shape])
    return "".join(_shape_mark(group, view, here) for group in groups)


def _shape_mark(group: Sequence[WorkspaceShape], view: View, here: Container[str]) -> str:
    """The mark of a set: the area it covers, and in space its edges."""
    shape = group[0]
    outlines = "".join(closed_path(outline(view.project(each.corners))) for each in group)
    face = f'<path class="face" d="{outlines}"/>'
    edges = ""
    if view.axes.shape[1] == 3:
        edges = f'<path class="edges" d="{shape_path(shape, view)}"/>'
    name = shape.label if len(group) > 1 else shape.name
    title = f"<title>{text(name)}</title>" if shape.kind != "bounds" else ""
    kind = f"{shape.kind} covered" if shape.covered else shape.kind
    if shape.kind == "cell" and name in here:
        kind += " here"
    return f'<g class="shape {kind}">{title}{face}{edges}</g>'


def box_corners(box: Array) -> Array:
    """The corners (2^d, d) of a box (d, 2)."""
    grids = np.meshgrid(*box, indexing="ij")
    return np.stack([grid.ravel() for grid in grids], axis=-1)


def boxes_path(boxes: Iterable[Array], view: View) -> str:
    """Boxes (d, 2) as the data of one path."""
    return "".join(line_path(outline(view.project(box_corners(box)))) + "Z" for box in boxes)


# --- Scales --------------------------------------------------------------------------------------


def plane_axes(view: View) -> str:
    """A frame around a view along z, with x and y in metres."""
    half = np.array([view.width, view.height]) / (2 * view.scale)
    low, high = view.centre[:2] - half, view.centre[:2] + half
    plot = Plot(
        Scale(float(low[0]), float(high[0]), 0.0, view.width),
        Scale(float(low[1]), float(high[1]), view.height, 0.0),
    )
    below, beside = labelled(plot.across, 8), labelled(plot.up, 8)
    return axes(plot, below, beside, grid=False, more=titles(plot, "x (m)", "y (m)"))


def set_sample(kind: str) -> str:
    """The sample in a legend, 24 x 12, for sets with these classes."""
    return f'<g class="shape {kind}"><path class="face" d="M2 1h20v10h-20Z"/></g>'


KIND_SAMPLES = {kind: set_sample(kind) for kind in ("obstacle", "target", "region")}
"""The sample in the legend for each kind of region."""
CELL_SAMPLE = set_sample("cell here")
"""The sample for a cell that an effector visits."""
AXES_ROOM = (60.0, 40.0)
"""The room that ``plane_axes`` needs on the left and below."""
RULER_LEFT = 12.0
"""Where the scale bar begins."""


def scale_bar(view: View) -> str:
    """A bar of 1, 2 or 5 times a power of ten metres, with its length beside it.

    Both lie in the margin below what is drawn, in large letters for phones, too.
    """
    length, begin = _ruler(view)
    y = view.height - 9
    return (
        f'<g class="ruler"><path d="M{RULER_LEFT:g} {y - 4}v4h{length * view.scale:.1f}v-4"/>'
        f'<text x="{begin:.1f}" y="{view.height - 4}">{number(length)} m</text></g>'
    )


def _ruler(view: View) -> tuple[float, float]:
    """The length of the scale bar in metres, and where its label begins in the picture."""
    most = 0.25 * view.width / view.scale
    power = 10.0 ** floor(log10(most))
    length = max(power * step for step in (1, 2, 5) if power * step <= most)
    return length, RULER_LEFT + length * view.scale + 6


def measure_box(view: View, size: float) -> Array:
    """The rectangle (1, 4) of the scale bar, or of the axes of space, with letters of a size."""
    if view.axes.shape[1] == 3:
        return np.array([[0.0, view.height - 104.0, 104.0, view.height]])
    length, begin = _ruler(view)
    wide = begin + block_size([f"{number(length)} m"], size)[0]
    return np.array([[0.0, view.height - PADDING, wide, view.height]])


def triad(view: View) -> str:
    """The directions of the axes of space, in the lower left corner."""
    marks = []
    for name, (x, y) in zip("xyz", view.axes.T, strict=True):
        marks.append(
            f'<path d="M0 0L{34 * x:.1f} {-34 * y:.1f}"/>'
            f'<text x="{44 * x:.1f}" y="{-44 * y:.1f}">{name}</text>'
        )
    return f'<g class="triad" transform="translate(52 {view.height - 52:.0f})">{"".join(marks)}</g>'
