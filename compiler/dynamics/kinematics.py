"""Forward kinematics of a robot model, and absolute angles of its joints."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, replace
from fractions import Fraction

import casadi as ca

from compiler.dynamics.symbolic_evaluator import SymbolicEvaluator
from compiler.expressions.scalars import evaluate_scalars
from compiler.robots.hull_corners import hull_middle
from compiler.robots.robot import (
    WORLD,
    Collider,
    Joint,
    Offset,
    PointBody,
    RobotModel,
    Shape,
    SolidBody,
    Step,
    Turn,
)

# --- Absolute angles: revolute joints about one axis measured from a fixed direction --------------
#
# .. math:: q = D y
#
# with an integer matrix D. In y the mass matrix of a chain has one cosine per entry and no velocity
# couples with another, so interval arithmetic loses far less than in the joints' own coordinates.
# (The paper's Example 3 uses such angles, its case study the joints' own.)


@dataclass(frozen=True, slots=True)
class Coordinates:
    """The matrix D, by rows, of q = D y, and the joints whose y is an absolute angle."""

    rows: tuple[tuple[int, ...], ...]
    absolute: frozenset[int]

    def solved_for(self, q: Sequence[Fraction]) -> list[Fraction]:
        """The y with D y = q, exactly. A row has its own entry and at most one of another joint."""
        known: dict[int, Fraction] = {}
        while len(known) < len(self.rows):
            for i, row in enumerate(self.rows):
                others = [j for j, entry in enumerate(row) if j != i and entry]
                if i not in known and all(j in known for j in others):
                    rest = q[i] - sum((row[j] * known[j] for j in others), Fraction(0))
                    known[i] = rest / row[i]
        return [known[i] for i in range(len(self.rows))]


def own_coordinates(model: RobotModel) -> Coordinates:
    """The identity: y are the joints' own coordinates."""
    n = len(model.dofs)
    return Coordinates(tuple(tuple(int(i == j) for j in range(n)) for i in range(n)), frozenset())


def absolute_angles(model: RobotModel) -> Coordinates:
    """The absolute angles of a robot.

    A revolute joint that follows another about its axis, with only rigid rotations about it and
    translations in between, is measured from where that one is measured. Every other coordinate is
    its own, up to its sign. A coordinate that moves two frames is left unchanged.
    """
    rows = [list(row) for row in own_coordinates(model).rows]
    uses = Counter(node.step.dof for node in model.frames if isinstance(node.step, Joint))
    absolute: set[int] = set()
    before: list[tuple[int, int | None]] = []
    for node in model.frames:
        axis, leader = before[node.parent] if before else (2, None)
        match node.step:
            case Turn(turned, _) if turned != axis:
                axis, leader = turned, None
            case Joint(dof, turned, sign) if model.dofs[dof].kind == "revolute":
                leader = leader if turned == axis else None
                axis = turned
                if uses[dof] == 1:
                    absolute.add(dof)
                    rows[dof][dof] = sign
                    if leader is not None:
                        rows[dof][leader] = -sign
                    leader = dof
            case _:
                pass
        before.append((axis, leader))
    return Coordinates(tuple(tuple(row) for row in rows), frozenset(absolute))


def own_motion(coordinates: Coordinates, y: ca.SX) -> ca.SX:
    """D y: the joints' own coordinates or rates, shape (n,)."""
    return _stack([_weighed(row, y) for row in coordinates.rows])


def generalised_forces(coordinates: Coordinates, forces: ca.SX) -> ca.SX:
    """D' tau: the forces on the joints' own coordinates by virtual work, shape (n,)."""
    return _stack([_weighed(column, forces) for column in zip(*coordinates.rows, strict=True)])


def _weighed(weights: Sequence[int], values: ca.SX) -> ca.SX:
    """The sum of values with weights 1, 0 and -1."""
    total = ca.SX(0)
    for i, weight in enumerate(weights):
        if weight:
            total = total + (values[i] if weight > 0 else -values[i])
    return total


