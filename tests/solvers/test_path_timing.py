"""Polylines through cells and the samples at which they are entered."""

from __future__ import annotations

from fractions import Fraction
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from compiler.workspaces.abstraction import abstract
from grammar_lang import ir
from solvers.trajectory.path_timing import (
    Polyline,
    gentle_entries,
    in_order,
    polyline,
    smooth_timing,
    timing_of,
)


def box(name: str, kind: ir.RegionKind, *ends: tuple[int, int]) -> ir.Region:
    rows = []
    for axis, (low, high) in enumerate(ends):
        unit = [Fraction(int(i == axis)) for i in range(len(ends))]
        rows.append(ir.HalfSpace(tuple(unit), Fraction(high)))
        rows.append(ir.HalfSpace(tuple(-u for u in unit), Fraction(-low)))
    return ir.Region(name, kind, ir.Inequalities(tuple(rows)))


ROW = abstract(
    ir.Workspace(
        "Row", 2, box("bounds", "bounds", (0, 12), (0, 2)),
        (box("P", "region", (0, 3), (0, 2)), box("Q", "region", (8, 12), (0, 2))),
    )
)  # fmt: skip
P, Q, FREE = ROW.index("P"), ROW.index("Q"), ROW.index("free")


def test_a_line_passes_centres_and_facets() -> None:
    line = polyline(ROW, (P, FREE, Q))
    np.testing.assert_allclose(line.points, [[1.5, 1], [3, 1], [8, 1], [10, 1]])
    assert line.gates == (1, 2)
    np.testing.assert_allclose(line.along, [0, 1.5, 6.5, 8.5])


def test_a_visit_goes_to_the_middle_of_the_cell() -> None:
    line = polyline(ROW, (FREE, P, FREE))
    np.testing.assert_allclose(line.points, [[5.5, 1], [3, 1], [1.5, 1], [3, 1], [5.5, 1]])
    assert line.gates == (1, 3)


def test_entries_of_given_samples_are_kept() -> None:
    line, steps = polyline(ROW, (FREE, P, FREE, Q)), 40
    entries = (0, 5, 9, 33)
    along = timing_of(line, entries, steps)
    assert along[0] == 0
    assert along[-1] == line.along[-1]
    assert np.all(np.diff(along) >= -1e-12)
    cells = [ROW.locate(place) for place in line.at(along)]
    assert cells == [FREE] * 5 + [P] * 4 + [FREE] * 24 + [Q] * 8
    # At rest at both ends: the first and last steps are short.
    assert along[1] < along[5] / 5
    assert along[-1] - along[-2] < 0.2


def test_smooth_timing_is_the_minimum_jerk_profile() -> None:
    line = polyline(ROW, (P, FREE, Q))
    along, entries = smooth_timing(line, 20)
    np.testing.assert_allclose(along[10], line.along[-1] / 2)
    assert entries == (0, *(int(np.argmax(along >= gate)) for gate in (1.5, 6.5)))


@given(st.data())
def test_entries_are_allowed_and_in_less_haste_than_planned(data: st.DataObject) -> None:
    steps, line = 12, polyline(ROW, (P, FREE, Q, FREE))
    orders = st.lists(st.integers(1, steps), min_size=3, max_size=3, unique=True).map(sorted)
    planned = (0, *data.draw(orders))
    latest = data.draw(st.integers(planned[2], steps))
    found = gentle_entries(line, planned, steps, lambda entries: entries[2] <= latest)
    assert in_order(found, steps)
    assert found[2] <= latest
    smooth = smooth_timing(line, steps)[1]
    if smooth[2] <= latest:
        assert found == smooth
    else:
        assert haste(line, found, steps) <= haste(line, planned, steps)


def haste(line: Polyline, entries: tuple[int, ...], steps: int) -> float:
    ends = [0.0, *(entry - 0.5 for entry in entries[1:]), steps]
    along = [0.0, *(line.along[gate] for gate in line.gates), line.along[-1]]
    return sum(
        (b - a) ** 2 / (t - s)
        for (a, b), (s, t) in zip(pairwise(along), pairwise(ends), strict=True)
    )


def test_a_deadline_leaves_even_speed_before_and_after_it() -> None:
    """Q, 5 m away, is to be entered by sample 8 of 40, and left again by the way it was entered."""
    line, steps = polyline(ROW, (P, FREE, Q, FREE)), 40
    found = gentle_entries(line, (0, 1, 2, 3), steps, lambda entries: entries[2] <= 8)
    assert found[2] == 8
    assert found[1] in (2, 3)  # 1.5 m of the 6.5 m to Q
    assert found[3] == pytest.approx(8 + 32 * 4 / 6.5, abs=1)  # 4 m in Q, then 2.5 m
