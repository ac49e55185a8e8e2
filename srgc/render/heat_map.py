"""Robustness over a grid of two parameters: a heat map, contour lines and the colour scale."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import pairwise
from math import dist
from typing import TypeAlias

import numpy as np

from compiler.arrays import Array
from srgc.render.axes import Plot, Scale, axes, labelled
from srgc.render.html_text import number, text
from srgc.render.svg import label

COLOURS = ("#440154", "#414487", "#2a788e", "#22a884", "#7ad151", "#fde725")
"""From low to high robustness: viridis (van der Walt and Smith, 2015), equally spaced."""
LACKING = ("#f3ece6", "#c9b8ad", "#8d7769")
"""For infeasible points, from the least to the largest violation; distinct from ``COLOURS``."""
STEPS = 24
"""The number of fields in a colour scale."""
LOWER = 0.4
"""The share of the height for the scale of infeasible points, if there are both scales."""
SCRAP = 45.0
"""Contour lines shorter than this are omitted."""
WIDTH, SIZE = 360, 300
"""The size of the report's chart; ``SIZE`` is the side of the square with plot and labels."""
LEFT, TOP, BOTTOM = 56, 10, 26


def edges(values: Sequence[float]) -> list[float]:
    """The borders between values, and as far beyond the first and the last."""
    if len(values) == 1:
        return [values[0] - 0.5, values[0] + 0.5]
    middle = [(a + b) / 2 for a, b in pairwise(values)]
    return [2 * values[0] - middle[0], *middle, 2 * values[-1] - middle[-1]]


def colour(part: float, colours: Sequence[str] = COLOURS) -> str:
    """The colour at a part from 0 to 1, interpolated in the list."""
    place = min(max(part, 0.0), 1.0) * (len(colours) - 1)
    i = min(int(place), len(colours) - 2)
    low, high = colours[i], colours[i + 1]
    parts = (
        round(int(low[k : k + 2], 16) * (i + 1 - place) + int(high[k : k + 2], 16) * (place - i))
        for k in (1, 3, 5)
    )
    return "#" + "".join(f"{part:02x}" for part in parts)


def heat_plot(xs: Sequence[float], ys: Sequence[float], box: tuple[float, ...]) -> Plot:
    """The plot of a grid in the rectangle (left, top, right, base) of the picture."""
    first, second = edges(xs), edges(ys)
    left, top, right, base = box
    return Plot(Scale(first[0], first[-1], left, right), Scale(second[0], second[-1], base, top))


def heat_marks(
    xs: Sequence[float],
    ys: Sequence[float],
    values: Array,
    plot: Plot,
    lacks: Array | None = None,
) -> str:
    """A field for each point of the grid, in the colour of its value, and the colour scales.

    Args:
        xs: the values of the first parameter, ascending.
        ys: the values of the second parameter, ascending.
        values: (len(xs), len(ys)); nan where infeasible.
        plot: the place of the fields; the scales are to its right.
        lacks: the negative robustness of infeasible points, with a scale of its own; nan where it
            is not known or the point is feasible.
    """
    missing = np.full_like(values, np.nan) if lacks is None else lacks
    kinds = [(values, COLOURS, _ends(values)), (-missing, LACKING, _ends(-missing))]
    columns, rows, parts = edges(xs), edges(ys), list[str]()
    for i, x in enumerate(xs):
        for j, y in enumerate(ys):
            value, lack = float(values[i, j]), float(missing[i, j])
            x0, x1 = plot.across(columns[i]), plot.across(columns[i + 1])
            y0, y1 = plot.up(rows[j + 1]), plot.up(rows[j])
            fill = next(
                (
                    f'fill="{colour(_part(float(each[i, j]), ends), colours)}"'
                    for each, colours, ends in kinds
                    if ends is not None and np.isfinite(each[i, j])
                ),
                'class="infeasible"',
            )
            parts.append(
                f'<rect x="{x0:.1f}" y="{y0:.1f}" width="{x1 - x0 + 0.2:.1f}" '
                f'height="{y1 - y0 + 0.2:.1f}" {fill}>'
                f"<title>({number(x)}, {number(y)}): {_field_words(value, lack)}</title></rect>"
            )
    return "".join(parts) + _scales([each[2] for each in kinds], plot)


def _field_words(value: float, lack: float) -> str:
    if np.isfinite(value):
        return f"robustness {number(value)}"
    return f"infeasible, robustness {number(lack)}" if np.isfinite(lack) else "infeasible"


def _ends(values: Array) -> tuple[float, float] | None:
    """The least and the greatest known value."""
    known = values[np.isfinite(values)]
    return (float(known.min()), float(known.max())) if known.size else None


def _part(value: float, ends: tuple[float, float]) -> float:
    """The position of a value between the ends, from 0 to 1."""
    low, high = ends
    return (value - low) / (high - low) if high > low else 1.0


def _scales(ends: Sequence[tuple[float, float] | None], plot: Plot) -> str:
    """The colour scale of robustness, and below it that of infeasible points."""
    above, lacks = ends
    middle = plot.base - LOWER * (plot.base - plot.top)
    found = ""
    if above is not None:
        base = plot.base if lacks is None else middle - 10
        found += _scale(above, COLOURS, (plot.top, base), plot.right + 8)
    if lacks is not None:
        # The least violation, nearest to 0, is at the top.
        top = plot.top if above is None else middle + 10
        found += _scale((-lacks[1], -lacks[0]), LACKING[::-1], (top, plot.base), plot.right + 8)
    return found