def _stack(entries: list[ca.SX]) -> ca.SX:
    return ca.vertcat(*entries) if entries else ca.SX(0, 1)


# --- Forward kinematics of a robot model as CasADi expressions ------------------------------------


@dataclass(frozen=True, slots=True)
class Orientation:
    """The rotation ``base * R(axis, angle + leading)``, so that angles about one axis add.

    ``leading`` is the absolute angle of the last joint that is measured from a fixed direction.
    """

    base: ca.SX
    axis: int
    angle: ca.SX
    leading: ca.SX

    def matrix(self) -> ca.SX:
        """The rotation matrix, shape (3, 3)."""
        return self.base @ rotation(self.axis, self.angle + self.leading)

    def turned(self, axis: int, angle: ca.SX) -> Orientation:
        """The orientation after a further rotation about a local axis."""
        if axis == self.axis:
            return Orientation(self.base, axis, self.angle + angle, self.leading)
        return Orientation(self.matrix(), axis, angle, ca.SX(0))

    def led(self, axis: int, leading: ca.SX) -> Orientation:
        """The orientation after a joint whose absolute angle about a local axis becomes leading."""
        if axis == self.axis:
            return Orientation(self.base, axis, self.angle, leading)
        return Orientation(self.matrix(), axis, ca.SX(0), leading)


UNTURNED = Orientation(ca.SX.eye(3), 2, ca.SX(0), ca.SX(0))
"""The orientation of the world."""


def rotation(axis: int, angle: ca.SX) -> ca.SX:
    """The rotation matrix about axis 0, 1 or 2."""
    matrix = ca.SX.eye(3)
    if angle.is_zero():
        return matrix
    i, j = (axis + 1) % 3, (axis + 2) % 3
    cosine, sine = ca.cos(angle), ca.sin(angle)
    matrix[i, i] = cosine
    matrix[j, j] = cosine
    matrix[i, j] = -sine
    matrix[j, i] = sine
    return matrix


@dataclass(frozen=True, slots=True)
class Kinematics:
    """Positions, orientations and joint axes of all frames as expressions in (q, theta).

    ``loads`` (c, 1) are the inputs that say which loads are present, 1 or 0; if empty, no load is.
    """

    model: RobotModel
    scalars: list[ca.SX]
    origins: list[ca.SX]
    orientations: list[Orientation]
    motion: _FrameMotion
    loads: ca.SX

    def mass(self, body: PointBody) -> ca.SX:
        """The mass of a point mass, zero while it is a load that is not present."""
        if body.load is None:
            return self.scalars[body.mass]
        return self.scalars[body.mass] * self.loads[body.load] if self.loads.numel() else ca.SX(0)

    def axis(self, frame: int, axis: int) -> ca.SX:
        """The direction of a local axis in the world, shape (3,)."""
        return self.orientations[frame].matrix()[:, axis]

    def point(self, frame: int, local: tuple[int, int, int]) -> ca.SX:
        """The world position of a point given by three scalars in a frame."""
        offset = ca.vertcat(*(self.scalars[i] for i in local))
        return self.origins[frame] + self.orientations[frame].matrix() @ offset

    def bases(self, collider: Collider) -> list[ca.SX]:
        """The base points of a body or shape.

        Both ends of a body or shape with a length, the middle of a box, sphere or hull, the place
        of a mass.
        """
        if isinstance(collider, Shape) and collider.corners:
            return [self._middle(collider)]
        if isinstance(collider, SolidBody):
            return [self.point(collider.frame, collider.com)]
        origin = self.origins[collider.frame]
        if isinstance(collider, PointBody) or collider.length is None:
            return [origin]
        direction = collider.sign * self.axis(collider.frame, collider.axis)
        return [origin, origin + direction * self.scalars[collider.length]]

    def _middle(self, hull: Shape) -> ca.SX:
        """The middle of a hull, in the world."""
        constants = self.motion.constants
        middle = (constants.constant(x) for x in hull_middle(hull, self.model.scalars))
        return self.origins[hull.frame] + self.orientations[hull.frame].matrix() @ ca.vertcat(
            *middle
        )

    def corners(self, collider: Collider) -> list[ca.SX]:
        """The corners of a hull, or the ``bases`` of anything else."""
        if isinstance(collider, Shape) and collider.corners:
            return [self.point(collider.frame, corner) for corner in collider.corners]
        return self.bases(collider)

    def columns(self, collider: Collider) -> list[ca.SX]:
        """The directions, in the world, of the axes along which a shape extends about its bases.

        Empty if it extends equally in all directions, or not at all.
        """
        if not isinstance(collider, Shape):
            return []
        return [self.axis(collider.frame, axis) for axis in collider.across(self.model.dimension)]

    def seen_from_below(self, one: int, two: int) -> Kinematics:
        """The kinematics without the motion that two frames share.

        The frames are seen from the last frame that both come after; with absolute angles, in world
        axes.
        """
        ways = [[WORLD, *self.model.chain(frame)] for frame in (one, two)]
        common = max(set(ways[0]) & set(ways[1]))
        origins, orientations = list(self.origins), list(self.orientations)
        origins[common] = ca.SX.zeros(3)
        if not self.motion.measured.absolute:
            orientations[common] = UNTURNED
        for frame in sorted({*ways[0], *ways[1]}):
            if frame > common:
                node = self.model.frames[frame]
                before = origins[node.parent], orientations[node.parent]
                origins[frame], orientations[frame] = self.motion.behind(node.step, *before)
        return replace(self, origins=origins, orientations=orientations)


