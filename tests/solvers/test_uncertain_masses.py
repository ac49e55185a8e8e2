"""Masses that are off by a constant per occurrence of a module, against chains written by hand."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from fractions import Fraction
from itertools import product

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from compiler.arrays import Array
from compiler.discretisation.numeric_robot import NumericRobot
from compiler.dynamics.equations_of_motion import robot_graph
from compiler.expressions.evaluators.balls import working_precision
from compiler.robots.robot import BodyOwner
from compiler.robots.robot_key import robot_key_in_task
from compiler.tasks.specification import UncertainMass, uncertain_masses
from grammar_lang import ir
from solvers.trajectory.disturbance_spread import disturbance_spread
from solvers.trajectory.trajectory import Trajectory
from solvers.verifier.proofs.disturbed_proof import disturbed_start, input_error
from solvers.verifier.proofs.enclosure import Accuracy
from solvers.verifier.proofs.scene import Scene, Watch
from solvers.verifier.proofs.trajectory_proof import Motion
from solvers.verifier.proofs.tube_proof import driven_robot, follow
from tests.oracles.planar_chain import chain_dynamics
from tests.solvers.test_disturbed_proof import scene, spec

F = Fraction
LENGTHS = np.array([1.3, 0.9, 1.3])
ARM = ("hand", "upper", "turn", "fore", "turn", "upper", "turn", "base")
"""Read from the hand: links of 1.3 m, 0.9 m and 1.3 m, the first and the last of one module."""
DOWN = (0.0, -1.5)


def task(disturbances: str, steps: int = 6) -> Scene:
    text = spec(steps, disturbances + " gravity (0, -1.5) m/s^2;")
    return scene(ARM, text)


def test_bodies_belong_to_the_modules_of_their_productions() -> None:
    where = task("robust mass 2 % of L; robust mass 3 %; robust mass 5 % of K;")
    model = where.model
    assert [None if x is None else x.module for x in model.owners] == ["L", "K", "L"]
    symbols = [x.symbol for x in model.owners if isinstance(x, BodyOwner)]
    assert symbols == sorted(set(symbols))
    assert uncertain_masses(where.task, model) == (
        UncertainMass(F(3, 100), (0, 1, 2)),
        UncertainMass(F(1, 50), (0,)),
        UncertainMass(F(1, 50), (2,)),
        UncertainMass(F(1, 20), (1,)),
    )


def test_several_bodies_of_one_occurrence_have_one_constant() -> None:
    model = replace(task("").model, owners=tuple(BodyOwner(i, "L") for i in (3, 7, 3)))
    robust = ir.Robust(masses=(ir.ModuleMass("L", F(1, 50)), ir.ModuleMass("K", F(1, 50))))
    given = replace(task("").task, robust=robust)
    assert uncertain_masses(given, model) == (
        UncertainMass(F(1, 50), (0, 2)), UncertainMass(F(1, 50), (1,)),
    )  # fmt: skip


@pytest.mark.parametrize("groups", [((0, 1, 2),), ((0,), (2,)), ((1, 2), (0, 1, 2), (2,)), ()])
def test_weighed_equations_are_those_of_other_densities(
    groups: tuple[tuple[int, ...], ...],
) -> None:
    """The acceleration and what is balanced, in the joints' coordinates, with rates and weight."""
    rng = np.random.default_rng(len(groups))
    graph = robot_graph(task("").model, (F(0), F(-3, 2)))
    weighed = graph.weighed(groups)
    k = NumericRobot(graph).constants
    for _ in range(5):
        q, v, u = rng.uniform(-2, 2, (3, 3))
        factors = rng.uniform(0.5, 1.5, len(groups))
        densities = np.ones(3)
        for factor, group in zip(factors, groups, strict=True):
            densities[list(group)] *= factor
        mass, coriolis, weight = chain_dynamics(LENGTHS, densities, q, v, DOWN)
        found = weighed.balance(q, np.concatenate([v, factors]), u, [], k)
        expected = np.concatenate([mass.T.ravel(), u - coriolis - weight, np.zeros(len(groups))])
        np.testing.assert_allclose(np.asarray(found).ravel(), expected, rtol=1e-11, atol=1e-11)
        found = weighed.acceleration(q, np.concatenate([v, factors]), u, [], k)
        pull = np.linalg.solve(mass, u - coriolis - weight)
        np.testing.assert_allclose(np.asarray(found).ravel()[:3], pull, rtol=1e-9)
        a = rng.uniform(-2, 2, 3)
        asked = np.asarray(graph.efforts_of(((0,), (1,), (2,)))(q, v, a, np.zeros(3), [], k))
        whole, turning, pulled = chain_dynamics(LENGTHS, np.ones(3), q, v, DOWN)
        np.testing.assert_allclose(asked.sum(axis=1), whole @ a + turning + pulled, rtol=1e-10)


# --- tubes ----------------------------------------------------------------------------------------


START = (F("0.3"), F("-0.8"), F("1.1"), F("0.4"), F("-0.2"), F("0.3"))
INPUTS = [(F("1.5") - F(k, 2), F("-0.8"), F("0.4")) for k in range(6)]


