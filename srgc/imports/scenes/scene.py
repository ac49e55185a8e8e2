"""A scene of shapes in space, whatever file it was read from."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from fractions import Fraction
from typing import TypeAlias

import numpy as np

from srgc.imports.meshes.exact_places import Point, exact_decimal, rational
from srgc.imports.meshes.mesh import Floats, Mesh
from srgc.imports.source_fault import SourceFault

Fault: TypeAlias = Callable[[str], SourceFault]
"""What makes a fault at some place of a file of what is said."""
ALIGNED = 1e-6
"""A turn that differs by less from one by right angles is that one: it was written as decimals."""

ORIGIN: Point = (Fraction(0), Fraction(0), Fraction(0))


@dataclass(frozen=True, slots=True)
class BoxShape:
    """A box about its middle; the edges are in metres."""

    size: tuple[float, float, float]


@dataclass(frozen=True, slots=True)
class BallShape:
    """A ball; its radius is in metres."""

    radius: float


@dataclass(frozen=True, slots=True)
class RodShape:
    """A ``cylinder`` or ``capsule`` about its middle along z; its length is without the caps."""

    kind: str
    radius: float
    length: float


@dataclass(frozen=True, slots=True)
class PointsShape:
    """The hull of points (n, 3) in metres."""

    points: Floats


@dataclass(frozen=True, slots=True)
class MeshShape:
    """A mesh, and where it was read."""

    mesh: Mesh
    source: str


Shape: TypeAlias = BoxShape | BallShape | RodShape | PointsShape | MeshShape


@dataclass(frozen=True, slots=True)
class Pose:
    """A turn (3, 3), then a shift (3,) in metres.

    ``exact`` is the shift in rationals, where that is known: not after other turns than by right
    angles.
    """

    turn: Floats = field(default_factory=lambda: np.eye(3))
    shift: Floats = field(default_factory=lambda: np.zeros(3))
    exact: Point | None = None

    def rationals(self) -> Point | None:
        """The shift in rationals, where that is known."""
        return self.exact if self.exact is not None or self.shift.any() else ORIGIN

    def then(self, inner: Pose) -> Pose:
        """The pose in the world of what has the pose ``inner`` in this one."""
        exact = _sum(self.rationals(), self._turned(inner.rationals()))
        shift = self.turn @ inner.shift + self.shift
        return Pose(_aligned(self.turn @ inner.turn), shift, exact)

    def inverse(self) -> Pose:
        """The pose of the world in this one."""
        turned = Pose(_aligned(self.turn.T))
        exact = turned._turned(self.rationals())
        back = None if exact is None else (-exact[0], -exact[1], -exact[2])
        return Pose(turned.turn, -self.turn.T @ self.shift, back)

    def _turned(self, shift: Point | None) -> Point | None:
        """A shift of what is turned by this pose."""
        if shift is None or not any(shift):
            return shift
        if not self.along_axes():
            return None
        x, y, z = (
            sum((int(by) * part for by, part in zip(row, shift, strict=True)), start=Fraction(0))
            for row in self.turn.tolist()
        )
        return x, y, z

    def of_mesh(self, mesh: Mesh) -> Mesh:
        """A mesh of this pose in the world; its places are exact after turns by right angles."""
        exact = self.rationals()
        if exact is None or not self.along_axes():
            return replace(mesh, vertices=self.of(mesh.vertices), places=None)
        return mesh.moved(mesh.exact().placed(self.turn, exact))

    def of(self, points: Floats) -> Floats:
        """Points (n, 3) of this pose in the world."""
        found: Floats = points @ self.turn.T + self.shift
        return found

    def along_axes(self) -> bool:
        """Whether the turn is by right angles."""
        return bool(((self.turn == 0) | (np.abs(self.turn) == 1)).all())


@dataclass(frozen=True, slots=True)
class SceneObject:
    """A shape at a place; ``note`` says what of it was changed."""

    name: str
    shape: Shape
    pose: Pose
    note: str = ""


@dataclass(slots=True)
class Scene:
    """Objects, and what of the file could not be carried over.

    ``ground`` is the height of a horizontal plane below everything (m), and ``notes`` are what may
    be meant otherwise.
    """

    name: str
    objects: list[SceneObject] = field(default_factory=list)
    dropped: list[str] = field(default_factory=list)
    ground: float | None = None
    notes: list[str] = field(default_factory=list)

    def plane(self, name: str, normal: Floats, through: Floats) -> None:
        """Take note of a plane without bounds, which is no obstacle; facing up it is a floor."""
        if normal[2] > 0 and np.abs(normal[:2]).max() <= ALIGNED * normal[2]:
            height = float(through[2])
            self.ground = height if self.ground is None else max(height, self.ground)
            said = "a floor without bounds; the bounds begin at it where nothing is below"
        else:
            said = "a plane without bounds"
        self.dropped.append(f"{name}: {said}")


def _sum(one: Point | None, other: Point | None) -> Point | None:
    if one is None or other is None:
        return None
    return one[0] + other[0], one[1] + other[1], one[2] + other[2]


def _aligned(turn: Floats) -> Floats:
    near = np.rint(turn)
    close = np.abs(turn - near).max() <= ALIGNED and abs(abs(np.linalg.det(near)) - 1) < 0.5
    return near + 0.0 if close else turn


def quaternion_pose(
    shift: Sequence[float], turn: Sequence[float], fault: Fault, words: Sequence[str] | None = None
) -> Pose:
    """The pose of a place and a quaternion (x, y, z, w), which need not be a unit one.

    ``words`` are the numbers of the place as the file has them.

    Raises:
        SourceFault: a number is not finite, or the quaternion is zero.
    """
    size = math.hypot(*turn)
    if not all(map(math.isfinite, (*shift, size))) or size < 1e-9:
        raise fault("its pose has a number that is not finite, or a zero quaternion")
    x, y, z, w = (part / size for part in turn)
    rows = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
        [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
        [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
    ]
    return Pose(
        _aligned(np.array(rows)), np.array(shift, dtype=np.float64), _exact(shift, words, fault)
    )


def _exact(shift: Sequence[float], words: Sequence[str] | None, fault: Fault) -> Point:
    """A place as the rationals that its words are, or those of doubles.

    Raises:
        SourceFault: a number is too long.
    """
    try:
        x, y, z = map(rational, shift) if words is None else map(exact_decimal, words)
    except ValueError as error:
        raise fault(f"its pose has {error}") from None
    return x, y, z


def angle_pose(
    shift: Sequence[float],
    angles: Sequence[float],
    fault: Fault,
    words: Sequence[str] | None = None,
) -> Pose:
    """The pose of a place and of turns about the fixed axes x, y, z in this order, in radians.

    ``words`` are the numbers of the place as the file has them.

    Raises:
        SourceFault: a number is not finite.
    """
    if not all(map(math.isfinite, (*shift, *angles))):
        raise fault("its pose has a number that is not finite")
    (ca, sa), (cb, sb), (cc, sc) = ((math.cos(angle), math.sin(angle)) for angle in angles)
    rows = [
        [cc * cb, cc * sb * sa - sc * ca, cc * sb * ca + sc * sa],
        [sc * cb, sc * sb * sa + cc * ca, sc * sb * ca - cc * sa],
        [-sb, cb * sa, cb * ca],
    ]
    return Pose(
        _aligned(np.array(rows)), np.array(shift, dtype=np.float64), _exact(shift, words, fault)
    )


def positive(values: Sequence[float], fault: Fault) -> None:
    """Refuse sizes that are none.

    Raises:
        SourceFault: one is not finite or not positive.
    """
    if not all(math.isfinite(value) and value > 0 for value in values):
        shown = ", ".join(f"{value:g}" for value in values)
        raise fault(f"a size is not positive: {shown}")


def cone_points(radius: float, length: float) -> Floats:
    """Points whose hull holds a cone about its middle, the tip up: its base is a 16-gon."""
    angles = 2 * np.pi * np.arange(16) / 16
    wide = radius / math.cos(np.pi / 16)
    base = [wide * np.cos(angles), wide * np.sin(angles), np.full(16, -length / 2)]
    return np.concatenate([np.column_stack(base), [[0.0, 0.0, length / 2]]])


def ellipsoid_points(radii: Sequence[float]) -> Floats:
    """Points whose hull holds an ellipsoid."""
    from trimesh.creation import icosphere

    ball = icosphere(subdivisions=2)
    sides = np.asarray(ball.triangles, dtype=np.float64)
    inner = np.linalg.norm(sides.mean(axis=1), axis=1).min()
    found: Floats = np.asarray(ball.vertices) / inner * 1.001 * np.array(radii)
    return found
