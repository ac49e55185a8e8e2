"""Forward kinematics of a robot model as CasADi expressions.

Every literal that is not an integer, and pi, is a symbolic input of the graph, because CasADi
folds constants in doubles: a validated evaluator must be able to give their exact values.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from fractions import Fraction

import casadi as ca

from compiler.dynamics.absolute_angles import Coordinates
from compiler.dynamics.definedness import Conditions
from compiler.expressions.evaluator import Evaluator
from compiler.expressions.scalars import Constant, PiConstant, evaluate_scalars
from compiler.robots.robot import WORLD, Body, Joint, Offset, RobotModel, RodBody, SolidBody, Turn


@dataclass(slots=True)
class SymbolicEvaluator(Evaluator[ca.SX]):
    """Values are CasADi expressions; the evaluator keeps the inputs that stand for constants.

    It keeps the conditions, too, under which the values exist.
    """

    symbols: dict[Constant | PiConstant, ca.SX] = field(
        default_factory=dict[Constant | PiConstant, ca.SX]
    )
    conditions: Conditions = field(default_factory=Conditions)

    def constant(self, value: Fraction | int) -> ca.SX:
        """A number if it is -1, 0 or 1, else an input.

        CasADi folds products of literals, in doubles: only these stay exact whatever happens.
        """
        return ca.SX(int(value)) if value in (-1, 0, 1) else self._input(Constant(Fraction(value)))

    def pi(self) -> ca.SX:
        """An input."""
        return self._input(PiConstant())

    def div(self, dividend: ca.SX, divisor: ca.SX, /) -> ca.SX:
        """A quotient, with the condition that it exists."""
        self.conditions.divisor(divisor)
        return self.unfolded(dividend) / self.unfolded(divisor)

    def power(self, base: ca.SX, exponent: int, /) -> ca.SX:
        """An integer power by repeated squaring, with the condition that it exists."""
        if exponent < 0:
            self.conditions.divisor(base)
        result, square, left = ca.SX(1), self.unfolded(base), abs(exponent)
        while left:
            if left & 1:
                result = result * square
            square, left = square * square, left >> 1
        return result if exponent >= 0 else 1 / result

    def sqrt(self, argument: ca.SX, /) -> ca.SX:
        """A square root, with the condition that it exists."""
        argument = self.unfolded(argument)
        self.conditions.radicand(argument, self._is_positive)
        return ca.sqrt(argument)

    def sin(self, argument: ca.SX, /) -> ca.SX:
        """The sine."""
        return ca.sin(self.unfolded(argument))

    def cos(self, argument: ca.SX, /) -> ca.SX:
        """The cosine."""
        return ca.cos(self.unfolded(argument))

    def tan(self, argument: ca.SX, /) -> ca.SX:
        """The tangent, with the condition that it exists."""
        argument = self.unfolded(argument)
        self.conditions.divisor(ca.cos(argument))
        return ca.tan(argument)

    def neg(self, argument: ca.SX, /) -> ca.SX:
        """The opposite."""
        return -argument

    def fabs(self, argument: ca.SX, /) -> ca.SX:
        """The absolute value."""
        return ca.fabs(argument)

    def add(self, left: ca.SX, right: ca.SX, /) -> ca.SX:
        """The sum."""
        return left + right

    def sub(self, left: ca.SX, right: ca.SX, /) -> ca.SX:
        """The difference."""
        return left - right

    def mul(self, left: ca.SX, right: ca.SX, /) -> ca.SX:
        """The product."""
        return left * right

    def _is_positive(self, symbol: ca.SX) -> bool:
        """Whether a symbol stands for a constant that is not negative."""
        names = {str(entry): constant for constant, entry in self.symbols.items()}
        constant = names.get(str(symbol))
        return constant is not None and (isinstance(constant, PiConstant) or constant.value >= 0)

    def unfolded(self, expression: ca.SX) -> ca.SX:
        """An expression as it is, but a literal other than zero as an input.

        Integers stay exact under sums and products only: CasADi folds 1 / 3 and sqrt(2) in doubles.
        """
        if not expression.is_constant() or expression.is_zero():
            return expression
        return self._input(Constant(Fraction(float(expression))))

    def _input(self, constant: Constant | PiConstant) -> ca.SX:
        if constant not in self.symbols:
            self.symbols[constant] = ca.SX.sym(f"k{len(self.symbols)}")
        return self.symbols[constant]

    def vector(self) -> ca.SX:
        """All constant inputs as one column."""
        return ca.vertcat(*self.symbols.values()) if self.symbols else ca.SX(0, 1)


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
