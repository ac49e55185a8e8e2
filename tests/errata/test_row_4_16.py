"""Row 4.16: what the paper leaves open decides about the numbers that it prints."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from solvers.trajectory.control import synthesise_control
from tests.oracles.turning_link import ANGLE, INERTIA, one_link

SPEC = Path(__file__).parents[2] / "specs" / "planar_arm.srg"
BOUND, STEPS = 10.0, 8


def robustness(dt: float) -> float:
    problem, seed = one_link(STEPS, BOUND, np.inf)
    return synthesise_control(replace(problem, dt=dt), seed).robustness


def test_the_step_alone_changes_the_robustness() -> None:
    """The least torque is 2 I angle / (k dt)^2: 81 steps in 10 s, or of an eighth of a second."""
    given, other = 0.125, 10 / 81
    peaks = [2 * INERTIA * ANGLE / (STEPS * dt) ** 2 for dt in (given, other)]
    assert peaks[1] / peaks[0] == pytest.approx((81 / 80) ** 2)
    found = [robustness(dt) for dt in (given, other)]
    assert found == pytest.approx([BOUND - peak for peak in peaks], rel=1e-4)
    assert found[0] - found[1] > 0.05


def test_our_choices_are_marked() -> None:
    lines = SPEC.read_text(encoding="utf-8").splitlines()
    marked = [line.split()[0] for line in lines if "(*)" in line]
    assert marked == ["accept", "bounds", "region", "start", "horizon"]
