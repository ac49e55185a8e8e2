"""The sparse convex step against the same problem written in cvxpy."""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
import pytest

from compiler.arrays import Array
from compiler.discretisation.numeric_robot import NumericRobot
from compiler.dynamics.equations_of_motion import robot_graph
from solvers.backends.conic import NotSolved, Status
from solvers.trajectory.convex_step import FEW, ConvexStep
from solvers.trajectory.linear_model import LinearRows, Model, PositionRows, fictitious_inputs
from solvers.trajectory.mobility import mobility
from solvers.trajectory.reference_step import ReferenceStep
from solvers.trajectory.subproblem import StepResult, SubproblemSpec, TrustRegion, Weights
from solvers.trajectory.task_limits import InputGroup, MotionLimits
from solvers.trajectory.trajectory import Trajectory
from tests.oracles.planar_chain import chain_dynamics
from tests.oracles.robots import rod_chain
from tests.oracles.some_cases import examples

DT = 0.125
STEPS = 6
NUMERIC = NumericRobot(robot_graph(rod_chain(2)))
THREE = NumericRobot(robot_graph(rod_chain(3)))
ACCURACY = 1e-9
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


def linearised(seed: int, numeric: NumericRobot = NUMERIC) -> Model:
    """About a random trajectory that obeys no dynamics."""
    rng, n = np.random.default_rng(seed), numeric.n
    x = np.concatenate(
        [
            np.cumsum(rng.uniform(-0.2, 0.2, (STEPS + 1, n)), axis=0),
            rng.uniform(-0.5, 0.5, (STEPS + 1, n)),
        ],
        axis=1,
    )
    about = Trajectory(x, rng.uniform(-2, 2, (STEPS, n)), rng.uniform(1, 2, n))
    return Model(
        about,
        numeric.step(x[:-1], about.u, about.theta, DT, 1),
        numeric.points(x[:, :n], about.theta),
        fictitious_inputs(numeric, about, DT),
        mobility(numeric, about, np.linspace(0.5, 1.5, n), DT),
    )


def accelerated(model: Model, limits: MotionLimits, seed: int) -> Model:
    """With rates that rise and fall by random parts of what limits of accelerations allow."""
    if not limits.accelerations.size:
        return model
    parts = np.random.default_rng(seed).uniform(0.3, 1.0, (2, STEPS, 2))
    return replace(model, rises=DT * parts * limits.accelerations)


def test_inputs_that_hold_a_start_are_bound() -> None:
    """Rows about the first sample alone, in lengths like others."""
    model, rng = linearised(4), np.random.default_rng(4)
    rows = end_in(model, 0.1)
    by_q, by_theta = rng.uniform(-1, 1, (3, 2)), rng.uniform(-1, 1, (3, 2))
    first = np.zeros(3, dtype=np.int64)
    moved = replace(model, holding=LinearRows(first, by_q, by_theta, np.array([-0.2, 0.3, -0.1])))
    for box in (None, BOX):
        case = Case(box=box)
        found, free = (agree(case, each, rows, fictitious=True) for each in (moved, model))
        assert found is not None
        assert free is not None

        def worst(result: StepResult) -> float:
            dq = result.trajectory.x[0, :2] - model.about.x[0, :2]
            dp = result.trajectory.theta - model.about.theta
            left = by_q @ dq + by_theta @ dp - [-0.2, 0.3, -0.1]
            return float(np.max(left)) - result.position_slack

        assert worst(found) <= 1e-6
        assert worst(free) > 1e-3


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


@dataclass(frozen=True)
class Case:
    """A question, how far the end is moved beyond a line, and the trust region."""

    limits: MotionLimits = FREE
    groups: tuple[InputGroup, ...] = GROUPS
    offset: float = 0.3
    radius: float = 0.5
    box: tuple[Array, Array] | None = None
    proximal: float = 0.0
    epsilon: float | None = None
    rates: float = 0.0
    mobility: float = 0.0
    prices: tuple[float, ...] = ()

    @property
    def question(self) -> SubproblemSpec:
        weights = Weights(
            position=200.0, rates=self.rates, mobility=self.mobility, parameters=self.prices
        )
        return SubproblemSpec(self.limits, self.groups, self.box, weights, self.epsilon)

    @property
    def region(self) -> TrustRegion:
        return TrustRegion(self.radius, self.proximal)


