"""A workspace as a picture: cells by kind, their names, adjacency, and paths through them, as SVG.

Source: Section 3, W = (P, H, N), and the figures of the case study.  Space is seen obliquely.
"""

from __future__ import annotations

from collections.abc import Container, Sequence
from fractions import Fraction
from itertools import pairwise
from typing import SupportsFloat

import matplotlib as mpl
import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.backends.backend_svg import FigureCanvasSVG
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.figure import Figure
from matplotlib.patches import Patch
from numpy.typing import NDArray

from compiler.geometry.abstraction import Abstraction, Cell
from compiler.geometry.double_description import Point
from compiler.geometry.polytope import AXES, Polytope, polytope_of
from compiler.geometry.volume import around
from compiler.views.workspace_view import cell_label, drawn
from grammar_lang.ir import Workspace
from srgc.render.svg import COLOURS, INK, PATH, figure_settings, svg_text

Array = NDArray[np.float64]
PAPER, MOST_PAPER = 7.0, 16.0
"""The longer side of the picture in inches; it grows with the cells up to the second."""
POINTS = 72.0
LARGEST, SMALLEST = 9.0, 3.5
"""Sizes of a name in points; where it would have to be smaller, it is left out."""
LETTER, LINE = 0.68, 1.35
"""Width of a letter and height of a line, in multiples of the size of the font."""
MOST_NAMES = 60
PLATE = {"boxstyle": "round,pad=0.15", "facecolor": "white", "alpha": 0.75, "edgecolor": "none"}
WALL, LINK = "#8d94a3", "#b4bac6"
WAYS = (PATH, "#e08e1b", "#7b4ea3", "#128a8a", "#8c564b", "#c23b8f")


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
    points = _projected([v for cell in abstraction.cells for v in cell.polytope.vertices])
    low, high = points.min(axis=0), points.max(axis=0)
    size = float(np.clip(0.55 * len(abstraction.cells) ** 0.5, PAPER, MOST_PAPER))
    scale = size / float((high - low).max())
    width, height = scale * (high - low)
    with figure_settings():
        figure = Figure(figsize=(max(width, 3.5) + 0.9, height + 1.3), layout="constrained")
        FigureCanvasSVG(figure)
        axes = figure.add_subplot()
        if workspace.dimension == 2:
            ends = {path[k] for path in paths if path for k in (0, -1)}
            _draw_plane(axes, abstraction, POINTS * scale, ends)
        else:
            _draw_space(axes, abstraction)
            _draw_bounds(axes, polytope_of(workspace.bounds.shape, 3).irredundant())
        for number, path in enumerate(paths):
            _draw_path(axes, abstraction, path, number, len(paths))
        _frame(axes, low, high, workspace.dimension)
        axes.set_title(workspace.name if title is None else title, fontsize=10, loc="left")
        _legend(axes, abstraction)
        return svg_text(figure)


def _projected(points: Sequence[Sequence[SupportsFloat]]) -> Array:
    """Where points are drawn, shape (n, 2)."""
    return np.array([drawn(point) for point in points], dtype=float).reshape(-1, 2)


def _shade(cell: Cell) -> tuple[str, float]:
    """The colour of a cell and its opacity."""
    return ("white", 1.0) if cell.kind == "free" else (COLOURS[cell.kind], 0.45)


def _draw_plane(
    axes: Axes, abstraction: Abstraction, points_per_metre: float, ends: Container[int]
) -> None:
    """Cells, adjacency, and the names that fit, beside the mark where a path ends."""
    cells = abstraction.cells
    shapes = [_projected(cell.polytope.vertices) for cell in cells]
    colours = [mpl.colors.to_rgba(*_shade(cell)) for cell in cells]
    thin = float(np.clip(8.0 / len(cells) ** 0.5, 0.25, 0.8))
    axes.add_collection(PolyCollection(shapes, facecolors=colours, edgecolors=WALL,
                                       linewidths=thin, zorder=1))  # fmt: skip
    _draw_adjacency(axes, abstraction, thin)
    for number, cell in enumerate(cells):
        text = cell_label(cell)
        size, upright = _room(cell, text, points_per_metre)
        if size < SMALLEST:
            text = cell.name
            size, upright = _room(cell, text, points_per_metre)
        if size >= SMALLEST:
            marked = number in ends
            axes.annotate(
                text, drawn(cell.polytope.centre), (-6, 5) if marked else (0, 0),
                textcoords="offset points", ha="right" if marked else "center",
                va="bottom" if marked else "center",
                fontsize=min(size, LARGEST), rotation=90 if upright else 0, color=INK, zorder=7,
                bbox={"boxstyle": "square,pad=0.1", "fc": _tint(cell), "ec": "none", "alpha": 0.7},
            )  # fmt: skip


def _tint(cell: Cell) -> str:
    """The colour of a cell as it looks on white."""
    colour, alpha = _shade(cell)
    red, green, blue = (alpha * part + 1 - alpha for part in mpl.colors.to_rgb(colour))
    return str(mpl.colors.to_hex((red, green, blue)))


def _room(cell: Cell, text: str, points_per_metre: float) -> tuple[float, bool]:
    """The size in points at which a text fits into a cell about its middle, and whether upright."""
    lines = text.split("\n")
    across = LETTER * max(map(len, lines)) / 2
    high = LINE * len(lines) / 2
    slack = cell.polytope.b - cell.polytope.A @ np.array(cell.polytope.centre, dtype=float)
    normals = np.abs(cell.polytope.A)
    flat, upright = (
        float((slack / (normals @ np.array(half))).min()) * points_per_metre
        for half in ((across, high), (high, across))
    )
    return (flat, False) if flat >= min(upright, LARGEST) else (upright, True)


