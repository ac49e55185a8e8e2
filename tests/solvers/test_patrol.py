"""The patrol of `specs/patrol.srg`, against an independent simulation."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from solvers.verifier.verification import Outcome, verify_directory
from tests.oracles.result_files import alter_spec, read
from tests.oracles.two_rods import simulated

pytestmark = pytest.mark.slow

C = np.array([(-0.4, 1.6), (0.3, 1.9), (0.1, 2.7), (-0.6, 2.5)])
"""The corners of the obstacle, counter-clockwise."""


def depth(x: np.ndarray, y: np.ndarray, box: tuple[float, float, float, float]) -> np.ndarray:
    """How deep points are in a box; negative outside."""
    return np.minimum.reduce([x - box[0], box[1] - x, y - box[2], box[3] - y])


def beside(x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """The distance from the obstacle to points outside of it, zero inside."""
    points, inside = np.stack([x, y], axis=1), np.ones(len(x), dtype=bool)
    gaps = []
    for a, b in zip(C, np.roll(C, -1, axis=0), strict=True):
        along = b - a
        share = np.clip((points - a) @ along / (along @ along), 0, 1)
        gaps.append(np.linalg.norm(points - a - share[:, None] * along, axis=1))
        inside &= along[0] * (points[:, 1] - a[1]) - along[1] * (points[:, 0] - a[0]) >= 0
    return np.where(inside, 0.0, np.min(gaps, axis=0))


def test_the_patrol_is_made(made: Callable[[str], Path]) -> None:
    folder = made("patrol") / "out"
    times, states, (x, y) = simulated(read(folder))
    assert len(times) == 64 * 2000 + 1
    assert depth(x[:1], y[:1], (2.4, 2.8, 0.4, 0.8)) > 0
    assert list(states[0, 2:]) == [0, 0]
    in_a, in_b = depth(x, y, (-2.9, -2.3, 1.2, 1.8)), depth(x, y, (0.9, 1.5, 2.9, 3.5))
    first, second, third = (item["robustness"] for item in read(folder, "design.json")["satisfy"])
    # Then B: the last second is after any visit to A within 3 s.
    visit = in_a[times <= 3].max()
    assert 0 < first <= min(visit, in_b[times >= 3].max()) + 1e-9
    assert first >= 0.95 * visit - 1e-3
    gap = beside(x, y).min()
    assert 0.95 * gap - 1e-3 <= second <= gap + 1e-9
    stay = in_b[times >= 7].min()
    assert 0.95 * stay - 1e-3 <= third <= stay + 1e-9
    report = verify_directory(folder)
    assert report.outcome is Outcome.VALID
    assert report.level == "validated"


@pytest.mark.parametrize(
    ("before", "after"),
    [
        ("eventually[0 s, 3 s] (A", "eventually[0 s, 2.4 s] (A"),
        ("last[1 s] B", "last[3 s] B"),
        ("always not C", "always not B"),
        ("(A and eventually B)", "(B and eventually A)"),
    ],
)
def test_another_task_is_not_done(result: Callable[[str], Path], before: str, after: str) -> None:
    folder = result("patrol")
    alter_spec(folder, before, after, sign=True)
    report = verify_directory(folder)
    assert report.outcome is Outcome.REFUTED
    assert report.reason is not None
    assert "satisfy" in report.reason
