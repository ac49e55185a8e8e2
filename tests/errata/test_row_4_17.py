"""Row 4.17: C.6 on negative slacks caps the robustness of a robust robot."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import linprog

from solvers.trajectory.control import synthesise_control
from solvers.trajectory.linear_model import PositionRows
from tests.oracles.turning_link import one_link

BOUND, EPSILON = 10.0, 0.01


def printed_robustness(steps: int, epsilon: float | None) -> float:
    """The largest -max s_i of a robot that needs no effort: |u_i| <= ubar + s_i with u = 0.

    The unknowns are the slacks, then their maximum.
    """
    rows = [np.append(unit, -1.0) for unit in np.eye(steps)]
    for i in range(1, steps):
        if epsilon is not None:
            row = np.zeros(steps + 1)
            row[:i], row[i] = epsilon, -1.0
            rows.append(row)
    found = linprog(
        np.append(np.zeros(steps), 1.0), A_ub=np.array(rows), b_ub=np.zeros(len(rows)),
        bounds=[(-BOUND, None)] * steps + [(None, None)],
    )  # fmt: skip
    assert found.status == 0
    return -float(found.fun)


@pytest.mark.parametrize("steps", [2, 3, 81])
def test_as_printed_a_hundredth_of_the_margin_is_left(steps: int) -> None:
    assert printed_robustness(steps, None) == pytest.approx(BOUND)
    assert printed_robustness(steps, EPSILON) == pytest.approx(EPSILON * BOUND)


def test_a_robot_that_needs_no_effort_has_its_whole_margin() -> None:
    """At rest, with nothing asked of it."""
    problem, seed = one_link(8, BOUND, 0.0)
    nowhere = PositionRows(
        np.zeros(0, dtype=np.int64), np.zeros(0, dtype=np.int64), np.zeros((0, 2)), np.zeros(0)
    )
    still = replace(seed, x=np.zeros_like(seed.x))
    outcome = synthesise_control(replace(problem, rows_of=lambda *_: nowhere), still)
    assert outcome.feasible
    assert outcome.robustness == pytest.approx(BOUND, rel=1e-6)


def test_a_robot_that_needs_some_has_the_rest() -> None:
    problem, seed = one_link(8, BOUND, np.inf)
    outcome = synthesise_control(problem, seed)
    first = abs(float(outcome.trajectory.u[0, 0]))
    assert outcome.robustness > 10 * EPSILON * (BOUND - first)
