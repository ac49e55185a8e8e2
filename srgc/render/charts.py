"""Charts: curves over time, and scattered points."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from compiler.arrays import Array
from srgc.render.axes import Plot, Scale, axes, labelled, padded, ticks, two_parts
from srgc.render.html_text import number, text
from srgc.render.svg import label as written

# --- Curves over time: bounds, the width of the tube, a cursor for the time -----------------------
#
# Curves have their own scale.  Bounds far outside of it appear only in the gauge on the right: a
# bar from one bound to the other, on which the part that the curves use is marked.


WIDTH, HEIGHT = 360, 190
LEFT, RIGHT, TOP, BOTTOM = 56, 58, 10, 26
GAUGE = 14
"""The width of the gauge, in units of the picture."""
VISIBLE = 0.6
"""The least width, in units of the picture, at which the band of a tube is drawn."""
MOST_POINTS = 500
NEAR = 1.5
"""A bound within this many spans of the curve is included in its scale."""


@dataclass(frozen=True, slots=True)
class Curve:
    """A quantity over time.

    Attributes:
        name: its name in the table of the motion, such as ``q1``.
        title: its name for people.
        unit: its SI unit.
        times: (k,) seconds; for a held quantity, the last one ends the last step.
        values: (k,) at those times; for a held quantity, (k - 1,), from each time to the next.
        held: whether it is constant over each step.
        bounds: the least and the greatest value allowed; None for no bound.
        band: the bounds of the tube, a pair per value; None for no band.
        series: the number of its colour, from 1.
    """

    name: str
    title: str
    unit: str
    times: Array
    values: Array
    held: bool = False
    bounds: tuple[float | None, float | None] = (None, None)
    band: Array | None = None
    series: int = 1


def thinned(curve: Curve, most: int = MOST_POINTS) -> Curve:
    """The curve with at most ``most`` points; of held values, the largest of each group stays."""
    count = len(curve.values)
    if count <= most:
        return curve
    kept = np.unique(np.linspace(0, count - 1, most).round().astype(int))
    if not curve.held:
        band = None if curve.band is None else curve.band[kept]
        return replace(curve, times=curve.times[kept], values=curve.values[kept], band=band)
    blocks = np.split(curve.values, kept[1:])
    largest = np.array([block[np.abs(block).argmax()] for block in blocks])
    band = curve.band
    if band is not None:
        parts = np.split(band, kept[1:])
        band = np.array([(part[:, 0].min(), part[:, 1].max()) for part in parts])
    times = np.append(curve.times[kept], curve.times[-1])
    return replace(curve, times=times, values=largest, band=band)


def line_chart(curve: Curve) -> str:
    """The chart of one curve; its data attributes give scripts the scale of time."""
    return lines_chart([curve], curve.name)


def lines_chart(curves: Sequence[Curve], name: str) -> str:
    """The chart of curves over the same times with a common scale; ``name`` is for scripts."""
    plot = plot_of(curves, WIDTH, HEIGHT)
    says = "; ".join(map(_described, curves))
    return (
        f'<svg class="chart" viewBox="0 0 {WIDTH} {HEIGHT}" role="img" '
        f'aria-label="{text(says)}" data-name="{text(name)}" '
        f'data-t0="{plot.across.low:.6g}" data-t1="{plot.across.high:.6g}" '
        f'data-x0="{LEFT}" data-x1="{WIDTH - RIGHT}">{curve_marks(curves, plot)}'
        f'<line class="cursor" x1="0" x2="0" y1="{TOP}" y2="{HEIGHT - BOTTOM}" '
        f'transform="translate({LEFT} 0)"/></svg>'
    )


def plot_of(curves: Sequence[Curve], width: float, height: float) -> Plot:
    """The plot that shows curves over the same times, in a picture of the given size."""
    times, (low, high) = curves[0].times, _range(curves)
    across = Scale(float(times[0]), float(times[-1]), LEFT, width - RIGHT)
    return Plot(across, Scale(low, high, height - BOTTOM, TOP))


def curve_marks(curves: Sequence[Curve], plot: Plot) -> str:
    """Axes, curves and their common bounds, which are those of the first curve."""
    times = ticks(plot.across.low, plot.across.high, 6)
    below = [(value, number(value) + (" s" if value == times[-1] else "")) for value in times]
    bands = "".join(_band(curve, plot) for curve in curves)
    lines = "".join(
        f'<path class="line {colour_class(curve)}" d="{_path(curve, plot)}"/>' for curve in curves
    )
    return (
        f"{axes(plot, below, labelled(plot.up))}{bands}{_bound_lines(curves[0], plot)}"
        f"{lines}{_gauge(curves, plot)}"
    )


def colour_class(curve: Curve) -> str:
    """The CSS class of the curve's colour; there are six colours."""
    return f"series-{(curve.series - 1) % 6 + 1}"


