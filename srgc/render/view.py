"""A parallel projection of the plane or of space onto a picture, the same as in the page's script.

In space the direction of sight is given by an azimuth and an elevation: at (0, 0) x goes to the
right and z up; at (0, 90 degrees) x goes to the right and y up.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import cos, pi, sin

import numpy as np

from compiler.arrays import Array

WIDTH, TALLEST, FLATTEST = 720.0, 620.0, 260.0
"""Size of a picture in its own units, which are about pixels."""
HEIGHT_IN_SPACE = 560.0
PADDING = 26.0
NAMED: tuple[tuple[str, float, float], ...] = (
    ("Oblique", pi / 6, 0.45),
    ("Front (x, z)", 0.0, 0.0),
    ("Side (y, z)", pi / 2, 0.0),
    ("Top (x, y)", 0.0, pi / 2),
)
"""The views of space that can be chosen, by azimuth and elevation; the first is where it begins."""


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
        """Where points (..., d) are in the picture, shape (..., 2)."""
        flat = (points - self.centre) @ self.axes.T * self.scale
        flat[..., 1] *= -1
        shifted: Array = flat + np.array([self.width / 2, self.height / 2])
        return shifted

    def scaled(self, width: float) -> View:
        """The same view as a picture of another width."""
        factor = width / self.width
        return View(self.axes, self.centre, self.scale * factor, width, self.height * factor)


def sight(azimuth: float, elevation: float) -> Array:
    """What goes right and what goes up in a view of space, shape (2, 3)."""
    a, e = (cos(azimuth), sin(azimuth)), (cos(elevation), sin(elevation))
    return np.array([[a[0], a[1], 0.0], [-a[1] * e[1], a[0] * e[1], e[0]]])


def fitted(corners: Sequence[Array], *, turning: bool = True) -> View:
    """The view in which all points fit; of space, if it is ``turning``, from whatever side."""
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
    """The view along the normal of two axes that holds points (m, d)."""
    seen = points @ axes.T
    low, high = seen.min(axis=0), seen.max(axis=0)
    across, up = (max(float(side), 1e-9) for side in high - low)
    scale = min((WIDTH - 2 * PADDING) / across, (TALLEST - 2 * PADDING) / up)
    height = max(scale * up + 2 * PADDING, FLATTEST)
    return View(axes, (low + high) / 2 @ axes, scale, WIDTH, height)
