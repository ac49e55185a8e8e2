"""The numbers of effectors: discs beside them that keep off names, effectors and each other.

The scripts of a report's page place them in the same way (``report/assets/drawing_numbers.js``).
"""

from __future__ import annotations

from itertools import product
from math import cos, pi, sin

import numpy as np
from numpy.typing import NDArray

from compiler.arrays import Array
from srgc.render.svg import line_path, place

HALF, NARROW_HALF = 8.0, 14.0
"""The radius of a disc in units of the picture; the second is for pages that show it small."""
RING = 8.0
"""Half the width of the mark of an effector, to which the disc belongs."""
GAP = 2.0
"""The least distance between a disc and anything else."""
FARTHER = (0.0, 10.0, 22.0, 38.0, 58.0, 84.0, 120.0, 170.0, 240.0, 340.0)
"""How much farther than beside the effector a disc may stand."""
TURNS = (0, 1, -1, 2, -2, 3, -3, 4, -4, 5, -5, 6, -6, 7, -7, 8)
"""Directions in sixteenths of a turn from the upper right, in the order in which they are tried."""
NEAR = 10.0
"""A disc that stands at most this much farther away needs no line to its effector."""
_BASELINE = 3.8
"""How far below the middle of the disc its number has its foot."""


def number_places(
    at: Array, size: tuple[float, float], taken: Array | None = None, half: float = HALF
) -> Array:
    """The middles (e, 2) of the numbers of effectors at (e, 2), in a picture of a size.

    Each is the first free place around its effector; if there is none, the first one of all.

    Args:
        at: the effectors in the picture.
        size: the width and height of the picture.
        taken: rectangles (m, 4) that numbers keep off: left, top, right, bottom.
        half: the radius of a disc.
    """
    boxes: Array = np.zeros((0, 4)) if taken is None else taken
    found: Array = np.zeros((0, 2))
    for point in at:
        places = _around(point, half)
        free = _within(places, half, size) & _off_boxes(places, half, boxes)
        free &= _off_discs(places, half + RING, at) & _off_discs(places, 2 * half, found)
        chosen = places[free][:1] if free.any() else places[:1]
        found = np.concatenate([found, chosen])
    return found


def _around(point: Array, half: float) -> Array:
    """Places around an effector, (k, 2), in the order of preference."""
    angles = [pi * (turn / 8 - 1 / 4) for turn in TURNS]
    far = [RING + half + GAP + more for more in FARTHER]
    ways = [(radius * cos(angle), radius * sin(angle)) for radius, angle in product(far, angles)]
    places: Array = point + np.array(ways)
    return places


def _within(places: Array, half: float, size: tuple[float, float]) -> NDArray[np.bool_]:
    """Which discs at (k, 2) lie within the picture."""
    found: NDArray[np.bool_] = np.all((places >= half) & (places <= np.array(size) - half), axis=1)
    return found


def _off_boxes(places: Array, half: float, boxes: Array) -> NDArray[np.bool_]:
    """Which discs at (k, 2) keep off rectangles (m, 4), as squares."""
    low, high = places[:, None, :] - half - GAP, places[:, None, :] + half + GAP
    meets = np.all((low < boxes[None, :, 2:]) & (high > boxes[None, :, :2]), axis=2)
    found: NDArray[np.bool_] = ~np.any(meets, axis=1)
    return found


def _off_discs(places: Array, reach: float, middles: Array) -> NDArray[np.bool_]:
    """Which places (k, 2) are at least about ``reach`` and a gap from the middles (m, 2)."""
    away = np.linalg.norm(places[:, None, :] - middles[None, :, :], axis=2)
    found: NDArray[np.bool_] = np.all(away > reach + GAP / 2, axis=1)
    return found


def number_mark(number: int, way: Array) -> str:
    """The number of an effector on a disc at ``way`` (2,) from the effector."""
    distance = float(np.hypot(*way))
    line = ""
    if distance > RING + NARROW_HALF + GAP + NEAR:
        line = line_path(np.stack([way * (RING / distance), way]))
    return (
        f'<path class="leader" d="{line}"/>'
        f'<g class="number" transform="translate({place(way[0])} {place(way[1])})">'
        f'<circle r="{HALF:g}"/><text y="{_BASELINE:g}">{number}</text></g>'
    )
