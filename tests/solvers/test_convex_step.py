"""The sparse convex step against the same problem written in cvxpy."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

from compiler.discretisation.float_reading import FloatReading
from compiler.dynamics.equations_of_motion import robot_graph
from solvers.backends.conic import NotSolved
from solvers.motions.convex_step import (
    Model,
    PositionRows,
    StepResult,
    Trajectory,
    Weights,
    convex_step,
    fictitious_inputs,
)
from solvers.motions.motion_limits import InputGroup, MotionLimits
from tests.oracles.convex_step_cvxpy import solve_reference
from tests.oracles.planar_chain import chain_dynamics
from tests.oracles.robots import rod_chain

Array = NDArray[np.float64]
DT = 0.125
STEPS = 6
READING = FloatReading(robot_graph(rod_chain(2)))
FREE = MotionLimits(
    lower=np.full(2, -np.inf),
    upper=np.full(2, np.inf),
    rate_lower=np.full(2, -np.inf),
    rate_upper=np.full(2, np.inf),
    start_rates=0.0,
    final_rates=np.inf,
    start_values=None,
)
GROUPS = (InputGroup((0, 1), -10.0, 10.0, norm2=False),)
NONE = PositionRows(
    np.zeros(0, dtype=np.int64), np.zeros(0, dtype=np.int64), np.zeros((0, 2)), np.zeros(0)
)


def linearised(seed: int) -> Model:
    """About a random trajectory that obeys no dynamics."""
    rng = np.random.default_rng(seed)
    x = np.concatenate(
        [
            np.cumsum(rng.uniform(-0.2, 0.2, (STEPS + 1, 2)), axis=0),
            rng.uniform(-0.5, 0.5, (STEPS + 1, 2)),
        ],
        axis=1,
    )
    about = Trajectory(x, rng.uniform(-2, 2, (STEPS, 2)), rng.uniform(1, 2, 2))
    return Model(
        about,
        READING.step(x[:-1], about.u, about.theta, DT, 1),
        READING.points(x[:, :2], about.theta),
        fictitious_inputs(READING, about, DT),
    )


def end_in(model: Model, offset: float) -> PositionRows:
    """The effector's last position beyond a line, and body points below others on the way."""
    tip = model.points.value[-1, 0]
    normal = np.array([[0.6, 0.8], [0.0, 1.0], [-1.0, 0.0]])
    sample, point = np.array([STEPS, 3, 2]), np.array([0, 2, 4])
    at = model.points.value[sample, point]
    level = np.einsum("rd,rd->r", normal, at) - np.array([offset, 0.05, 0.01])
    assert tip.shape == (2,)
    return PositionRows(sample, point, normal, level)


BOX = (np.array([0.5, 0.5]), np.array([5.0, 5.0]))
RATED = replace(
    FREE,
    rate_lower=np.array([-0.4, -np.inf]),
    rate_upper=np.array([0.5, 0.6]),
    lower=np.array([-1.0, -np.inf]),
    upper=np.array([np.inf, 0.9]),
)
CASES = {
    "free": (FREE, GROUPS, 0.3, 0.5, None),
    "far: needs sigma": (FREE, GROUPS, 4.0, 0.3, None),
    "rest to rest": (replace(FREE, final_rates=0.0), GROUPS, 0.1, 0.5, None),
    "bounded rates": (replace(FREE, start_rates=0.2, final_rates=0.05), GROUPS, 0.1, 0.5, None),
    "limits": (RATED, GROUPS, 0.1, 0.6, None),
    "limits of the initial rates": (
        replace(FREE, start_rates=3.0, rate_lower=np.full(2, -0.1), rate_upper=np.full(2, 0.1)),
        GROUPS, 0.3, 0.6, None,
    ),
    "given start": (replace(FREE, start_values=np.array([0.1, 0.2])), GROUPS, 0.2, 0.5, None),
    "tight trust region": (FREE, GROUPS, 0.3, 0.05, None),
    "norm": (FREE, (InputGroup((0, 1), -5.0, 5.0, norm2=True),), 0.2, 0.5, None),
    "two groups": (
        FREE, (InputGroup((0,), -5.0, 5.0, norm2=False), InputGroup((1,), -3.0, 3.0, norm2=True)),
        0.2, 0.5, None,
    ),
    "a jump: needs V": (
        replace(
            FREE, start_values=np.zeros(2), lower=np.array([0.2, -np.inf]),
            rate_lower=np.full(2, -0.1), rate_upper=np.full(2, 0.1),
        ),
        GROUPS, 0.1, 0.9, None,
    ),
    "free lengths": (FREE, GROUPS, 0.3, 0.5, BOX),
    "free lengths, norm, tight": (
        replace(FREE, final_rates=0.0), (InputGroup((0, 1), -8.0, 8.0, norm2=True),), 0.3, 0.1, BOX,
    ),
    "lengths in a small box": (FREE, GROUPS, 0.3, 0.5, (np.full(2, 0.99), np.full(2, 2.0))),
}  # fmt: skip


