"""By how much a margin is widened where disturbances outgrow it."""

from __future__ import annotations

import pytest

from solvers.structure_search import MARGINS, WIDEST, shortfall, wider_margin
from solvers.verifier.proofs.finding import Finding
from solvers.verifier.proofs.tube_checks import Status


def finding(margin: float, unit: str = "m", status: Status = Status.UNDECIDED) -> Finding:
    return Finding("something", status, margin, unit)


def test_the_largest_shortfall_counts() -> None:
    assert shortfall([finding(-0.01), finding(-0.03), finding(0.5, status=Status.HOLDS)]) == 0.03
    assert shortfall([finding(0.2, status=Status.HOLDS)]) == 0
    assert shortfall([finding(float("-inf"), "")]) == float("inf")


def test_limits_widen_faster_than_positions() -> None:
    assert shortfall([finding(-0.08, "rad")]) < shortfall([finding(-0.08)])


def test_a_margin_gets_as_wide_as_was_lacking() -> None:
    following = wider_margin(MARGINS[0], 0.2)
    assert following is not None
    assert following >= MARGINS[0] + 0.2
    assert wider_margin(MARGINS[-1], 0.2) == pytest.approx(following - MARGINS[0] + MARGINS[-1])


def test_a_step_is_never_smaller_than_without_disturbances() -> None:
    assert wider_margin(MARGINS[0], 1e-6) == MARGINS[1]
    assert [wider_margin(margin, 0) for margin in MARGINS] == [*MARGINS[1:], None]


def test_it_ends() -> None:
    assert wider_margin(MARGINS[0], float("inf")) is None
    margin: float | None = MARGINS[0]
    for _ in range(100):
        if margin is None:
            break
        margin = wider_margin(margin, 0.05)
    assert margin is None
    assert MARGINS[-1] < WIDEST
