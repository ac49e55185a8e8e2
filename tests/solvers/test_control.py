"""Sequential convex programming on robots whose optimum is known otherwise."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import linprog

from compiler.discretisation.numeric_robot import NumericRobot
from compiler.dynamics.equations_of_motion import robot_graph
from solvers.trajectory.control import shortfall, synthesise_control
from solvers.trajectory.control_problem import (
    ControlOutcome,
    ControlProblem,
    Ending,
    effort_peak,
    input_margin,
)
from solvers.trajectory.linear_model import PositionRows
from solvers.trajectory.task_limits import InputGroup
from solvers.trajectory.trajectory import Trajectory
from tests.oracles.robots import rod_chain
from tests.oracles.turning_link import (
    ANGLE,
    DT,
    INERTIA,
    LENGTH,
    ONE,
    double_integrator,
    limits,
    one_link,
)


@pytest.mark.parametrize("steps", [8, 9, 16])
@pytest.mark.parametrize("rest", [True, False])
def test_the_least_peak_torque_of_a_double_integrator(steps: int, rest: bool) -> None:
    problem, seed = one_link(steps, 10.0, 0.0 if rest else np.inf)
    outcome = synthesise_control(problem, seed)
    peak = double_integrator(steps, rest, ANGLE)
    if rest and steps % 2 == 0:
        assert peak == pytest.approx(4 * INERTIA * ANGLE / (steps * DT) ** 2)  # bang-bang
    if not rest:
        assert peak == pytest.approx(2 * INERTIA * ANGLE / (steps * DT) ** 2)  # one constant
    assert outcome.feasible
    assert outcome.ending is Ending.FIXPOINT
    assert outcome.effort_peak == pytest.approx(peak, rel=1e-4)
    assert outcome.robustness == pytest.approx(10.0 - peak, rel=1e-4)


def test_an_input_with_one_value_only() -> None:
    """No margin is positive: the constant torque turns the link by u T^2 / 2 I, and rho is 0."""
    problem, seed = one_link(8, 1.0, np.inf)
    constant = 2 * INERTIA * 1.01 * ANGLE / (8 * DT) ** 2
    fixed = replace(problem, groups=(InputGroup((0,), constant, constant, norm2=False),))
    outcome = synthesise_control(fixed, seed)
    assert outcome.feasible
    assert outcome.trajectory.u == pytest.approx(constant)
    assert outcome.trajectory.x[-1, 0] == pytest.approx(1.01 * ANGLE)
    assert abs(outcome.robustness) < 1e-9


def test_rate_limits_raise_the_peak() -> None:
    problem, seed = one_link(16, 10.0, 0.0, rate_lower=np.array([-0.8]), rate_upper=np.array([0.8]))
    outcome = synthesise_control(problem, seed)
    peak = double_integrator(16, rest=True, reach=ANGLE, rate=0.8)
    assert peak > 1.01 * double_integrator(16, rest=True, reach=ANGLE)
    assert outcome.feasible
    assert outcome.effort_peak == pytest.approx(peak, rel=1e-4)
    assert np.abs(outcome.trajectory.x[:, 1]).max() < 0.8 + 1e-5


def check_motion(problem: ControlProblem, outcome: ControlOutcome) -> None:
    """A feasible outcome is a motion of the discretised robot within limits, reaching its rows."""
    at, numeric = outcome.trajectory, problem.numeric
    after = numeric.step(at.x[:-1], at.u, at.theta, problem.dt, problem.substeps).value
    np.testing.assert_allclose(at.x[1:], after, atol=1e-9)
    points = numeric.points(at.x[:, : numeric.n], at.theta)
    assert problem.rows(at, points).excess(points).max(initial=0.0) < 1e-5
    assert input_margin(problem.groups, at.u) >= 0
    assert outcome.robustness == pytest.approx(input_margin(problem.groups, at.u))
    bounds, n = problem.limits, numeric.n
    assert np.all(at.x[:, :n] <= bounds.upper + 1e-5)
    assert np.all(at.x[:, :n] >= bounds.lower - 1e-5)
    assert np.abs(at.x[0, n:]).max() <= bounds.start_rates + 1e-9
    assert np.abs(at.x[-1, n:]).max() <= bounds.final_rates + 1e-4


@pytest.mark.parametrize("share", [0.5, 0.95, 1.05, 2.0])
def test_feasible_exactly_from_the_least_peak_on(share: float) -> None:
    peak = double_integrator(8, rest=True, reach=ANGLE)
    problem, seed = one_link(8, share * peak, 0.0)
    outcome = synthesise_control(problem, seed)
    assert outcome.feasible == (share > 1)
    if outcome.feasible:
        check_motion(problem, outcome)
        assert outcome.robustness == pytest.approx((share - 1) * peak, abs=1e-3)
    else:
        assert outcome.robustness < 0
        least = least_fictitious(8, share * peak, ANGLE)
        assert outcome.robustness == pytest.approx(-least, rel=1e-3)


def least_fictitious(steps: int, bound: float, reach: float) -> float:
    """The least V from rest to rest over an angle of at least ``reach``, by an LP.

    The unknowns are the inputs, the fictitious inputs of angles and of rates, then V: after all
    steps the rate is sum_j h (u_j + v_rj), the angle
    sum_j (h^2 (k - j - 1) (u_j + v_rj) + h^2/2 (u_j + v_qj)), by the inertia.
    """
    h = DT / INERTIA
    later = np.array([DT * h * (steps - j - 1) for j in range(steps)])
    half, zero = np.full(steps, DT * h / 2), np.zeros(steps)
    place = np.concatenate([later + half, half, later, [0.0]])
    rate = np.concatenate([np.full(steps, h), zero, np.full(steps, h), [0.0]])
    above, level = [-place], [-reach]
    for column in range(steps, 3 * steps):
        for sign in (1.0, -1.0):
            row = np.zeros(3 * steps + 1)
            row[column], row[-1] = sign, -1.0
            above.append(row)
            level.append(0.0)
    bounds = [(-bound, bound)] * steps + [(None, None)] * (2 * steps + 1)
    found = linprog(
        np.append(np.zeros(3 * steps), 1.0), A_ub=np.array(above), b_ub=level,
        A_eq=rate[None, :], b_eq=[0.0], bounds=bounds,
    )  # fmt: skip
    assert found.status == 0
    return float(found.fun)


@pytest.mark.parametrize("norm2", [False, True])
def test_two_links_reach_a_height_at_rest(norm2: bool) -> None:
    numeric, steps = NumericRobot(robot_graph(rod_chain(2))), 16
    rows = PositionRows(
        np.array([steps, steps]), np.array([0, 0]), np.array([[0.0, -1.0], [1.0, 0.0]]),
        np.array([-0.9, 0.8]),
    )  # fmt: skip
    problem = ControlProblem(
        numeric, DT, 2, limits(2, 0.0), (InputGroup((0, 1), -10.0, 10.0, norm2),), lambda *_: rows
    )
    x = np.zeros((steps + 1, 4))
    x[:, :2] = np.linspace([0, 0], [0.9, 0.6], steps + 1)
    seed = Trajectory(x, np.zeros((steps, 2)), np.array([1.0, 0.5]))
    outcome = synthesise_control(problem, seed)
    assert outcome.feasible
    check_motion(problem, outcome)


def test_free_lengths_are_used() -> None:
    """One link: the torque falls with the length, so the shortest that reaches is best."""
    steps = 8
    height = 1.0
    rows = PositionRows(
        np.array([steps]), np.array([0]), np.array([[0.0, -1.0]]), np.array([-height])
    )
    problem = ControlProblem(
        ONE,
        DT,
        1,
        limits(1, np.inf),
        (InputGroup((0,), -10.0, 10.0, norm2=False),),
        lambda *_: rows,
    )
    x = np.stack([np.linspace(0, 0.8, steps + 1), np.full(steps + 1, 0.8)], axis=1)
    seed = Trajectory(x, np.zeros((steps, 1)), np.array([1.5]))
    outcome = synthesise_control(problem, seed, (np.array([0.5]), np.array([5.0])))
    lengths = np.linspace(1.0, 3.0, 20001)
    peaks = 2 * lengths**3 / 3 * np.arcsin(height / lengths) / (steps * DT) ** 2
    assert outcome.feasible
    assert 10 - outcome.robustness == pytest.approx(float(peaks.min()), rel=1e-3)
    assert outcome.trajectory.theta[0] == pytest.approx(lengths[peaks.argmin()], rel=0.02)
    fixed = synthesise_control(problem, seed)
    np.testing.assert_array_equal(fixed.trajectory.theta, [1.5])
    assert fixed.effort_peak > outcome.effort_peak


@pytest.mark.parametrize(
    "wrong",
    [{"rates": 1.0}, {"final": 1.0}],
)
def test_a_seed_that_breaks_the_limits_is_not_taken_for_a_solution(wrong: dict[str, float]) -> None:
    """A free motion needs no effort, but it neither starts nor ends at rest."""
    steps, rate = 8, 1.0
    problem, _ = one_link(
        steps, 10.0, 0.0 if "final" in wrong else np.inf, angle=0.9 * steps * DT * rate
    )
    if "final" in wrong:
        problem = replace(problem, limits=replace(problem.limits, start_rates=2.0))
    times = np.arange(steps + 1) * DT
    x = np.stack([times * rate, np.full(steps + 1, rate)], axis=1)
    seed = Trajectory(x, np.zeros((steps, 1)), np.array([LENGTH]))
    outcome = synthesise_control(problem, seed)
    assert outcome.feasible
    assert outcome.effort_peak > 0.1
    check_motion(problem, outcome)


def test_a_seed_outside_the_joint_limits_is_not_taken_for_a_solution() -> None:
    problem, _ = one_link(8, 10.0, np.inf, angle=0.5, upper=np.array([0.8]))
    times = np.arange(9) * DT
    x = np.stack([times, np.ones(9)], axis=1)
    problem = replace(problem, limits=replace(problem.limits, start_rates=1.0))
    outcome = synthesise_control(problem, Trajectory(x, np.zeros((8, 1)), np.array([LENGTH])))
    assert outcome.feasible
    assert outcome.trajectory.x[:, 0].max() < 0.8 + 1e-5


def test_margins_and_peaks_by_group() -> None:
    u = np.array([[3.0, -4.0, 1.0], [1.0, 2.0, -2.5]])
    groups = (InputGroup((0, 1), -6.0, 6.0, norm2=True), InputGroup((2,), -3.0, 3.0, norm2=False))
    # A sixth is left of either bound, and the widest margin is 6.
    assert input_margin(groups, u) == pytest.approx(1.0)
    wider = (groups[0], InputGroup((2,), -2.0, 4.0, norm2=False))
    assert input_margin(wider, u) == pytest.approx(6 * -0.5 / 3)
    fixed = (groups[0], InputGroup((2,), 1.0, 1.0, norm2=False))
    assert input_margin(fixed, u * [1, 1, 0] + [0, 0, 1]) == pytest.approx(1.0)
    assert input_margin(fixed, u) == pytest.approx(-3.5)
    assert effort_peak(groups, u) == pytest.approx(5.0)
    assert input_margin((InputGroup((0, 1), -6.0, 6.0, norm2=False),), u) == pytest.approx(2.0)
    assert input_margin((), u) == 0.0


def test_what_an_outcome_without_missing_forces_lacks() -> None:
    """Each condition of a motion is broken in turn, by itself or before those that follow."""
    problem, seed = one_link(8, 10.0, 0.0)
    outcome = synthesise_control(problem, seed)
    assert outcome.feasible
    lacks = replace(outcome, feasible=False)
    assert shortfall(problem, lacks) == "does not keep to these cells"
    lacks = replace(lacks, robustness=-1.0)
    # Nothing is broken before it is simulated.
    assert "is not what its inputs cause" in shortfall(problem, lacks)
    motion = outcome.trajectory

    def bent(sample: int, by: float) -> ControlOutcome:
        x = motion.x.copy()
        x[sample, 0] += by
        return replace(lacks, trajectory=replace(motion, x=x))

    assert "does not satisfy the equations of motion" in shortfall(problem, bent(4, -0.05))
    short = motion.x[-1, 0] - ANGLE + 0.001  # a row is in metres: the link is LENGTH long
    assert "mm of the margins" in shortfall(problem, bent(8, -short))
    low = replace(problem.limits, upper=np.array([motion.x[:, 0].max() - 0.01]))
    said = shortfall(replace(problem, limits=low), lacks)
    assert said == "passes a limit of a joint or a rate by 0.01 (SI)"
    broken = replace(motion, x=np.full_like(motion.x, np.nan))
    assert "no finite" in shortfall(problem, replace(lacks, trajectory=broken))


@pytest.mark.parametrize("norm2", [False, True])
def test_a_distance_that_is_kept_from_a_bound_is_no_part_of_the_margin(norm2: bool) -> None:
    """Rho is about the bound; what disturbances may add binds besides, step by step."""
    group = InputGroup((0, 1), -6.0, 6.0, norm2)
    spread = np.array([[3.0, 0.0, 9.0], [0.0, 4.0, 9.0], [50.0, 0.0, 0.0]])
    narrowed = group.narrowed(spread)
    np.testing.assert_allclose(narrowed.kept, [3.0, 4.0, 6.0])
    u = np.array([[2.0, 0.0], [0.0, -2.0], [0.0, 0.0]])
    assert narrowed.margin(u) == pytest.approx(group.margin(u)) == pytest.approx(4.0)
    u[0, 0] = 3.5
    assert group.margin(u) == pytest.approx(2.5)
    assert narrowed.margin(u) == pytest.approx(-0.5)
    np.testing.assert_allclose(narrowed.clipped(np.array([5.0, 0.0]), 0), [3.0, 0.0])
    np.testing.assert_allclose(narrowed.clipped(np.array([0.0, -5.0]), 1), [0.0, -2.0])
