"""The drives of a robot's joints, in the quantities that other tools use."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction

from compiler.expressions.evaluators.balls import closed_ball, working_precision
from compiler.rigid_links.ball_pose import nearest
from compiler.rigid_links.rigid_tree import PRECISION
from compiler.robots.robot import OwnDynamics, RobotModel
from compiler.robots.state_and_input import dry_friction
from grammar_lang import ir


@dataclass(frozen=True, slots=True)
class JointDrive:
    """The drive of a joint, in SI units for a revolute and for a prismatic joint.

    ``damping`` is its viscous friction (N m s, N s/m), ``friction`` the effort of its dry friction
    (N m, N), ``armature`` the inertia of its rotor at the joint, after the gear (kg m^2, kg); each
    is 0 if absent.  ``acceleration`` is the limit of the joint's acceleration (rad/s^2, m/s^2),
    ``gear`` the motion of the motor per motion of the joint (1, rad/m); each is None if absent.
    """

    damping: float = 0.0
    friction: float = 0.0
    armature: float = 0.0
    acceleration: float | None = None
    gear: float | None = None


def joint_drives(model: RobotModel, theta: Sequence[Fraction]) -> tuple[JointDrive, ...]:
    """The drive of every degree of freedom of a robot with these parameters (SI).

    Own dynamics of modules other than viscous friction are not included.

    Raises:
        ValueError: a number is too large for a double.
    """
    damping, dry = dict[int, Fraction](), dry_friction(model)
    for own in model.own:
        damping |= viscous_friction(own, theta) or {}
    return tuple(
        JointDrive(
            float(damping.get(number, 0)),
            _double(dry[number]) if number in dry else 0.0,
            0.0 if dof.inertia is None else _double(dof.inertia),
            None if dof.accel is None else _double(dof.accel),
            None if dof.gear is None else _double(dof.gear),
        )
        for number, dof in enumerate(model.dofs)
    )


def _double(closed: ir.Expr) -> float:
    """The value of a closed expression, rounded once."""
    with working_precision(PRECISION):
        return nearest(closed_ball(closed))


# --------------------------------------------------------------------------------------------------
# The own dynamics of modules that other formats can represent: viscous friction, and nothing else.
#
# That is torque(q) = u - b rate(q).


@dataclass(frozen=True, slots=True)
class _Linear:
    """``constant + effort * u + rate * rate(q)``, exactly."""

    constant: Fraction
    effort: Fraction = Fraction(0)
    rate: Fraction = Fraction(0)

    @property
    def number(self) -> Fraction | None:
        """The value if the expression is constant, otherwise None."""
        return None if self.effort or self.rate else self.constant

    def plus(self, other: _Linear, factor: int) -> _Linear:
        """The sum with ``factor`` times another."""
        return _Linear(
            self.constant + factor * other.constant,
            self.effort + factor * other.effort,
            self.rate + factor * other.rate,
        )

    def times(self, factor: Fraction) -> _Linear:
        """The product with a number."""
        return _Linear(self.constant * factor, self.effort * factor, self.rate * factor)


def viscous_friction(own: OwnDynamics, theta: Sequence[Fraction]) -> dict[int, Fraction] | None:
    """The damping b >= 0 (SI) of each degree of freedom that a module's own dynamics act on.

    None if for these parameter values the dynamics are anything else, or not rational.
    """
    values = {name: theta[index] for name, index in own.parameters}
    found: dict[int, Fraction] = {}
    for torque in own.torques:
        read = _linear(torque.value, torque.dof, values)
        if read is None or read.constant != 0 or read.effort != 1 or read.rate > 0:
            return None
        found[own.bound_dofs[torque.dof]] = -read.rate
    return found


def _linear(expression: ir.Expr, dof: str, values: dict[str, Fraction]) -> _Linear | None:
    """The expression as a linear one in the input and rate of a degree of freedom, or None."""
    match expression:
        case ir.Num(value):
            return _Linear(value)
        case ir.ParameterOf(_, name):
            return _Linear(values[name])
        case ir.EffortOf(_, name) if name == dof:
            return _Linear(Fraction(0), effort=Fraction(1))
        case ir.RateOf(_, name) if name == dof:
            return _Linear(Fraction(0), rate=Fraction(1))
        case ir.Unary("neg", operand):
            inner = _linear(operand, dof, values)
            return None if inner is None else inner.times(Fraction(-1))
        case ir.Binary(operator, left, right):
            a, b = _linear(left, dof, values), _linear(right, dof, values)
            return None if a is None or b is None else _combined(operator, a, b)
        case _:
            return None


def _combined(operator: str, a: _Linear, b: _Linear) -> _Linear | None:
    """The result of an operation on two linear expressions, or None if it is not linear."""
    if operator in ("+", "-"):
        return a.plus(b, 1 if operator == "+" else -1)
    left, right = a.number, b.number
    if operator == "*" and left is not None:
        return b.times(left)
    if right is None:
        return None
    if operator == "*":
        return a.times(right)
    if operator == "/" and right:
        return a.times(1 / right)
    if operator == "^" and left:
        return _Linear(left ** int(right))
    return None