@dataclass(frozen=True, slots=True)
class _FrameMotion:
    """How a frame moves relative to its parent; ``coordinates`` are y, defined by ``measured``."""

    model: RobotModel
    scalars: Sequence[ca.SX]
    coordinates: ca.SX
    constants: SymbolicEvaluator
    measured: Coordinates

    def behind(
        self, step: Step | None, origin: ca.SX, orientation: Orientation
    ) -> tuple[ca.SX, Orientation]:
        """The origin and the orientation after a step."""
        match step:
            case Turn(axis, angle):
                orientation = orientation.turned(axis, self.constants.unfolded(self.scalars[angle]))
            case Offset(vector):
                offset = ca.vertcat(*(self.scalars[i] for i in vector))
                origin = origin + orientation.matrix() @ offset
            case Joint(dof, axis, sign):
                motion = sign * self.coordinates[dof]
                if dof in self.measured.absolute:
                    orientation = orientation.led(axis, self.coordinates[dof])
                elif self.model.dofs[dof].kind == "revolute":
                    orientation = orientation.turned(axis, motion)
                else:
                    origin = origin + orientation.matrix()[:, axis] * motion
            case None:
                pass
        return origin, orientation


def kinematics(
    model: RobotModel,
    coordinates: ca.SX,
    parameters: ca.SX,
    constants: SymbolicEvaluator,
    measured: Coordinates,
    loads: ca.SX | None = None,
) -> Kinematics:
    """Forward kinematics, one pass over the frames in topological order.

    ``coordinates`` are y with q = D y, as defined by ``measured``. ``loads`` (c, 1) say which loads
    are present; without them none is.
    """
    scalars = evaluate_scalars(model.scalars, constants, ca.vertsplit(parameters))
    motion = _FrameMotion(model, scalars, coordinates, constants, measured)
    origins, orientations = [ca.SX.zeros(3)], [UNTURNED]
    for node in model.frames[WORLD + 1 :]:
        before = origins[node.parent], orientations[node.parent]
        origin, orientation = motion.behind(node.step, *before)
        origins.append(origin)
        orientations.append(orientation)
    there = ca.SX(0, 1) if loads is None else loads
    return Kinematics(model, scalars, origins, orientations, motion, there)
