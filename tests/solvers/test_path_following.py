"""Limits and substeps of a path problem, against arithmetic and a precise integrator."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import solvers.trajectory.path_following
from compiler.discretisation.numeric_robot import NumericRobot
from compiler.dynamics.equations_of_motion import robot_graph
from compiler.robots.normal_form import family_of
from compiler.workspaces.abstraction import abstract
from grammar_lang.load import load
from solvers.trajectory.control_problem import ControlOutcome, limit_excess
from solvers.trajectory.disturbance_spread import DisturbanceSpread
from solvers.trajectory.fine_motion import BEYOND, inset, refined, unstable
from solvers.trajectory.path_following import LIMIT_MARGIN, PathProblem
from solvers.trajectory.task_limits import motion_limits
from solvers.trajectory.task_size import LEAST_MARGIN
from solvers.trajectory.trajectory import Trajectory
from tests.oracles.small_specs import TURNER

WORD = ("tool", "link", "joint", "base")


def path_problem(tmp_path, *changes):
    text = TURNER
    for before, after in changes:
        assert before in text
        text = text.replace(before, after)
    path = tmp_path / "spec.srg"
    path.write_text(text, encoding="utf-8")
    program = load(path).program
    (task,) = program.tasks.values()
    workspace = program.workspaces[task.workspace]
    family = family_of(program, task)
    model = family.robot(family.replay(WORD))
    numeric = NumericRobot(robot_graph(model, task.gravity))
    cells = abstract(workspace)
    return PathProblem(numeric, workspace, task, cells, 0, (cells.index("S"),), LEAST_MARGIN, 0)


def test_limits_are_kept_at_a_distance_that_grows_with_the_margin(tmp_path):
    plain = path_problem(tmp_path)
    least = motion_limits(plain.model, plain.task, plain.limit_margin)
    assert least.upper[0] == pytest.approx(np.pi - LIMIT_MARGIN)
    wide = plain.with_margin(4e-2)
    wider = motion_limits(plain.model, plain.task, wide.limit_margin)
    assert np.pi - 0.3 < wider.upper[0] < least.upper[0]
    assert wider.lower[0] == pytest.approx(-wider.upper[0])


def test_a_narrow_range_is_never_turned_inside_out(tmp_path):
    narrow = path_problem(tmp_path, ("[-180, 180] deg", "[0.3, 0.301]"))
    limits = motion_limits(narrow.model, narrow.task, 0.5)
    assert 0.3 < limits.lower[0] < limits.upper[0] < 0.301
    fixed = path_problem(tmp_path, ("[-180, 180] deg", "[0.3, 0.3]"))
    limits = motion_limits(fixed.model, fixed.task, 0.5)
    assert limits.lower[0] == limits.upper[0] == pytest.approx(0.3)


def test_limits_are_narrowed_by_what_proofs_lack(tmp_path):
    """More than the usual share of a range where a proof lacked more than that."""
    plain = path_problem(tmp_path)
    lacks = np.array([[[2.0], [0.0]]])
    usual = inset(plain, lacks).limits
    assert usual.upper[0] == pytest.approx(0.8 * np.pi)
    wide = replace(inset(plain, lacks), narrowing=0.4).limits
    assert wide.upper[0] == pytest.approx(np.pi - min(0.8 * np.pi, BEYOND * 2.0 + LIMIT_MARGIN))
    assert wide.lower[0] == pytest.approx(-wide.upper[0])


def test_substeps_are_refined_until_the_integration_is_accurate(tmp_path):
    """A rod hanging in strong gravity, held over coarse steps, against DOP853."""
    swing = path_problem(
        tmp_path,
        ("  horizon 10 steps of 0.2 s", "  gravity (0, -40) m/s^2;\n  horizon 10 steps of 0.5 s"),
    )
    theta, k = np.array([1.2]), 10
    u = np.linspace(-3, 3, k)[:, None]
    still = Trajectory(np.zeros((k + 1, 2)), u, theta)
    fine = refined(swing, still)
    assert fine.substeps > swing.substeps
    inertia, pull = 1.2**3 / 3, 1.2 * 40 * 0.6
    state = np.zeros(2)
    for row in u:
        torque = row[0]
        answer = solve_ivp(
            lambda _t, x, torque=torque: [x[1], (torque - pull * np.cos(x[0])) / inertia],
            (0, 0.5), state, method="DOP853", rtol=1e-11, atol=1e-12,
        )  # fmt: skip
        state = answer.y[:, -1]
    ends = [
        swing.numeric.simulate(np.zeros(2), u, theta, 0.5, substeps)[-1]
        for substeps in (swing.substeps, fine.substeps)
    ]
    coarse_error, fine_error = (np.abs(end - state).max() for end in ends)
    assert fine_error < 1e-3 < coarse_error


def test_a_motion_that_errors_carry_away_is_unstable_but_not_with_feedback(tmp_path):
    """An upright rod in strong gravity: errors grow by e^12 a second, by linearisation.

    Two seconds later the whole rod is off; feedback sees every step for itself.
    """
    upright = path_problem(
        tmp_path,
        ("  horizon 10 steps of 0.2 s", "  gravity (0, -120) m/s^2;\n  horizon 10 steps of 0.2 s"),
    )
    theta, k = np.array([1.2]), 10
    x = np.tile([np.pi / 2, 0.0], (k + 1, 1))
    x[:, 0] += 1e-3
    tilted = Trajectory(x, np.zeros((k, 1)), theta)
    assert unstable(upright, tilted)
    assert not unstable(replace(upright, feedback=True, substeps=32), tilted)
    hanging = Trajectory(np.tile([-np.pi / 2, 0.0], (k + 1, 1)), np.zeros((k, 1)), theta)
    assert not unstable(upright, hanging)


def test_a_gentle_motion_keeps_its_substeps(tmp_path):
    plain = path_problem(tmp_path)
    still = Trajectory(np.zeros((11, 2)), np.full((10, 1), 0.1), np.array([1.5]))
    assert refined(plain, still).substeps == plain.substeps


def test_an_outcome_that_is_no_number_counts_as_the_worst(tmp_path, monkeypatch):
    plain = path_problem(tmp_path)
    seed = Trajectory(np.zeros((11, 2)), np.zeros((10, 1)), np.array([1.5]))
    broken = ControlOutcome(seed, True, np.nan, 0.0, np.zeros(10), 0.0, 1, "diverged")
    monkeypatch.setattr(
        solvers.trajectory.path_following, "synthesise_control", lambda *_a, **_k: broken
    )
    outcome = plain.solve(seed, (0,))
    assert not outcome.feasible
    assert outcome.robustness == -100.0  # ten times the effort bound


def test_limits_and_bounds_of_inputs_are_narrowed_sample_by_sample(tmp_path):
    """A bump of 0.2 rad, 0.3 rad/s and 4 N m in the middle is not felt at the ends."""
    plain = path_problem(tmp_path)
    k = plain.task.steps
    states, inputs = np.zeros((k + 1, 1, 2)), np.zeros((k, 1))
    states[5, 0], inputs[5] = (0.2, 0.3), 4.0
    spread = DisturbanceSpread(np.zeros((k + 1, 1)), states, inputs)
    narrow, wide = replace(plain, spread=spread), plain.limits
    least = np.pi - LIMIT_MARGIN
    np.testing.assert_allclose(wide.upper, [least])
    lower, upper = (np.full((k + 1, 1), end) for end in (-least, least))
    lower[4:7], upper[4:7] = -least + 0.2, least - 0.2
    np.testing.assert_allclose(narrow.limits.lower, lower)
    np.testing.assert_allclose(narrow.limits.upper, upper)
    assert narrow.limits.joints == 1
    np.testing.assert_allclose(narrow.limits.box, ([-least + 0.2], [least - 0.2]))
    # A motion at 3.1 rad keeps to the limits but where disturbed ones would not.
    x = np.zeros((k + 1, 2))
    x[0, 0] = x[10, 0] = 3.1
    assert limit_excess(narrow.limits, x) == 0
    x[6, 0] = 3.1
    assert limit_excess(narrow.limits, x) == pytest.approx(3.1 - least + 0.2)
    (group,) = narrow.groups
    u = np.full((k, 1), 9.0)
    u[5] = 6.0
    assert group.margin(u) == pytest.approx(1.0)
    u[5] = 6.5
    assert group.margin(u) == pytest.approx(-0.5)
