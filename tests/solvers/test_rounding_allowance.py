"""The allowance for rounding that a controller states: by hand, and within its bound."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from grammar_lang import ir
from grammar_lang.load import load_text
from solvers.trajectory.rounding_allowance import rounding_allowance
from solvers.trajectory.trajectory import Trajectory
from tests.oracles.robots import rod_chain
from tests.oracles.small_specs import CLOSED, replaced

MOTION = Trajectory(
    np.array([[1.0, -2.0, 0.5, 0.0], [0.0, 3.0, 0.0, 0.0], [9.0, 9.0, 9.0, 9.0]]),
    np.array([[4.0, -1.0], [0.0, 2.0]]),
    np.zeros(0),
)
GAINS = np.array(
    [
        [[10.0, 0.0, 1.0, 0.0], [0.0, 0.0, 0.0, 0.0]],
        [[0.0, -20.0, 0.0, 2.0], [0.0, 0.0, 0.0, 5.0]],
    ]
)
# |u| + sum of |K| (2 |x| + 1), of the two samples; the last state is not measured.
NEEDED = (max(4 + 10 * 3 + 2, 20 * 7 + 2), max(1, 2 + 5))


def task(text: str = CLOSED) -> ir.Task:
    program = load_text(text, "spec.srg").program
    assert program is not None
    (found,) = program.tasks.values()
    return found


def allowed(gains: np.ndarray, of: ir.Task) -> list[float]:
    found: list[float] = rounding_allowance(MOTION, gains, rod_chain(2), of).tolist()
    return found


@pytest.mark.parametrize(("digits", "robust"), [(24, True), (53, False)])
def test_twice_what_a_precision_rounds(digits: int, robust: bool) -> None:
    of = task() if robust else replace(task(), robust=None)
    expected = [2 * needed * 2.0**-digits for needed in NEEDED]
    assert allowed(GAINS, of) == pytest.approx(expected, rel=0.05)


def test_no_more_than_a_part_of_the_bound() -> None:
    """Of 10 N*m, or of 4 N*m for the norm."""
    assert allowed(1e4 * GAINS, task()) == [1e-3, 1e-3]
    norm = replaced(CLOSED, "effort <= 10 N*m;", "effort <= 4 N*m norm 2;")
    assert allowed(1e4 * GAINS, task(norm)) == [4e-4, 4e-4]


def test_without_gains_the_inputs_themselves_are_rounded() -> None:
    assert allowed(np.zeros_like(GAINS), task()) == [2 * 4 * 2.0**-24, 2 * 2 * 2.0**-24]


def test_turns_are_taken_off_an_angle_that_winds() -> None:
    """The second joint is up to 3 rad away: one turn, and one more, and the last one it may be."""
    found = rounding_allowance(MOTION, GAINS, rod_chain(2), task(), np.array([False, True]))
    more = 6 * 2 * np.pi * (2 + 1)
    needed = (max(4 + 10 * 3 + 2, 20 * (7 + more) + 2), max(1, 2 + 5))
    assert found.tolist() == pytest.approx([2 * each * 2.0**-24 for each in needed])
