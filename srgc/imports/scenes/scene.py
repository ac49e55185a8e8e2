"""Scenes of shapes in space, independent of the file format."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from fractions import Fraction
from typing import TypeAlias

import numpy as np

from srgc.imports.meshes.exact_places import Point, exact_decimal, rational
from srgc.imports.meshes.mesh import Floats, Mesh
from srgc.imports.meshes.mesh_limits import LARGEST
from srgc.imports.source_fault import SourceFault

Fault: TypeAlias = Callable[[str], SourceFault]
"""A function that makes a fault with a message, at a certain place in a file."""
ALIGNED = 1e-6
"""Rotations this close to one by right angles are rounded to it, since files have decimals."""

ORIGIN: Point = (Fraction(0), Fraction(0), Fraction(0))


@dataclass(frozen=True, slots=True)
class BoxShape:
    """A box about its centre, with edges in metres."""

    size: tuple[float, float, float]


@dataclass(frozen=True, slots=True)
class BallShape:
    """A ball about its centre, with a radius in metres."""

    radius: float


@dataclass(frozen=True, slots=True)
class RodShape:
    """A ``cylinder`` or ``capsule`` along z about its centre; the length excludes the caps."""

    kind: str
    radius: float
    length: float


@dataclass(frozen=True, slots=True)
class PointsShape:
    """The convex hull of points (n, 3) in metres."""

    points: Floats


@dataclass(frozen=True, slots=True)
class MeshShape:
    """A mesh, and the name of its file."""

    mesh: Mesh
    source: str


Shape: TypeAlias = BoxShape | BallShape | RodShape | PointsShape | MeshShape


@dataclass(frozen=True, slots=True)
class Pose:
    """A rotation (3, 3), followed by a translation (3,) in metres.

    ``exact`` is the translation in rationals if it is known; after rotations other than by right
    angles it is not.
    """

    turn: Floats = field(default_factory=lambda: np.eye(3))
    shift: Floats = field(default_factory=lambda: np.zeros(3))
    exact: Point | None = None

    def rationals(self) -> Point | None:
        """The translation in rationals, or None if it is not known."""
        return self.exact if self.exact is not None or self.shift.any() else ORIGIN

    def then(self, inner: Pose) -> Pose:
        """The composition with ``inner``: the world pose of an object placed in this pose."""
        exact = _sum(self.rationals(), self._turned(inner.rationals()))
        shift = self.turn @ inner.shift + self.shift
        return Pose(_aligned(self.turn @ inner.turn), shift, exact)

    def inverse(self) -> Pose:
        """The inverse pose."""
        turned = Pose(_aligned(self.turn.T))
        exact = turned._turned(self.rationals())
        back = None if exact is None else (-exact[0], -exact[1], -exact[2])
        return Pose(turned.turn, -self.turn.T @ self.shift, back)

    def _turned(self, shift: Point | None) -> Point | None:
        """A translation rotated by this pose."""
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
        """A mesh moved by this pose; its coordinates stay exact after rotations by right angles."""
        exact = self.rationals()
        if exact is None or not self.along_axes():
            return replace(mesh, vertices=self.of(mesh.vertices), places=None)
        return mesh.moved(mesh.exact().placed(self.turn, exact))

    def of(self, points: Floats) -> Floats:
        """Points (n, 3) moved by this pose."""
        found: Floats = points @ self.turn.T + self.shift
        return found

    def along_axes(self) -> bool:
        """Whether the rotation is by right angles."""
        return bool(((self.turn == 0) | (np.abs(self.turn) == 1)).all())


@dataclass(frozen=True, slots=True)
class SceneObject:
    """A shape with a pose; ``note`` says what was changed."""

    name: str
    shape: Shape
    pose: Pose
    note: str = ""


@dataclass(slots=True)
class Scene:
    """The objects of a file; ``dropped`` says what could not be carried over.

    ``ground`` is the height of the highest horizontal plane that is a floor (m), and ``notes`` are
    remarks on what may be meant differently.
    """

    name: str
    objects: list[SceneObject] = field(default_factory=list)
    dropped: list[str] = field(default_factory=list)
    ground: float | None = None
    notes: list[str] = field(default_factory=list)

    def plane(self, name: str, normal: Floats, through: Floats) -> None:
        """Record an unbounded plane, which cannot be an obstacle; if it faces up it is a floor.

        It is perpendicular to ``normal`` (3,), ``through`` a point (3,).
        """
        height = math.inf
        if normal[2] > 0 and np.abs(normal[:2]).max() <= ALIGNED * normal[2]:
            height = float(through[2])
        if abs(height) < LARGEST:
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
    """The pose of a position and a quaternion (x, y, z, w), which need not be of unit length.

    ``words`` are the numbers of the position as written in the file.

    Raises:
        SourceFault: a number is not finite, too long or too large, or the quaternion is zero.
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
    """A position in rationals: of its words if given, otherwise of its doubles.

    Raises:
        SourceFault: a number is too long or too large.
    """
    if max(map(abs, shift)) >= LARGEST:
        raise fault(f"its place is {LARGEST:g} m away or farther")
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
    """The pose of a position and rotations about the fixed axes x, y, z in this order (rad).

    ``words`` are the numbers of the position as written in the file.

    Raises:
        SourceFault: a number is not finite, too long or too large.
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
    """Reject invalid sizes.

    Raises:
        SourceFault: a size is not finite, not positive, or too large.
    """
    if not all(math.isfinite(value) and value > 0 for value in values):
        shown = ", ".join(f"{value:g}" for value in values)
        raise fault(f"a size is not positive: {shown}")
    if max(values) >= LARGEST:
        raise fault(f"a size is {LARGEST:g} m or more: {max(values):g}")


def cone_points(radius: float, length: float) -> Floats:
    """Points (17, 3) whose hull contains a cone about its centre, tip up, base a 16-gon."""
    angles = 2 * np.pi * np.arange(16) / 16
    wide = radius / math.cos(np.pi / 16)
    base = [wide * np.cos(angles), wide * np.sin(angles), np.full(16, -length / 2)]
    return np.concatenate([np.column_stack(base), [[0.0, 0.0, length / 2]]])


def ellipsoid_points(radii: Sequence[float]) -> Floats:
    """Points (n, 3) whose hull contains an ellipsoid."""
    from trimesh.creation import icosphere

    ball = icosphere(subdivisions=2)
    sides = np.asarray(ball.triangles, dtype=np.float64)
    inner = np.linalg.norm(sides.mean(axis=1), axis=1).min()
    found: Floats = np.asarray(ball.vertices) / inner * 1.001 * np.array(radii)
    return found
