"""How much more tightening a motion is given where a proof did not go through."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from grammar_lang.load import load
from solvers.run_context import RunContext
from solvers.search.constraint_tightening import (
    MOST_NARROWING,
    WIDENINGS,
    WIDEST,
    ConstraintTightening,
    missing_at_limits,
    missing_margin,
    without_limits,
)
from solvers.search.synthesis import synthesise
from solvers.trajectory.disturbance_spread import DisturbanceSpread
from solvers.verifier.proofs.checked_condition import CheckedCondition
from solvers.verifier.proofs.tube_checks import Status
from tests.oracles.small_specs import QUICK_TURN

SPREAD = DisturbanceSpread(
    np.array([[0.0], [0.01], [0.04]]), np.array([[[0.0, 0.1]], [[0.02, 0.1]], [[0.01, 0.0]]])
)


def finding(margin: float, unit: str = "m", status: Status = Status.UNDECIDED) -> CheckedCondition:
    return CheckedCondition("something", status, margin, unit)


def test_the_largest_lack_counts_as_a_part_of_the_tightening() -> None:
    held = finding(0.5, status=Status.HOLDS)
    assert missing_margin([finding(-0.01), finding(-0.03), held], SPREAD) == pytest.approx(0.75)
    assert missing_margin([held], SPREAD) == 0
    assert missing_margin([finding(float("-inf"), "")], SPREAD) == float("inf")
    # Limits of coordinates and rates are held against the spread of those.
    assert missing_margin([finding(-0.05, "rad")], SPREAD) == pytest.approx(0.5)
    # Those of the rates at the end, against what they spread there: whatever their unit.
    resting = DisturbanceSpread(np.zeros((2, 1)), np.full((2, 1, 2), 0.1), final=0.02)
    for unit in ("rad/s", "SI"):
        late = CheckedCondition("rest at the end", Status.UNDECIDED, -0.01, unit)
        assert missing_margin([late], resting) == pytest.approx(0.5)


def test_what_the_disturbances_do_not_move_is_given_a_wider_margin() -> None:
    none = DisturbanceSpread(np.zeros((3, 1)), np.zeros((3, 1, 2)))
    lacking = missing_margin([finding(-0.01)], none)
    assert ConstraintTightening().wider(lacking, none) == ConstraintTightening(widened=1)
    assert missing_margin([finding(float("-inf"), "")], none) == float("inf")


def test_the_tightening_gets_as_wide_as_was_lacking() -> None:
    tightening = ConstraintTightening().wider(0.75, SPREAD)
    assert tightening is not None
    assert tightening.widened == 0
    assert tightening.spreads >= 1.75
    again = tightening.wider(1e-9, SPREAD.scaled(tightening.spreads))
    assert again is not None
    assert again.spreads > 1.1 * tightening.spreads


def test_without_disturbances_margins_grow_step_by_step() -> None:
    tightening, seen = ConstraintTightening(3e-4), [3e-4]
    while (following := tightening.wider(0.0, None)) is not None:
        tightening = following
        seen.append(tightening.margin)
    assert seen == pytest.approx([3e-4 * factor for factor in WIDENINGS])
    assert tightening.is_last


def test_it_ends() -> None:
    assert ConstraintTightening().wider(float("inf"), SPREAD) is None
    tightening: ConstraintTightening | None = ConstraintTightening()
    for _ in range(100):
        if tightening is None:
            break
        assert tightening.spreads * SPREAD.widest <= WIDEST
        tightening = tightening.wider(0.3, SPREAD.scaled(tightening.spreads))
    assert tightening is None


LIMITS = [
    finding(0.02, "rad", status=Status.HOLDS),
    CheckedCondition("range of Hip.q (joint 1)", Status.UNDECIDED, -0.01, "rad"),
    CheckedCondition("rate of Hip.q (joint 2)", Status.UNDECIDED, -0.11, "rad/s"),
    CheckedCondition("range of Hip.q (joint 2)", Status.HOLDS, 0.3, "rad"),
]
HIPS = ["Hip.q (joint 1)", "Hip.q (joint 2)"]


def test_what_limits_lack_is_known_joint_by_joint() -> None:
    assert missing_at_limits(LIMITS, HIPS) == ((0.01, 0.0), (0.0, 0.11))
    assert missing_at_limits(LIMITS[:1], HIPS) == ()
    # Nothing finite is known of it: the whole tightening grows.
    unknown = CheckedCondition("rate of Hip.q (joint 2)", Status.UNDECIDED, float("-inf"), "rad/s")
    assert missing_at_limits([unknown], HIPS) == ()
    assert missing_margin(without_limits([unknown]), SPREAD) == float("inf")
    assert missing_margin(without_limits(LIMITS), SPREAD) == 0


def test_limits_are_narrowed_before_everything_else_is() -> None:
    """A limit that may not be narrowed further gains nothing from more spreads."""
    first = ConstraintTightening()
    narrower = first.wider(0.0, SPREAD, limited=True)
    assert narrower is not None
    assert (narrower.spreads, narrower.widened) == (first.spreads, first.widened)
    assert first.narrowing < narrower.narrowing <= MOST_NARROWING < 1 / 2
    both = first.wider(0.5, SPREAD, limited=True)
    assert both is not None
    assert both.narrowing == narrower.narrowing
    assert both.spreads > 1.5
    # It ends, although limits never do.
    tightening: ConstraintTightening | None = first
    for _ in range(100):
        if tightening is None:
            break
        tightening = tightening.wider(0.0, SPREAD.scaled(tightening.spreads), limited=True)
    assert tightening is None


def test_a_rate_limit_is_narrowed_as_far_as_disturbed_motions_need(tmp_path: Path) -> None:
    """Slow motions spread as much as fast ones, so some motion stays below 1 rad/s."""
    (tmp_path / "turn.srg").write_text(QUICK_TURN, encoding="utf-8")
    program = load(tmp_path / "turn.srg").program
    assert program is not None
    result = synthesise(program, program.tasks["Turn"], RunContext())
    assert result.verdict == "found"
    assert result.design is not None
    assert result.design.controller is not None
    rates = [abs(float(row[1])) for row in result.design.controller.reference]
    assert max(rates) < 1 - 0.2
