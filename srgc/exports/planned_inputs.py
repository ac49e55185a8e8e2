"""What a certificate says of a motion, as doubles: its start, its inputs, its parameters."""

from __future__ import annotations

import numpy as np

from compiler.robots.robot import RobotModel
from compiler.robots.state_and_input import robot_inputs, robot_states
from grammar_lang.ir.constants import to_float
from solvers.trajectory.trajectory import Trajectory
from solvers.verifier.claims.certificate import CertificateError, exact
from srgc.faults import UsageFault
from srgc.results.found_design import FoundDesign


def planned_inputs(design: FoundDesign) -> Trajectory:
    """The initial state alone (1, 2n + r), the inputs (k, m) and the parameters (p,).

    Raises:
        UsageFault: there are not as many inputs as the task has steps, or one is no number.
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


def free_inputs(model: RobotModel) -> list[int]:
    """The column of the free input of every degree of freedom.

    Raises:
        KeyError: one has none, since its module's own dynamics do without.
    """
    columns = {item.dof: column for column, item in enumerate(robot_inputs(model))}
    return [columns[dof] for dof in range(len(model.dofs))]
