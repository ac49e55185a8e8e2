"""Row 4.8: Theorem 2 takes a sum of slacks for a proof; a fictitious input hides in it."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import linprog

from solvers.trajectory.control import synthesise_control
from tests.oracles.turning_link import DT, INERTIA, one_link


def test_a_state_that_no_effort_reaches_is_called_robust() -> None:
    """x1 = x0 + u/10 + v with |u| <= 10, from 0 to 5: at most 1 is reached, and rho is 5."""
    # The unknowns are u, v, s_u, s_v: minimise s_u + s_v.
    rows = [[1, 0, -1, 0], [-1, 0, -1, 0], [0, 1, 0, -1], [0, -1, 0, -1]]
    found = linprog(
        [0, 0, 1, 1], A_ub=rows, b_ub=[10, 10, 0, 0], A_eq=[[0.1, 1, 0, 0]], b_eq=[5],
        bounds=[(None, None)] * 3 + [(0, None)],
    )  # fmt: skip
    assert -found.fun == pytest.approx(5)
    honest = linprog([-0.1], bounds=[(-10, 10)])
    assert -honest.fun == pytest.approx(1)


def hidden_robustness(bound: float, angle: float) -> float:
    """Definition 7 as printed, for one step from rest to rest: max of -(s_u + s_v).

    The unknowns are u, v_q, v_r with (h^2/2)(u + v_q) = angle and h (u + v_r) = 0, times inertia.
    """
    h = DT / INERTIA
    # minimise s_u + s_v  s.t.  |u| - bound <= s_u, |v_q|, |v_r| <= s_v.
    rows, level = [], []
    for column, slack, offset in ((0, 3, bound), (1, 4, 0.0), (2, 4, 0.0)):
        for sign in (1.0, -1.0):
            row = np.zeros(5)
            row[column], row[slack] = sign, -1.0
            rows.append(row)
            level.append(offset)
    equal = np.array([[DT * h / 2, DT * h / 2, 0, 0, 0], [h, 0, h, 0, 0]])
    found = linprog(
        [0, 0, 0, 1, 1], A_ub=np.array(rows), b_ub=level, A_eq=equal, b_eq=[angle, 0.0],
        bounds=[(None, None)] * 4 + [(0, None)],
    )  # fmt: skip
    assert found.status == 0
    return -float(found.fun)


def test_a_fictitious_input_cannot_hide_in_the_sum() -> None:
    """From rest to rest elsewhere in one step needs v whatever the effort."""
    angle, bound = 0.2, 1000.0
    assert hidden_robustness(bound, angle) > 0  # the printed criterion calls it robust
    problem, seed = one_link(1, bound, 0.0, angle)
    outcome = synthesise_control(problem, seed)
    assert not outcome.feasible
    # u + v_q = f and u + v_r = 0 with f = 2 I angle / dt^2: the least V is f / 2.
    least = INERTIA * angle / DT**2
    assert outcome.robustness == pytest.approx(-least, rel=1e-3)
    assert outcome.fictitious.max() == pytest.approx(least, rel=1e-3)