TOGETHER = (InputGroup((0, 1), -5.0, 5.0, norm2=True),)
JUMP = replace(
    FREE,
    start_values=np.zeros(2),
    lower=np.array([0.2, -np.inf]),
    rate_lower=np.full(2, -0.1),
    rate_upper=np.full(2, 0.1),
)
WAVE = np.sin(np.arange(STEPS + 1))[:, None]
BY_SAMPLE = replace(
    FREE,
    rate_lower=np.array([-0.4, -np.inf]) + 0.1 * WAVE,
    rate_upper=np.array([0.5, 0.6]) - 0.3 * WAVE**2,
    lower=np.array([-1.0, -np.inf]) + 0.2 * WAVE,
    upper=np.array([np.inf, 0.9]) + 0.3 * WAVE,
)
KEPT = np.array([0.0, 2.0, 4.0, 3.5, 1.0, 0.5])
CASES = {
    "free": Case(),
    "far: needs sigma": Case(offset=4.0, radius=0.3),
    "rest to rest": Case(replace(FREE, final_rates=0.0), offset=0.1),
    "rests for a while": Case(replace(FREE, final_rates=0.0, final_samples=3), offset=0.1),
    "slow for a while": Case(replace(FREE, final_rates=0.05, final_samples=3), offset=0.1),
    "bounded rates": Case(replace(FREE, start_rates=0.2, final_rates=0.05), offset=0.1),
    "limits": Case(RATED, offset=0.1, radius=0.6),
    "limits of the initial rates": Case(
        replace(FREE, start_rates=3.0, rate_lower=np.full(2, -0.1), rate_upper=np.full(2, 0.1)),
        radius=0.6,
    ),
    "a seed outside the limits": Case(replace(FREE, lower=np.full(2, 1.5)), radius=0.2),
    "given start": Case(replace(FREE, start_values=np.array([0.1, 0.2])), offset=0.2),
    "tight trust region": Case(radius=0.05),
    "moves have a price": Case(proximal=0.3),
    "moves are dear": Case(proximal=40.0, box=BOX),
    "rates have a price": Case(offset=0.2, rates=0.05),
    "rates are dear": Case(offset=0.2, rates=5.0, box=BOX),
    "mobility has a price": Case(offset=0.2, mobility=5.0, proximal=0.1),
    "mobility is dear": Case(offset=0.2, mobility=200.0, box=BOX, proximal=0.1, rates=0.05),
    "parameters have prices": Case(offset=0.2, box=BOX, proximal=0.1, prices=(0.5, -0.2)),
    "parameters and mobility have prices": Case(
        offset=0.2, mobility=5.0, box=BOX, proximal=0.1, prices=(3.0, 1.0)
    ),
    "fixed parameters have prices": Case(offset=0.2, prices=(3.0, 1.0)),
    "norm": Case(groups=TOGETHER, offset=0.2),
    "two groups": Case(
        groups=(InputGroup((0,), -3.0, 5.0, norm2=False), InputGroup((1,), -3.0, 3.0, norm2=True)),
        offset=0.2,
    ),
    "accelerations": Case(replace(FREE, accelerations=np.array([0.6, np.inf]))),
    "accelerations, rest to rest": Case(
        replace(RATED, accelerations=np.array([3.0, 2.0]), final_rates=0.0), box=BOX
    ),
    "limits by sample": Case(BY_SAMPLE, offset=0.1, radius=0.6),
    "limits by sample, given start": Case(
        replace(BY_SAMPLE, start_values=np.array([0.1, 0.2])), offset=0.1
    ),
    "inputs by step": Case(groups=(replace(GROUPS[0], lower=-4.0, upper=5.0, kept=KEPT),)),
    "inputs by step, norm": Case(groups=(replace(TOGETHER[0], kept=KEPT),), offset=0.2),
    "a jump: needs V": Case(JUMP, offset=0.1, radius=0.9),
    "free lengths": Case(box=BOX),
    "free lengths, norm, tight": Case(
        replace(FREE, final_rates=0.0), TOGETHER, radius=0.1, box=BOX, proximal=1e-3
    ),
    "lengths in a small box": Case(box=(np.full(2, 0.99), np.full(2, 2.0))),
    "C.6": Case(JUMP, (replace(GROUPS[0], lower=-0.5, upper=0.5),), 0.4, 0.9, epsilon=0.2),
}