def _described(curve: Curve) -> str:
    least, most = float(curve.values.min()), float(curve.values.max())
    return f"{curve.title}: between {number(least)} and {number(most)} {curve.unit}"


def _extent(curves: Sequence[Curve]) -> tuple[float, float]:
    """The least and the greatest value of the curves and their tubes."""
    values = [curve.values if curve.band is None else curve.band for curve in curves]
    values += [curve.values for curve in curves]
    return min(float(each.min()) for each in values), max(float(each.max()) for each in values)


def _range(curves: Sequence[Curve]) -> tuple[float, float]:
    """The range to show: the curves, their tubes, and bounds that are not far away."""
    low, high = _extent(curves)
    span = high - low
    lower, upper = curves[0].bounds
    if lower is not None and low - lower <= NEAR * span:
        low = min(low, lower)
    if upper is not None and upper - high <= NEAR * span:
        high = max(high, upper)
    return padded(low, high)


def _path(curve: Curve, plot: Plot) -> str:
    times, values = curve.times, curve.values
    if curve.held:
        times, values = np.repeat(times, 2)[1:-1], np.repeat(values, 2)
    return "M" + "L".join(
        f"{plot.across(float(t)):.1f} {plot.up(float(v)):.1f}"
        for t, v in zip(times, values, strict=True)
    )


def _band(curve: Curve, plot: Plot) -> str:
    """The band of the tube, if it is wide enough to be seen."""
    if curve.band is None:
        return ""
    size = abs(plot.up(1.0) - plot.up(0.0))
    if float((curve.band[:, 1] - curve.band[:, 0]).max()) * size < VISIBLE:
        return ""
    times, band = curve.times, curve.band
    if curve.held:
        times, band = np.repeat(times, 2)[1:-1], np.repeat(band, 2, axis=0)
    ends = [(t, v) for t, v in zip(times, band[:, 1], strict=True)]
    ends += [(t, v) for t, v in zip(times[::-1], band[::-1, 0], strict=True)]
    corners = "L".join(f"{plot.across(float(t)):.1f} {plot.up(float(v)):.1f}" for t, v in ends)
    return f'<path class="tube {colour_class(curve)}" d="M{corners}Z"/>'


def _bound_lines(curve: Curve, plot: Plot) -> str:
    parts = []
    for value in curve.bounds:
        if value is not None and plot.up.low <= value <= plot.up.high:
            y = plot.up(value)
            parts.append(
                f'<line class="bound" data-bound="{number(value, 9)}" '
                f'x1="{plot.left:g}" x2="{plot.right:g}" y1="{y:.1f}" y2="{y:.1f}"/>'
            )
    return "".join(parts)


