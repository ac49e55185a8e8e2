"""A landscape as a picture, SVG: colours over two parameters, a curve over one (Figure 4)."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from compiler.arrays import Array
from solvers.search.configuration_search import Sample
from srgc.landscapes.landscape import Landscape
from srgc.landscapes.landscape_request import Axis
from srgc.render.axes import Plot, Scale, axes, labelled, padded, titles
from srgc.render.heat_map import contours, edges, heat_marks, heat_plot
from srgc.render.html_text import number
from srgc.render.svg import SAMPLE, document, label, line_path, symbol

LINES = 8
"""Lines of equal robustness."""
NOTHING = "no point of the grid is feasible"
LEFT, RIGHT, TOP, BELOW = 70.0, 60.0, 6.0, 40.0
WIDTH, SQUARE, LOW = 640.0, 440.0, 320.0
"""Of the plot: its width, and its height over two parameters and over one."""
SHAPES = ("diamond", "square", "plus", "wedge", "triangle")
"""Of the marks that are asked for, in their order."""


def landscape_svg(content: Landscape, title: str) -> str:
    """The picture; ``title`` is above it."""
    wide = len(content.axes) == 2
    plot = _plane(content) if wide else _line(content)
    marks = _fields(content, plot) if wide else _curve(content, plot)
    floor = None if wide else _floor(content)
    drawn = list(_points(content, plot, floor))
    points = "".join(
        symbol(kind, shape, plot.across(x), plot.up(y)) for kind, shape, _, x, y in drawn
    )
    legend = dict.fromkeys(
        (symbol(kind, shape, SAMPLE / 2, 6), says) for kind, shape, says, _, _ in drawn
    )
    entries = [*_grid_legend(content), *legend]
    names = [_named(axis) for axis in content.axes]
    beside = names[1] if wide else "robustness ρ"
    frame = axes(
        plot, labelled(plot.across, 8), labelled(plot.up, 8), grid=False,
        more=titles(plot, names[0], beside),
    )  # fmt: skip
    size = plot.right + RIGHT, plot.base + BELOW
    return document(f"{marks}{frame}{points}", size, "chart", title, entries)


def _named(axis: Axis) -> str:
    unit = "" if axis.unit == "1" else f" ({axis.unit.replace('*', ' ')})"
    symbol_, _, name = axis.name.partition(".")
    return f"{axis.module}.{name}, symbol {symbol_}{unit}"


def _rho(content: Landscape) -> Array:
    """Rho over the grid, nan where infeasible; its shape is that of the axes."""
    values = [item.robustness if item.feasible else np.nan for item in content.grid]
    return np.array(values).reshape([len(axis.values) for axis in content.axes])


def _points(
    content: Landscape, plot: Plot, floor: float | None
) -> Iterator[tuple[str, str, str, float, float]]:
    """Class, shape, words of the legend and place of samples, marks and design, in this order.

    Samples of the search that are outside of the plot are left out.
    """
    for sample in content.samples:
        x, y = _at(content, sample, floor)
        inside = plot.across.low <= x <= plot.across.high and plot.up.low <= y <= plot.up.high
        if inside and sample.feasible:
            yield "over", "dot", "search, feasible", x, y
        elif inside:
            yield "over bad", "cross", "search, infeasible", x, y
    for place, (mark, sample) in enumerate(zip(content.marks, content.marked, strict=True)):
        value = f"ρ {number(sample.robustness)}" if sample.feasible else "infeasible"
        x, y = _at(content, sample, floor)
        yield "asked", SHAPES[place % len(SHAPES)], f"{mark.label}, {value}", x, y
    says = f"design, ρ {number(content.design.robustness)}"
    yield "over", "star", says, *_at(content, content.design, floor)


def _at(content: Landscape, sample: Sample, floor: float | None) -> tuple[float, float]:
    """Where a sample is on the axes; over one parameter what is infeasible is at the bottom."""
    place = content.at(sample)
    if floor is None:
        return place[0], place[1]
    return place[0], sample.robustness if sample.feasible else floor


def _grid_legend(content: Landscape) -> list[tuple[str, str]]:
    found = []
    if any(not item.feasible for item in content.grid):
        found.append(
            ('<rect class="infeasible" x="2" y="1" width="20" height="10"/>', "infeasible")
        )
    if len(content.axes) == 1:
        found.append((f'<path class="line series-1" d="M0 6h{SAMPLE:g}"/>', "grid"))
    return found


# --- two parameters ------------------------------------------------------------------------------


def _plane(content: Landscape) -> Plot:
    first, second = content.axes
    box = (LEFT, TOP, LEFT + WIDTH, TOP + SQUARE)
    return heat_plot(first.values.tolist(), second.values.tolist(), box)


def _fields(content: Landscape, plot: Plot) -> str:
    first, second = content.axes
    rho, xs, ys = _rho(content), first.values.tolist(), second.values.tolist()
    marks = heat_marks(xs, ys, rho, plot)
    if not np.isfinite(rho).any():
        x, y = (plot.left + plot.right) / 2, (plot.top + plot.base) / 2
        return marks + label(x, y, "middle", NOTHING, ' class="says"')
    return (
        marks if first.discrete or second.discrete else marks + contours(xs, ys, rho, plot, LINES)
    )


# --- one parameter -------------------------------------------------------------------------------


def _floor(content: Landscape) -> float:
    """The least robustness that is known."""
    known = [item for item in (*content.grid, content.design) if item.feasible]
    return min(item.robustness for item in known)


def _line(content: Landscape) -> Plot:
    borders = edges(content.axes[0].values.tolist())
    shown = [*content.grid, content.design, *content.samples, *content.marked]
    rho = [item.robustness for item in shown if item.feasible]
    low, high = padded(min(rho), max(rho))
    across = Scale(borders[0], borders[-1], LEFT, LEFT + WIDTH)
    return Plot(across, Scale(low, high, TOP + LOW, TOP))


def _curve(content: Landscape, plot: Plot) -> str:
    """Bands where no motion was found, and the values elsewhere, joined unless they are all."""
    (axis,) = content.axes
    rho, borders = _rho(content), edges(axis.values.tolist())
    bands, lines, run = [], [], list[tuple[float, float]]()
    for place, value in enumerate(rho.tolist()):
        x0, x1 = plot.across(borders[place]), plot.across(borders[place + 1])
        if np.isfinite(value):
            run.append((plot.across(float(axis.values[place])), plot.up(value)))
            continue
        bands.append(
            f'<rect class="infeasible" x="{x0:.1f}" y="{plot.top:g}" width="{x1 - x0:.1f}" '
            f'height="{plot.base - plot.top:g}"/>'
        )
        lines.append(run)
        run = []
    lines.append(run)
    curve = "" if axis.discrete else "".join(line_path(np.array(line)) for line in lines if line)
    dots = "".join(symbol("good", "dot", x, y) for line in lines for x, y in line)
    return f'{"".join(bands)}<path class="line series-1" d="{curve}"/>{dots}'
