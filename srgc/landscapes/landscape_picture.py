"""A landscape as an SVG picture: colours over two parameters, a curve over one (Figure 4)."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import groupby

import numpy as np

from compiler.arrays import Array
from solvers.search.configuration_search import Sample
from srgc.landscapes.landscape import Landscape
from srgc.landscapes.landscape_request import Axis
from srgc.render.axes import Plot, Scale, axes, labelled, titles, two_parts
from srgc.render.heat_map import LACKING, contours, edges, heat_marks, heat_plot
from srgc.render.html_text import number
from srgc.render.svg import SAMPLE, document, label, line_path, symbol

LINES = 8
"""The number of contour lines of robustness."""
NOTHING = "no point of the grid is feasible"
LEFT, RIGHT, TOP, BELOW = 70.0, 60.0, 6.0, 40.0
WIDTH, SQUARE, LOW = 640.0, 440.0, 320.0
"""The width of the plot, and its height over two parameters and over one."""
SHAPES = ("diamond", "square", "plus", "wedge", "triangle")
"""The shapes of the requested marks, in their order."""


@dataclass(frozen=True, slots=True)
class _Shown:
    """The plots of feasible and of infeasible samples, which may be the same."""

    feasible: Plot
    lacking: Plot
    wide: bool

    def at(self, content: Landscape, sample: Sample) -> tuple[float, float] | None:
        """The position of a sample; None if it lies outside the plots or its value is not known."""
        place = content.at(sample)
        plot = self.feasible if sample.feasible else self.lacking
        x, y = place if self.wide else (place[0], sample.robustness)
        inside = plot.across.low <= x <= plot.across.high and plot.up.low <= y <= plot.up.high
        return (plot.across(x), plot.up(y)) if inside else None


def landscape_svg(content: Landscape, title: str) -> str:
    """The picture, with ``title`` above it."""
    wide = len(content.axes) == 2
    shown = _plane(content) if wide else _line(content)
    marks = _fields(content, shown.feasible) if wide else _curves(content, shown)
    drawn = list(_points(content, shown))
    points = "".join(symbol(kind, shape, x, y) for kind, shape, _, (x, y) in drawn)
    legend = dict.fromkeys(
        (symbol(kind, shape, SAMPLE / 2, 6), says) for kind, shape, says, _ in drawn
    )
    entries = [*_grid_legend(content), *legend]
    lower = shown.lacking
    size = lower.right + RIGHT, lower.base + BELOW
    return document(f"{marks}{_frames(content, shown)}{points}", size, "chart", title, entries)


def _frames(content: Landscape, shown: _Shown) -> str:
    """The axes of the plots; if there are two plots, one is below the other."""
    names = [_named(axis) for axis in content.axes]
    upper, lower = shown.feasible, shown.lacking
    whole = Plot(lower.across, Scale(0, 1, lower.base, upper.top))
    says = titles(whole, names[0], names[1] if shown.wide else "robustness ρ")
    below = labelled(lower.across, 8)
    if upper is lower:
        return axes(lower, below, labelled(lower.up, 8), grid=False, more=says)
    first = axes(upper, (), labelled(upper.up, 5), grid=False)
    return first + axes(lower, below, labelled(lower.up, 4), grid=False, more=says)


def _named(axis: Axis) -> str:
    unit = "" if axis.unit == "1" else f" ({axis.unit})"
    symbol_, _, name = axis.name.partition(".")
    return f"{axis.module}.{name}, symbol {symbol_}{unit}"


def _rho(content: Landscape, *, feasible: bool) -> Array:
    """Rho over the grid, of the shape of the axes; nan where feasibility is not ``feasible``."""
    values = [item.robustness if item.feasible == feasible else np.nan for item in content.grid]
    found = np.array(values).reshape([len(axis.values) for axis in content.axes])
    found[~np.isfinite(found)] = np.nan
    return found


def _points(
    content: Landscape, shown: _Shown
) -> Iterator[tuple[str, str, str, tuple[float, float]]]:
    """Class, shape, legend text and position of samples, marks and design, in this order.

    Those outside the plots are omitted.
    """
    for sample in content.samples:
        kind, shape = ("over", "dot") if sample.feasible else ("over bad", "cross")
        says = "search, feasible" if sample.feasible else "search, infeasible"
        if (at := shown.at(content, sample)) is not None:
            yield kind, shape, says, at
    for place, (mark, sample) in enumerate(zip(content.marks, content.marked, strict=True)):
        value = f"ρ {number(sample.robustness)}{'' if sample.feasible else ', infeasible'}"
        if (at := shown.at(content, sample)) is not None:
            yield "asked", SHAPES[place % len(SHAPES)], f"{mark.label}, {value}", at
    if (at := shown.at(content, content.design)) is not None:
        yield "over", "star", f"design, ρ {number(content.design.robustness)}", at


def _grid_legend(content: Landscape) -> list[tuple[str, str]]:
    found = []
    if any(not item.feasible for item in content.grid):
        wide = len(content.axes) == 2
        says = "infeasible: the lower scale" if wide else "infeasible"
        kind = f'fill="{LACKING[1]}"' if wide else 'class="infeasible"'
        found.append((f'<rect {kind} x="2" y="1" width="20" height="10"/>', says))
    if len(content.axes) == 1:
        found.append((f'<path class="line series-1" d="M0 6h{SAMPLE:g}"/>', "grid"))
    return found


# --- two parameters ------------------------------------------------------------------------------


def _plane(content: Landscape) -> _Shown:
    first, second = content.axes
    box = (LEFT, TOP, LEFT + WIDTH, TOP + SQUARE)
    plot = heat_plot(first.values.tolist(), second.values.tolist(), box)
    return _Shown(plot, plot, wide=True)


def _fields(content: Landscape, plot: Plot) -> str:
    first, second = content.axes
    rho, xs, ys = _rho(content, feasible=True), first.values.tolist(), second.values.tolist()
    marks = heat_marks(xs, ys, rho, plot, _rho(content, feasible=False))
    if not np.isfinite(rho).any():
        x, y = (plot.left + plot.right) / 2, (plot.top + plot.base) / 2
        return marks + label(x, y, "middle", NOTHING, ' class="says"')
    return (
        marks if first.discrete or second.discrete else marks + contours(xs, ys, rho, plot, LINES)
    )


# --- one parameter -------------------------------------------------------------------------------


def _line(content: Landscape) -> _Shown:
    borders = edges(content.axes[0].values.tolist())
    items = [*content.grid, content.design, *content.samples, *content.marked]
    known = [item for item in items if np.isfinite(item.robustness)]
    upper, lower = ([i.robustness for i in known if i.feasible == kind] for kind in (True, False))
    across = Scale(borders[0], borders[-1], LEFT, LEFT + WIDTH)
    return _Shown(*two_parts(across, (TOP, TOP + LOW), upper, lower), wide=False)


def _curves(content: Landscape, shown: _Shown) -> str:
    """Bands where no motion was found, and the values of each kind, neighbours joined."""
    (axis,) = content.axes
    bands = "".join(
        f'<rect class="infeasible" x="{x0:.1f}" y="{shown.feasible.top:g}" width="{x1 - x0:.1f}" '
        f'height="{shown.feasible.base - shown.feasible.top:g}"/>'
        for x0, x1 in _infeasible(content, shown.feasible)
    )
    parts = []
    for plot, kind, feasible in ((shown.feasible, "good", True), (shown.lacking, "lacks", False)):
        rho = _rho(content, feasible=feasible)
        lines = [
            np.array([(plot.across(float(axis.values[k])), plot.up(float(rho[k]))) for k in run])
            for run in _runs(np.isfinite(rho).tolist())
        ]
        curve = "".join(line_path(line) for line in lines if len(line) > 1)
        if curve and not axis.discrete:
            series = "series-1" if feasible else "series-2"
            parts.append(f'<path class="line {series}" d="{curve}"/>')
        parts += [symbol(kind, "dot", x, y) for line in lines for x, y in line.tolist()]
    return "".join([bands, *parts])


def _infeasible(content: Landscape, plot: Plot) -> Iterator[tuple[float, float]]:
    """The intervals in which no grid point is feasible."""
    (axis,) = content.axes
    borders = edges(axis.values.tolist())
    for run in _runs([not item.feasible for item in content.grid]):
        yield plot.across(borders[run[0]]), plot.across(borders[run[-1] + 1])


def _runs(kept: Sequence[bool]) -> Iterator[list[int]]:
    """The kept indices, in groups of consecutive ones."""
    for yes, group in groupby(range(len(kept)), key=lambda place: kept[place]):
        if yes:
            yield list(group)
