"""Motions of robots that share parameters, where the best common values are known otherwise."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from fractions import Fraction
from itertools import product

import cvxpy as cp
import numpy as np
import pytest

from compiler.arrays import Array
from compiler.discretisation.numeric_robot import NumericRobot
from compiler.dynamics.equations_of_motion import robot_graph
from solvers.backends.conic import NotSolved
from solvers.trajectory.control import synthesise_control
from solvers.trajectory.control_problem import (
    ControlOutcome,
    ControlProblem,
    IterationBudget,
    measured,
)
from solvers.trajectory.convex_step import ConvexStep
from solvers.trajectory.linear_model import PositionRows
from solvers.trajectory.reference_step import _Step
from solvers.trajectory.shared_control import (
    SharedOutcome,
    SharedTask,
    merged,
    share_of,
    shared_control,
)
from solvers.trajectory.shared_step import OTHERS, SharedStep
from solvers.trajectory.subproblem import SubproblemSpec, TrustRegion, Weights
from solvers.trajectory.task_limits import InputGroup
from solvers.trajectory.trajectory import Trajectory
from tests.oracles.robots import rod_chain
from tests.oracles.turning_link import DT, beyond, limits, one_link

STEPS = 16
BOX = np.array([0.5]), np.array([3.0])
TWO = NumericRobot(robot_graph(rod_chain(2)))
HEAVY = NumericRobot(robot_graph(rod_chain(2), (Fraction(0), Fraction(-981, 100))))
BOTH = [[(0, 0), (1, 0)], [(0, 1), (1, 1)]]
QUICK = IterationBudget(15, 1e-3, 1e-8, 6, 1, 2e-3)


def half_plane(normal: Sequence[float], offset: float, sample: int = STEPS) -> PositionRows:
    return PositionRows(
        np.array([sample]), np.array([0]), np.array([normal], dtype=float), np.array([offset])
    )


def turned(bound: float, rows: PositionRows, length: float = 1.6) -> SharedTask:
    """One link that turns from rest to rest, from a length."""
    problem, start = one_link(STEPS, bound, 0.0)
    problem = replace(problem, rows_of=lambda *_: rows)
    return SharedTask(problem, replace(start, theta=np.array([length])), BOX)


def by_angle(bound: float, angle: float, length: float = 1.6) -> SharedTask:
    """The link turns by an angle at least, however long it is."""
    return turned(bound, half_plane((np.sin(angle), -np.cos(angle)), 0.0), length)


def to_height(bound: float, height: float, length: float = 1.6) -> SharedTask:
    """Its tip gets to a height at least."""
    return turned(bound, beyond(STEPS, np.pi / 2, height), length)


def check_links(found: SharedOutcome, links: Sequence[Sequence[tuple[int, int]]]) -> None:
    for link in links:
        values = {found.trajectories[k].theta[i].tobytes() for k, i in link}
        assert len(values) == 1


def check_motions(tasks: Sequence[SharedTask], found: SharedOutcome) -> None:
    """Every outcome is a motion of its own robot, within its rows, box and bounds."""
    for task, outcome, share in zip(tasks, found.outcomes, found.shares, strict=True):
        problem, at = task.problem, outcome.trajectory
        numeric = problem.numeric
        after = numeric.step(at.x[:-1], at.u, at.theta, problem.dt, problem.substeps).value
        np.testing.assert_allclose(at.x[1:], after, atol=1e-8)
        points = numeric.points(at.x[:, : numeric.n], at.theta)
        assert problem.rows(at, points).excess(points).max() < 5e-4
        assert np.all(at.theta >= task.box[0])
        assert np.all(at.theta <= task.box[1])
        (group,) = problem.groups
        assert share == pytest.approx(1 - np.max(np.abs(at.u)) / group.upper, abs=1e-9)


# --- one link: lengths in closed form -------------------------------------------------------------


@pytest.mark.parametrize("lengths", [(1.6, 1.6), (1.5, 1.9), (2.5, 2.6)])
def test_the_length_at_which_two_tasks_are_as_hard_as_each_other(
    lengths: tuple[float, float],
) -> None:
    """The least peak torque from rest to rest by an angle a is 4 (l^3/3) a / T^2 (bang-bang).

    The first task wants a short link; the second is harder for a shorter one near its height h,
    since its angle is asin(h / l).  Both have the same share where asin(h / l) = a b2 / b1.
    """
    height, angle, bounds = 1.4, 1.0, (10.0, 14.0)
    tasks = [
        by_angle(bounds[0], angle, lengths[0]),
        to_height(bounds[1], height, lengths[1]),
    ]
    found = shared_control(tasks, [[(0, 0), (1, 0)]])
    assert found is not None
    assert found.feasible
    length = height / np.sin(angle * bounds[1] / bounds[0])
    share = 1 - 4 * angle * length**3 / (3 * (STEPS * DT) ** 2 * bounds[0])
    assert found.share == pytest.approx(share, rel=1e-5)
    assert found.trajectories[0].theta[0] == pytest.approx(length, rel=1e-4)
    assert found.robustness == pytest.approx([share * bound for bound in bounds], rel=1e-4)
    check_links(found, [[(0, 0), (1, 0)]])
    check_motions(tasks, found)


def test_one_task_decides_where_it_is_harder_anyhow() -> None:
    """The other then has the length that is best for the first: the root of 3 x = tan x, x its
    angle, from the derivative of l^3 asin(h / l)."""
    height = 1.4
    tasks = [by_angle(1000.0, 0.5), to_height(10.0, height)]
    found = shared_control(tasks, [[(0, 0), (1, 0)]])
    assert found is not None
    x = 1.3
    for _ in range(50):
        x -= (3 * x - np.tan(x)) / (3 - 1 / np.cos(x) ** 2)
    length = height / np.sin(x)
    share = 1 - 4 * x * length**3 / (3 * (STEPS * DT) ** 2 * 10.0)
    assert found.share == pytest.approx(share, rel=1e-5)
    assert found.trajectories[1].theta[0] == pytest.approx(length, rel=2e-3)  # it is flat there


def test_no_length_for_both() -> None:
    """The first needs two metres to get to its height, the second one metre to begin."""
    tasks = [to_height(50.0, 2.0), turned(50.0, half_plane((1.0, 0.0), 1.0, sample=0))]
    for apart in tasks:
        assert synthesise_control(apart.problem, apart.start, apart.box).feasible
    found = shared_control(tasks, [[(0, 0), (1, 0)]], QUICK)
    assert found is not None
    assert not found.feasible
    assert found.share < 0
    check_links(found, [[(0, 0), (1, 0)]])


def test_ranges_without_a_common_value() -> None:
    short = replace(by_angle(10.0, 1.0), box=(np.array([0.5]), np.array([1.0])))
    long = replace(by_angle(10.0, 1.0), box=(np.array([2.0]), np.array([3.0])))
    assert shared_control([short, long], [[(0, 0), (1, 0)]]) is None


def test_a_box_binds_all_that_it_is_linked_to() -> None:
    """Both want short links; the second may not have less than 1.2 m."""
    tasks = [by_angle(10.0, 1.0), replace(by_angle(20.0, 1.0), box=(np.array([1.2]), BOX[1]))]
    found = shared_control(tasks, [[(0, 0), (1, 0)]])
    assert found is not None
    assert found.trajectories[0].theta[0] == pytest.approx(1.2, abs=1e-6)
    check_motions([tasks[1], tasks[1]], replace(found, outcomes=found.outcomes[1:] * 2,
                                                shares=found.shares[1:] * 2))  # fmt: skip


def test_inputs_with_one_value_say_nothing_of_the_least_share() -> None:
    """A torque that is given turns one link; the other is as robust as if alone."""
    free = by_angle(10.0, 1.0, 1.3)
    alone = synthesise_control(free.problem, free.start, (np.array([1.2]), np.array([3.0])))
    problem, start = one_link(STEPS, 1.0, np.inf)
    constant = 2 * (1.5**3 / 3) * 1.0 / (STEPS * DT) ** 2
    given = replace(
        problem,
        groups=(InputGroup((0,), constant, constant, norm2=False),),
        rows_of=lambda *_: half_plane((np.sin(0.9), -np.cos(0.9)), 0.0),
    )
    box = np.array([1.2]), np.array([3.0])
    tasks = [free, SharedTask(given, replace(start, theta=np.array([1.3])), box)]
    found = shared_control(tasks, [[(0, 0), (1, 0)]])
    assert found is not None
    assert found.feasible
    assert found.shares[1] == 1.0
    assert found.share == pytest.approx(alone.robustness / 10.0, rel=1e-4)


# --- what belongs together ------------------------------------------------------------------------


def test_one_problem_alone_is_solved_as_always() -> None:
    task = to_height(10.0, 1.4)
    found = shared_control([task], [])
    ordinary = synthesise_control(task.problem, task.start, task.box)
    assert found is not None
    check_same(found.outcomes[0], ordinary)


def check_same(one: ControlOutcome, other: ControlOutcome) -> None:
    assert one.robustness == other.robustness
    for array in ("x", "u", "theta"):
        np.testing.assert_array_equal(
            getattr(one.trajectory, array), getattr(other.trajectory, array)
        )


def test_the_same_problem_twice_is_as_robust_as_once() -> None:
    task = to_height(10.0, 1.4)
    found = shared_control([task, task], [[(0, 0), (1, 0)]])
    ordinary = synthesise_control(task.problem, task.start, task.box)
    assert found is not None
    assert found.shares == pytest.approx([ordinary.robustness / 10.0] * 2, rel=1e-5)


def test_problems_without_links_are_solved_apart() -> None:
    """Of three, the outer two share their length; the one in between is as if alone."""
    tasks = [by_angle(10.0, 1.0), to_height(9.0, 1.3), to_height(14.0, 1.4)]
    found = shared_control(tasks, [[(0, 0), (2, 0)]])
    outer = shared_control([tasks[0], tasks[2]], [[(0, 0), (1, 0)]])
    assert found is not None
    assert outer is not None
    own = synthesise_control(tasks[1].problem, tasks[1].start, tasks[1].box)
    check_same(found.outcomes[1], own)
    check_same(found.outcomes[0], outer.outcomes[0])
    check_same(found.outcomes[2], outer.outcomes[1])
    assert found.trajectories[1].theta[0] != found.trajectories[0].theta[0]


def test_links_that_meet_are_one() -> None:
    assert merged([[(0, 0), (1, 1)], [(2, 0)], [(3, 0), (2, 1)], [(1, 1), (2, 1)]]) == (
        ((0, 0), (1, 1), (2, 1), (3, 0)),
    )


def test_a_link_to_no_parameter() -> None:
    task = by_angle(10.0, 1.0)
    with pytest.raises(ValueError, match="without such a parameter"):
        shared_control([task, task], [[(0, 0), (1, 1)]])


# --- two links: against the values all over a grid ------------------------------------------------


def reached(
    numeric: NumericRobot, bound: float, places: tuple[Array, Array], theta: Sequence[float],
    *, norm2: bool = False,
) -> SharedTask:  # fmt: skip
    """An arm from rest at a given pose to a place of its tip, from given lengths.

    The first place is that of the coordinates (2,), the second a corner that the tip ends beyond.
    """
    pose, corner = places
    outward = corner / np.linalg.norm(corner)
    aside = np.array([-outward[1], outward[0]])
    rows = PositionRows(
        np.full(3, STEPS), np.zeros(3, dtype=np.int64), np.array([-outward, aside, -aside]),
        np.array([-np.linalg.norm(corner), 0.1, 0.1]),
    )  # fmt: skip
    bounds = replace(limits(2, 0.0), start_values=pose)
    group = InputGroup((0, 1), -bound, bound, norm2=norm2)
    problem = ControlProblem(numeric, DT, 2, bounds, (group,), lambda *_: rows)
    x = np.zeros((STEPS + 1, 4))
    x[:, :2] = pose
    start = Trajectory(x, np.zeros((STEPS, 2)), np.array(theta))
    return SharedTask(problem, start, (np.full(2, 0.4), np.full(2, 1.6)))


def arms(
    numeric: NumericRobot, bounds: tuple[float, float], *, norm2: bool = False
) -> list[SharedTask]:
    """Two tasks that want different arms, l1 and l2 unlike each other."""
    near = np.array([0.3, 1.6]), np.array([0.5, 0.6])
    far = np.array([-0.5, 0.9]), np.array([1.3, 0.9])
    return [
        reached(numeric, bounds[0], near, (1.1, 0.7), norm2=norm2),
        reached(numeric, bounds[1], far, (1.0, 0.8), norm2=norm2),
    ]


def share_at(tasks: Sequence[SharedTask], theta: Array, starts: Sequence[Trajectory]) -> float:
    """The least share of both tasks for given lengths, each solved alone from its start."""
    found = [
        synthesise_control(task.problem, replace(start, theta=theta))
        for task, start in zip(tasks, starts, strict=True)
    ]
    return min(share_of(task.problem, each) for task, each in zip(tasks, found, strict=True))


GRID = [np.array(pair) for pair in product(np.linspace(0.4, 1.6, 7), repeat=2)]
MOVES = list(product((-0.03, 0, 0.03), repeat=2))


def check_around(tasks: Sequence[SharedTask], found: SharedOutcome) -> None:
    """Lengths of three per cent more or less are no better, in turn or together."""
    check_links(found, BOTH)
    check_motions(tasks, found)
    theta = found.trajectories[0].theta
    assert abs(theta[0] - theta[1]) > 0.05
    around = [np.clip(theta * (1 + np.array(move)), 0.4, 1.6) for move in MOVES]
    values = [share_at(tasks, each, found.trajectories) for each in around]
    assert max(values) <= found.share + 1e-3


def test_no_lengths_of_a_grid_are_better() -> None:
    tasks = arms(TWO, (0.8, 1.2))
    found = shared_control(tasks, BOTH)
    assert found is not None
    assert found.feasible
    values = [share_at(tasks, theta, found.trajectories) for theta in GRID]
    assert sum(value >= 0 for value in values) > 10
    assert 0.9 * found.share < max(values) <= found.share + 1e-3
    check_around(tasks, found)


def test_under_gravity_the_best_lengths_of_a_grid_are_made_better() -> None:
    """There are several locally best arms: the nearest one to the best of the grid."""
    tasks = arms(HEAVY, (6.0, 8.0))
    values = [share_at(tasks, theta, [task.start for task in tasks]) for theta in GRID]
    theta = GRID[int(np.argmax(values))]
    begun = [replace(task, start=replace(task.start, theta=theta)) for task in tasks]
    found = shared_control(begun, BOTH)
    assert found is not None
    assert found.feasible
    assert max(values) > 0
    assert found.share > max(values) + 0.01
    check_around(tasks, found)


def test_one_length_is_shared_and_the_other_is_not() -> None:
    """From an arm for both tasks, each gets a second link of its own; that is no worse."""
    tasks, links = arms(TWO, (0.8, 1.2)), [[(0, 0), (1, 0)]]
    both = shared_control(tasks, BOTH, QUICK)
    assert both is not None
    assert both.feasible
    begun = [
        replace(task, start=motion) for task, motion in zip(tasks, both.trajectories, strict=True)
    ]
    found = shared_control(begun, links, QUICK)
    assert found is not None
    assert found.feasible
    check_links(found, links)
    check_motions(tasks, found)
    assert found.trajectories[0].theta[1] != found.trajectories[1].theta[1]
    assert found.share > both.share + 0.01


def test_torques_that_are_bound_together() -> None:
    """Programs with cones go another way: no worse than bounds one by one that are inside."""
    tasks = arms(TWO, (0.8, 1.2), norm2=True)
    found = shared_control(tasks, BOTH, QUICK)
    assert found is not None
    assert found.feasible
    check_links(found, BOTH)
    for task, motion, share in zip(tasks, found.trajectories, found.shares, strict=True):
        peak = np.max(np.linalg.norm(motion.u, axis=1))
        assert share == pytest.approx(1 - peak / task.problem.groups[0].upper, abs=1e-9)


def test_it_is_the_same_each_time() -> None:
    one, other = (shared_control(arms(TWO, (0.8, 1.2)), BOTH, QUICK) for _ in range(2))
    assert one is not None
    assert other is not None
    for first, second in zip(one.outcomes, other.outcomes, strict=True):
        check_same(first, second)


# --- one step: against the program as it is on paper ----------------------------------------------


def test_a_shared_step_is_that_of_the_written_program() -> None:
    tasks = arms(HEAVY, (25.0, 40.0))
    tasks = [replace(task, start=replace(task.start, theta=np.array([1.0, 0.8]))) for task in tasks]
    region = TrustRegion(0.3, 1e-2)
    about = [measured(task.problem, task.start) for task in tasks]
    motions = [at for at in about if at is not None]
    questions = [
        SubproblemSpec(task.problem.limits, task.problem.groups, task.box, Weights())
        for task in tasks
    ]
    step = SharedStep(tuple(ConvexStep(question) for question in questions), tuple(merged(BOTH)))
    own = step.solve(motions, [region] * 2, 1e-10, [True, True])
    assert not isinstance(own, NotSolved)
    written = [
        _Step(question, at.model, at.rows, region, fictitious=True)
        for question, at in zip(questions, motions, strict=True)
    ]
    share, least = (
        cp.Variable(nonneg=True),
        min(each.margin / question.scale for each, question in zip(own, questions, strict=True)),
    )
    objective: cp.Expression = share
    constraints = [written[0].theta == written[1].theta]
    for part in written:
        scale = part.question.scale
        objective += part.objective() - (1 - OTHERS) * part.rho / scale
        constraints += [*part.constraints(), share <= part.rho / scale]
    problem = cp.Problem(cp.Maximize(objective), constraints)
    problem.solve(solver="CLARABEL")
    assert problem.status == cp.OPTIMAL
    optimum = float(problem.value)
    assert least == pytest.approx(float(share.value), abs=1e-4)
    # Rates hardly count: the two points differ in them, and their values do not.
    share.value = least
    for result, part in zip(own, written, strict=True):
        at = result.trajectory
        part.x.value, part.u.value, part.theta.value = at.x, at.u, at.theta
        part.v.value, part.largest.value = result.fictitious, result.largest_fictitious
        part.sigma.value, part.rho.value = result.position_slack, result.margin
        part.g.value = np.zeros(STEPS)
    assert max(float(np.max(each.violation())) for each in constraints) < 1e-6
    assert float(objective.value) == pytest.approx(optimum, rel=1e-6)
