"""Where the texts of a picture are, by the outlines of DejaVu Sans itself, read with FreeType.

It knows the few rules of the style sheet that place and size texts, and reads transforms and
anchors of its own; nothing of the code that draws is used.
"""

from __future__ import annotations

import re
import xml.etree.ElementTree as ET
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from itertools import combinations
from pathlib import Path

import matplotlib as mpl
import numpy as np
from fontTools.ttLib import TTFont

SVG = "{http://www.w3.org/2000/svg}"
ABOVE, BELOW = 0.76, 0.24
"""Of letters, above and below their base line, in sizes of the font: those of `Ag`."""


@dataclass(frozen=True)
class DrawnText:
    """A text with its size and its rectangle: left, top, right, bottom."""

    says: str
    size: float
    box: tuple[float, float, float, float]


@cache
def _font(bold: bool) -> TTFont:
    name = "DejaVuSans-Bold.ttf" if bold else "DejaVuSans.ttf"
    return TTFont(Path(mpl.get_data_path()) / "fonts" / "ttf" / name)


def true_width(says: str, size: float, *, bold: bool = False) -> float:
    """The sum of the advances of the letters."""
    font = _font(bold)
    cmap, metrics = font.getBestCmap(), font["hmtx"].metrics
    advances = sum(metrics[cmap.get(ord(letter), ".notdef")][0] for letter in says)
    return size * advances / font["head"].unitsPerEm


def drawn_texts(svg: str, size: float | None = None) -> list[DrawnText]:
    """All texts that are shown; ``size`` overrides what the style sheet says of names."""
    root = ET.fromstring(svg)
    return list(_walk(root, np.eye(3), [root.get("class", "").split()], size))


def view_box(svg: str) -> tuple[float, float]:
    """The width and the height of a picture."""
    _, _, width, height = map(float, ET.fromstring(svg).get("viewBox", "").split())
    return width, height


def overlaps(texts: list[DrawnText], slack: float = 0.3) -> list[tuple[str, str]]:
    """Pairs of texts whose rectangles meet."""
    found = []
    for one, other in combinations(texts, 2):
        (a, b, c, d), (e, f, g, h) = one.box, other.box
        if min(c, g) - max(a, e) > slack and min(d, h) - max(b, f) > slack:
            found.append((one.says, other.says))
    return found


def outside(texts: list[DrawnText], svg: str, slack: float = 0.3) -> list[str]:
    """Texts that reach out of the picture."""
    width, height = view_box(svg)
    return [
        text.says
        for text in texts
        if min(text.box[:2]) < -slack or text.box[2] > width + slack or text.box[3] > height + slack
    ]


def _walk(
    element: ET.Element, at: np.ndarray, classes: list[list[str]], size: float | None
) -> Iterator[DrawnText]:
    at = at @ _matrix(element.get("transform", ""))
    inside = [*classes, element.get("class", "").split()]
    if element.get("visibility") == "hidden":
        return
    if element.tag == f"{SVG}text":
        yield from _lines(element, at, {name for each in inside for name in each}, size)
        return
    for child in element:
        yield from _walk(child, at, inside, size)


def _matrix(transform: str) -> np.ndarray:
    found = np.eye(3)
    for name, numbers in re.findall(r"(\w+)\(([^)]*)\)", transform):
        values = [float(x) for x in re.split(r"[\s,]+", numbers.strip())]
        if name == "translate":
            found = found @ _moved(*values)
        elif name == "rotate":
            turn = np.radians(values[0])
            matrix = np.eye(3)
            matrix[:2, :2] = [[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]]
            middle = values[1:] or [0.0, 0.0]
            found = found @ _moved(*middle) @ matrix @ _moved(-middle[0], -middle[1])
        elif name == "scale":
            found = found @ np.diag([values[0], values[-1], 1.0])
        else:
            raise AssertionError(transform)
    return found


def _moved(x: float, y: float) -> np.ndarray:
    matrix = np.eye(3)
    matrix[:2, 2] = x, y
    return matrix


def _lines(
    element: ET.Element, at: np.ndarray, classes: set[str], size: float | None
) -> Iterator[DrawnText]:
    small = classes & {"axes", "legend"}
    usual = 13.0 if classes & {"scene", "modules"} else 10.5
    styled = re.search(r"font-size:([\d.]+)px", element.get("style", ""))
    own = 12.0 if "title" in classes else 11.0 if small and "picture" in classes else usual
    if styled:
        own = float(styled[1])
    elif size is not None and classes & {"names", "name"}:
        own = size
    bold = bool(classes & {"scene", "modules"}) and not (small or classes & {"title", "fitted"})
    anchor = element.get("text-anchor", "start")
    if classes & {"names", "fitted", "modules"}:
        anchor = "middle"
    x, y = float(element.get("x", 0)), float(element.get("y", 0))
    spans = element.findall(f"{SVG}tspan") or element.findall("tspan") or [element]
    for span in spans:
        x = float(span.get("x", x))
        y = float(span.get("y", y)) if span is not element else y
        if span is not element and span.get("dy", "").endswith("em"):
            y += own * float(span.get("dy", "")[:-2])
        says = span.text or ""
        width = true_width(says, own, bold=bold)
        left = x - {"start": 0.0, "middle": width / 2, "end": width}[anchor]
        up, down = (0.5, 0.5) if "fitted" in classes else (ABOVE, BELOW)
        corners = np.array(
            [(a, b, 1) for a in (left, left + width) for b in (y - up * own, y + down * own)]
        )
        seen = (corners @ at.T)[:, :2]
        low, high = seen.min(axis=0), seen.max(axis=0)
        yield DrawnText(says, own, (*low.tolist(), *high.tolist()))
