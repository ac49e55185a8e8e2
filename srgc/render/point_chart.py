"""Points over an axis, such as evaluations: feasible, infeasible, the design."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from srgc.render.axes import Plot, Scale, axes, labelled, padded, ticks
from srgc.render.html_text import number, text
from srgc.render.line_chart import BOTTOM, HEIGHT, LEFT, TOP, WIDTH
from srgc.render.svg import label as written

EDGE = 12
"""Free on the right."""
RAIL = 16
"""Above the axis, for what is infeasible."""


@dataclass(frozen=True, slots=True)
class Point:
    """A place with a value; ``mark`` is ``good``, ``bad`` (infeasible) or ``design``."""

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
    """Points over an axis.  Infeasible ones stand on a rail below, where there are feasible ones.

    ``best`` is a line of the best value so far; ``counted``: the axis has whole numbers only.
    """
    good = [point for point in points if point.mark != "bad"]
    low, high = padded(*_ends([point.y for point in good or points]))
    left, right = padded(*_ends([point.x for point in points]))
    base, railed = HEIGHT - BOTTOM, len(good) < len(points) and bool(good)
    rail = base - (RAIL if railed else 0)
    plot = Plot(Scale(left, right, LEFT, WIDTH - EDGE), Scale(low, high, rail - 4, TOP))
    below = Plot(plot.across, Scale(low, high, base, TOP))
    values = [(value, number(value)) for value in ticks(left, right) if value.is_integer()]
    says = f"robustness over {label}: {len(points)}"
    size = f'viewBox="0 0 {WIDTH} {HEIGHT + 8}"'
    parts = [
        f'<svg class="chart" {size} role="img" aria-label="{text(says)}">',
        axes(plot, (), labelled(plot.up, 4)),
        axes(below, values if counted else labelled(plot.across), (),
             more=written(WIDTH - EDGE, base + 29, "end", unit)),
    ]  # fmt: skip
    if railed:
        parts.append(f'<rect class="rail" x="{LEFT}" y="{rail}" width="{WIDTH - EDGE - LEFT}" '
                     f'height="{RAIL}"/>')  # fmt: skip
    if best:
        corners = "L".join(f"{plot.across(x):.1f} {plot.up(y):.1f}" for x, y in best)
        parts.append(f'<path class="best" d="M{corners}"/>')
    for point in points:
        on_rail = point.mark == "bad" and railed
        y = rail + RAIL / 2 if on_rail else plot.up(point.y)
        parts.append(_mark(point, plot.across(point.x), y))
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
