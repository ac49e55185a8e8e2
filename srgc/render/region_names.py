"""The names of regions in a picture of a workspace: in their regions, else beside them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from compiler.arrays import Array
from srgc.render.html_text import name_in_picture, text
from srgc.render.label_placement import Label, LabelPlacer, along, leader_ends, sized
from srgc.render.svg import View, line_path, place
from srgc.render.text_size import BASELINE
from srgc.render.workspace_drawing import WorkspaceShape, measure_box, outline

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
    whole: bool = False,
) -> str:
    """The names of regions, above all else: in the region if there is room, else beside it.

    Args:
        shapes: the sets; those without a label have no name.
        view: the projection.
        drawn: points (m, 2) of the picture that names should not cover.
        taken: rectangles (m, 4) of the picture that names avoid.
        size: the size of the font.
        kind: the classes of the group; scripts move its names by their ``data-half``.
        whole: whether a name stands in a planar set only if the set contains all of it; else it
            has to fit into the bounding box.
    """
    marks = "".join(
        _name_mark(shapes[index], index, label, middle, size)
        for index, (label, middle) in _placed(shapes, view, drawn, taken, size, whole=whole).items()
    )
    return f'<g class="{kind}">{marks}</g>'


def name_boxes(
    shapes: Sequence[WorkspaceShape],
    view: View,
    drawn: Array | None = None,
    *,
    taken: Array | None = None,
    size: float = NAME_SIZE,
    whole: bool = False,
) -> Array:
    """The rectangles (m, 4) that ``shape_names`` with these arguments covers."""
    found = [
        np.concatenate([middle - np.array(label.size) / 2, middle + np.array(label.size) / 2])
        for label, middle in _placed(shapes, view, drawn, taken, size, whole=whole).values()
        if middle is not None
    ]
    return np.array(found).reshape(-1, 4)


def _placed(
    shapes: Sequence[WorkspaceShape],
    view: View,
    drawn: Array | None,
    taken: Array | None,
    size: float,
    *,
    whole: bool,
) -> dict[int, tuple[Label, Array | None]]:
    """The labels of sets by their indices, and their middles, None where no place is free."""
    placer = LabelPlacer((view.width, view.height), drawn)
    if taken is not None:
        placer.take(taken)
    boxes = {index: _box_of(shape, view) for index, shape in enumerate(shapes) if shape.label}
    wanted = {index: _name_of(shapes[index], view, size, whole=whole) for index in boxes}
    if view.axes.shape[1] == 2:
        # In space, sets are seen upon each other wherever their names are.
        for index, label in wanted.items():
            others = np.array([boxes[each] for each in boxes if each != index]).reshape(-1, 4)
            wanted[index] = replace(label, others=others)
    # Names that fit into their regions stay there, whatever the other names.
    order = sorted(wanted, key=lambda index: (wanted[index].home is None, index))
    places = {index: placer.place(wanted[index]) for index in order}
    return {index: (label, places[index]) for index, label in wanted.items()}


def page_names(shapes: Sequence[WorkspaceShape], view: View, drawn: Array | None = None) -> str:
    """The names of regions twice: for a wide page and for a phone.

    They avoid the lower left corner, which has the scale bar or the axes, and keep off ``drawn``,
    points (m, 2) of the picture, and the edges of regions if there is room elsewhere.
    """
    corner, drawn = measure_box(view, NARROW_SIZE), _with_edges(shapes, view, drawn)
    return "".join(
        shape_names(shapes, view, drawn, taken=corner, size=size, kind=f"names {kind}", whole=True)
        for kind, size in (("wide", NAME_SIZE), ("narrow", NARROW_SIZE))
    )


def page_name_boxes(
    shapes: Sequence[WorkspaceShape], view: View, drawn: Array | None = None
) -> Array:
    """The rectangles (m, 4) that ``page_names`` covers, and the corner that they avoid."""
    corner, drawn = measure_box(view, NARROW_SIZE), _with_edges(shapes, view, drawn)
    wide, narrow = (
        name_boxes(shapes, view, drawn, taken=corner, size=size, whole=True)
        for size in (NAME_SIZE, NARROW_SIZE)
    )
    return np.concatenate([corner, wide, narrow])


def _with_edges(shapes: Sequence[WorkspaceShape], view: View, drawn: Array | None) -> Array | None:
    """Points (m, 2) to keep visible: ``drawn``, and in the plane the edges of named regions."""
    rims = [outline(view.project(shape.corners)) for shape in shapes if shape.label]
    if view.axes.shape[1] == 3 or not rims:
        return drawn
    edges = [along(np.concatenate([rim, rim[:1]])) for rim in rims]
    return np.concatenate(edges if drawn is None else [drawn, *edges])


def _name_of(shape: WorkspaceShape, view: View, size: float, *, whole: bool) -> Label:
    """The label of a set, in it if it fits there."""
    box = _box_of(shape, view)
    low, high = box[:2], box[2:]
    middle = (low + high) / 2
    label = sized(middle, [name_in_picture(shape.label)], size, bold=True)
    across, up = high - low
    if across > label.size[0] + 8 and up > label.size[1] + 5:
        half = np.array([label.size[0] + 8, label.size[1] + 5]) / 2
        corners = view.project(shape.corners)
        for home in (middle, corners.mean(axis=0)):
            if not whole or view.axes.shape[1] == 3 or _within(outline(corners), home, half):
                return replace(label, home=home)
    reach = min(across / 2, label.size[0] / 2), up / 2
    return replace(label, reach=reach)


def _within(rim: Array, middle: Array, half: Array) -> bool:
    """Whether a rectangle lies in the convex polygon with corners (m, 2) in order."""
    ways = np.roll(rim, -1, axis=0) - rim
    corners = middle + half * np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]])
    off = corners[:, None] - rim
    return bool((ways[:, 0] * off[..., 1] - ways[:, 1] * off[..., 0] >= -1e-6).all())


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


def _box_of(shape: WorkspaceShape, view: View) -> Array:
    """The bounding box (4,) of a set in the picture."""
    corners = view.project(shape.corners)
    return np.concatenate([corners.min(axis=0), corners.max(axis=0)])
