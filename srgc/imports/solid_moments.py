"""Mass, centre and inertia of bodies of uniform density, from their shapes."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from srgc.imports.module_set import Move, Steps, Vector, matrix_of

if TYPE_CHECKING:
    from yourdfpy.urdf import Geometry


@dataclass(frozen=True, slots=True)
class Moments:
    """Mass (kg), centre (m) and inertia about the centre (3, 3) in kg m^2, or for unit density."""

    mass: float
    centre: NDArray[np.float64]
    inertia: NDArray[np.float64]

    @property
    def com(self) -> Vector:
        """The centre as a tuple."""
        x, y, z = (float(value) for value in self.centre)
        return (x, y, z)

    @property
    def six(self) -> tuple[float, float, float, float, float, float]:
        """The inertia as (xx, yy, zz, xy, xz, yz)."""
        a = self.inertia
        found = (a[0, 0], a[1, 1], a[2, 2], a[0, 1], a[0, 2], a[1, 2])
        xx, yy, zz, xy, xz, yz = (float(value) for value in found)
        return (xx, yy, zz, xy, xz, yz)

    def placed(self, steps: Steps) -> Moments:
        """The moments in the frame where the steps to the body's frame begin."""
        matrix = matrix_of(steps)
        turn = matrix[:3, :3]
        return Moments(self.mass, matrix[:3, 3] + turn @ self.centre, turn @ self.inertia @ turn.T)

    def times(self, factor: float) -> Moments:
        """The moments for a density multiplied by ``factor``."""
        return Moments(self.mass * factor, self.centre, self.inertia * factor)

    def __add__(self, other: Moments) -> Moments:
        mass = self.mass + other.mass
        centre = (self.mass * self.centre + other.mass * other.centre) / mass
        inertia = np.zeros((3, 3))
        for part in (self, other):  # parallel axis theorem
            arm = part.centre - centre
            inertia += part.inertia + part.mass * (arm @ arm * np.eye(3) - np.outer(arm, arm))
        return Moments(mass, centre, inertia)


def moments_of_shape(geometry: Geometry, *, round_ends: bool = False) -> Moments | None:
    """The moments of a box, sphere or cylinder about its middle, for a density of 1 kg/m^3.

    With ``round_ends`` the cylinder is part of a capsule, and half a ball is added at each end.
    """
    if geometry.box is not None:
        a, b, c = (float(value) for value in geometry.box.size)
        three = ((b * b + c * c) / 12, (a * a + c * c) / 12, (a * a + b * b) / 12)
        return _diagonal(a * b * c, *three)
    if geometry.sphere is not None:
        radius = float(geometry.sphere.radius)
        own = 0.4 * radius**2
        return _diagonal(4 / 3 * math.pi * radius**3, own, own, own)
    if geometry.cylinder is not None:
        radius, length = float(geometry.cylinder.radius), float(geometry.cylinder.length)
        across = (3 * radius**2 + length**2) / 12
        whole = _diagonal(math.pi * radius**2 * length, across, across, radius**2 / 2)
        return _with_half_balls(whole, radius, length) if round_ends else whole
    return None


def _with_half_balls(cylinder: Moments, radius: float, length: float) -> Moments:
    """The moments of a cylinder along z with half a ball at each end."""
    across = 83 / 320 * radius**2  # about the centre, which is 3/8 of the radius from the flat side
    ball = _diagonal(2 / 3 * math.pi * radius**3, across, across, 0.4 * radius**2)
    height = length / 2 + 3 / 8 * radius
    for side in (-1, 1):
        cylinder += ball.placed((Move((0.0, 0.0, side * height)),))
    return cylinder


def _diagonal(mass: float, xx: float, yy: float, zz: float) -> Moments:
    """The moments of a body at the origin of its frame; ``xx``, ``yy`` and ``zz`` are per mass."""
    return Moments(mass, np.zeros(3), mass * np.diag([xx, yy, zz]))
