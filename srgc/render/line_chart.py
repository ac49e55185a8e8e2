"""A curve over time as inline SVG: bounds, the width of the tube, a cursor for the time.

It is drawn to the scale of the curve.  Bounds that lie far outside are not drawn to that scale but
in the gauge on the right, a bar from one bound to the other with the part that the curve uses.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from srgc.render.html_text import number, text
from srgc.render.view import Array

WIDTH, HEIGHT = 360, 190
LEFT, RIGHT, TOP, BOTTOM = 56, 58, 10, 26
LONGEST_LABEL = 7
"""Characters of a number; longer ones get an exponent, with which they have room, too."""
GAUGE = 14
"""Width of the gauge, in units of the picture."""
VISIBLE = 0.6
"""So many units wide a tube has to be for its band to be seen."""
MOST_POINTS = 500
LEAST_SPAN = 0.04
"""Of what is shown, as a part of the largest value."""
NEAR = 1.5
"""A bound within so many spans of the curve is drawn to its scale."""


@dataclass(frozen=True, slots=True)
class Curve:
    """A quantity over time.

    Attributes:
        name: how the motion's table calls it, as ``q1``.
        title: what it is, for people.
        unit: in SI.
        times: (k,) seconds; where it is held, the last one ends the last step.
        values: (k,) at those times; where it is held, (k - 1,), from each time to the next.
        held: whether it is constant over each step.
        bounds: the least and the greatest value allowed; None: no bound.
        band: (k, 2) what the tube allows at those times, or None.
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


def thinned(curve: Curve) -> Curve:
    """The curve with at most ``MOST_POINTS``; of what is held, the largest of neighbours stay."""
    count = len(curve.values)
    if count <= MOST_POINTS:
        return curve
    kept = np.unique(np.linspace(0, count - 1, MOST_POINTS).round().astype(int))
    if not curve.held:
        band = None if curve.band is None else curve.band[kept]
        return replace(curve, times=curve.times[kept], values=curve.values[kept], band=band)
    blocks = np.split(curve.values, kept[1:])
    largest = np.array([block[np.abs(block).argmax()] for block in blocks])
    return replace(curve, times=np.append(curve.times[kept], curve.times[-1]), values=largest)


@dataclass(frozen=True, slots=True)
class Scale:
    """From values to places in the picture, linearly."""

    low: float
    high: float
    first: float
    last: float

    def __call__(self, value: float) -> float:
        """The place of a value."""
        part = (value - self.low) / (self.high - self.low)
        return self.first + part * (self.last - self.first)


def ticks(low: float, high: float, most: int = 5) -> list[float]:
    """Round numbers in an interval, with equal steps of 1, 2 or 5 times 10^k.

    There are two at least, and at most so many (4 or more).
    """
    span = high - low
    power = 10.0 ** math.floor(math.log10(span / most))
    steps = [power * m for m in (0.5, 1, 2, 5, 10, 20)]
    place = next(i for i, step in enumerate(steps) if i and span / step <= most)
    found = _multiples(steps[place], low, high)
    return found if len(found) > 1 else _multiples(steps[place - 1], low, high)


def _multiples(step: float, low: float, high: float) -> list[float]:
    first = math.ceil(low / step - 1e-9)
    last = math.floor(high / step + 1e-9)
    return [round(i * step, 12) for i in range(first, last + 1)]


def padded(low: float, high: float) -> tuple[float, float]:
    """An interval a little wider, and wide enough that a constant with noise looks like one."""
    least = max(LEAST_SPAN * max(abs(low), abs(high)), 1e-9)
    lacking = max(least - (high - low), 0.0) / 2
    edge = 0.08 * max(high - low, least)
    return low - lacking - edge, high + lacking + edge


def tick_labels(values: Sequence[float]) -> list[str]:
    """The labels of equally spaced values, with as many digits as tell them apart.

    None is longer than ``LONGEST_LABEL``, unless steps are that small beside the values.
    """
    if len(values) < 2:
        return [number(value, 3) for value in values]
    finest = math.floor(math.log10(values[1] - values[0]) + 1e-9)
    plain = [f"{value + 0.0:.{max(0, -finest)}f}" for value in values]
    if max(map(len, plain)) <= LONGEST_LABEL:
        return plain
    return [_with_exponent(value, finest) for value in values]


def _with_exponent(value: float, finest: int) -> str:
    """A number whose last digit counts ``10**finest``, as ``-1.5e-8``."""
    if value == 0:
        return "0"
    digits = max(0, math.floor(math.log10(abs(value)) + 1e-9) - finest)
    mantissa, exponent = f"{value:.{digits}e}".split("e")
    return f"{mantissa}e{int(exponent)}"


def line_chart(curve: Curve) -> str:
    """The picture; its data attributes tell a script where times are."""
    across = Scale(float(curve.times[0]), float(curve.times[-1]), LEFT, WIDTH - RIGHT)
    low, high = _range(curve)
    up = Scale(low, high, HEIGHT - BOTTOM, TOP)
    return (
        f'<svg class="chart" viewBox="0 0 {WIDTH} {HEIGHT}" role="img" '
        f'aria-label="{text(_described(curve))}" data-name="{text(curve.name)}" '
        f'data-t0="{across.low:.6g}" data-t1="{across.high:.6g}" '
        f'data-x0="{LEFT}" data-x1="{WIDTH - RIGHT}">'
        f"{_axes(across, up)}{_band(curve, across, up)}{_bound_lines(curve, up)}"
        f'<path class="line {_colour(curve)}" d="{_path(curve, across, up)}"/>{_gauge(curve)}'
        f'<line class="cursor" x1="0" x2="0" y1="{TOP}" y2="{HEIGHT - BOTTOM}" '
        f'transform="translate({LEFT} 0)"/></svg>'
    )


