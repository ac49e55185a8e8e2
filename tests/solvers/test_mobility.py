"""How far wrong efforts push a robot: against the chain written by hand, and against motions."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest

from compiler.arrays import Array
from compiler.discretisation.numeric_robot import NumericRobot
from compiler.dynamics.equations_of_motion import robot_graph
from grammar_lang import ir
from solvers.search.calm_motion import calmer
from solvers.search.evaluation import evaluate
from solvers.trajectory.control import synthesise_control
from solvers.trajectory.mobility import joint_errors, mobility
from solvers.trajectory.trajectory import Trajectory
from tests.oracles.planar_chain import chain_dynamics
from tests.oracles.planned_arm import THETAS, planned_arm
from tests.oracles.robots import rod_chain
from tests.oracles.turning_link import one_link

THREE = NumericRobot(robot_graph(rod_chain(3)))
DT, ERRORS = 0.2, np.array([0.3, 0.05, 0.1])


def motion(seed: int, n: int = 3, steps: int = 4) -> Trajectory:
    rng = np.random.default_rng(seed)
    x = rng.uniform(-2, 2, (steps + 1, 2 * n))
    return Trajectory(x, rng.uniform(-1, 1, (steps, n)), rng.uniform(0.3, 1.5, n))


def by_hand(q: Array, lengths: Array) -> float:
    """h^4 times the sum of the squares of all entries of M^-1 W."""
    mass, _, _ = chain_dynamics(lengths, np.ones(len(q)), q, np.zeros(len(q)), (0, 0))
    return float(DT**4 * np.sum((np.linalg.inv(mass) @ np.diag(ERRORS)) ** 2))


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_the_value_and_its_slopes_are_those_of_the_chain_by_hand(seed: int) -> None:
    given = motion(seed)
    found = mobility(THREE, given, ERRORS, DT)
    for sample, q in enumerate(given.x[:-1, :3]):
        assert found.value[sample] == pytest.approx(by_hand(q, given.theta), rel=1e-9)
        for j, move in enumerate(1e-4 * np.eye(3)):
            wanted = (by_hand(q + move, given.theta) - by_hand(q - move, given.theta)) / 2e-4
            scale = found.value[sample]
            assert found.by_q[sample, j] == pytest.approx(wanted, rel=1e-4, abs=1e-5 * scale)
            wanted = (by_hand(q, given.theta + move) - by_hand(q, given.theta - move)) / 2e-4
            assert found.by_theta[sample, j] == pytest.approx(wanted, rel=1e-4, abs=1e-5 * scale)


def test_it_is_what_efforts_held_for_a_short_step_do_to_a_robot_at_rest() -> None:
    """Twice the way that each joint goes, squared and summed over the wrong efforts."""
    given, short = motion(5), 1e-3
    found = mobility(THREE, given, ERRORS, short)
    for sample, q in enumerate(given.x[:-1, :3]):
        rest = np.concatenate([q, np.zeros(3)])
        ways = [
            THREE.simulate(rest, error[None, :], given.theta, short, 4)[-1, :3] - q
            for error in np.diag(ERRORS)
        ]
        assert found.value[sample] == pytest.approx(4 * np.sum(np.square(ways)), rel=1e-4)


def test_a_bent_arm_is_pushed_less_than_a_stretched_one() -> None:
    """Hogan's example: the inertia at the last joint of a stretched arm is that of its link."""
    x = np.zeros((4, 4))
    x[:, 1] = [0.0, 0.5, 1.5, 0.0]
    given = Trajectory(x, np.zeros((3, 2)), np.array([1.0, 0.6]))
    two = NumericRobot(robot_graph(rod_chain(2)))
    stretched, less, bent = mobility(two, given, np.array([0.1, 0.1]), DT).value
    assert stretched > 1.2 * less > 1.4 * bent


def test_a_price_leads_to_less_of_it() -> None:
    """The whole iteration, between the same half-planes: phi falls as its price rises."""
    problem, seed = one_link(8, 10.0, np.inf)
    lengths = (np.array([0.5]), np.array([3.0]))
    found = []
    for price in (0.0, 1.0, 100.0):
        priced = replace(problem, mobility=price, errors=np.array([0.5]))
        outcome = synthesise_control(priced, seed, lengths)
        assert outcome.feasible
        found.append(
            mobility(problem.numeric, outcome.trajectory, np.array([0.5]), problem.dt).value.mean()
        )
    assert found[0] > found[1] > found[2]


def test_disturbed_motions_that_end_have_the_price_and_others_have_not() -> None:
    """An arm between its obstacles: with the price, wrong efforts push it less."""
    alone = planned_arm()
    assert calmer(alone).mobility == 0
    errors = ir.Robust(effort_of_bound=Fraction(1, 20))
    disturbed = replace(alone, task=replace(alone.task, robust=errors))
    assert calmer(replace(disturbed, loop=3)).mobility == 0
    priced = calmer(disturbed)
    numeric, dt = alone.numeric, float(alone.task.step)
    wrong = joint_errors(numeric, disturbed.task)
    np.testing.assert_allclose(wrong, 0.05 * 10)  # of an effort bound of 10 N m
    means = []
    for problem in (replace(priced, mobility=0.0), replace(priced, mobility=1e4 * priced.mobility)):
        outcome = evaluate(problem, THETAS[0])
        assert outcome.feasible
        means.append(mobility(numeric, outcome.trajectory, wrong, dt).value.mean())
    assert means[1] < means[0]
