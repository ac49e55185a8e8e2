r"""The weight that the joints of a robot carry, by the position of one of its effectors.

A task says where an effector is at its goal, while the coordinates of the joints are known only to
be in a box. The weight of what is fixed to the effector, of mass m with its centre at p + c, turns
a joint with the axis a through o by

.. math:: m\, (\gamma \times a) \cdot (p + c - o)

in a field of gravity :math:`\gamma`. In this p stands for itself: for the first joint of an arm,
whose axis does not move, nothing but p and the direction of c is uncertain.

Source: Siciliano et al., *Robotics*, section 7.1 (gravity by virtual work).
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from fractions import Fraction

import casadi as ca

from compiler.dynamics.kinematics import Kinematics, kinematics, own_coordinates
from compiler.dynamics.rigid_bodies import inertia_of, potential_energy
from compiler.dynamics.symbolic_evaluator import SymbolicEvaluator
from compiler.expressions.scalars import Constant, PiConstant
from compiler.expressions.tape import Tape, tape
from compiler.robots.robot import WORLD, Joint, Offset, RobotModel


@dataclass(frozen=True, slots=True)
class WeightGraph:
    """What gravity does to the joints, with the position of an effector as a variable.

    Inputs of the tape: q (n,), theta, the exact ``constants``, and the effector's position (d,) in
    metres. It returns the gradient of the potential energy in q (n,), in N m and N.
    """

    constants: tuple[Constant | PiConstant, ...]
    pull: Tape


def weight_graph(model: RobotModel, gravity: tuple[Fraction, ...], effector: int) -> WeightGraph:
    """The weight graph of a robot for one of its effectors (from 0).

    Args:
        model: the robot.
        gravity: the acceleration in m/s^2, (d,).
        effector: the effector whose position is a variable.

    Raises:
        UndefinedValueError: a rule of the robot divides by zero everywhere.
    """
    n, d = len(model.dofs), model.dimension
    q, theta, place = (
        ca.SX.sym("q", n),
        ca.SX.sym("theta", len(model.parameters)),
        ca.SX.sym("p", d),
    )
    constants = SymbolicEvaluator()
    at = kinematics(model, q, theta, constants, own_coordinates(model))
    tip = model.effectors[effector]
    fixed = _fixed_to(model, tip)
    others = tuple(body for body in model.bodies if body.frame not in fixed)
    energy = potential_energy(replace(model, bodies=others), at, gravity, constants)
    pull = ca.densify(ca.gradient(energy, q))
    if len(others) < len(model.bodies):
        down = ca.vertcat(*(constants.constant(g) for g in gravity), ca.SX.zeros(3 - d))
        pull -= _turned(model, at, tip, down, *_carried(model, at, tip, fixed, place, constants))
    expression = ca.cse(ca.densify(pull))
    function = ca.Function("weight", [q, theta, constants.vector(), place], [expression])
    return WeightGraph(tuple(constants.symbols), tape(function))


def _fixed_to(model: RobotModel, tip: int) -> set[int]:
    """The frames that no joint moves against the frame of an effector."""
    found, frame = {tip}, tip
    while frame != WORLD and not isinstance(model.frames[frame].step, Joint):
        frame = model.frames[frame].parent
        found.add(frame)
    for number, node in enumerate(model.frames):
        if number != WORLD and node.parent in found and not isinstance(node.step, Joint):
            found.add(number)
    return found


def _carried(
    model: RobotModel,
    at: Kinematics,
    tip: int,
    fixed: set[int],
    place: ca.SX,
    constants: SymbolicEvaluator,
) -> tuple[ca.SX, ca.SX]:
    """The mass of what is fixed to an effector, and its moment (3,) about the world's origin."""
    origins, frame = list(at.origins), tip
    origins[tip] = ca.vertcat(place, ca.SX.zeros(3 - place.numel()))
    known = {tip}
    while model.frames[frame].parent in fixed and frame != WORLD:
        parent = model.frames[frame].parent
        origins[parent] = origins[frame] - _offset(model, at, frame)
        known.add(parent)
        frame = parent
    for number in sorted(fixed - known):
        parent = model.frames[number].parent
        origins[number] = origins[parent] + _offset(model, at, number)
    there, mass, moment = replace(at, origins=origins), ca.SX(0), ca.SX.zeros(3)
    for body in model.bodies:
        if body.frame in fixed:
            own, centre, _ = inertia_of(body, there, constants)
            mass, moment = mass + own, moment + own * centre
    return mass, moment


def _offset(model: RobotModel, at: Kinematics, frame: int) -> ca.SX:
    """The way from the origin of a frame's parent to its own, (3,), in the world."""
    node = model.frames[frame]
    if not isinstance(node.step, Offset):
        return ca.SX.zeros(3)
    vector = ca.vertcat(*(at.scalars[i] for i in node.step.vector))
    return at.orientations[node.parent].matrix() @ vector


def _turned(
    model: RobotModel, at: Kinematics, tip: int, down: ca.SX, mass: ca.SX, moment: ca.SX
) -> ca.SX:
    """The work of a field ``down`` (3,) on a mass with a moment, by each coordinate, (n,)."""
    work = ca.SX.zeros(len(model.dofs))
    for frame in model.chain(tip):
        step = model.frames[frame].step
        if not isinstance(step, Joint):
            continue
        axis = step.sign * at.axis(frame, step.axis)
        if model.dofs[step.dof].kind == "revolute":
            work[step.dof] += ca.dot(ca.cross(down, axis), moment - mass * at.origins[frame])
        else:
            work[step.dof] += mass * ca.dot(down, axis)
    return work