def _colour(curve: Curve) -> str:
    """The class of its colour, of which there are six."""
    return f"series-{(curve.series - 1) % 6 + 1}"


def _described(curve: Curve) -> str:
    least, most = float(curve.values.min()), float(curve.values.max())
    return f"{curve.title}: between {number(least)} and {number(most)} {curve.unit}"


def _extent(curve: Curve) -> tuple[float, float]:
    """The least and the greatest value of the curve and its tube."""
    low, high = float(curve.values.min()), float(curve.values.max())
    if curve.band is None:
        return low, high
    return min(low, float(curve.band.min())), max(high, float(curve.band.max()))


def _range(curve: Curve) -> tuple[float, float]:
    """What is shown: the curve, its tube, and bounds that are not far."""
    low, high = _extent(curve)
    span = high - low
    lower, upper = curve.bounds
    if lower is not None and low - lower <= NEAR * span:
        low = min(low, lower)
    if upper is not None and upper - high <= NEAR * span:
        high = max(high, upper)
    return padded(low, high)


def _axes(across: Scale, up: Scale) -> str:
    """Grid lines with their values."""
    base = HEIGHT - BOTTOM
    parts = ['<g class="axes">']
    heights = ticks(up.low, up.high)
    for value, label in zip(heights, tick_labels(heights), strict=True):
        y = up(value)
        parts.append(f'<line x1="{LEFT}" x2="{WIDTH - RIGHT}" y1="{y:.1f}" y2="{y:.1f}"/>')
        parts.append(f'<text x="{LEFT - 5}" y="{y + 3.5:.1f}" text-anchor="end">{label}</text>')
    times = ticks(across.low, across.high, 6)
    for value in times:
        x = across(value)
        unit = " s" if value == times[-1] else ""
        parts.append(f'<line x1="{x:.1f}" x2="{x:.1f}" y1="{base}" y2="{base + 4}"/>')
        parts.append(
            f'<text x="{x:.1f}" y="{base + 16}" text-anchor="middle">{number(value)}{unit}</text>'
        )
    return "".join([*parts, "</g>"])


def _path(curve: Curve, across: Scale, up: Scale) -> str:
    times, values = curve.times, curve.values
    if curve.held:
        times, values = np.repeat(times, 2)[1:-1], np.repeat(values, 2)
    return "M" + "L".join(
        f"{across(float(t)):.1f} {up(float(v)):.1f}" for t, v in zip(times, values, strict=True)
    )


def _band(curve: Curve, across: Scale, up: Scale) -> str:
    """The tube, where it is wide enough to be seen."""
    if curve.band is None:
        return ""
    size = abs(up(1.0) - up(0.0))
    if float((curve.band[:, 1] - curve.band[:, 0]).max()) * size < VISIBLE:
        return ""
    ends = [(t, v) for t, v in zip(curve.times, curve.band[:, 1], strict=True)]
    ends += [(t, v) for t, v in zip(curve.times[::-1], curve.band[::-1, 0], strict=True)]
    corners = "L".join(f"{across(float(t)):.1f} {up(float(v)):.1f}" for t, v in ends)
    return f'<path class="tube {_colour(curve)}" d="M{corners}Z"/>'


def _bound_lines(curve: Curve, up: Scale) -> str:
    parts = []
    for value in curve.bounds:
        if value is not None and up.low <= value <= up.high:
            y = up(value)
            parts.append(
                f'<line class="bound" data-bound="{number(value, 9)}" '
                f'x1="{LEFT}" x2="{WIDTH - RIGHT}" y1="{y:.1f}" y2="{y:.1f}"/>'
            )
    return "".join(parts)


def _gauge(curve: Curve) -> str:
    """The whole allowed range, and the part of it that is used."""
    lower, upper = curve.bounds
    if lower is None or upper is None or not lower < upper:
        return ""
    up = Scale(lower, upper, HEIGHT - BOTTOM, TOP)
    least, most = _extent(curve)
    x, top = WIDTH - RIGHT + 10, max(up(most), TOP)
    height = max(min(up(least), HEIGHT - BOTTOM) - top, 1.5)
    return (
        f'<g class="gauge"><title>allowed: {number(lower)} to {number(upper)}, '
        f"used: {number(least)} to {number(most)}</title>"
        f'<rect class="allowed" x="{x}" y="{TOP}" width="{GAUGE}" height="{up.first - TOP}"/>'
        f'<rect class="used {_colour(curve)}" x="{x}" y="{top:.1f}" '
        f'width="{GAUGE}" height="{height:.1f}"/>'
        f'<text data-bound="{number(upper, 9)}" x="{x + GAUGE + 3}" y="{TOP + 8}">'
        f"{number(upper, 3)}</text>"
        f'<text data-bound="{number(lower, 9)}" x="{x + GAUGE + 3}" y="{HEIGHT - BOTTOM}">'
        f"{number(lower, 3)}</text></g>"
    )


def sampled(values: Array) -> Sequence[float]:
    """Values for a script: to six digits, which is more than can be seen."""
    return [float(f"{value:.6g}") for value in values]