def objective(found: StepResult, weights: Weights) -> float:
    return (
        found.margin
        - weights.fictitious * found.largest_fictitious
        - weights.position * found.position_slack
        - weights.quadratic * float(np.sum(found.trajectory.u**2))
    )


@pytest.mark.parametrize("case", sorted(CASES))
def test_the_optimum_is_that_of_the_readable_formulation(case: str) -> None:
    limits, groups, offset, radius, box = CASES[case]
    weights = Weights()
    for seed in (1, 2):
        model = linearised(seed)
        rows = end_in(model, offset)
        found = convex_step(model, rows, limits, groups, radius, box, weights)
        wanted = solve_reference(model, rows, limits, groups, radius, box, weights)
        assert isinstance(found, StepResult)
        scale = 1 + abs(wanted.value)
        assert abs(objective(found, weights) - wanted.value) < 1e-6 * scale
        assert found.largest_fictitious == pytest.approx(wanted.fictitious, abs=1e-5 * scale)
        assert found.position_slack == pytest.approx(wanted.slack, abs=1e-6 * scale)
        assert found.margin == pytest.approx(wanted.margin, abs=1e-4 * scale)
        if case.startswith("far"):
            assert wanted.slack > 0.1
        if case.startswith("a jump"):
            assert wanted.fictitious > 0.1


@pytest.mark.parametrize("case", sorted(CASES))
def test_the_point_satisfies_every_constraint(case: str) -> None:
    """Each row of the problem, evaluated on the answer."""
    limits, groups, offset, radius, box = CASES[case]
    model = linearised(3)
    rows, about = end_in(model, offset), model.about
    found = convex_step(model, rows, limits, groups, radius, box, Weights())
    assert isinstance(found, StepResult)
    x, u, theta = found.trajectory.x, found.trajectory.u, found.trajectory.theta
    dx, du, dp = x - about.x, u - about.u, theta - about.theta
    after = model.dynamics.value + np.einsum("kij,kj->ki", model.dynamics.state, dx[:-1])
    after += np.einsum("kij,kj->ki", model.dynamics.input, du) + model.dynamics.parameter @ dp
    after += np.einsum("kij,kj->ki", model.fictitious, found.fictitious)
    tolerance = 1e-6
    np.testing.assert_allclose(x[1:], after, atol=tolerance)
    assert np.abs(found.fictitious).max() <= found.largest_fictitious + tolerance
    moved = model.points.value + np.einsum("kmdn,kn->kmd", model.points.by_q, dx[:, :2])
    moved += model.points.by_theta @ dp
    at = np.einsum("rd,rd->r", rows.normal, moved[rows.sample, rows.point])
    assert np.all(at <= rows.offset + found.position_slack + tolerance)
    for group in groups:
        part = u[:, list(group.inputs)]
        size = np.linalg.norm(part, axis=1) if group.norm2 else np.abs(part).max(axis=1)
        assert np.all(size <= group.upper - found.margin + tolerance)
        assert found.margin <= group.upper + tolerance
    bound = x[0 if limits.start_values is None else 1 :, :2]
    assert np.all(bound >= limits.lower - tolerance)
    assert np.all(bound <= limits.upper + tolerance)
    assert np.all(x[:, 2:] >= limits.rate_lower - tolerance)
    assert np.all(x[:, 2:] <= limits.rate_upper + tolerance)
    assert np.abs(x[0, 2:]).max() <= limits.start_rates + tolerance
    assert np.abs(x[-1, 2:]).max() <= limits.final_rates + tolerance
    assert np.abs(dx[:, :2]).max() <= radius + tolerance
    if box is None:
        np.testing.assert_array_equal(theta, about.theta)
    else:
        assert np.all(np.abs(dp) <= radius * np.maximum(np.abs(about.theta), 0.1) + tolerance)
        assert np.all(theta >= box[0] - tolerance)
        assert np.all(theta <= box[1] + tolerance)


