"""The parts of the equations of motion that people and SMT solvers read, one by one.

A :class:`~compiler.dynamics.equations_of_motion.RobotGraph` has accelerations and their
derivatives, too, which are far larger than what is read here.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from fractions import Fraction

import casadi as ca

from compiler.arithmetic.scalars import Constant, PiConstant
from compiler.dynamics.absolute_angles import own_coordinates
from compiler.dynamics.kinematics import ConstantInputs, kinematics
from compiler.dynamics.rigid_bodies import centrifugal, gravitational, mass_matrix
from compiler.dynamics.tape import CONSTANT
from compiler.robots.robot import RobotModel


class UndefinedMotionError(ValueError):
    """The equations of motion of a robot are undefined whatever its parameters are."""


@dataclass(frozen=True, slots=True)
class MotionGraph:
    """M, c, g and the effectors' positions in the joints' own coordinates.

    Inputs and shapes are those of a ``RobotGraph``, whose bias is c + g:
    ``mass_matrix(q, theta, k)``, ``centrifugal(q, v, theta, k)``, ``gravitational(q, theta, k)``,
    ``effectors(q, theta, k)``.
    """

    model: RobotModel
    constants: tuple[Constant | PiConstant, ...]
    mass_matrix: ca.Function
    centrifugal: ca.Function
    gravitational: ca.Function
    effectors: ca.Function


def motion_graph(model: RobotModel, gravity: tuple[Fraction, ...] = ()) -> MotionGraph:
    """The graph of a robot; ``gravity`` is the acceleration in m/s^2, default none.

    Raises:
        UndefinedMotionError: a divisor is zero.
    """
    n, own = len(model.dofs), own_coordinates(model)
    q, v = ca.SX.sym("q", n), ca.SX.sym("v", n)
    theta = ca.SX.sym("theta", len(model.parameters))
    constants = ConstantInputs()
    at = kinematics(model, q, theta, constants, own)
    mass = mass_matrix(model, at, q, constants, own)
    bias = centrifugal(mass, q, v, constants)
    pull = gravitational(model, at, q, gravity, constants)
    tips = [at.origins[frame][: model.dimension] for frame in model.effectors]
    k = constants.vector()

    def function(name: str, inputs: list[ca.SX], output: ca.SX) -> ca.Function:
        made = ca.Function(name, [*inputs, theta, k], [ca.cse(ca.densify(output))])
        for i in range(made.n_instructions()):
            constant = made.instruction_id(i) == CONSTANT
            if constant and not math.isfinite(made.instruction_constant(i)):
                raise UndefinedMotionError("a divisor in the semantic rules is zero")
        return made

    return MotionGraph(
        model,
        tuple(constants.symbols),
        function("mass_matrix", [q], mass),
        function("centrifugal", [q, v], bias),
        function("gravitational", [q], pull),
        function("effectors", [q], ca.vertcat(*tips) if tips else ca.SX(0, 1)),
    )