def simulated(densities: Sequence[float], times: Array) -> Array:
    """Coordinates and rates of the joints at some times, by a method of order 8."""
    state, found = np.array([float(x) for x in START]), []
    for k, u in enumerate(INPUTS):
        push = np.array([float(x) for x in u])

        def slope(_: float, x: Array, push: Array = push) -> Array:
            mass, turning, weight = chain_dynamics(LENGTHS, np.array(densities), x[:3], x[3:], DOWN)
            return np.concatenate([x[3:], np.linalg.solve(mass, push - turning - weight)])

        solved = solve_ivp(
            slope, (0, 0.1), state, method="DOP853", rtol=1e-11, atol=1e-12, dense_output=True
        )
        inside = times[(times >= 0.1 * k) & (times < 0.1 * (k + 1))] - 0.1 * k
        found += [solved.sol(t) for t in inside]
        state = solved.y[:, -1]
    return np.array([*found, state])


@pytest.mark.slow
def test_motions_of_all_masses_are_in_the_tube() -> None:
    """Every corner of the two occurrences and of all masses, and what lies between."""
    where = task("robust mass 0.4 % of L; robust mass 0.1 %;")
    motion = Motion((), START, tuple(INPUTS), 0, ())
    with working_precision(80):
        robot = driven_robot(where, motion, disturbed=True)
        initial = disturbed_start(where, robot.state)
        assert len(robot.state) == 6 + 3 + 3
        assert len(initial.radii) == 3
        followed = follow(
            robot, initial, input_error(where), Accuracy(12, 80, 1e-9), Watch(lambda: None)
        )
        assert not followed.ended
        rows = np.array(where.graph.coordinates.rows, dtype=float)
        boxes = [
            [(float(x.lower()), float(x.upper())) for x in sample[:6]]
            for sample in followed.samples
        ]
    to_own = np.kron(np.eye(2), np.linalg.inv(rows))
    rng, spread = np.random.default_rng(3), np.zeros((7, 6))
    planned = simulated([1, 1, 1], np.arange(6) * 0.1) @ to_own.T
    factors = [*product((-1, 1), repeat=3), *rng.uniform(-1, 1, (6, 3))]
    for first, last, both in factors:
        all_of_it = 1 + 0.001 * both
        densities = [all_of_it * (1 + 0.004 * first), all_of_it, all_of_it * (1 + 0.004 * last)]
        states = simulated(densities, np.arange(6) * 0.1) @ to_own.T
        spread = np.maximum(spread, np.abs(states - planned))
        for state, box in zip(states, boxes, strict=True):
            for value, (low, high) in zip(state, box, strict=True):
                assert low - 1e-9 <= value <= high + 1e-9
    widths = np.array([[(high - low) / 2 for low, high in box] for box in boxes])
    # The corners are felt, and the tube is little wider than what they show.
    assert spread[-1].max() > 1e-4
    assert (widths[-1] < 1.3 * spread[-1] + 1e-5).all()


@pytest.mark.parametrize(
    "clauses", ["robust mass 4 % of L;", "robust mass 3 % of K;", "robust mass 2 %;"]
)
def test_the_spread_that_a_search_tightens_by_is_that_of_corners(clauses: str) -> None:
    """To first order and to the accuracy of steps, by differences of simulations."""
    where = task(clauses)
    numeric = NumericRobot(robot_graph(where.model, where.task.gravity))
    u = np.array([[float(x) for x in row] for row in INPUTS])
    x = numeric.simulate(np.array([float(v) for v in START]), u, np.zeros(0), 0.1, 8)
    steps = numeric.step(x[:-1], u, np.zeros(0), 0.1, 8)
    found = disturbance_spread(numeric, where.task, Trajectory(x, u, np.zeros(0)), steps)
    expected, times = np.zeros((7, 6)), np.arange(6) * 0.1
    for item in uncertain_masses(where.task, where.model):
        low, high = (
            simulated([1 + s * 1e-3 * (i in item.bodies) for i in range(3)], times) for s in (-1, 1)
        )
        expected += float(item.part) * np.abs(high - low) / 2e-3
    states = found.states.transpose(0, 2, 1).reshape(7, 6)
    np.testing.assert_allclose(states, expected, rtol=0.1, atol=2e-4)


def test_equal_robots_differ_where_other_masses_are_uncertain() -> None:
    """In the order of the word, whatever the numbers of the symbols are."""
    where = task("")

    def key(owners: str, masses: str) -> str:
        numbered = enumerate(owners.split(), 1)
        made = tuple(BodyOwner(10 * i + len(owners), name) for i, name in numbered)
        robust = ir.Robust(masses=tuple(ir.ModuleMass(name, F(1, 50)) for name in masses.split()))
        return robot_key_in_task(
            replace(where.model, owners=made), replace(where.task, robust=robust)
        )

    assert key("L K L", "L") == key("L Long L", "L") != key("L L K", "L")
    assert key("L K L", "") == key("L L K", "")
    assert key("L K L", "L K") != key("L K L", "L")


def test_masses_of_modules_need_owners() -> None:
    where = task("robust mass 2 % of L;")
    with pytest.raises(ValueError, match="owners"):
        uncertain_masses(where.task, replace(where.model, owners=()))
    assert uncertain_masses(task("").task, replace(where.model, owners=())) == ()
