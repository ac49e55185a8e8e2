"""The planned motion of a design, sampled at the steps of its task, with named columns.

It is integrated anew from the certificate (start, parameters, inputs), like ``trajectory.csv``; no
proof rests on it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction

import numpy as np

from compiler.arrays import Array
from compiler.discretisation.numeric_robot import NumericRobot
from compiler.dynamics.equations_of_motion import robot_graph
from compiler.robots.robot import RobotModel
from compiler.robots.state_and_input import robot_inputs, robot_states
from grammar_lang.ir.constants import to_float
from solvers.trajectory.fine_motion import fine_motion
from solvers.trajectory.rubbing_motion import rates_of_change
from solvers.trajectory.trajectory import Trajectory
from solvers.verifier.claims.certificate import CertificateError, exact
from srgc.exports.exported_robot import design_names, design_tree, input_name, left_out
from srgc.exports.joint_drives import joint_drives
from srgc.faults import UsageFault
from srgc.results.found_design import FoundDesign

# --- The start, inputs and parameters in a certificate, as doubles --------------------------------


def planned_inputs(design: FoundDesign) -> Trajectory:
    """The initial state (1, 2n + r), the inputs (k, m) and the parameters (p,).

    Raises:
        UsageFault: the number of inputs is not that of the task's steps, or one is not a number.
    """
    model = design.model
    if len(design.claim.inputs) != design.task.steps:
        raise UsageFault("the inputs of the certificate are not those of the task")
    try:
        own = [0.0 if s.initial is None else to_float(s.initial) for s in robot_states(model)]
        start = [float(value) for value in design.start[: 2 * len(model.dofs)]]
        rows = [[float(exact(text)) for text in row] for row in design.claim.inputs]
    except CertificateError as error:
        raise UsageFault(str(error)) from None
    inputs = np.array(rows, dtype=float).reshape(len(rows), len(robot_inputs(model)))
    return Trajectory(np.array([[*start, *own]]), inputs, design.theta)


def planned_motion(design: FoundDesign, numeric: NumericRobot) -> Trajectory:
    """The undisturbed motion at the samples (k + 1, N), with its inputs (k, m).

    It is integrated in fine steps; a controller keeps an unstable motion on its reference.

    Raises:
        UsageFault: the numbers of the certificate do not match the robot.
    """
    planned, dt, feedback = planned_inputs(design), float(design.task.step), design.feedback
    if feedback is None:
        return fine_motion(numeric, planned, dt)
    states, inputs = [planned.x[0]], list[Array]()
    for step, u in enumerate(planned.u):
        inputs.append(feedback.commanded(step, u, states[-1]))
        held = Trajectory(states[-1][None, :], inputs[-1][None, :], planned.theta)
        states.append(fine_motion(numeric, held, dt).x[-1])
    return Trajectory(np.array(states), np.array(inputs), planned.theta)


def free_inputs(model: RobotModel) -> list[int]:
    """The column of the free input of each degree of freedom.

    Raises:
        KeyError: a degree of freedom has none, since its module's own dynamics do not use one.
    """
    columns = {item.dof: column for column, item in enumerate(robot_inputs(model))}
    return [columns[dof] for dof in range(len(model.dofs))]


# --------------------------------------------------------------------------------------------------
# The motion at the samples.


POSITION_UNITS = {"revolute": "rad", "prismatic": "m"}
EFFORT_UNITS = {"revolute": "N*m", "prismatic": "N"}


@dataclass(frozen=True, slots=True)
class Quantity:
    """The name and SI unit of a column."""

    name: str
    unit: str


def quantities(names: Sequence[str], units: Sequence[str]) -> tuple[Quantity, ...]:
    """Columns with these names and units."""
    return tuple(Quantity(name, unit) for name, unit in zip(names, units, strict=True))


def input_quantities(model: RobotModel, joints: Sequence[str]) -> tuple[Quantity, ...]:
    """The inputs of a robot: free ones are named after their joints, others after modules.

    Loads have their own names.
    """
    inputs = robot_inputs(model)
    names = [input_name(item) if item.dof is None else joints[item.dof] for item in inputs]
    return quantities(names, [item.unit for item in inputs])


@dataclass(frozen=True, slots=True, eq=False)
class ExportedMotion:
    """The k + 1 samples of a motion with k rows of held inputs, in SI units.

    Attributes:
        times: (k + 1,) exact, in seconds.
        position, velocity: (k + 1, n) of the joints.
        acceleration: (k + 1, n) just after each sample; at the end, just before it.
        effort: (k + 1, n) of a motor at each joint, at the same instants.
        input: (k, m) held from each sample to the next.
        state: (k + 1, r) of the modules' own dynamics.
        effector: (k + 1, e, d) positions.
        joints, efforts, inputs, states: the columns of position, effort, input and state.
        effectors: the names of the effectors.
    """

    design: FoundDesign
    joints: tuple[Quantity, ...]
    efforts: tuple[Quantity, ...]
    inputs: tuple[Quantity, ...]
    states: tuple[Quantity, ...]
    effectors: tuple[str, ...]
    times: tuple[Fraction, ...]
    position: Array
    velocity: Array
    acceleration: Array
    effort: Array
    input: Array
    state: Array
    effector: Array


def exported_motion(design: FoundDesign) -> ExportedMotion:
    """The motion that the inputs of a design cause.

    Raises:
        UsageFault: the motion has numbers that are not finite doubles.
    """
    with np.errstate(all="ignore"):
        motion = _integrated(design)
    values = (motion.position, motion.velocity, motion.acceleration, motion.effort)
    if not all(np.isfinite(value).all() for value in (*values, motion.state, motion.effector)):
        raise UsageFault("the motion cannot be simulated in doubles")
    return motion


def _integrated(design: FoundDesign) -> ExportedMotion:
    model, step = design.model, design.task.step
    graph = robot_graph(model, design.task.gravity)
    numeric = NumericRobot(graph)
    planned = planned_inputs(design)
    count, n = len(planned.u), len(model.dofs)
    moved = planned_motion(design, numeric)
    held = moved.u[[*range(count), count - 1]]
    rates = rates_of_change(numeric, moved.x, held, planned.theta)[:, n:]
    q, v = moved.x[:, :n], moved.x[:, n : 2 * n]
    tips = numeric.places(q, planned.theta)
    effort = _efforts(design, numeric, moved.x, rates[:, :n], held, planned.theta)
    names = design_names(design, design_tree(design))
    kinds = [dof.kind for dof in model.dofs]
    return ExportedMotion(
        design,
        quantities(names.joints, [POSITION_UNITS[kind] for kind in kinds]),
        quantities(names.joints, [EFFORT_UNITS[kind] for kind in kinds]),
        input_quantities(model, names.joints),
        tuple(
            Quantity(f"{item.module}_{item.symbol}.{item.name}", item.unit)
            for item in robot_states(model)
        ),
        names.effectors,
        tuple(i * step for i in range(count + 1)),
        q,
        v,
        rates[:, :n],
        effort,
        moved.u,
        moved.x[:, 2 * n :],
        tips,
    )


def _efforts(
    design: FoundDesign,
    numeric: NumericRobot,
    x: Array,
    acceleration: Array,
    held: Array,
    theta: Array,
) -> Array:
    """The efforts of motors at the joints: the free inputs, or what causes the accelerations.

    If a module's own dynamics are only viscous friction, that is not part of the effort.
    """
    n = len(design.model.dofs)
    if left_out(design) is None:
        return held[:, free_inputs(design.model)]
    q, v = x[:, :n], x[:, n : 2 * n]
    # The bias is the generalized force of the bodies at zero acceleration.
    bodies = (tuple(range(len(design.model.bodies))),)
    mass = numeric.mass_matrix(q, theta, held)
    slowed = numeric.slowed(bodies, x, np.zeros_like(q), held, theta)
    bias: Array = (mass @ slowed)[:, :, 0]
    inertial: Array = (mass @ acceleration[:, :, None])[:, :, 0]
    drives = joint_drives(design.model, design.stated)
    # At a joint at rest, dry friction opposes the motion that is about to begin.
    way = np.sign(np.where(v == 0, acceleration, v))
    friction: Array = np.array([drive.damping for drive in drives]) * v
    friction += np.array([drive.friction for drive in drives]) * way
    return inertial + bias + friction
