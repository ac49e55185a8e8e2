"""Gains against SciPy's Riccati equation, closed motions and the law's sets against arithmetic."""

from __future__ import annotations

from fractions import Fraction
from itertools import product
from types import SimpleNamespace
from typing import cast

import numpy as np
import pytest
from flint import arb
from scipy.linalg import solve_discrete_are

from compiler.discretisation.numeric_robot import Linearisation, NumericRobot
from compiler.dynamics.equations_of_motion import robot_graph
from compiler.robots.state_and_input import InputBound
from grammar_lang import ir
from solvers.trajectory.feedback import (
    SIZES,
    Sizes,
    closed_motion,
    closed_spread,
    reference_motion,
    regulator,
)
from solvers.trajectory.task_limits import InputGroup
from solvers.trajectory.trajectory import Trajectory
from solvers.verifier.proofs import effort_bounds
from solvers.verifier.proofs.control_law import ControlLaw, InputError, open_loop, sampled_law
from solvers.verifier.proofs.zonotope import Zonotope
from tests.oracles.robots import rod_chain

STEPS = 400


def steps(a: np.ndarray, b: np.ndarray) -> Linearisation:
    n = len(b)
    return Linearisation(
        np.zeros((STEPS, n)), np.tile(a, (STEPS, 1, 1)), np.tile(b, (STEPS, 1, 1)),
        np.zeros((STEPS, n, 0)),
    )  # fmt: skip


def test_the_first_gain_of_a_long_motion_is_that_of_the_algebraic_riccati_equation() -> None:
    h = 0.1
    a = np.array([[1.0, 0.0, h, 0.0], [0.0, 1.0, 0.0, h], [0.3, 0.0, 1.02, 0.0], [0, 0.1, 0, 1]])
    b = np.array([[h * h / 2, 0.0], [0.0, h * h], [h, 0.02], [0.0, 2 * h]])
    scales = np.array([10.0, 3.0])
    q = np.diag([SIZES[0].coordinate ** -2] * 2 + [SIZES[0].rate ** -2] * 2)
    r = np.diag(scales**-2)
    p = solve_discrete_are(a, b, q, r)
    expected = np.linalg.solve(r + b.T @ p @ b, b.T @ p @ a)
    np.testing.assert_allclose(regulator(steps(a, b), 4, scales)[0], expected, rtol=1e-8)


def test_what_is_not_measured_is_not_fed_back() -> None:
    a, b = np.eye(3), np.array([[0.1], [1.0], [0.5]])
    gains = regulator(steps(a, b), 2, np.array([1.0]))
    assert np.abs(gains[0, :, :2]).max() > 0.01
    assert not gains[:, :, 2:].any()


def test_equations_without_a_solution_have_no_gains() -> None:
    assert not regulator(steps(np.full((2, 2), np.nan), np.ones((2, 1))), 2, np.ones(1)).any()


TASK = cast(ir.Task, SimpleNamespace(step=Fraction(1, 20), robust=None))


@pytest.fixture(scope="module")
def inverted() -> tuple[NumericRobot, Trajectory, tuple[InputGroup, ...]]:
    """Two links on end: without feedback the slightest deviation grows."""
    numeric = NumericRobot(robot_graph(rod_chain(2), (Fraction(0), Fraction("-9.81"))))
    theta, k = np.array([1.0, 0.7]), 60
    x = np.zeros((k + 1, 4))
    x[:, 0] = np.pi / 2 + 0.02
    return numeric, Trajectory(x, np.zeros((k, 2)), theta), (InputGroup((0, 1), -40, 40, False),)


def test_feedback_keeps_an_unstable_motion(inverted) -> None:
    numeric, about, groups = inverted
    gains = closed_spread(numeric, TASK, about, groups, 2)[0]
    free = numeric.simulate(about.x[0], about.u, about.theta, 0.05, 4)
    kept = closed_motion(numeric, about.x[0], about, gains, groups, 0.05, 4)
    assert np.abs(free[:, :2] - about.x[:, :2]).max() > 1
    assert np.abs(kept.x[:, :2] - about.x[:, :2]).max() < 0.1
    assert np.abs(kept.u).max() <= 40
    # The inputs alone cause the same motion, as long as rounding has not grown.
    again = numeric.simulate(about.x[0], kept.u, about.theta, 0.05, 4)
    np.testing.assert_allclose(again[:20], kept.x[:20], atol=1e-9)


def test_the_reference_is_what_the_controller_then_does(inverted) -> None:
    numeric, about, groups = inverted
    gains = closed_spread(numeric, TASK, about, groups, 2)[0]
    found = reference_motion(numeric, about, gains, groups, 0.05, 2)
    again = closed_motion(numeric, found.x[0], found, gains, groups, 0.05, 128)
    np.testing.assert_allclose(again.x, found.x, atol=1e-8)
    np.testing.assert_allclose(again.u, found.u, atol=1e-6)


