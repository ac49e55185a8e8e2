"""Rigid motions in ball arithmetic, and conversions to quaternions and angles."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import isfinite

from flint import arb, arb_mat

UNCERTAIN = 1e-30
"""Balls around the numbers of a pose are far narrower, unless a number has no definite value."""


def column(values: Sequence[arb | int]) -> arb_mat:
    """Three numbers as a matrix of shape (3, 1)."""
    return arb_mat([[value] for value in values])


def unit(axis: int, sign: int = 1) -> arb_mat:
    """``sign`` times axis 0, 1 or 2, shape (3, 1)."""
    return column([sign if i == axis else 0 for i in range(3)])


def identity() -> arb_mat:
    """The identity, shape (3, 3)."""
    return arb_mat([[int(i == j) for j in range(3)] for i in range(3)])


def nearest(value: arb) -> float:
    """The double that represents a ball: zero if the ball contains zero, else its middle.

    Raises:
        ValueError: the ball is too wide to represent a number, or the number for a double.
    """
    if not value.is_finite() or not value.rad() < UNCERTAIN * (1 + abs(value.mid())):
        raise ValueError(f"no definite value: {value}")
    found = 0.0 if value.contains(0) else float(value.mid())
    if not isfinite(found):
        raise ValueError(f"too large for a double: {value.str(3, radius=False)}")
    return found


def doubles(vector: arb_mat) -> tuple[float, float, float]:
    """The entries of a matrix of shape (3, 1) as doubles."""
    x, y, z = (nearest(vector[i, 0]) for i in range(3))
    return x, y, z


def _zero(value: arb) -> bool:
    return bool(value.contains(0))


@dataclass(frozen=True, slots=True)
class Pose:
    """A frame in another: the columns of ``rotation`` (3, 3) are its axes, ``origin`` is (3, 1)."""

    rotation: arb_mat
    origin: arb_mat

    def __mul__(self, other: Pose) -> Pose:
        """Express ``other``, given in this frame, in the frame that this pose is given in."""
        return Pose(self.rotation * other.rotation, self.point(other.origin))

    def point(self, local: arb_mat) -> arb_mat:
        """A point of this frame, expressed in the frame that this pose is given in."""
        return self.origin + self.rotation * local

    def inverse(self) -> Pose:
        """The pose of the reference frame in this one; its rotation is the transpose, (3, 3)."""
        back = self.rotation.transpose()
        return Pose(back, -(back * self.origin))

    def moved(self, vector: arb_mat) -> Pose:
        """This pose after a translation (3, 1) along its own axes."""
        return Pose(self.rotation, self.point(vector))

    def turned(self, axis: int, angle: arb) -> Pose:
        """This pose after a rotation (3, 3) about its own axis 0, 1 or 2."""
        i, j = (axis + 1) % 3, (axis + 2) % 3
        turn = identity()
        cosine, sine = angle.cos(), angle.sin()
        turn[i, i], turn[j, j], turn[i, j], turn[j, i] = cosine, cosine, -sine, sine
        return Pose(self.rotation * turn, self.origin)

    def quaternion(self) -> tuple[float, float, float, float]:
        """The unit quaternion (w, x, y, z) of the rotation, with w >= 0.

        Source: Shepperd 1978, which computes the component of largest magnitude first.
        """
        r = self.rotation
        diagonal = [r[i, i] for i in range(3)]
        trace = diagonal[0] + diagonal[1] + diagonal[2]
        sizes = [float(item.mid()) for item in (trace, *diagonal)]
        largest = sizes.index(max(sizes))
        if largest == 0:
            w = (1 + trace).sqrt() / 2
            parts = [w, *(_skew(r, i) / (4 * w) for i in range(3))]
        else:
            i = largest - 1
            j, k = (i + 1) % 3, (i + 2) % 3
            own = (1 + r[i, i] - r[j, j] - r[k, k]).sqrt() / 2
            parts = [_skew(r, i) / (4 * own), arb(0), arb(0), arb(0)]
            parts[1 + i] = own
            parts[1 + j] = (r[i, j] + r[j, i]) / (4 * own)
            parts[1 + k] = (r[i, k] + r[k, i]) / (4 * own)
        a, b, c, d = (nearest(part) for part in parts)
        return (a, b, c, d) if a >= 0 else (-a, -b, -c, -d)

    def roll_pitch_yaw(self) -> tuple[float, float, float]:
        """Angles (rad) about fixed x, y, z in this order, as in URDF; roll is 0 if undetermined."""
        r = self.rotation
        if _zero(r[0, 0]) and _zero(r[1, 0]):
            return 0.0, nearest(_angle(-r[2, 0], arb(0))), nearest(_angle(-r[0, 1], r[1, 1]))
        pitch = _angle(-r[2, 0], (r[0, 0] ** 2 + r[1, 0] ** 2).sqrt())
        roll, yaw = _angle(r[2, 1], r[2, 2]), _angle(r[1, 0], r[0, 0])
        return nearest(roll), nearest(pitch), nearest(yaw)


def _skew(r: arb_mat, axis: int) -> arb:
    """Twice the sine of the angle, times one component of the axis."""
    i, j = (axis + 1) % 3, (axis + 2) % 3
    return r[j, i] - r[i, j]


def _angle(y: arb, x: arb) -> arb:
    """The angle of a vector; components whose balls contain zero are taken as zero."""
    return arb.atan2(arb(0) if _zero(y) else y, arb(0) if _zero(x) else x)


WORLD_POSE = Pose(identity(), column([0, 0, 0]))
