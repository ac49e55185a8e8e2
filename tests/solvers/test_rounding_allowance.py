"""The allowance for rounding that a controller states: by hand, and within its bound."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from grammar_lang import ir
from grammar_lang.load import load_text
from solvers.search.closed_loop import rounding_allowance
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
    return [float(text) for text in rounding_allowance(MOTION, gains, rod_chain(2), of)]


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


def test_a_decimal_for_every_input() -> None:
    texts = rounding_allowance(MOTION, np.zeros_like(GAINS), rod_chain(2), task())
    assert texts == ("0.00000048", "0.00000024")
