"""Row 4.10: "the first problem is linear": it is not, nor is what it allows convex."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from compiler.arrays import Array
from compiler.discretisation.numeric_robot import NumericRobot
from compiler.dynamics.equations_of_motion import robot_graph
from solvers.trajectory.control import synthesise_control
from solvers.trajectory.control_problem import FULL, ControlProblem, IterationBudget
from solvers.trajectory.linear_model import PositionRows
from solvers.trajectory.task_limits import InputGroup
from solvers.trajectory.trajectory import Trajectory
from tests.oracles.planar_bodies import two_link_poses
from tests.oracles.robots import rod_chain
from tests.oracles.turning_link import DT, limits
from tests.oracles.two_rods import rates, tip

LENGTHS = np.array([1.0, 0.5])
STEPS = 16
ONCE = IterationBudget(1, 1e-5, 1e-9, 0)


def test_half_way_between_two_poses_the_tip_is_elsewhere() -> None:
    """Both poses with the tip at (0.9, 0.6); their mean has the arm stretched, 0.42 m farther."""
    up, down = (np.array(pose) for pose in two_link_poses(1.0, 0.5, 0.9, 0.6))
    for pose in (up, down):
        np.testing.assert_allclose(tip(LENGTHS, *pose), [0.9, 0.6], atol=1e-12)
    mean = (up + down) / 2
    assert mean[1] == pytest.approx(0)
    gap = np.hypot(*(tip(LENGTHS, *mean) - [0.9, 0.6]))
    assert gap == pytest.approx(1.5 - np.hypot(0.9, 0.6))


def two_links() -> tuple[ControlProblem, Trajectory]:
    """From rest to rest, the tip at the end at (0.8, 0.9) or to the left of it and above."""
    rows = PositionRows(
        np.array([STEPS, STEPS]), np.array([0, 0]), np.array([[0.0, -1.0], [1.0, 0.0]]),
        np.array([-0.9, 0.8]),
    )  # fmt: skip
    numeric = NumericRobot(robot_graph(rod_chain(2)))
    groups = (InputGroup((0, 1), -10.0, 10.0, norm2=False),)
    x = np.zeros((STEPS + 1, 4))
    x[:, :2] = np.linspace([0, 0], [0.9, 0.6], STEPS + 1)
    seed = Trajectory(x, np.zeros((STEPS, 2)), LENGTHS)
    return ControlProblem(numeric, DT, 16, limits(2, 0.0), groups, lambda *_: rows), seed


def simulated_end(at: Trajectory) -> Array:
    """Where the inputs lead from the first state, by an integrator of order eight."""
    state = at.x[0]
    for torque in at.u:
        answer = solve_ivp(
            rates, (0, DT), state, method="DOP853", rtol=1e-11, atol=1e-12, args=(LENGTHS, torque)
        )
        state = answer.y[:, -1]
    return np.asarray(state)


def test_one_linear_program_does_not_do_and_their_sequence_does() -> None:
    problem, seed = two_links()
    once = synthesise_control(problem, seed, budget=ONCE)
    missed = simulated_end(once.trajectory) - once.trajectory.x[-1]
    assert not once.feasible
    assert np.abs(missed).max() > 0.1
    outcome = synthesise_control(problem, seed, budget=FULL)
    assert outcome.feasible
    end = simulated_end(outcome.trajectory)
    np.testing.assert_allclose(end, outcome.trajectory.x[-1], atol=1e-5)
    x, y = tip(LENGTHS, *end[:2])
    assert x < 0.8 + 1e-5
    assert y > 0.9 - 1e-5