def _gauge(curves: Sequence[Curve], plot: Plot) -> str:
    """The whole allowed range, and the part of it that is used."""
    lower, upper = curves[0].bounds
    if lower is None or upper is None or not lower < upper:
        return ""
    up = Scale(lower, upper, plot.base, plot.top)
    least, most = _extent(curves)
    x, top = plot.right + 10, max(up(most), plot.top)
    height = max(min(up(least), plot.base) - top, 1.5)
    return (
        f'<g class="gauge"><title>allowed: {number(lower)} to {number(upper)}, '
        f"used: {number(least)} to {number(most)}</title>"
        f'<rect class="allowed" x="{x:g}" y="{plot.top:g}" width="{GAUGE}" '
        f'height="{plot.base - plot.top:g}"/>'
        f'<rect class="used {colour_class(curves[0])}" x="{x:g}" y="{top:.1f}" '
        f'width="{GAUGE}" height="{height:.1f}"/>'
        f'<text data-bound="{number(upper, 9)}" x="{x + GAUGE + 3:g}" y="{plot.top + 8:g}">'
        f"{number(upper, 3)}</text>"
        f'<text data-bound="{number(lower, 9)}" x="{x + GAUGE + 3:g}" y="{plot.base:g}">'
        f"{number(lower, 3)}</text></g>"
    )


def sampled(values: Array) -> Sequence[float]:
    """Values (n,) for a script, to six digits, which is more than can be seen."""
    return [float(f"{value:.6g}") for value in values]


# --- Points over an axis, such as evaluations: feasible, infeasible, the design -------------------


EDGE = 12
"""The free space on the right."""


@dataclass(frozen=True, slots=True)
class Point:
    """A point with a value; ``mark`` is ``good``, ``bad`` (infeasible) or ``design``."""

    x: float
    y: float
    mark: str
    says: str


def scatter_chart(
    points: Sequence[Point],
    label: str,
    unit: str,
    best: Sequence[tuple[float, float]] = (),
    *,
    counted: bool = False,
) -> str:
    """Points over an axis; infeasible ones are in a separate part below, with their own scale.

    ``best`` is the curve of the best value so far; ``counted``: the axis has whole numbers only.
    """
    good, bad = (
        [each.y for each in points if (each.mark == "bad") == lacks] for lacks in (False, True)
    )
    left, right = padded(*_ends([point.x for point in points]))
    base = HEIGHT - BOTTOM
    upper, lower = two_parts(Scale(left, right, LEFT, WIDTH - EDGE), (TOP, base), good, bad)
    values = [(value, number(value)) for value in ticks(left, right) if value.is_integer()]
    says = f"robustness over {label}: {len(points)}"
    size = f'viewBox="0 0 {WIDTH} {HEIGHT + 8}"'
    parts = [f'<svg class="chart" {size} role="img" aria-label="{text(says)}">']
    if upper is not lower:
        width, height = WIDTH - EDGE - LEFT, f"{base - lower.top:.1f}"
        parts.append(f'<rect class="rail" x="{LEFT}" y="{lower.top:.1f}" width="{width}" '
                     f'height="{height}"/>')  # fmt: skip
        parts.append(axes(upper, (), labelled(upper.up, 4)))
    parts.append(
        axes(lower, values if counted else labelled(lower.across), labelled(lower.up, 4),
             more=written(WIDTH - EDGE, base + 29, "end", unit))
    )  # fmt: skip
    if best:
        corners = "L".join(f"{upper.across(x):.1f} {upper.up(y):.1f}" for x, y in best)
        parts.append(f'<path class="best" d="M{corners}"/>')
    for point in points:
        plot = lower if point.mark == "bad" else upper
        parts.append(_mark(point, plot.across(point.x), plot.up(point.y)))
    return "".join([*parts, "</svg>"])


def _ends(values: Sequence[float]) -> tuple[float, float]:
    return min(values), max(values)


def _mark(point: Point, x: float, y: float) -> str:
    title = f"<title>{text(point.says)}</title>"
    if point.mark == "bad":
        shape = f"M{x - 3:.1f} {y - 3:.1f}l6 6m0 -6l-6 6"
    elif point.mark == "design":
        shape = f"M{x:.1f} {y - 6:.1f}l6 6l-6 6l-6 -6z"
    else:
        return f'<circle class="good" cx="{x:.1f}" cy="{y:.1f}" r="3.2">{title}</circle>'
    return f'<path class="{point.mark}" d="{shape}">{title}</path>'