def value(case: Case, model: Model, found: StepResult) -> float:
    """The objective at a point, from its definition."""
    weights, about = case.question.weights, model.about
    scale = max(group.widest_margin for group in case.groups)
    x, u, theta = found.trajectory.x, found.trajectory.u, found.trajectory.theta
    n = x.shape[1] // 2
    slacks = np.abs(found.fictitious).max(axis=1, initial=0.0)
    if case.epsilon is None:
        worth = found.margin - weights.fictitious * found.largest_fictitious
    else:
        worth, total = 0.0, 0.0
        for slack in slacks:  # the least g that C.6 allows
            total += max(float(slack), case.epsilon * total)
        worth = -weights.fictitious * total
    worth -= scale * weights.rates * float(np.sum(x[:, n:] ** 2))
    if model.mobility is not None:
        pushed = np.sum(model.mobility.by_q * (x - about.x)[:-1, :n])
        pushed += np.sum(model.mobility.by_theta @ (theta - about.theta))
        worth -= scale * weights.mobility * pushed
    if case.prices:
        worth -= scale * float(np.dot(case.prices, theta - about.theta))
    moves = np.sum((x - about.x)[:, :n] ** 2)
    moves += len(x) * np.sum(((theta - about.theta) / np.maximum(np.abs(about.theta), 0.1)) ** 2)
    paid = weights.position * found.position_slack + weights.quadratic * np.sum((u / scale) ** 2)
    return float(worth / scale - paid - case.proximal * moves)


def agree(case: Case, model: Model, rows: PositionRows, *, fictitious: bool) -> StepResult | None:
    """Both answers have the same optimum, or both have none."""
    found, wanted = (
        step.solve(model, rows, case.region, ACCURACY, fictitious=fictitious)
        for step in (ConvexStep(case.question), ReferenceStep(case.question))
    )
    if isinstance(wanted, NotSolved):
        assert wanted.status is Status.INFEASIBLE
        assert isinstance(found, NotSolved)
        assert found.status is Status.INFEASIBLE
        return None
    assert isinstance(found, StepResult)
    scale = 1 + abs(value(case, model, wanted))
    assert abs(value(case, model, found) - value(case, model, wanted)) < 1e-6 * scale
    assert found.position_slack == pytest.approx(wanted.position_slack, abs=1e-6 * scale)
    if case.epsilon is None:
        largest = pytest.approx(wanted.largest_fictitious, abs=1e-5 * scale)
        assert found.largest_fictitious == largest
        assert found.margin == pytest.approx(wanted.margin, abs=1e-4 * scale)
    if not fictitious:
        assert not found.fictitious.any()
        assert found.largest_fictitious == 0.0
    return found


@pytest.mark.parametrize("case", sorted(CASES))
def test_the_optimum_is_that_of_the_readable_formulation(case: str) -> None:
    chosen = CASES[case]
    for seed in range(1, 1 + examples(1, 2)):
        model = accelerated(linearised(seed), chosen.limits, seed)
        rows = end_in(model, chosen.offset)
        found = agree(chosen, model, rows, fictitious=True)
        assert found is not None
        without = agree(chosen, model, rows, fictitious=False)
        if case.startswith("far"):
            assert found.position_slack > 0.1
        if case.startswith(("a jump", "C.6")):
            assert found.largest_fictitious > 0.1
            assert without is None


@pytest.mark.parametrize("free", [False, True])
def test_three_links_about_another_trajectory_each_time(*, free: bool) -> None:
    """The structure is kept, and only numbers change: also those of the half-planes."""
    inf = np.full(3, np.inf)
    limits = MotionLimits(-inf, inf, -inf, inf, 0.3, 0.2, None)
    groups = (InputGroup((0, 1), -9.0, 9.0, norm2=False), InputGroup((2,), -4.0, 2.0, norm2=False))
    box = (np.full(3, 0.5), np.full(3, 5.0)) if free else None
    case = Case(limits, groups, 0.3, 0.4, box, 1e-2)
    step, reference = ConvexStep(case.question), ReferenceStep(case.question)
    for seed in range(4):
        model = linearised(seed, THREE)
        rows = end_in(model, 0.1 * seed)
        found, wanted = (
            each.solve(model, rows, case.region, ACCURACY) for each in (step, reference)
        )
        assert isinstance(found, StepResult)
        assert isinstance(wanted, StepResult)
        expected = value(case, model, wanted)
        assert value(case, model, found) == pytest.approx(expected, abs=1e-6 * (1 + abs(expected)))
        np.testing.assert_allclose(found.trajectory.x, wanted.trajectory.x, atol=1e-3)