def _draw_adjacency(axes: Axes, abstraction: Abstraction, thin: float) -> None:
    """Thin lines from middle to middle through the middles of the facets."""
    centres = _projected([cell.polytope.centre for cell in abstraction.cells])
    links = []
    for i, j in abstraction.adjacency:
        (crossing,) = _projected([_facet_middle(abstraction, i, j)])
        links.append(np.array([centres[i], crossing, centres[j]]))
    axes.add_collection(
        LineCollection(links, colors=LINK, linewidths=thin, linestyles=(0, (3, 2)), zorder=2)
    )


def _facet_middle(abstraction: Abstraction, i: int, j: int) -> Point:
    corners = abstraction.facets[min(i, j), max(i, j)]
    return tuple(sum(axis, Fraction(0)) / len(corners) for axis in zip(*corners, strict=True))


def _draw_space(axes: Axes, abstraction: Abstraction) -> None:
    """The edges of all cells, far ones first; cells of regions with their faces."""
    ordered = sorted(abstraction.cells, key=lambda cell: -cell.polytope.centre[1])
    free = [cell for cell in ordered if cell.kind == "free"]
    named = [cell for cell in ordered if cell.kind != "free"]
    thin = float(np.clip(8.0 / len(ordered) ** 0.5, 0.2, 0.6))
    rims = [_rim(cell.polytope, row) for cell in free for row in cell.polytope.facets]
    axes.add_collection(
        PolyCollection(rims, facecolors="none", edgecolors=WALL, linewidths=thin, zorder=1)
    )
    for cell in named:
        faces = [_rim(cell.polytope, row) for row in cell.polytope.facets]
        colour = COLOURS[cell.kind]
        glass = mpl.colors.to_rgba(colour, 0.16)
        axes.add_collection(
            PolyCollection(faces, facecolors=glass, edgecolors=colour, linewidths=0.7, zorder=2)
        )
    if len(named) <= MOST_NAMES:
        for cell in named:
            axes.annotate(cell.name, drawn(cell.polytope.centre), ha="center", va="center",
                          fontsize=7, color=INK, zorder=7, bbox=PLATE)  # fmt: skip


def _draw_bounds(axes: Axes, bounds: Polytope) -> None:
    """The edges of the bounds, and which way the axes go."""
    rims = [_rim(bounds, row) for row in bounds.facets]
    axes.add_collection(
        PolyCollection(rims, facecolors="none", edgecolors=INK, linewidths=0.9, zorder=3)
    )
    low, high = bounds.box
    length = 0.12 * float((high - low).max())
    for axis, name in enumerate(AXES):
        tip = low.copy()
        tip[axis] += length
        (foot,), (head,) = _projected([tuple(low)]), _projected([tuple(tip)])
        axes.annotate("", head, foot, arrowprops={"arrowstyle": "->", "color": INK}, zorder=4)
        axes.annotate(name, head, (2, 2), textcoords="offset points", fontsize=8, color=INK)


def _rim(polytope: Polytope, row: int) -> Array:
    """The corners of a face of space in order, projected."""
    corners = tuple(vertex.point() for vertex in polytope.face(row))
    return _projected(around(corners))


def _draw_path(
    axes: Axes, abstraction: Abstraction, path: Sequence[int], number: int, count: int
) -> None:
    """From the middle of the first cell through the facets to that of the last.

    Of several the earlier are broader, so that one that goes the same way does not hide them.
    """
    way = [cell for k, cell in enumerate(path) if k == 0 or cell != path[k - 1]]
    if not way:
        return
    stops = [abstraction.cells[way[0]].polytope.centre]
    for before, after in pairwise(way):
        crossing = _facet_middle(abstraction, before, after)
        if crossing == stops[-1]:
            stops.append(abstraction.cells[before].polytope.centre)  # in and out the same way
        stops.append(crossing)
    stops.append(abstraction.cells[way[-1]].polytope.centre)
    line = _projected(stops)
    colour = WAYS[number % len(WAYS)]
    below = count - 1 - number
    axes.plot(*line.T, color=colour, lw=2.4 + 2.8 * below, solid_joinstyle="round", zorder=5,
              label="path" if count == 1 else f"path {number + 1}")  # fmt: skip
    axes.plot(*line[0], "o", color=colour, ms=8 + 5 * below, mec="white", zorder=6)
    axes.plot(*line[-1], "*", color=colour, ms=15 + 8 * below, mec="white", zorder=6)


def _frame(axes: Axes, low: Array, high: Array, dimension: int) -> None:
    pad = 0.015 * float((high - low).max())
    axes.set_xlim(low[0] - pad, high[0] + pad)
    axes.set_ylim(low[1] - pad, high[1] + pad)
    axes.set_aspect("equal")
    if dimension == 2:
        axes.set_xlabel("x (m)")
        axes.set_ylabel("y (m)")
    else:
        axes.set_axis_off()


def _legend(axes: Axes, abstraction: Abstraction) -> None:
    """The kinds there are, and the paths, below the picture."""
    present = {cell.kind for cell in abstraction.cells}
    patches: list[Artist] = [
        Patch(facecolor=colour, alpha=0.45, label=kind)
        for kind, colour in COLOURS.items()
        if kind in present
    ]
    lines, _ = axes.get_legend_handles_labels()
    handles = [*patches, *lines]
    if handles:
        axes.legend(handles=handles, loc="lower right", bbox_to_anchor=(1, 1), fontsize=8,
                    frameon=False, ncols=min(6, len(handles)), columnspacing=1.2)  # fmt: skip
