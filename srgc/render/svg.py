"""SVG: coordinates, paths and labels, and pictures as files with a title and a legend.

The marks of all pictures have classes, which one style sheet defines, ``assets/marks.css``.  The
report's page contains it and follows light and dark mode; a file contains it as well.
"""

from __future__ import annotations

import re
import textwrap
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cache
from importlib.resources import files
from math import cos, pi, sin

import numpy as np

from compiler.arrays import Array
from srgc.render.html_text import text

MARGIN = 14.0
"""The margin of a file, in units of the picture, about pixels."""
LETTER = 7.0
"""The mean width of a letter of titles and legends in a wide font (DejaVu Sans)."""
TITLE_LINE, LEGEND_LINE, SAMPLE = 17.0, 18.0, 24.0
MOST_TITLE_LINES = 3
_LEADING_ZERO = re.compile(r"(^|[ -])0\.")
_PALETTE = re.compile(r":root \{(.*?)\}", re.DOTALL)
_COLOUR = re.compile(r"(--[a-z0-9-]+): (#[0-9a-f]+);")


def place(value: float) -> str:
    """A coordinate in the picture, to one decimal."""
    shown = f"{value:.1f}"
    return shown.removesuffix(".0") if shown != "-0.0" else "0"


def line_path(points: Array) -> str:
    """A line through points (m, 2), as path data."""
    return "M" + "L".join(f"{place(x)} {place(y)}" for x, y in points)


def closed_path(corners: Array) -> str:
    """A polygon (m, 2) as path data with relative coordinates, short even for large m.

    A single corner gives a dot, which a stroke with round ends draws as a disc.
    """
    tenths = np.rint(10 * corners).astype(int)
    steps = "".join(
        f" {place(dx / 10)} {place(dy / 10)}" for dx, dy in np.diff(tenths, axis=0).tolist()
    )
    short = _LEADING_ZERO.sub(r"\1.", steps.lstrip()).replace(" -", "-")
    x, y = tenths[0].tolist()
    return f"M{place(x / 10)} {place(y / 10)}{'l' if short else ''}{short}Z"


def label(x: float, y: float, anchor: str, content: str, more: str = "") -> str:
    """A text element; ``anchor`` is start, middle or end."""
    return f'<text x="{x:.1f}" y="{y:.1f}" text-anchor="{anchor}"{more}>{text(content)}</text>'


def moved(x: float, y: float, content: str) -> str:
    """Marks with their origin at another place."""
    return f'<g transform="translate({place(x)} {place(y)})">{content}</g>'


def clipped(width: float, height: float, content: str) -> str:
    """The part of marks within (0, 0) and the given size; a nested picture needs no clip names."""
    return f'<svg width="{place(width)}" height="{place(height)}">{content}</svg>'


def symbol(kind: str, shape: str, x: float, y: float) -> str:
    """A mark at a point, with one of ``SHAPES``."""
    return (
        f'<path class="{kind}" transform="translate({place(x)} {place(y)})" d="{SHAPES[shape]}"/>'
    )


SHAPES = {
    "dot": "M-3.2 0a3.2 3.2 0 1 0 6.4 0a3.2 3.2 0 1 0-6.4 0Z",
    "disc": "M-5 0a5 5 0 1 0 10 0a5 5 0 1 0-10 0Z",
    "cross": "M-3-3l6 6m0-6l-6 6",
    "star": "M0-9L2.1-2.9L8.6-2.8L3.4 1.1L5.3 7.3L0 3.6L-5.3 7.3L-3.4 1.1L-8.6-2.8L-2.1-2.9Z",
    "diamond": "M0-6l6 6l-6 6l-6-6Z",
    "square": "M-4.5-4.5h9v9h-9Z",
    "triangle": "M0-6L5.5 4.5H-5.5Z",
    "wedge": "M0 6L5.5-4.5H-5.5Z",
    "plus": "M-2-6h4v4h4v4h-4v4h-4v-4h-4v-4h4Z",
}


# --- Pictures as files ---------------------------------------------------------------------------


def document(
    content: str,
    size: tuple[float, float],
    kind: str,
    title: str,
    legend: Sequence[tuple[str, str]] = (),
) -> str:
    """A picture as a file, with a white background; equal arguments give equal bytes.

    Args:
        content: marks, from (0, 0) to the size.
        size: width and height of the content.
        kind: the class that its styles use, ``scene`` or ``chart``.
        title: one or several lines above the content; lines that are too long are wrapped.
        legend: samples of marks, 24 x 12 units each, and their meanings; below the title.
    """
    width, height = size
    lines = _title_lines(title, width)
    rows, across = _legend(legend, width)
    top = MARGIN + TITLE_LINE * len(lines) + LEGEND_LINE * rows
    heading = "".join(
        label(MARGIN, MARGIN + TITLE_LINE * number - 5, "start", line, ' class="title"')
        for number, line in enumerate(lines, 1)
    )
    heading += moved(MARGIN, MARGIN + TITLE_LINE * len(lines), across) if rows else ""
    whole = width + 2 * MARGIN, top + height + MARGIN
    shape = f"{whole[0]:.0f} {whole[1]:.0f}"
    return (
        '<?xml version="1.0" encoding="utf-8"?>\n'
        f'<svg xmlns="http://www.w3.org/2000/svg" class="picture {kind}" width="{whole[0]:.0f}" '
        f'height="{whole[1]:.0f}" viewBox="0 0 {shape}" role="img">'
        f"<title>{text(title)}</title>\n<style>{_own_style()}</style>\n"
        f'<rect class="paper" width="100%" height="100%"/>{heading}'
        f"{moved(MARGIN, top, content)}</svg>\n"
    )


