"""The axes of charts: scales, round tick values, and the lines and labels of a plot."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from srgc.render.html_text import number
from srgc.render.svg import label
from srgc.render.text_size import text_width

LONGEST_LABEL = 7
"""The most characters of a number; longer ones get an exponent and then fit, too."""
LETTERS = 11.5
"""The largest size of labels; if two on the horizontal axis would overlap, one is omitted."""
LEAST_SPAN = 0.04
"""The least range of an axis, as a fraction of the largest absolute value."""


@dataclass(frozen=True, slots=True)
class Scale:
    """A linear map from values to coordinates in the picture."""

    low: float
    high: float
    first: float
    last: float

    def __call__(self, value: float) -> float:
        """The coordinate of a value."""
        part = (value - self.low) / (self.high - self.low)
        return self.first + part * (self.last - self.first)


@dataclass(frozen=True, slots=True)
class Plot:
    """A rectangle of the picture with a scale for each axis; ``up`` starts at its bottom."""

    across: Scale
    up: Scale

    @property
    def left(self) -> float:
        """The x-coordinate of its left side."""
        return self.across.first

    @property
    def right(self) -> float:
        """The x-coordinate of its right side."""
        return self.across.last

    @property
    def base(self) -> float:
        """The y-coordinate of its lower side."""
        return self.up.first

    @property
    def top(self) -> float:
        """The y-coordinate of its upper side."""
        return self.up.last


def ticks(low: float, high: float, most: int = 5) -> list[float]:
    """Round numbers in an interval, with equal steps of 1, 2 or 5 times 10^k.

    There are at least two, and at most ``most``, which is 4 or more.
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
    """Widen an interval a little, and enough for a constant with noise to look constant."""
    least = max(LEAST_SPAN * max(abs(low), abs(high)), 1e-9)
    lacking = max(least - (high - low), 0.0) / 2
    edge = 0.08 * max(high - low, least)
    return low - lacking - edge, high + lacking + edge


def tick_labels(values: Sequence[float]) -> list[str]:
    """The labels of equally spaced values, with enough digits to tell them apart.

    No label is longer than ``LONGEST_LABEL``, unless the steps are tiny compared with the values.
    """
    if len(values) < 2:
        return [number(value, 3) for value in values]
    finest = math.floor(math.log10(values[1] - values[0]) + 1e-9)
    plain = [f"{value + 0.0:.{max(0, -finest)}f}" for value in values]
    if max(map(len, plain)) <= LONGEST_LABEL:
        return plain
    return [_with_exponent(value, finest) for value in values]


def _with_exponent(value: float, finest: int) -> str:
    """A number whose last digit counts ``10**finest``, such as ``-1.5e-8``."""
    if value == 0:
        return "0"
    digits = max(0, math.floor(math.log10(abs(value)) + 1e-9) - finest)
    mantissa, exponent = f"{value:.{digits}e}".split("e")
    return f"{mantissa}e{int(exponent)}"


def labelled(scale: Scale, most: int = 5) -> list[tuple[float, str]]:
    """Round values on a scale, with their labels."""
    values = ticks(scale.low, scale.high, most)
    return list(zip(values, tick_labels(values), strict=True))


LOWER_PART, BETWEEN = 0.38, 10.0
"""The share of the height for the lower part of a two-part plot, and the gap between the parts."""


def two_parts(
    across: Scale, box: tuple[float, float], upper: Sequence[float], lower: Sequence[float]
) -> tuple[Plot, Plot]:
    """A plot for feasible values above one for infeasible values, each with its own scale.

    If there are values of one kind only, both are the plot of that kind.

    Args:
        across: the axis that they share.
        box: the top and the base of both together.
        upper: the feasible values.
        lower: the infeasible values.
    """
    top, base = box
    if not upper or not lower:
        low, high = padded(min(upper or lower), max(upper or lower))
        whole = Plot(across, Scale(low, high, base, top))
        return whole, whole
    middle = base - LOWER_PART * (base - top)
    ends = (min(upper), max(upper)), (min(lower), max(lower))
    (a, b), (c, d) = (padded(*pair) for pair in ends)
    first = Plot(across, Scale(a, b, middle - BETWEEN, top))
    return first, Plot(across, Scale(c, d, base, middle))


def axes(
    plot: Plot,
    below: Sequence[tuple[float, str]],
    beside: Sequence[tuple[float, str]],
    *,
    grid: bool = True,
    more: str = "",
) -> str:
    """The axes of a plot: values below and to the left of it, with tick or grid lines.

    Args:
        plot: the rectangle and its scales.
        below: values along the horizontal axis, with their labels.
        beside: values along the vertical axis, with their labels.
        grid: whether lines cross the plot; otherwise it has a frame.
        more: further labels.
    """
    left, right, base, top = plot.left, plot.right, plot.base, plot.top
    parts = ['<g class="axes">']
    if not grid:
        size = f'width="{right - left:.1f}" height="{base - top:.1f}"'
        parts.append(f'<rect class="spine" x="{left:.1f}" y="{top:.1f}" {size}/>')
    for value, says in beside:
        y = plot.up(value)
        if grid:
            parts.append(f'<line x1="{left:g}" x2="{right:g}" y1="{y:.1f}" y2="{y:.1f}"/>')
        else:
            parts.append(_tick(left - 4, left, y, y))
        parts.append(label(left - 5 - (0 if grid else 2), y + 3.5, "end", says))
    end = -math.inf
    for value, says in sorted(below):
        x, half = plot.across(value), text_width(says, LETTERS) / 2
        parts.append(_tick(x, x, base, base + 4))
        if x - half >= end:
            parts.append(label(x, base + 16, "middle", says))
            end = x + half + LETTERS / 3
    return "".join([*parts, more, "</g>"])


def _tick(x1: float, x2: float, y1: float, y2: float) -> str:
    return f'<line class="tick" x1="{x1:.1f}" x2="{x2:.1f}" y1="{y1:.1f}" y2="{y2:.1f}"/>'


def titles(plot: Plot, across: str, up: str, gap: float = 46.0) -> str:
    """The titles of the axes: below the horizontal one, and turned beside the vertical one."""
    x, y = (plot.left + plot.right) / 2, (plot.top + plot.base) / 2
    turned = f' transform="rotate(-90 {plot.left - gap:.1f} {y:.1f})"'
    return label(x, plot.base + 33, "middle", across) + label(
        plot.left - gap, y, "middle", up, turned
    )
