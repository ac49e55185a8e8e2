r"""Inputs that compensate dry friction, so that a robot moves as if it had none.

A search plans motions of the robot without dry friction, within bounds that leave room for it.  A
joint that slides throughout a step needs its friction in addition.  Over a step in which its rate
goes linearly from v to w, the mean sign of friction is

.. math:: \bar\sigma = \frac{|w| - |v|}{w - v} .

At rest nothing is added: friction itself then balances the remaining effort of inputs and loads.
"""

from __future__ import annotations

import numpy as np

from compiler.arrays import Array
from compiler.discretisation.numeric_robot import NumericRobot
from compiler.robots.robot import RobotModel
from compiler.robots.state_and_input import dry_friction, robot_inputs
from grammar_lang.ir.constants import to_float
from solvers.trajectory.trajectory import Trajectory

AT_REST = 1e-3
"""A joint whose rates at both ends of a step are below this, in SI, is at rest."""


def joint_friction(model: RobotModel) -> Array:
    """The size of the effort of dry friction at each joint, (n,), in N m or N."""
    found = np.zeros(len(model.dofs))
    for joint, size in dry_friction(model).items():
        found[joint] = to_float(size)
    return found


def input_friction(model: RobotModel) -> Array:
    """The size of dry friction at each input that drives a joint, (m,); 0 for declared inputs."""
    sizes = joint_friction(model)
    return np.array([0.0 if i.dof is None else sizes[i.dof] for i in robot_inputs(model)])


def friction_inputs(numeric: NumericRobot, trajectory: Trajectory) -> Array:
    """The inputs (k, m) to add to those of a motion without dry friction.

    Inputs that act on a joint only through states of its module cannot compensate it.
    """
    n, m, size = numeric.n, numeric.m, numeric.size
    sizes = joint_friction(numeric.graph.model)
    if not (sizes.any() and m):
        return np.zeros_like(trajectory.u)
    efforts = sizes * _mean_signs(trajectory.x[:, n : 2 * n])
    before = trajectory.x[:-1]
    with np.errstate(all="ignore"):
        slopes = numeric.acceleration(before, trajectory.u, trajectory.theta)[1]
        mass = numeric.mass_matrix(before[:, :n], trajectory.theta, trajectory.u)
        pull = np.linalg.solve(mass, efforts[:, :, None])
        inverse = np.linalg.pinv(slopes[:, :n, size : size + m])
    return np.asarray((inverse @ pull)[:, :, 0])


def _mean_signs(rates: Array) -> Array:
    """The mean sign of each rate (k + 1, n) over each step, (k, n)."""
    before, after = rates[:-1], rates[1:]
    changes, turned = after - before, np.abs(after) - np.abs(before)
    moves = np.maximum(np.abs(before), np.abs(after)) > AT_REST
    steady = changes == 0
    found: Array = np.where(steady, np.sign(before), turned / np.where(steady, 1.0, changes))
    return np.where(moves, found, 0.0)