@pytest.mark.parametrize("case", sorted(CASES))
def test_the_point_satisfies_every_constraint(case: str) -> None:
    """Each row of the problem, evaluated on the answer."""
    chosen = CASES[case]
    limits, groups, radius, box = chosen.limits, chosen.groups, chosen.radius, chosen.box
    model = accelerated(linearised(3), limits, 3)
    rows, about = end_in(model, chosen.offset), model.about
    found = ConvexStep(chosen.question).solve(model, rows, chosen.region, ACCURACY)
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
    assert found.margin >= -tolerance
    widest = max(group.widest_margin for group in groups)
    for group in groups:
        part = u[:, list(group.inputs)]
        room = found.margin * group.widest_margin / widest
        size = np.linalg.norm(part, axis=1) if group.norm2 else part.max(axis=1)
        assert np.all(size <= group.upper - room + tolerance)
        if group.kept.size:
            assert np.all(np.abs(part).max(axis=1) <= group.upper - group.kept + tolerance)
        assert group.norm2 or np.all(part >= group.lower + room - tolerance)
    first = 0 if limits.start_values is None else 1
    bound = x[first:, :2]
    assert np.all((x[:, :2] >= limits.lower - tolerance)[first:])
    assert np.all((x[:, :2] <= limits.upper + tolerance)[first:])
    assert np.all(x[:, 2:] >= limits.rate_lower - tolerance)
    assert np.all(x[:, 2:] <= limits.rate_upper + tolerance)
    assert np.abs(x[0, 2:]).max() <= limits.start_rates + tolerance
    assert np.abs(x[-1, 2:]).max() <= limits.final_rates + tolerance
    if model.rises is not None:
        moved = x[1:, 2:] - x[:-1, 2:]
        assert np.all(moved <= model.rises[0] + tolerance)
        assert np.all(moved >= -model.rises[1] - tolerance)
    if limits.start_values is not None:
        np.testing.assert_allclose(x[0, :2], limits.start_values, atol=tolerance)
    centre = np.clip(about.x[:, :2], limits.lower, limits.upper)[first:]
    assert np.abs(bound - centre).max() <= radius + tolerance
    if box is None:
        np.testing.assert_array_equal(theta, about.theta)
    else:
        assert np.all(np.abs(dp) <= radius * np.maximum(np.abs(about.theta), 0.1) + tolerance)
        assert np.all(theta >= box[0] - tolerance)
        assert np.all(theta <= box[1] + tolerance)


@pytest.mark.parametrize("epsilon", [1e-6, 0.2])
def test_slacks_by_step_under_c6(epsilon: float) -> None:
    """Problem 4: a jump at the start and an end out of reach, each to be paid for where it is."""
    small = (replace(GROUPS[0], lower=-0.5, upper=0.5),)
    for limits in (JUMP, replace(FREE, start_values=np.zeros(2), final_rates=0.0)):
        model = linearised(2)
        case = Case(limits, small, 0.4, 0.9, epsilon=epsilon)
        found = agree(case, model, end_in(model, 0.4), fictitious=True)
        assert found is not None
        assert np.abs(found.trajectory.u).max() <= 0.5 + 1e-6
        assert value(case, model, found) < -1


def crowded(model: Model, rows: PositionRows, count: int) -> PositionRows:
    """With many more half-planes, most far away: what points could reach is cut off by some."""
    rng = np.random.default_rng(count)
    samples, points = model.points.value.shape[:2]
    sample, point = rng.integers(0, samples, count), rng.integers(0, points, count)
    angle = rng.uniform(0, 2 * np.pi, count)
    normal = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    at = np.einsum("rd,rd->r", normal, model.points.value[sample, point])
    offset = at + rng.uniform(0.02, 2.0, count)
    return PositionRows(
        np.concatenate([rows.sample, sample]),
        np.concatenate([rows.point, point]),
        np.concatenate([rows.normal, normal]),
        np.concatenate([rows.offset, offset]),
    )


