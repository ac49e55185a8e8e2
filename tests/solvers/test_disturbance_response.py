"""What disturbances add along a path, against integrals of switching ones by scipy."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from flint import arb, arb_mat
from scipy.integrate import quad, solve_ivp
from scipy.optimize import linprog

from compiler.expressions.evaluators.balls import working_precision
from solvers.verifier.proofs.a_priori import LinearPart, Steady, comparison
from solvers.verifier.proofs.disturbance_response import THIRD, linear_slices, response
from solvers.verifier.proofs.linearisation import InertiaMatrix, Linearisation

DEGREE = 6
BOUNDS = (0.3, 1.2)


def inertia(t: float) -> np.ndarray:
    """N(t) of two joints, far from constant."""
    return np.array([[2 + np.cos(3 * t), np.sin(2 * t)], [np.sin(2 * t), 1.5 - np.sin(t)]])


def slopes(t: float) -> np.ndarray:
    """R(t), (2, 4)."""
    return np.array([[-4 * np.cos(t), 1.0, -2 * np.sin(3 * t), 1], [2.0, 3 * np.sin(t), 1, -2 + t]])


C = np.array([[1.0, -0.5], [0.25, 2.0]])


def series(f: object, shape: tuple[int, int], half: float) -> tuple[list[arb_mat], list[arb_mat]]:
    """Coefficients about the middle, and hulls of those about all instants of [0, 2 half].

    By Cauchy's integral over circles of radius one, exact to rounding for entire functions.
    """
    angles = np.exp(2j * np.pi * np.arange(64) / 64)
    assert callable(f)

    def about(at: float, order: int) -> np.ndarray:
        values = np.array([f(at + z) for z in angles])
        return np.real(np.tensordot(angles**-order, values, 1) / 64)

    middle, over = [], []
    for order in range(DEGREE + 1):
        centre = about(half, order)
        sampled = np.array([about(at, order) for at in np.linspace(0, 2 * half, 41)])
        reach = np.abs(sampled - centre).max(axis=0) * 1.1 + 1e-12
        pairs = zip(centre.ravel().tolist(), reach.ravel().tolist(), strict=True)
        over.append(arb_mat(*shape, [arb(c, r) for c, r in pairs]))
        if order < DEGREE:
            exact = [arb(c, 1e-13) for c in centre.ravel().tolist()]
            middle.append(arb_mat(*shape, exact))
    return middle, over


def linear_part(half: float) -> LinearPart:
    masses, pulls = series(inertia, (2, 2), half), series(slopes, (2, 4), half)
    times = np.linspace(0, 2 * half, 200)
    lower = np.array([np.linalg.solve(inertia(t), slopes(t)) for t in times])
    rates = np.vstack([np.eye(4)[2:], np.abs(lower).max(axis=0) * 1.01])
    return LinearPart(
        arb_mat(rates.tolist()),
        arb_mat(lower.mean(axis=0).tolist()),
        InertiaMatrix(hull([inertia(t) for t in times])),
        Linearisation(masses[0], pulls[0]),
        Linearisation(masses[1], pulls[1]),
    )


def hull(matrices: list[np.ndarray]) -> arb_mat:
    low, high = np.min(matrices, axis=0), np.max(matrices, axis=0)
    pairs = zip(((low + high) / 2).ravel(), ((high - low) / 2 * 1.01).ravel(), strict=True)
    return arb_mat(2, 2, [arb(float(c), float(r)) for c, r in pairs])


def found(length: float, columns: np.ndarray = C) -> tuple[LinearPart, Steady]:
    half = length / 2
    with working_precision(64):
        linear = linear_part(half)
        parts = linear_slices(linear, arb(half), 4)
        bounds = [arb(item) for item in BOUNDS]
        none = arb_mat(2, 1, [arb(0)] * 2)
        steady = response(arb_mat(columns.tolist()), bounds, arb(length), linear, parts, none)
    return linear, steady


def deviation(length: float, switches: list[np.ndarray], signs: list[float]) -> np.ndarray:
    """e(H) under disturbances at their bounds that switch at some instants."""

    def rate(t: float, e: np.ndarray) -> np.ndarray:
        d = [
            b * s * (-1) ** np.searchsorted(times, t)
            for b, s, times in zip(BOUNDS, signs, switches, strict=True)
        ]
        return np.concatenate([e[2:], np.linalg.solve(inertia(t), slopes(t) @ e + C @ d)])

    instants = np.unique(np.concatenate([[0.0, length], *switches]))
    e = np.zeros(4)
    for first, last in pairwise(instants.tolist()):
        inner = (first + 1e-12 * length, last - 1e-12 * length)
        e = solve_ivp(rate, inner, e, "DOP853", rtol=1e-11, atol=1e-14).y[:, -1]
    return e


@pytest.mark.parametrize("length", [0.4, 0.1])
def test_what_switching_disturbances_add_is_in_the_image(length: float) -> None:
    """Whatever they do within the segment: constant, switching once, twice, at random."""
    linear, steady = found(length)
    columns = np.array([[float(x) for x in row] for row in steady.columns.tolist()])
    with working_precision(64):
        zero = [arb(0)] * 4
        box = np.array([float(x) for x in comparison(linear.rates, steady.rest, zero, arb(length))])
    reach = np.array([float(x) for x in steady.reach]) + box
    rng = np.random.default_rng(5)
    most = np.zeros(4)
    for trial in range(40):
        switches = [np.sort(rng.uniform(0, length, trial % 4)) for _ in BOUNDS]
        e = deviation(length, switches, rng.choice([-1.0, 1.0], 2).tolist())
        slack = 1e-9 * length
        solved = linprog(
            np.zeros(columns.shape[1]),
            np.vstack([columns, -columns]),
            np.concatenate([e + box + slack, box + slack - e]),
            bounds=(-1, 1),
        )
        assert solved.status == 0
        assert (np.abs(e) <= reach + slack).all()
        most = np.maximum(most, np.abs(e))
    # Over a tenth of a second, the image is not much larger than what they reach.
    assert length > 0.2 or (np.abs(columns).sum(axis=1) + box <= 1.6 * most + 1e-4).all()


def test_what_is_not_in_the_image_is_of_third_order() -> None:
    """What pushes besides is of second order: half the length, a quarter of it."""
    parts = []
    for length in (0.2, 0.1, 0.05):
        _, steady = found(length)
        parts.append(max(float(item) for item in steady.rest))
    assert parts[0] / parts[1] > 3.4
    assert parts[1] / parts[2] > 3.4


def test_constant_disturbances_are_known() -> None:
    """The image of the constant ones, against scipy, to fourth order in the length."""
    errors = []
    for length in (0.2, 0.1):
        _, steady = found(length)
        sums = np.array([[float(x) for x in row] for row in steady.constant.tolist()]).sum(axis=1)
        errors.append(np.abs(sums - deviation(length, [np.zeros(0)] * 2, [1.0, 1.0])).max())
    assert errors[0] / errors[1] > 10


def test_the_third_moment_has_its_bound() -> None:
    """The integral of |(v^2 - 1/12) / 2| over -1/2 <= v <= 1/2 is less than 1 / THIRD."""
    root = 12**-0.5
    value = quad(lambda v: abs(v * v - 1 / 12) / 2, -0.5, 0.5, points=[-root, root])[0]
    assert value < 1 / THIRD < value * 1.05