@pytest.mark.parametrize("epsilon", [1e-6, 0.2])
def test_slacks_by_step_under_c6(epsilon: float) -> None:
    """Problem 4: a jump at the start and an end out of reach, each to be paid for where it is."""
    limits, groups, _, radius, _ = CASES["a jump: needs V"]
    weights = Weights(position=1e4)
    for changed in (limits, replace(FREE, start_values=np.zeros(2), final_rates=0.0)):
        model = linearised(2)
        rows = end_in(model, 0.4)
        small = (replace(groups[0], lower=-0.5, upper=0.5),)
        args = model, rows, changed, small, radius, None, weights
        found, wanted = convex_step(*args, epsilon), solve_reference(*args, epsilon)
        assert isinstance(found, StepResult)
        assert np.abs(found.trajectory.u).max() <= 0.5 + 1e-6
        total = 0.0
        for size in np.abs(found.fictitious).max(axis=1):  # the least g that C.6 allows
            total += max(float(size), epsilon * total)
        paid = weights.fictitious * total + weights.position * found.position_slack
        assert -paid == pytest.approx(wanted.value, rel=1e-4, abs=1e-4)
        assert paid > 1


def test_a_contradiction_is_not_an_optimum() -> None:
    """Start values that the trust region excludes."""
    model = linearised(1)
    limits = replace(FREE, start_values=np.array([3.0, 3.0]))
    found = convex_step(model, NONE, limits, GROUPS, 0.1, None, Weights())
    assert isinstance(found, NotSolved)
    assert "Infeasible" in found.status


def test_without_constraints_standing_still_is_best() -> None:
    x = np.zeros((STEPS + 1, 4))
    x[:, :2] = 0.3
    about = Trajectory(x, np.ones((STEPS, 2)), np.array([1.0, 0.5]))
    model = Model(
        about,
        READING.step(x[:-1], about.u, about.theta, DT, 1),
        READING.points(x[:, :2], about.theta),
        fictitious_inputs(READING, about, DT),
    )
    found = convex_step(model, NONE, FREE, GROUPS, 0.5, None, Weights())
    assert isinstance(found, StepResult)
    assert found.margin == pytest.approx(10.0, abs=1e-4)
    assert found.largest_fictitious == pytest.approx(0.0, abs=1e-6)


def test_a_unit_of_fictitious_input_is_the_effort_that_causes_it() -> None:
    """At rest, a unit torque held for a step moves q by B'_q and q' by B'_v, to first order."""
    theta, q = np.array([1.0, 0.5]), np.array([0.3, 0.4])
    about = Trajectory(np.tile([*q, 0.0, 0.0], (2, 1)), np.zeros((1, 2)), theta)
    matrix = fictitious_inputs(READING, about, DT)[0]
    mass, _, _ = chain_dynamics(theta, np.ones(2), q, np.zeros(2), (0, 0))
    np.testing.assert_allclose(matrix[:2, :2], DT**2 / 2 * np.linalg.inv(mass), rtol=1e-10)
    np.testing.assert_allclose(matrix[2:, 2:], DT * np.linalg.inv(mass), rtol=1e-10)
    assert not matrix[:2, 2:].any()
    assert not matrix[2:, :2].any()


def test_excess_is_signed() -> None:
    model = linearised(1)
    rows = end_in(model, 0.25)
    np.testing.assert_allclose(rows.excess(model.points), [0.25, 0.05, 0.01])
