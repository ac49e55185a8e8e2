"""Timing of paths on which an effector stops, and what plans say of loads."""

from __future__ import annotations

import numpy as np
import pytest

from compiler.tasks.carrying import carried_samples
from compiler.tasks.word_formula import Literal, Obligation, eventually, every, holds, obligations
from solvers.trajectory.path_timing import (
    Polyline,
    gentle_entries,
    rests_of,
    smooth_timing,
    timing_of,
)

LINE = Polyline(np.array([[0.0, 0], [2, 0], [3, 0], [3, 3], [4, 3]]), (1, 2, 3))
"""Cells are entered after 2, 3 and 6 m of 7."""


def test_a_line_with_stops_is_minimum_jerk_between_them() -> None:
    """Half way through the cells 1 and 2: after 2.5 and 4.5 m."""
    along, entries = smooth_timing(LINE, 100, (1, 2))
    legs = np.sqrt([2.5, 2.0, 2.5])
    first, second = 100 * np.cumsum(legs)[:2] / legs.sum()
    assert np.interp([first, second], range(101), along) == pytest.approx([2.5, 4.5], abs=1e-3)
    slopes = np.gradient(along)
    assert slopes[[0, round(first), round(second), 100]] == pytest.approx(0, abs=5e-3)
    # By hand: the middle of the first leg has the speed 15/8 of its mean.
    middle = first / 2
    speed = np.interp(middle, range(101), slopes)
    assert speed == pytest.approx(15 / 8 * 2.5 / first, rel=5e-3)
    assert np.all(np.diff(along) >= 0)
    assert entries[0] == 0
    for cell, length in enumerate((2, 3, 6), 1):
        assert along[entries[cell] - 1] < length <= along[entries[cell]] + 1e-9


def test_without_stops_it_is_as_before() -> None:
    t = np.linspace(0, 1, 41)
    along, _ = smooth_timing(LINE, 40)
    assert along == pytest.approx(7 * (10 * t**3 - 15 * t**4 + 6 * t**5), abs=1e-12)


def test_a_timing_rests_at_samples() -> None:
    entries = (0, 10, 14, 30)
    along = timing_of(LINE, entries, 40, (12, 20))
    assert along[[0, 12, 20, 40]] == pytest.approx([0, 2.5, 4.5, 7])
    ways = np.diff(along)
    # Next to where it rests, a sample's way is a third of that of others near by, or less.
    assert np.all(ways[[0, 20, 39]] < ways[[2, 23, 37]] / 2)
    assert ways[19] < ways[16] / 4
    assert np.all(ways >= 0)
    # Cells are entered where they are to be.
    for entry, length in zip(entries[1:], (2, 3, 6), strict=True):
        assert along[entry - 1] < length < along[entry]


def test_gentle_entries_leave_time_to_stop() -> None:
    planned, stops = (0, 1, 2, 3), (1, 2)
    found = gentle_entries(LINE, planned, 60, lambda _: True, stops)
    assert found == smooth_timing(LINE, 60, stops)[1]


def carried(number: int, first: str, then: str):
    taken = Literal(first, 1, positive=True, transfer=(number, True))
    put = Literal(then, 1, positive=True, transfer=(number, False))
    return eventually(every([taken, eventually(put, 1, None)]), 0, None)


@pytest.mark.parametrize(
    ("cells", "samples"),
    [
        ("..AA.BB.", (2, 5)),
        ("A......B", (0, 7)),
        ("B.A.B.A.", (2, 4)),
        ("BBBBAAAA", None),
        ("A.......", None),
        ("...CCC..", (3, 4)),
        (".......C", None),
    ],
)
def test_when_a_plan_takes_a_load_up(cells: str, samples: tuple[int, int] | None) -> None:
    """Of a cell in both regions, `C`, two samples are needed."""
    inside = {"A": {"A"}, "B": {"B"}, "C": {"A", "B"}, ".": set()}
    word = [{1: frozenset(inside[cell])} for cell in cells]
    formula = carried(0, "A", "B")
    assert holds(formula, word) is (samples is not None)
    found = obligations(formula, word)
    if samples is None:
        assert found is None
        return
    assert found is not None
    first, last = carried_samples(found, 1)[0]
    assert (first, last) == samples
    assert rests_of(found, 0) == samples
    assert rests_of(found, 1) == ()


def test_two_loads_at_two_effectors() -> None:
    found = [
        Obligation("A", 0, inside=True, first=3, last=3, transfer=(0, True)),
        Obligation("B", 0, inside=True, first=9, last=9, transfer=(0, False)),
        Obligation("A", 1, inside=True, first=1, last=1, transfer=(1, True)),
        Obligation("B", 1, inside=True, first=4, last=4, transfer=(1, False)),
        Obligation("B", 1, inside=True, first=0, last=7),
    ]
    assert carried_samples(found, 2) == [(3, 9), (1, 4)]
    assert carried_samples(found[:2], 2) == [(3, 9), (0, 0)]
    assert rests_of(found, 1) == (1, 4)
