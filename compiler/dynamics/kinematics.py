"""Forward kinematics of a robot model as CasADi expressions."""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca

from compiler.dynamics.absolute_angles import Coordinates
from compiler.dynamics.symbolic_evaluator import SymbolicEvaluator
from compiler.expressions.scalars import evaluate_scalars
from compiler.robots.robot import WORLD, Body, Joint, Offset, RobotModel, RodBody, SolidBody, Turn


@dataclass(frozen=True, slots=True)
class Orientation:
    """``base * R(axis, angle + leading)``, so that angles about one axis add.

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
        """After a further rotation about a local axis."""
        if axis == self.axis:
            return Orientation(self.base, axis, self.angle + angle, self.leading)
        return Orientation(self.matrix(), axis, angle, ca.SX(0))

    def led(self, axis: int, leading: ca.SX) -> Orientation:
        """After a joint whose absolute angle about a local axis replaces the one before."""
        if axis == self.axis:
            return Orientation(self.base, axis, self.angle, leading)
        return Orientation(self.matrix(), axis, ca.SX(0), leading)


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
    """Positions, orientations and joint axes of all frames as expressions in (q, theta)."""

    model: RobotModel
    scalars: list[ca.SX]
    origins: list[ca.SX]
    orientations: list[Orientation]

    def axis(self, frame: int, axis: int) -> ca.SX:
        """The direction of a local axis in the world, shape (3,)."""
        return self.orientations[frame].matrix()[:, axis]

    def point(self, frame: int, local: tuple[int, int, int]) -> ca.SX:
        """The world position of a point given by three scalars in a frame."""
        offset = ca.vertcat(*(self.scalars[i] for i in local))
        return self.origins[frame] + self.orientations[frame].matrix() @ offset

    def rod_end(self, rod: RodBody) -> ca.SX:
        """The world position of the far end of a rod."""
        direction = rod.sign * self.axis(rod.frame, rod.axis)
        return self.origins[rod.frame] + direction * self.scalars[rod.length]

    def body_points(self, body: Body) -> list[ca.SX]:
        """The points whose convex hull is the body: both ends of a rod, else one point."""
        if isinstance(body, RodBody):
            return [self.origins[body.frame], self.rod_end(body)]
        if isinstance(body, SolidBody):
            return [self.point(body.frame, body.com)]
        return [self.origins[body.frame]]


def kinematics(
    model: RobotModel,
    coordinates: ca.SX,
    parameters: ca.SX,
    constants: SymbolicEvaluator,
    measured: Coordinates,
) -> Kinematics:
    """Forward kinematics, one pass over the frames in topological order.

    ``coordinates`` are y with q = D y, as ``measured`` says.
    """
    scalars = evaluate_scalars(model.scalars, constants, ca.vertsplit(parameters))
    origins = [ca.SX.zeros(3)]
    orientations = [Orientation(ca.SX.eye(3), 2, ca.SX(0), ca.SX(0))]
    for node in model.frames[WORLD + 1 :]:
        origin, orientation = origins[node.parent], orientations[node.parent]
        match node.step:
            case Turn(axis, angle):
                orientation = orientation.turned(axis, constants.unfolded(scalars[angle]))
            case Offset(vector):
                offset = ca.vertcat(*(scalars[i] for i in vector))
                origin = origin + orientation.matrix() @ offset
            case Joint(dof, axis, sign):
                motion = sign * coordinates[dof]
                if dof in measured.absolute:
                    orientation = orientation.led(axis, coordinates[dof])
                elif model.dofs[dof].kind == "revolute":
                    orientation = orientation.turned(axis, motion)
                else:
                    origin = origin + orientation.matrix()[:, axis] * motion
            case None:
                pass
        origins.append(origin)
        orientations.append(orientation)
    return Kinematics(model, scalars, origins, orientations)
