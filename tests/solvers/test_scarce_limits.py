"""What to try first after *unknown*: what poses of the robot say about time, rates and efforts."""

from __future__ import annotations

import json
from dataclasses import replace
from math import inf
from pathlib import Path
from typing import Any
from unittest.mock import Mock

import numpy as np
import pytest

from compiler.robots.candidate import robot_in_task
from compiler.robots.normal_form import family_of
from compiler.words.structures import structures
from solvers.explanation import scarce_limits
from solvers.explanation.scarce_limits import least_time, remedy
from solvers.search.search_state import Cause
from solvers.trajectory.task_limits import MotionLimits, motion_limits
from srgc.cli import run
from tests.oracles.small_specs import TURNER, replaced
from tests.solvers.test_changes import posed

GANTRY = """
module Rail { role base; dof sx: prismatic x in [-2, 2] m RAIL; port out: P;
  frame out = in * move(x, sx); }
module Hook { role effector; dof sy: prismatic y in [-2, 2] m; port in: P;
  frame end = in * move(y, sy); point(frame: end, mass: 2 kg); effector(frame: end); }
grammar Gantry from ports { start Rail; with Hook; }
workspace W { plane xy; bounds box [-2, 2] x [-2, 2] m;
  region S box [-0.01, 0.01] x [-0.01, 0.01] m; target T box [0.99, 1.01] x [0.99, 1.01] m; }
task Go { robot Gantry; workspace W; start in S at rest; reach T END; effort <= 50 N;
  horizon 42 steps of 0.1 s; }
"""
"""At least 0.98 m along either axis in 4.2 s."""
ARM = replaced(
    replaced(TURNER, "[-180, 180] deg;", "[-180, 180] deg rate in [-2, 2] deg/s;"),
    "accept contains EN and starts with B eps JO;",
    "accept matches B eps JO eps L eps EN;",
)


def said(text: str) -> str:
    """What to try first for the first robot of a task."""
    asked = posed(text)
    family = family_of(asked.program, asked.task)
    model = robot_in_task(family, asked.task.origin, next(iter(structures(family.language, 4))))
    return remedy(model, asked.workspace, asked.task, 0)


def gantry(rail: str, end: str = "at rest") -> str:
    return GANTRY.replace("RAIL", rail).replace("END", end)


def limits(rate: float, hard: float) -> MotionLimits:
    asked = posed(gantry("rate in [-1, 1] m/s"))
    family = family_of(asked.program, asked.task)
    model = robot_in_task(family, asked.task.origin, next(iter(structures(family.language, 4))))
    found = motion_limits(model, asked.task)
    ends = np.array([rate, inf])
    return replace(found, rate_upper=ends, accelerations=np.array([hard, inf]))


@pytest.mark.parametrize("rests", [0, 1, 2])
@pytest.mark.parametrize(("rate", "hard"), [(0.25, 0.2), (0.25, inf), (inf, 0.2), (2.0, 0.2)])
def test_in_the_least_time_the_fastest_motion_covers_the_way(
    rests: int, rate: float, hard: float
) -> None:
    time = least_time(limits(rate, hard), 0, 0.98, rests)
    if not rests and rate == inf:
        assert time == 0  # nothing bounds it
        return
    instants = np.linspace(0.0, time, 20001)
    rising = hard * instants if rests and hard < inf else np.full_like(instants, inf)
    falling = rising[::-1] if rests == 2 else np.full_like(instants, inf)
    fastest = np.minimum(np.minimum(rising, falling), rate)
    assert np.trapezoid(fastest, instants) == pytest.approx(0.98, rel=1e-3)


def test_a_joint_takes_its_rate_in_the_direction_of_its_way() -> None:
    one_way = replace(limits(0.5, inf), rate_lower=np.array([0.0, -inf]))
    assert least_time(one_way, 0, 1.0, 2) == pytest.approx(2)
    assert least_time(one_way, 0, -1.0, 2) == inf
    assert least_time(one_way, 0, 0.0, 2) == 0


def test_rates_too_low_for_the_time_are_named() -> None:
    """At 0.2 m/s, 0.98 m to 1.02 m take 4.9 s to 5.1 s."""
    text = said(gantry("rate in [-0.2, 0.2] m/s"))
    head, _, rest = text.partition(": to the nearest poses found, `Rail.sx` takes ")
    assert head == "a longer horizon or higher rates"
    seconds, _, has = rest.partition(" s, and there are ")
    assert 4.9 <= float(seconds) <= 5.1
    assert has == "4.2 s"


def test_accelerations_too_low_for_the_time_are_named() -> None:
    """Twice the root of 0.98 m over 0.2 m/s^2; without a rest at the end it is in time."""
    text = said(gantry("accel <= 0.2 m/s^2"))
    assert text.startswith("a longer horizon or higher accelerations: ")
    assert 4.427 <= float(text.split(" takes ")[1].split()[0]) <= 4.52
    assert said(gantry("accel <= 0.2 m/s^2", "")).startswith("more steps, higher accelerations, ")


def test_a_slow_arm_is_told_of_its_rates() -> None:
    """2 degrees a second, for 2 s: 4 degrees of 90, less what the regions are wide."""
    text = said(ARM)
    assert text.startswith("a longer horizon or higher rates: to the nearest poses found, `JO.q` ")
    assert text.endswith(" s, and there are 2 s")


def test_rates_that_may_be_too_low_come_instead_of_efforts() -> None:
    """In the time at best, but not as smoothly: of the 50 N hardly any are taken."""
    text = said(gantry("rate in [-0.25, 0.25] m/s"))
    assert text == "more steps, higher rates, or larger budgets: `--paths`, `--evaluations`"


def test_where_efforts_alone_are_taken_the_cause_says_what_to_try() -> None:
    assert said(gantry("")) == ""
    strong = said(gantry("effort <= 0.1 N"))
    assert strong == ""


def test_a_joint_without_limits_takes_the_shorter_way_round() -> None:
    """A quarter turn at 1 rad/s in 2 s, whichever way the poses were found."""
    text = replaced(ARM, "in [-180, 180] deg rate in [-2, 2] deg/s", "rate in [-1, 1] rad/s")
    assert "takes" not in said(text)


@pytest.mark.slow
def test_synth_ends_with_it(tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "slow.srg"
    path.write_text(gantry("rate in [-0.25, 0.25] m/s accel <= 0.2 m/s^2"), encoding="utf-8")
    few = ["--paths", "1", "--evaluations", "2"]
    assert run(["synth", str(path), "-q", *few, "-o", str(tmp_path / "out")]) == 4
    tried = "a longer horizon or higher rates and accelerations: to the nearest poses found, "
    assert f"next:    try {tried}`Rail.sx` takes 5." in capfd.readouterr().out
    design = json.loads((tmp_path / "out" / "design.json").read_text())
    assert design["nearest"]["try_first"].startswith(tried)


def test_after_a_time_limit_no_poses_are_searched(monkeypatch: pytest.MonkeyPatch) -> None:
    asked: list[object] = []
    monkeypatch.setattr(scarce_limits, "remedy", lambda *given: asked.append(given))
    result: Any = Mock(unfinished=True)
    result.nearest.cause = Cause.NOT_FOLLOWED
    assert scarce_limits.with_remedy(result, Mock(), Mock(), 0) is result
    assert asked == []
