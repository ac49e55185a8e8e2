"""Row 4.7: the robustness of Definition 7 maximises over the slacks, which nothing bounds above."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import linprog

from solvers.trajectory.control import synthesise_control
from tests.oracles.turning_link import ANGLE, DT, INERTIA, one_link

STEPS, BOUND, EPSILON = 3, 10.0, 0.01


def slack_program(sign: int) -> object:
    """Least (1) or greatest (-1) s_0^u + s_0^v under C.3 to C.6 for the inputs u = v = 0.

    The unknowns are the s^u of all steps, then the s^v.
    """
    rows, level = [], []
    for i in range(1, STEPS):
        row = np.zeros(2 * STEPS)
        row[:i] = row[STEPS : STEPS + i] = EPSILON
        row[i] = row[STEPS + i] = -1
        rows.append(row)
        level.append(0.0)
    cost = np.zeros(2 * STEPS)
    cost[0] = cost[STEPS] = sign
    bounds = [(-BOUND, None)] * STEPS + [(0, None)] * STEPS
    return linprog(cost, A_ub=np.array(rows), b_ub=level, bounds=bounds)


def test_the_inner_maximum_is_unbounded() -> None:
    unbounded, optimal = 3, 0
    assert slack_program(-1).status == unbounded
    least = slack_program(1)
    assert least.status == optimal
    assert least.fun == pytest.approx(-BOUND)


def test_as_one_program_it_is_the_margin_of_the_effort() -> None:
    """From rest to rest the least torque is that of two constant halves, 4 I angle / T^2."""
    problem, seed = one_link(8, BOUND, 0.0)
    outcome = synthesise_control(problem, seed)
    assert outcome.feasible
    peak = 4 * INERTIA * ANGLE / (8 * DT) ** 2
    assert outcome.robustness == pytest.approx(BOUND - peak, rel=1e-4)
