"""One rod that turns about its end: motions to ask for, and the least torque of each by an LP."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from fractions import Fraction
from math import cos, sin
from typing import Any

import numpy as np
from scipy.optimize import linprog

from compiler.arrays import Array
from compiler.discretisation.numeric_robot import NumericRobot
from compiler.dynamics.equations_of_motion import robot_graph
from solvers.trajectory.control_problem import ControlProblem
from solvers.trajectory.linear_model import PositionRows
from solvers.trajectory.task_limits import InputGroup, MotionLimits
from solvers.trajectory.trajectory import Trajectory
from tests.oracles.robots import rod_chain

DT = 0.125
LENGTH = 1.5
INERTIA = LENGTH**3 / 3
ONE = NumericRobot(robot_graph(rod_chain(1)))
ANGLE = 1.1


def limits(n: int, final: float, **changes: Array | float) -> MotionLimits:
    wide = np.full(n, 4.0), np.full(n, np.inf)
    base = MotionLimits(-wide[0], wide[0], -wide[1], wide[1], 0.0, final, np.zeros(n))
    return replace(base, **changes)


def beyond(steps: int, angle: float, length: float = LENGTH) -> PositionRows:
    """The tip's last position is at least as high as at an angle below a right one."""
    return PositionRows(
        np.array([steps]),
        np.array([0]),
        np.array([[0.0, -1.0]]),
        np.array([-length * np.sin(angle)]),
    )


def one_link(
    steps: int, bound: float, final: float, angle: float = ANGLE, **changes: Array | float
) -> tuple[ControlProblem, Trajectory]:
    rows = beyond(steps, angle)
    problem = ControlProblem(
        ONE,
        DT,
        1,
        limits(1, final, **changes),
        (InputGroup((0,), -bound, bound, norm2=False),),
        lambda *_: rows,
    )
    x = np.stack([np.linspace(0, angle, steps + 1), np.full(steps + 1, angle / steps / DT)], axis=1)
    x[0, 1] = 0.0
    return problem, Trajectory(x, np.zeros((steps, 1)), np.array([LENGTH]))


def double_integrator(steps: int, rest: bool, reach: float, rate: float = np.inf) -> float:
    """The least peak torque from rest to an angle of at least ``reach``, by an LP in the inputs.

    After i steps the rate is sum_j h u_j, the angle sum_j h^2 (i - j - 1/2) u_j, by the inertia.
    """
    h = DT / INERTIA
    rates = np.tril(np.ones((steps, steps))) * h
    place = np.array([DT * h * (steps - j - 0.5) for j in range(steps)])
    above = [np.append(-place, 0.0)]
    level = [-reach]
    for sign in (1, -1):
        above += [np.append(sign * unit, -1.0) for unit in np.eye(steps)]
        level += [0.0] * steps
        if np.isfinite(rate):
            above += [np.append(sign * row, 0.0) for row in rates]
            level += [rate] * steps
    equal = np.append(rates[-1], 0.0)[None, :] if rest else None
    found = linprog(
        np.append(np.zeros(steps), 1.0),
        A_ub=np.array(above), b_ub=level, A_eq=equal, b_eq=[0.0] if rest else None,
        bounds=[(None, None)] * (steps + 1),
    )  # fmt: skip
    assert found.status == 0
    return float(found.fun)


def one_link_tips(content: Mapping[str, Any], per_step: int) -> list[tuple[float, float]]:
    """The tip of one uniform link of 1 kg/m, whose acceleration is constant within a step."""
    length = float(content["parameters"][0]["value"])
    inertia, dt = length**3 / 3, float(Fraction(content["step"]))
    q, rate, tips = float(content["start"][0]), 0.0, []
    for (text,) in content["inputs"]:
        pull = float(text) / inertia
        for i in range(per_step):
            t = dt * i / per_step
            angle = q + rate * t + pull * t * t / 2
            tips.append((length * cos(angle), length * sin(angle)))
        q, rate = q + rate * dt + pull * dt * dt / 2, rate + pull * dt
    return [*tips, (length * cos(q), length * sin(q))]