def test_bounds_are_kept_by_what_feedback_commands(inverted) -> None:
    numeric, about, _ = inverted
    weak = (InputGroup((0,), -1, 2, False), InputGroup((1,), 0, 1.5, True))
    gains = closed_spread(numeric, TASK, about, weak, 2)[0]
    u = closed_motion(numeric, about.x[0] + 0.1, about, 50 * gains, weak, 0.05, 2).u
    assert u[:, 0].min() == -1
    assert u[:, 0].max() <= 2
    assert np.abs(u[:, 1]).max() <= 1.5 + 1e-12


def exact(value: arb) -> Fraction:
    numerator, exponent = value.man_exp()
    return Fraction(int(numerator)) * Fraction(2) ** int(exponent)


def test_the_law_maps_every_state_of_a_set_into_the_set_after_it() -> None:
    """Against rational arithmetic, with coordinates of the graph that are not the joints'."""
    rng = np.random.default_rng(3)

    def some(*shape: int) -> list:
        return np.vectorize(lambda x: Fraction(int(x), 97))(rng.integers(-97, 97, shape)).tolist()

    rows = [[1, 0], [-1, 1]]
    law = ControlLaw((tuple(some(4)),), (tuple(tuple(row) for row in some(2, 4)),))
    planned, noise = [some(2)], [Fraction(1, 50), Fraction(0), Fraction(1, 9), Fraction(1, 7)]
    rounding = [Fraction(1, 30), Fraction(1, 3)]
    sampled = sampled_law(law, planned, rows, noise, rounding, 1)
    middle, columns = some(8), [some(8) for _ in range(3)]
    as_balls = [[arb(v.numerator) / v.denominator for v in row] for row in (middle, *columns)]
    before = Zonotope(
        [v.mid() for v in as_balls[0]], np.array([[float(v) for v in c] for c in as_balls[1:]]).T
    )
    after = sampled.held(0, before).hull()
    for signs in product((-1, 1), repeat=3):
        state = [
            exact(m)
            + sum(s * Fraction(x) for s, x in zip(signs, before.columns[i].tolist(), strict=True))
            for i, m in enumerate(before.middle)
        ]
        for errors in product((-1, 1), repeat=4):
            joints = [
                sum(a * y for a, y in zip(row, state[part : part + 2], strict=True))
                for part in (0, 2)
                for row in rows
            ]
            read = [x + e * n for x, e, n in zip(joints, errors, noise, strict=True)]
            off = [x - r for x, r in zip(read, law.reference[0], strict=True)]
            for i, (u, gain) in enumerate(zip(planned[0], law.gains[0], strict=True)):
                held = u - sum(k * x for k, x in zip(gain, off, strict=True))
                ball = after[5 + i]
                assert exact(ball.lower()) <= held - rounding[i]
                assert held + rounding[i] <= exact(ball.upper())
    # What is not held stays as it was, and the set of inputs is reached.
    assert after[4].overlaps(before.hull()[4])


def test_an_open_loop_is_a_law_without_gains() -> None:
    law = open_loop([[Fraction(3)], [Fraction(-2)]], 2)
    sampled = sampled_law(law, [[Fraction(3)], [Fraction(-2)]], [[1]], [], [], 0)
    still = Zonotope([arb(0), arb(0), arb(0)], np.array([[1.0], [1.0], [0.0]]))
    assert [sampled.held(k, still).hull()[2] for k in (0, 1)] == [3, -2]


def test_errors_of_inputs_add_up() -> None:
    error = InputError((arb("0.5"),) * 2, (arb(1), arb(0)))
    first, second = error.about([arb(-4), arb(0, 2)])
    assert float(first) == pytest.approx(3, rel=1e-8)
    assert float(second) == pytest.approx(1, rel=1e-8)


@pytest.mark.parametrize(
    ("commanded", "holds", "margin"),
    [
        ([(0, 2), (0, 1)], True, 3 - 5**0.5),
        ([(3, 0.1), (0, 0)], False, -0.1),
        ([(0, 4), (0, 0)], False, -1),
    ],
)
def test_a_norm_of_inputs_about_zero(
    commanded: list[tuple[float, float]], holds: bool, margin: float
) -> None:
    """A ball about 0 has a square whose ball holds negative numbers."""
    bound = InputBound((0, 1), Fraction(-3), Fraction(3), "N*m", "effort", norm2=True)
    gap = effort_bounds.distance(bound, [arb(*pair) for pair in commanded])
    assert bool(gap > 0) is holds
    assert float(gap.lower()) == pytest.approx(margin, abs=1e-6)


def test_relaxed_weights_forgive_an_error_of_the_start_and_fade() -> None:
    """Weights are inverse squares of the sizes, which are stretched by e^-10 s at a part s."""
    shares = np.array([0.0, 0.1, 1.0])
    found = Sizes(0.05, 1.0, 4.0).weights(shares, 1, 3)
    stretch = 1 + 3 * np.exp(-10 * shares)
    np.testing.assert_allclose(found[:, 0], 1 / (0.05 * stretch) ** 2)
    np.testing.assert_allclose(found[:, 1], 1 / stretch)
    assert not found[:, 2].any()