@pytest.mark.parametrize("free", [False, True])
def test_a_great_many_half_planes_are_all_kept(*, free: bool) -> None:
    """The optimum with a working set of them is that of all, about one trajectory after another."""
    case = Case(offset=0.2, radius=0.4, box=BOX if free else None, proximal=0.01)
    step, reference = ConvexStep(case.question), ReferenceStep(case.question)
    fewer, bound = 0, 0
    for seed in range(2):
        model = linearised(seed)
        rows = crowded(model, end_in(model, case.offset), 2 * FEW)
        found, wanted, loose = (
            each.solve(model, some, case.region, ACCURACY)
            for each, some in ((step, rows), (reference, rows),
                               (reference, end_in(model, case.offset)))
        )  # fmt: skip
        assert isinstance(found, StepResult)
        assert isinstance(wanted, StepResult)
        assert isinstance(loose, StepResult)
        expected = value(case, model, wanted)
        assert value(case, model, found) == pytest.approx(expected, abs=1e-6 * (1 + abs(expected)))
        fewer += step.working < len(rows.sample) / 2
        bound += value(case, model, loose) > expected + 1e-4
    assert fewer
    assert bound


def test_a_contradiction_is_not_an_optimum() -> None:
    """Start values that the trust region does not lead to, without fictitious inputs."""
    case = Case(replace(FREE, start_values=np.array([3.0, 3.0])), radius=0.1)
    assert agree(case, linearised(1), NONE, fictitious=False) is None
    found = agree(case, linearised(1), NONE, fictitious=True)
    assert found is not None
    assert found.largest_fictitious > 1


def test_the_dearer_rates_are_the_slower_is_the_motion() -> None:
    """By the theory of penalties: sums of squares fall, and so does the margin."""
    model = linearised(1)
    rows = end_in(model, 0.3)
    squares, margins = [], []
    for price in (0.0, 0.05, 0.5, 5.0):
        found = agree(Case(rates=price), model, rows, fictitious=True)
        assert found is not None
        squares.append(float(np.sum(found.trajectory.x[:, 2:] ** 2)))
        margins.append(found.margin)
    assert all(after < before for before, after in pairwise(squares))
    assert all(after <= before + 1e-6 for before, after in pairwise(margins))


def test_without_constraints_standing_still_is_best() -> None:
    x = np.zeros((STEPS + 1, 4))
    x[:, :2] = 0.3
    about = Trajectory(x, np.ones((STEPS, 2)), np.array([1.0, 0.5]))
    model = Model(
        about,
        NUMERIC.step(x[:-1], about.u, about.theta, DT, 1),
        NUMERIC.points(x[:, :2], about.theta),
        fictitious_inputs(NUMERIC, about, DT),
    )
    found = ConvexStep(Case().question).solve(model, NONE, TrustRegion(0.5))
    assert isinstance(found, StepResult)
    assert found.margin == pytest.approx(10.0, abs=1e-4)
    assert found.largest_fictitious == pytest.approx(0.0, abs=1e-6)


def test_a_unit_of_fictitious_input_is_the_effort_that_causes_it() -> None:
    """At rest, a unit torque held for a step moves q by B'_q and q' by B'_v, to first order."""
    theta, q = np.array([1.0, 0.5]), np.array([0.3, 0.4])
    about = Trajectory(np.tile([*q, 0.0, 0.0], (2, 1)), np.zeros((1, 2)), theta)
    matrix = fictitious_inputs(NUMERIC, about, DT)[0]
    mass, _, _ = chain_dynamics(theta, np.ones(2), q, np.zeros(2), (0, 0))
    np.testing.assert_allclose(matrix[:2, :2], DT**2 / 2 * np.linalg.inv(mass), rtol=1e-10)
    np.testing.assert_allclose(matrix[2:, 2:], DT * np.linalg.inv(mass), rtol=1e-10)
    assert not matrix[:2, 2:].any()
    assert not matrix[2:, :2].any()


def test_excess_is_signed() -> None:
    model = linearised(1)
    rows = end_in(model, 0.25)
    np.testing.assert_allclose(rows.excess(model.points), [0.25, 0.05, 0.01])
