"""Ways in joint space with the inputs that cause them, against the hand-written equations."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from compiler.arrays import Array
from compiler.discretisation.numeric_robot import NumericRobot
from compiler.dynamics.equations_of_motion import robot_graph
from compiler.robots.normal_form import family_of
from compiler.tasks.specification import planning_problem
from compiler.workspaces.abstraction import abstract
from grammar_lang.load import load_text
from solvers.planner import Planner
from solvers.search.first_motion import first_motion, followed
from solvers.trajectory.path_following import PathProblem
from solvers.trajectory.task_size import LEAST_MARGIN
from solvers.trajectory.trajectory import Trajectory
from solvers.verdict import Holds
from tests.oracles.planar_chain import chain_dynamics
from tests.oracles.small_specs import TURNER

WORD = ("tool", "link", "joint", "link", "joint", "base")
PULL = (0.0, -9.81)


def problem_of(effort: int, obstacle: str = "box [1.4, 2.5] x [1.4, 2.5] m") -> PathProblem:
    """Two links under gravity, from S to T in two seconds."""
    text = TURNER.replace("effort <= 10 N*m", f"effort <= {effort} N*m; gravity (0, -9.81) m/s^2")
    text = text.replace("length in [1, 2]", "length in [0.5, 1.1]")
    text = text.replace("box [1.4, 2.5] x [1.4, 2.5] m", obstacle)
    assert f"<= {effort} N*m" in text
    program = load_text(text, "turner.srg").program
    assert program is not None
    (task,) = program.tasks.values()
    place = program.workspaces[task.workspace]
    family = family_of(program, task)
    numeric = NumericRobot(robot_graph(family.robot(family.replay(WORD)), task.gravity))
    cells = abstract(place)
    found = Planner(planning_problem(cells, task, 0)).next_plan()
    assert isinstance(found, Holds)
    path = found.witness.paths[0].cells
    return PathProblem(numeric, place, task, cells, 0, path, LEAST_MARGIN, 0)


def simulated(motion: Trajectory, dt: float) -> Array:
    """The states (k + 1, 4) that the hand-written equations have under the inputs, held."""
    lengths, densities = motion.theta, np.ones(2)
    states = [motion.x[0]]

    def slope(_: float, x: Array, u: Array) -> Array:
        mass, bias, weight = chain_dynamics(lengths, densities, x[:2], x[2:], PULL)
        return np.concatenate([x[2:], np.linalg.solve(mass, u - bias - weight)])

    for u in motion.u:
        found = solve_ivp(slope, (0, dt), states[-1], args=(u,), rtol=1e-10, atol=1e-12)
        states.append(found.y[:, -1])
    return np.array(states)


def test_inputs_cause_motions_along_their_ways() -> None:
    given = replace(problem_of(200), substeps=32)
    dt, k = float(given.task.step), given.task.steps
    share = (1 - np.cos(np.pi * np.linspace(0, 1, k + 1))) / 2
    moves = np.array([[1.2, -0.7], [-0.4, 0.9]])
    ways = np.array([0.3, 0.8]) + share[None, :, None] * moves[:, None, :]
    theta = np.array([0.6, 0.9])
    motions = followed(given, ways, theta)
    assert len(motions) == 2
    for motion, way in zip(motions, ways, strict=True):
        after = simulated(motion, dt)
        np.testing.assert_allclose(motion.x, after, atol=1e-2)  # it is unstable
        np.testing.assert_allclose(motion.x[:, :2], way, atol=0.05)
        np.testing.assert_allclose(motion.x[-1, 2:], 0.0, atol=1e-3)
        assert np.all(motion.theta == theta)


def test_the_first_motion_reaches_with_the_drives_that_there_are() -> None:
    given = problem_of(60)
    outcome = first_motion(given, 0, lambda: None)
    assert outcome is not None
    assert outcome.feasible
    motion = outcome.trajectory
    assert np.abs(motion.u).max() <= 60
    assert outcome.robustness == pytest.approx(60 - np.abs(motion.u).max())
    lengths = motion.theta
    assert np.all((lengths >= 0.5) & (lengths <= 1.1))
    states = simulated(motion, float(given.task.step))
    phi = np.cumsum(states[:, :2], axis=1)
    tips = np.stack([np.cos(phi) @ lengths, np.sin(phi) @ lengths], axis=1)
    assert np.all((tips[0] >= [1.2, -0.3]) & (tips[0] <= [1.9, 0.3]))
    assert np.all(
        (tips[-1] >= np.array([-0.3, 1.2]) - 1e-2) & (tips[-1] <= np.array([0.3, 1.9]) + 1e-2)
    )
    assert not np.any(np.all(tips > 1.4 + 1e-2, axis=1))


@pytest.mark.parametrize(
    ("effort", "obstacle"),
    [
        (1, "box [1.4, 2.5] x [1.4, 2.5] m"),  # too weak to lift itself
        (60, "box [-0.9, 2.9] x [0.6, 0.9] m"),  # a wall between
    ],
)
def test_there_is_none_where_drives_or_obstacles_forbid_it(effort: int, obstacle: str) -> None:
    assert first_motion(problem_of(effort, obstacle), 0, lambda: None) is None


def test_whoever_asks_may_end_it() -> None:
    def late() -> None:
        raise TimeoutError

    with pytest.raises(TimeoutError):
        first_motion(problem_of(60), 0, late)