def _title_lines(title: str, width: float) -> list[str]:
    found = [
        line
        for part in title.split("\n")
        for line in textwrap.wrap(
            part, int(width / LETTER), max_lines=MOST_TITLE_LINES, placeholder=" …"
        )
    ]
    return found[: 2 * MOST_TITLE_LINES]


def _legend(entries: Iterable[tuple[str, str]], width: float) -> tuple[int, str]:
    """The number of rows, and the rows, each with as many entries as fit."""
    found, x, row = [], 0.0, 0
    for sample, says in entries:
        needed = SAMPLE + 6 + LETTER * len(says) + 16
        if x and x + needed - 16 > width:
            x, row = 0.0, row + 1
        y = LEGEND_LINE * row
        found.append(moved(x, y, f"{sample}{label(SAMPLE + 6, 10, 'start', says)}"))
        x += needed
    return (row + 1 if found else 0), f'<g class="legend">{"".join(found)}</g>'


def marks_style() -> str:
    """The style sheet of all marks, with the colours of light pages as variables."""
    return (files("srgc.render") / "assets" / "marks.css").read_text("utf-8")


@cache
def _own_style() -> str:
    """The style sheet with the colours inserted, as some programs that show SVG lack variables."""
    style = marks_style()
    palette = _PALETTE.search(style)
    if palette is None:
        raise ValueError("the style sheet has no colours")
    colours = dict(_COLOUR.findall(palette[1]))
    rules = _PALETTE.sub("", style, count=1)
    return re.sub(r"var\((--[a-z0-9-]+)\)", lambda name: colours[name[1]], rules).strip()


# --------------------------------------------------------------------------------------------------
# A parallel projection of the plane or of space onto a picture, as in the page's script.
#
# In space, an azimuth and an elevation give the line of sight: at (0, 0), x points right and z up;
# at (0, 90 degrees), x points right and y up.


WIDTH, TALLEST, FLATTEST = 720.0, 620.0, 260.0
"""The size of a picture in its own units, about pixels."""
HEIGHT_IN_SPACE = 560.0
PADDING = 26.0
NAMED: tuple[tuple[str, float, float], ...] = (
    ("Oblique", pi / 6, 0.45),
    ("Front (x, z)", 0.0, 0.0),
    ("Side (y, z)", pi / 2, 0.0),
    ("Top (x, y)", 0.0, pi / 2),
)
"""The views of space to choose from, with azimuth and elevation; the first is the initial one."""


@dataclass(frozen=True, slots=True)
class View:
    """A projection: picture = middle + scale * axes (p - centre), y downwards.

    Shapes: ``axes`` (2, d), ``centre`` (d,).
    """

    axes: Array
    centre: Array
    scale: float
    width: float
    height: float

    def project(self, points: Array) -> Array:
        """The positions (..., 2) in the picture of points (..., d)."""
        flat = (points - self.centre) @ self.axes.T * self.scale
        flat[..., 1] *= -1
        shifted: Array = flat + np.array([self.width / 2, self.height / 2])
        return shifted

    def scaled(self, width: float) -> View:
        """The same view in a picture of another width."""
        factor = width / self.width
        return View(self.axes, self.centre, self.scale * factor, width, self.height * factor)


def sight(azimuth: float, elevation: float) -> Array:
    """The directions that point right and up in a view of space, shape (2, 3)."""
    a, e = (cos(azimuth), sin(azimuth)), (cos(elevation), sin(elevation))
    return np.array([[a[0], a[1], 0.0], [-a[1] * e[1], a[0] * e[1], e[0]]])


def fitted(corners: Sequence[Array], *, turning: bool = True) -> View:
    """The view in which all points (..., d) fit; with ``turning``, from all directions in space."""
    points = np.concatenate([each.reshape(-1, each.shape[-1]) for each in corners])
    low, high = points.min(axis=0), points.max(axis=0)
    if len(low) == 2:
        return _flat(points, np.eye(2))
    axes = sight(*NAMED[0][1:])
    if not turning:
        return _flat(points, axes)
    centre = (low + high) / 2
    reach = max(float(np.linalg.norm(points - centre, axis=1).max()), 1e-9)
    scale = (HEIGHT_IN_SPACE / 2 - PADDING / 2) / reach
    return View(axes, centre, scale, WIDTH, HEIGHT_IN_SPACE)


def from_above(points: Array) -> View:
    """The view along z in which points (m, d) of the plane or of space fit."""
    return _flat(points, np.eye(2, points.shape[-1]))


def _flat(points: Array, axes: Array) -> View:
    """The view along the normal of two axes in which points (m, d) fit."""
    seen = points @ axes.T
    low, high = seen.min(axis=0), seen.max(axis=0)
    across, up = (max(float(side), 1e-9) for side in high - low)
    scale = min((WIDTH - 2 * PADDING) / across, (TALLEST - 2 * PADDING) / up)
    height = max(scale * up + 2 * PADDING, FLATTEST)
    return View(axes, (low + high) / 2 @ axes, scale, WIDTH, height)