def _scale(
    ends: tuple[float, float], colours: Sequence[str], box: tuple[float, float], x: float
) -> str:
    """A colour scale between a top and a base, labelled at its ends."""
    (low, high), (top, base) = ends, box
    height = (base - top) / STEPS
    parts = [
        f'<rect x="{x:g}" y="{top + (STEPS - 1 - i) * height:.1f}" width="12" '
        f'height="{height + 0.3:.1f}" fill="{colour(i / (STEPS - 1), colours)}"/>'
        for i in range(STEPS)
    ]
    parts.append(f'<g class="axes">{label(x + 15, top + 8, "start", number(high, 3))}')
    parts.append(f"{label(x + 15, base, 'start', number(low, 3))}</g>")
    return "".join(parts)


def plane_chart(
    cells: Sequence[tuple[float, float, float, bool]],
    design: tuple[float, float],
    labels: tuple[str, str],
) -> str:
    """The report's chart; ``cells`` are two parameters, a value, and whether it is feasible."""
    xs, ys = sorted({cell[0] for cell in cells}), sorted({cell[1] for cell in cells})
    values, lacks = (np.full((len(xs), len(ys)), np.nan) for _ in range(2))
    places = {x: i for i, x in enumerate(xs)}, {y: j for j, y in enumerate(ys)}
    for x, y, value, feasible in cells:
        (values if feasible else lacks)[places[0][x], places[1][y]] = value
    plot = heat_plot(xs, ys, (LEFT, TOP, SIZE, SIZE - BOTTOM))
    says = label(SIZE, SIZE + 6, "end", f"→ {labels[0]},  ↑ {labels[1]}")
    x, y = plot.across(design[0]), plot.up(design[1])
    return (
        f'<svg class="chart" viewBox="0 0 {WIDTH} {SIZE + 10}" role="img" '
        f'aria-label="{text(f"robustness over {labels[0]} and {labels[1]}")}">'
        f"{heat_marks(xs, ys, values, plot, lacks)}"
        f"{axes(plot, labelled(plot.across), labelled(plot.up), grid=False, more=says)}"
        f'<path class="design" d="M{x:.1f} {y - 6:.1f}l6 6l-6 6l-6 -6z"/></svg>'
    )


# --- Contour lines -------------------------------------------------------------------------------


def contours(
    xs: Sequence[float], ys: Sequence[float], values: Array, plot: Plot, count: int
) -> str:
    """Lines at ``count`` levels between the least and the greatest value (marching squares).

    ``values`` (len(xs), len(ys)) are interpolated linearly between grid points; a square with a nan
    corner (infeasible) gets no line.
    """
    known = values[np.isfinite(values)]
    if not known.size or known.min() == known.max():
        return ""
    levels = np.linspace(known.min(), known.max(), count + 2)[1:-1]
    found = list[_Segment]()
    for i in range(len(xs) - 1):
        for j in range(len(ys) - 1):
            corners = [(i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)]
            heights = [float(values[at]) for at in corners]
            if not np.isfinite(heights).all():
                continue
            places = [(plot.across(xs[a]), plot.up(ys[b])) for a, b in corners]
            for level in levels:
                crossings = [
                    (round(x, 1), round(y, 1)) for x, y in _crossings(places, heights, float(level))
                ]
                found += zip(crossings[::2], crossings[1::2], strict=True)
    data = "".join(
        f"M{x0:.1f} {y0:.1f}L{x1:.1f} {y1:.1f}" for (x0, y0), (x1, y1) in _without_scraps(found)
    )
    return f'<path class="contour" d="{data}"/>' if data else ""


_Point: TypeAlias = tuple[float, float]
_Segment: TypeAlias = tuple[_Point, _Point]


def _without_scraps(segments: Sequence[_Segment]) -> Iterator[_Segment]:
    """The segments of contour lines that are long enough; segments that meet form one line."""
    first: dict[_Point, _Point] = {}

    def root(point: _Point) -> _Point:
        while first.setdefault(point, point) != point:
            first[point] = first[first[point]]
            point = first[point]
        return point

    for a, b in segments:
        first[root(a)] = root(b)
    lengths: dict[_Point, float] = {}
    for a, b in segments:
        lengths[root(a)] = lengths.get(root(a), 0.0) + dist(a, b)
    for a, b in segments:
        if a != b and lengths[root(a)] >= SCRAP:
            yield a, b


def _crossings(
    places: Sequence[tuple[float, float]], heights: Sequence[float], level: float
) -> Iterator[tuple[float, float]]:
    """The points where a level crosses the sides of a square; there are none, two or four."""
    for k in range(4):
        (x0, y0), (x1, y1) = places[k], places[(k + 1) % 4]
        a, b = heights[k], heights[(k + 1) % 4]
        if (a < level) != (b < level):
            part = (level - a) / (b - a)
            yield x0 + part * (x1 - x0), y0 + part * (y1 - y0)
