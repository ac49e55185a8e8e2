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
from srgc.render.html_text import name_in_picture, number, text
from srgc.render.label_placement import Label, LabelPlacer, leader_ends, sized
from srgc.render.svg import View, closed_path, line_path, place
from srgc.render.text_size import BASELINE

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


NAME_SIZE, NARROW_SIZE = 13.0, 24.0
"""Sizes of region names, in units of the picture; the second is for pages that show it small."""


def shape_names(
    shapes: Sequence[WorkspaceShape],
    view: View,
    drawn: Array | None = None,
    *,
    taken: Array | None = None,
    size: float = NAME_SIZE,
    kind: str = "names",
) -> str:
    """The names of regions, above all else: in the region if there is room, else beside it.

    Args:
        shapes: the sets; those without a label have no name.
        view: the projection.
        drawn: points (m, 2) of the picture that names should not cover.
        taken: rectangles (m, 4) of the picture that names avoid.
        size: the size of the font.
        kind: the classes of the group; scripts move its names by their ``data-half``.
    """
    marks = "".join(
        _name_mark(shapes[index], index, label, middle, size)
        for index, (label, middle) in _placed(shapes, view, drawn, taken, size).items()
    )
    return f'<g class="{kind}">{marks}</g>'


def name_boxes(
    shapes: Sequence[WorkspaceShape],
    view: View,
    drawn: Array | None = None,
    *,
    taken: Array | None = None,
    size: float = NAME_SIZE,
) -> Array:
    """The rectangles (m, 4) that ``shape_names`` with these arguments covers."""
    found = [
        np.concatenate([middle - np.array(label.size) / 2, middle + np.array(label.size) / 2])
        for label, middle in _placed(shapes, view, drawn, taken, size).values()
        if middle is not None
    ]
    return np.array(found).reshape(-1, 4)


def _placed(
    shapes: Sequence[WorkspaceShape],
    view: View,
    drawn: Array | None,
    taken: Array | None,
    size: float,
) -> dict[int, tuple[Label, Array | None]]:
    """The labels of sets by their indices, and their middles, None where no place is free."""
    placer = LabelPlacer((view.width, view.height), drawn)
    if taken is not None:
        placer.take(taken)
    boxes = {index: _box_of(shape, view) for index, shape in enumerate(shapes) if shape.label}
    wanted = {index: _name_of(shapes[index], view, size) for index in boxes}
    if view.axes.shape[1] == 2:
        # In space, sets are seen upon each other wherever their names are.
        for index, label in wanted.items():
            others = np.array([boxes[each] for each in boxes if each != index]).reshape(-1, 4)
            wanted[index] = replace(label, others=others)
    # Names that fit into their regions stay there, whatever the other names.
    order = sorted(wanted, key=lambda index: (wanted[index].home is None, index))
    places = {index: placer.place(wanted[index]) for index in order}
    return {index: (label, places[index]) for index, label in wanted.items()}


def page_names(shapes: Sequence[WorkspaceShape], view: View) -> str:
    """The names of regions twice: for a wide page and for a phone.

    They avoid the lower left corner, which has the scale bar or the axes.
    """
    return "".join(
        shape_names(shapes, view, taken=_corner(view), size=size, kind=f"names {kind}")
        for kind, size in (("wide", NAME_SIZE), ("narrow", NARROW_SIZE))
    )


def page_name_boxes(shapes: Sequence[WorkspaceShape], view: View) -> Array:
    """The rectangles (m, 4) that ``page_names`` covers, and the corner that they avoid."""
    corner = _corner(view)
    sizes = NAME_SIZE, NARROW_SIZE
    return np.concatenate(
        [corner, *(name_boxes(shapes, view, taken=corner, size=size) for size in sizes)]
    )


def _corner(view: View) -> Array:
    """The corner of a page's picture with the scale bar or the axes, as a rectangle (1, 4)."""
    wide, high = (104.0, 104.0) if view.axes.shape[1] == 3 else (0.25 * view.width + 24, 40.0)
    return np.array([[0.0, view.height - high, wide, view.height]])


def _name_of(shape: WorkspaceShape, view: View, size: float) -> Label:
    """The label of a set, in its middle if it fits there."""
    box = _box_of(shape, view)
    low, high = box[:2], box[2:]
    middle = (low + high) / 2
    label = sized(middle, [name_in_picture(shape.label)], size, bold=True)
    across, up = high - low
    if across > label.size[0] + 8 and up > label.size[1] + 5:
        return replace(label, home=middle)
    reach = min(across / 2, label.size[0] / 2), up / 2
    return replace(label, reach=reach)


def _name_mark(
    shape: WorkspaceShape, index: int, label: Label, middle: Array | None, size: float
) -> str:
    """A name, with a leader line if it is far away; hidden if no place is free."""
    half = f"{label.size[0] / 2:.1f} {label.size[1] / 2:.1f}"
    x, y = label.at if middle is None else middle
    ends = None if middle is None else leader_ends(label, middle)
    line = "" if ends is None else line_path(ends)
    hidden = ' visibility="hidden"' if middle is None else ""
    return (
        f'<path class="leader" d="{line}"/><text data-shape="{index}" data-half="{half}" '
        f'x="{place(x)}" y="{place(y + BASELINE * size)}"{hidden}>'
        f"{text(name_in_picture(shape.label))}</text>"
    )


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


def scale_bar(view: View) -> str:
    """A bar of 1, 2 or 5 times a power of ten metres."""
    most = 0.25 * view.width / view.scale
    power = 10.0 ** floor(log10(most))
    length = max(power * step for step in (1, 2, 5) if power * step <= most)
    x, y = 12.0, view.height - 10
    return (
        f'<g class="ruler"><path d="M{x} {y - 4}v4h{length * view.scale:.1f}v-4"/>'
        f'<text x="{x + 5}" y="{y - 4}">{number(length)} m</text></g>'
    )


def triad(view: View) -> str:
    """The directions of the axes of space, in the lower left corner."""
    marks = []
    for name, (x, y) in zip("xyz", view.axes.T, strict=True):
        marks.append(
            f'<path d="M0 0L{34 * x:.1f} {-34 * y:.1f}"/>'
            f'<text x="{44 * x:.1f}" y="{-44 * y:.1f}">{name}</text>'
        )
    return f'<g class="triad" transform="translate(52 {view.height - 52:.0f})">{"".join(marks)}</g>'


def _box_of(shape: WorkspaceShape, view: View) -> Array:
    """The bounding box (4,) of a set in the picture."""
    corners = view.project(shape.corners)
    return np.concatenate([corners.min(axis=0), corners.max(axis=0)])
