"""Pictures of evaluations as inline SVG: robustness over something, and over two parameters."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

from srgc.render.html_text import number, text
from srgc.render.line_chart import (
    BOTTOM,
    HEIGHT,
    LEFT,
    TOP,
    WIDTH,
    Scale,
    padded,
    tick_labels,
    ticks,
)

EDGE = 12
"""Free on the right."""
RAIL = 16
"""Above the axis, for what is infeasible."""
COLOURS = ("#440154", "#414487", "#2a788e", "#22a884", "#7ad151", "#fde725")
"""From low to high robustness: viridis (matplotlib), at equal distances."""


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
    rail = HEIGHT - BOTTOM - (RAIL if len(good) < len(points) and good else 0)
    across, up = Scale(left, right, LEFT, WIDTH - EDGE), Scale(low, high, rail - 4, TOP)
    says = f"robustness over {label}: {len(points)}"
    parts = [_opened(HEIGHT, says), _axes(across, up, unit, counted=counted)]
    if rail < HEIGHT - BOTTOM:
        parts.append(f'<rect class="rail" x="{LEFT}" y="{rail}" width="{WIDTH - EDGE - LEFT}" '
                     f'height="{RAIL}"/>')  # fmt: skip
    if best:
        corners = "L".join(f"{across(x):.1f} {up(y):.1f}" for x, y in best)
        parts.append(f'<path class="best" d="M{corners}"/>')
    for point in points:
        on_rail = point.mark == "bad" and bool(good)
        parts.append(_mark(point, across(point.x), rail + RAIL / 2 if on_rail else up(point.y)))
    return "".join([*parts, "</svg>"])


def _opened(height: int, says: str) -> str:
    return (
        f'<svg class="chart" viewBox="0 0 {WIDTH} {height}" role="img" aria-label="{text(says)}">'
    )


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


def _axes(across: Scale, up: Scale, unit: str, *, counted: bool) -> str:
    base = HEIGHT - BOTTOM
    parts = ['<g class="axes">']
    heights = ticks(up.low, up.high, 4)
    for value, label in zip(heights, tick_labels(heights), strict=True):
        y = up(value)
        parts.append(f'<line x1="{LEFT}" x2="{WIDTH - EDGE}" y1="{y:.1f}" y2="{y:.1f}"/>')
        parts.append(_label(LEFT - 5, y + 3.5, "end", label))
    parts += _below(across, base + 14, counted=counted)
    return "".join([*parts, _label(WIDTH - EDGE, base + 25, "end", unit), "</g>"])


def _below(across: Scale, y: float, *, counted: bool = False) -> list[str]:
    """The values along the axis."""
    values = ticks(across.low, across.high)
    if counted:
        values = [value for value in values if value.is_integer()]
    labels = [number(value) for value in values] if counted else tick_labels(values)
    return [
        _label(across(value), y, "middle", label)
        for value, label in zip(values, labels, strict=True)
    ]


def _label(x: float, y: float, anchor: str, content: str) -> str:
    return f'<text x="{x:.1f}" y="{y:.1f}" text-anchor="{anchor}">{text(content)}</text>'


# --- two parameters ------------------------------------------------------------------------------


def plane_chart(
    cells: Sequence[tuple[float, float, float | None]],
    design: tuple[float, float],
    labels: tuple[str, str],
) -> str:
    """Robustness over a grid of two parameters; None: infeasible, drawn grey."""
    xs, ys = sorted({cell[0] for cell in cells}), sorted({cell[1] for cell in cells})
    size = 300
    first, second = _edges(xs), _edges(ys)
    across = Scale(first[0], first[-1], LEFT, LEFT + size - LEFT)
    up = Scale(second[0], second[-1], size - BOTTOM, TOP)
    known = [value for _, _, value in cells if value is not None]
    low, high = (min(known), max(known)) if known else (0.0, 1.0)
    parts = [_opened(size + 10, f"robustness over {labels[0]} and {labels[1]}")]
    places = {x: i for i, x in enumerate(xs)}, {y: j for j, y in enumerate(ys)}
    for x, y, value in cells:
        i, j = places[0][x], places[1][y]
        x0, x1 = across(first[i]), across(first[i + 1])
        y0, y1 = up(second[j + 1]), up(second[j])
        says = "infeasible" if value is None else f"robustness {number(value)}"
        parts.append(
            f'<rect x="{x0:.1f}" y="{y0:.1f}" width="{x1 - x0 + 0.2:.1f}" '
            f'height="{y1 - y0 + 0.2:.1f}" {_filled(value, low, high)}>'
            f"<title>({number(x)}, {number(y)}): {says}</title></rect>"
        )
    parts.append(_plane_axes(across, up, labels, size))
    if known:
        parts.append(_scale(low, high, size))
    x, y = across(design[0]), up(design[1])
    parts.append(f'<path class="design" d="M{x:.1f} {y - 6:.1f}l6 6l-6 6l-6 -6z"/></svg>')
    return "".join(parts)


def _edges(values: Sequence[float]) -> list[float]:
    """The borders between values, and as far beyond the first and the last."""
    if len(values) == 1:
        return [values[0] - 0.5, values[0] + 0.5]
    middle = [(a + b) / 2 for a, b in pairwise(values)]
    return [2 * values[0] - middle[0], *middle, 2 * values[-1] - middle[-1]]


def _filled(value: float | None, low: float, high: float) -> str:
    if value is None:
        return 'class="infeasible"'
    return f'fill="{colour((value - low) / (high - low) if high > low else 1.0)}"'


def colour(part: float) -> str:
    """The colour of a part from 0 to 1, between those of the list."""
    place = min(max(part, 0.0), 1.0) * (len(COLOURS) - 1)
    i = min(int(place), len(COLOURS) - 2)
    low, high = COLOURS[i], COLOURS[i + 1]
    parts = (
        round(int(low[k : k + 2], 16) * (i + 1 - place) + int(high[k : k + 2], 16) * (place - i))
        for k in (1, 3, 5)
    )
    return "#" + "".join(f"{part:02x}" for part in parts)


def _plane_axes(across: Scale, up: Scale, labels: tuple[str, str], size: int) -> str:
    parts = ['<g class="axes">']
    parts += _below(across, size - BOTTOM + 14)
    values = ticks(up.low, up.high)
    parts += [
        _label(LEFT - 5, up(value) + 3.5, "end", label)
        for value, label in zip(values, tick_labels(values), strict=True)
    ]
    parts.append(_label(across.last, size - BOTTOM + 27, "end", f"→ {labels[0]},  ↑ {labels[1]}"))
    return "".join([*parts, "</g>"])


def _scale(low: float, high: float, size: int) -> str:
    """Which colour means which robustness."""
    x, steps = WIDTH - 52, 24
    height = (size - BOTTOM - TOP) / steps
    parts = [
        f'<rect x="{x}" y="{TOP + (steps - 1 - i) * height:.1f}" width="12" '
        f'height="{height + 0.3:.1f}" fill="{colour(i / (steps - 1))}"/>'
        for i in range(steps)
    ]
    parts.append(f'<g class="axes">{_label(x + 15, TOP + 8, "start", number(high, 3))}')
    parts.append(f"{_label(x + 15, size - BOTTOM, 'start', number(low, 3))}</g>")
    return "".join(parts)
