r"""Mobility: how far the errors of inputs push a robot within one step.

An effort w that is held for a step of h seconds moves the coordinates by :math:`h^2/2\, M^{-1} w`
before any feedback can answer.  The price of a motion is the mean over its samples of

.. math::
    \varphi(q, \theta) = h^4 \lVert M(q, \theta)^{-1} W \rVert_F^2,

with W the diagonal matrix of the errors.  It is small where the inertia that a joint sees is
large: for a stretched arm a push at its last joint turns the light link alone, for a bent one it
moves more.  The mobility tensor is from Hogan, *Impedance Control* (1985), part II.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from compiler.arrays import Array
from compiler.discretisation.numeric_robot import NumericRobot
from compiler.robots.state_and_input import input_bounds, robot_inputs
from compiler.tasks.specification import input_errors
from grammar_lang import ir
from solvers.trajectory.trajectory import Trajectory

STEP = 1e-5
"""The step of central differences, in rad or m."""


@dataclass(frozen=True, slots=True, eq=False)
class Mobility:
    """phi along a motion: ``value`` (k,), ``by_q`` (k, n) and ``by_theta`` (k, p), in SI units."""

    value: Array
    by_q: Array
    by_theta: Array


def joint_errors(numeric: NumericRobot, task: ir.Task) -> Array:
    """The largest error of the effort at each joint (n,), in N m or N; 0 without an input."""
    model = numeric.graph.model
    parts, most = input_errors(task, model)
    errors = np.array([float(value) for value in most])
    for bound in input_bounds(model, task):
        size = max(abs(bound.lower), abs(bound.upper))
        errors[list(bound.inputs)] += [float(parts[place] * size) for place in bound.inputs]
    found = np.zeros(numeric.n)
    for place, item in enumerate(robot_inputs(model)):
        if item.dof is not None:
            found[item.dof] += errors[place]
    return found


def mobility(numeric: NumericRobot, trajectory: Trajectory, errors: Array, dt: float) -> Mobility:
    """Mobility at all samples but the last; efforts are off by ``errors`` (n,) for ``dt`` seconds.

    Raises:
        numpy.linalg.LinAlgError: if a mass matrix is singular.
    """
    q, theta = trajectory.x[:-1, : numeric.n], trajectory.theta
    n, p = numeric.n, len(theta)

    def value(at: Array, parameters: Array) -> Array:
        pushed = dt**2 * np.linalg.solve(
            numeric.mass_matrix(at, parameters, trajectory.u), np.diag(errors)
        )
        return np.asarray((pushed**2).sum(axis=(1, 2)))

    moves = STEP * np.eye(max(n, p))
    by_q = [value(q + move, theta) - value(q - move, theta) for move in moves[:n, :n]]
    by_theta = [value(q, theta + move) - value(q, theta - move) for move in moves[:p, :p]]
    slopes = np.array([*by_q, *by_theta]).reshape(n + p, len(q)).T / (2 * STEP)
    return Mobility(value(q, theta), slopes[:, :n], slopes[:, n:])
