"""Which changes of drives, of limits and of the time come first: what straight motions need."""

from __future__ import annotations

from fractions import Fraction

import pytest

from solvers.explanation.suggestions import SuggestionSearch
from solvers.explanation.task_line import task_lines
from solvers.run_context import RunContext
from tests.solvers.test_changes import Vain, posed, scale

RATE = "rate in [-0.5, 0.25] m/s"
GANTRY = """
module Rail { role base; dof sx: prismatic x in [-2, 2] m RAIL effort <= 50 N; port out: P;
  frame out = in * move(x, sx); }
module Hook { role effector; dof sy: prismatic y in [-2, 2] m HOOK effort <= 50 N; port in: P;
  frame end = in * move(y, sy); point(frame: end, mass: 2 kg); effector(frame: end); }
grammar Gantry from ports { start Rail; with Hook; }
workspace W { plane xy; bounds box [-2, 2] x [-2, 2] m;
  region S box [-0.01, 0.01] x [-0.01, 0.01] m; target T box [0.99, 1.01] x [0.99, 1.01] m; }
task Go { robot Gantry; workspace W; start in S at rest; reach T at rest for 0.5 s;
  horizon 15 steps of 0.1 s; }
"""
"""One metre along both axes in 1 s, then a rest of 0.5 s."""


def gantry(rail: str = "", hook: str = "") -> str:
    return GANTRY.replace("RAIL", rail).replace("HOOK", hook)


def test_rates_rise_together_by_two_digits() -> None:
    asked = posed(gantry(RATE))
    rates = scale(asked, "joint_rate")
    assert (rates.values[0], rates.values[-1]) == (Fraction(51, 100), 32)
    change = rates.at(Fraction(1))
    assert change.says == "with `rate in [-1, 0.5] m/s` of `Rail.sx`"
    changed = posed(gantry("rate in [-1, 0.5] m/s")).program.modules["Rail"].dofs[0]
    assert change.posed.program.modules["Rail"].dofs[0].rate == changed.rate
    one_way = scale(posed(gantry("rate in [0, 90/100] m/s")), "joint_rate").at(Fraction(2))
    assert one_way.says == "with `rate in [0, 2] m/s` of `Rail.sx`"


def test_accelerations_rise_by_two_digits() -> None:
    asked = posed(gantry("accel <= 2 m/s^2"))
    change = scale(asked, "joint_accel").at(Fraction(3))
    assert change.says == "with `accel <= 3 m/s^2` of `Rail.sx`"
    changed = posed(gantry("accel <= 3 m/s^2")).program.modules["Rail"].dofs[0]
    assert change.posed.program.modules["Rail"].dofs[0].accel == changed.accel


@pytest.mark.parametrize(
    ("rail", "hook", "wanted"),
    [
        # One joint is too slow: its rate, or more time, and no drive.
        ("rate in [-0.5, 0.5] m/s", "", ["joint_rate", "horizon"]),
        ("accel <= 2 m/s^2", "", ["horizon", "joint_accel"]),
        # Both are: only time helps.
        ("rate in [-0.5, 0.5] m/s", "rate in [-0.6, 0.6] m/s", ["horizon"]),
    ],
)
def test_where_time_is_short_efforts_come_last(rail: str, hook: str, wanted: list[str]) -> None:
    asked = posed(gantry(rail, hook))
    runs = Vain(RunContext(), limit=100)
    SuggestionSearch(asked, runs).drives(task_lines(asked))
    kinds = [each.line.kind for each in runs.failed if each.line is not None]
    order = list(dict.fromkeys(kinds))
    assert sorted(order[: len(wanted)]) == sorted(wanted)
    assert order.index("joint_effort") >= len(wanted)


def test_the_first_value_is_what_a_straight_motion_needs() -> None:
    """15/8 of the mean rate: 1.03 m at most in 1 s; the time for it at 0.5 m/s, and the rest."""
    asked = posed(gantry("rate in [-0.5, 0.5] m/s"))
    runs = Vain(RunContext(), limit=100)
    SuggestionSearch(asked, runs).drives(task_lines(asked))
    first = {each.line.kind: each.value for each in reversed(runs.failed) if each.line is not None}
    assert 15 / 8 * 0.97 * 0.95 <= float(first["joint_rate"] or 0) <= 15 / 8 * 1.03 + 0.1
    time = 15 / 8 / 0.5
    assert 0.93 * time + 0.5 <= float(first["horizon"] or 0) / 10 <= 1.03 * time + 0.6
