"""Ways in joint space with the inputs that cause them, against the hand-written equations."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from compiler.arrays import Array
from solvers.run_context import RunContext
from solvers.search.configuration_search import search_configuration
from solvers.search.first_motion import first_motion, followed
from solvers.trajectory.control_problem import ControlOutcome
from solvers.trajectory.path_following import PathProblem
from solvers.trajectory.task_size import LEAST_MARGIN
from solvers.trajectory.trajectory import Trajectory
from tests.oracles.planar_chain import chain_dynamics
from tests.oracles.planned_arm import planned
from tests.oracles.small_specs import TURNER

PULL = (0.0, -9.81)


def problem_of(effort: int, obstacle: str = "box [1.4, 2.5] x [1.4, 2.5] m") -> PathProblem:
    """Two links under gravity, from S to T in two seconds."""
    text = TURNER.replace("effort <= 10 N*m", f"effort <= {effort} N*m; gravity (0, -9.81) m/s^2")
    text = text.replace("length in [1, 2]", "length in [0.5, 1.1]")
    text = text.replace("box [1.4, 2.5] x [1.4, 2.5] m", obstacle)
    assert f"<= {effort} N*m" in text
    return planned(text, LEAST_MARGIN)


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
    given = replace(problem_of(200), substeps=128)
    dt, k = float(given.task.step), given.task.steps
    share = (1 - np.cos(np.pi * np.linspace(0, 1, k + 1))) / 2
    moves = np.array([[1.2, -0.7], [-0.4, 0.9]])
    ways = np.array([0.3, 0.8]) + share[None, :, None] * moves[:, None, :]
    theta = np.array([0.6, 0.9])
    motions = followed(given, ways, theta, np.zeros((0, 0)))
    assert len(motions) == 2
    for motion, way in zip(motions, ways, strict=True):
        after = simulated(motion, dt)
        np.testing.assert_allclose(motion.x, after, atol=1e-3)
        # No farther off than the way bends within a step.
        assert np.abs(motion.x[:, :2] - way).max() <= np.abs(np.diff(way, 2, axis=0)).max()
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


class Told:
    """Writes down what it is told."""

    def __init__(self) -> None:
        self.kinds = list[str]()
        self.feasible = list[bool]()

    def see(self, path_problem: PathProblem, outcome: ControlOutcome) -> None:
        self._write("seen", outcome)

    def prove(self, path_problem: PathProblem, outcome: ControlOutcome) -> None:
        self._write("to be proved", outcome)

    def _write(self, kind: str, outcome: ControlOutcome) -> None:
        self.kinds.append(kind)
        self.feasible.append(outcome.feasible)


@pytest.mark.parametrize("length", ["param length in [0.5, 1.1] m", "const length = 0.8 m"])
def test_the_first_motion_is_told_of_before_any_search(length: str) -> None:
    text = TURNER.replace("param length in [1, 2] m", length)
    assert length in text
    told = Told()
    search_configuration(planned(text, LEAST_MARGIN), "", RunContext(evaluations=1), told)
    assert told.feasible[0]
    assert len(told.kinds) > 1
    assert told.kinds[0] == ("seen" if "const" in length else "to be proved")
