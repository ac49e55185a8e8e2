"""Time sets against sets of the parts of a grid, on which everything can be enumerated."""

from __future__ import annotations

from fractions import Fraction
from itertools import product

import pytest
from hypothesis import given
from hypothesis import strategies as st

from compiler.tasks.time_set import AFTER, BEFORE, TimeSet
from grammar_lang import ir
from tests.oracles.formula_semantics import Meaning, instant, parts_between
from tests.oracles.time_grid import marks, time_set

F = Fraction


def grids(n: int) -> st.SearchStrategy[list[bool]]:
    return st.lists(st.booleans(), min_size=2 * n + 1, max_size=2 * n + 1)


GRIDS = st.integers(1, 6).flatmap(grids)
PAIRS = st.integers(1, 6).flatmap(lambda n: st.tuples(grids(n), grids(n)))


def interval(a: int, b: int, end: int = 10, *, closed: str = "[]") -> TimeSet:
    sides = {"[": BEFORE, "(": AFTER, "]": AFTER, ")": BEFORE}
    return TimeSet(F(end), ((F(a), sides[closed[0]]), (F(b), sides[closed[1]])))


@given(GRIDS)
def test_a_set_is_told_from_its_instants(parts: list[bool]) -> None:
    assert marks(time_set(parts)) == parts


@given(PAIRS)
def test_boolean_operations(pair: tuple[list[bool], list[bool]]) -> None:
    left, right = map(time_set, pair)
    both = list(zip(*pair, strict=True))
    assert marks(left | right) == [a or b for a, b in both]
    assert marks(left & right) == [a and b for a, b in both]
    assert marks(left.complement) == [not a for a, _ in both]
    assert (left <= right) == all(b or not a for a, b in both)


@given(PAIRS)
def test_equal_sets_have_equal_cuts(pair: tuple[list[bool], list[bool]]) -> None:
    left, right = map(time_set, pair)
    for found in (left, left | right, left & right, left.complement, left.until(right)):
        assert time_set(marks(found)) == found
        assert list(found.cuts) == sorted(set(found.cuts))


@given(GRIDS, st.integers(0, 7), st.none() | st.integers(0, 7))
def test_before(parts: list[bool], lower: int, width: int | None) -> None:
    end = F(len(parts) // 2)
    upper = None if width is None else F(lower + width)
    expected = []
    for part in range(len(parts)):
        now = instant(part)
        last = end if upper is None else min(now + upper, end)
        expected.append(any(parts[p] for p in parts_between(now + lower, last)))
    assert marks(time_set(parts).before(F(lower), upper)) == expected


@given(PAIRS)
def test_until(pair: tuple[list[bool], list[bool]]) -> None:
    both = list(zip(*pair, strict=True))
    signal = [{1: frozenset("A" * a + "C" * c)} for a, c in both]
    meaning, until = Meaning(signal, F(1), F(1)), ir.Until(ir.Atom("A", 1), ir.Atom("C", 1))
    left, right = map(time_set, pair)
    expected = [meaning.holds(until, part) for part in range(len(both))]
    assert marks(left.until(right)) == expected


def test_until_at_the_ends_of_intervals() -> None:
    """Strong, right side at the supremum of the left one: the left need not hold there."""
    assert interval(1, 3, closed="[)").until(interval(3, 3)) == interval(1, 3)
    assert interval(1, 3, closed="(]").until(interval(3, 3)) == interval(1, 3, closed="(]")
    # Just after 3 comes too late for [1, 3): what follows an excluded 3 needs 3 on the left.
    assert interval(1, 3, closed="[)").until(interval(3, 5, closed="(]")) == interval(
        3, 5, closed="(]"
    )
    assert interval(1, 3).until(interval(3, 5, closed="(]")) == interval(3, 5, closed="(]")
    # An instant of the right inside: only what comes before it, and itself.
    assert interval(1, 8).until(interval(4, 4)) == interval(1, 4)
    assert interval(1, 8).until(TimeSet(F(10))) == TimeSet(F(10))
    # One interval of the right serves two of the left.
    two = interval(0, 2, closed="[)") | interval(3, 5, closed="[)")
    assert two.until(interval(1, 4)) == interval(0, 4)


@pytest.mark.parametrize(("opening", "closing"), list(product("[(", "])")))
def test_windows_keep_the_kind_of_an_end(opening: str, closing: str) -> None:
    found = interval(5, 6, closed=opening + closing).before(F(1), F(2))
    assert found == interval(3, 5, closed=opening + closing)


def test_what_of_a_window_lies_after_the_end_is_cut_off() -> None:
    whole = TimeSet.all(F(10))
    assert whole.before(F(4), F(7)) == interval(0, 6)
    assert whole.before(F(4), None) == interval(0, 6)
    assert whole.before(F(10), F(10)) == interval(0, 0)
    assert not whole.before(F(11), F(12))
    assert interval(9, 10, closed="[)").before(F(3), None) == interval(0, 7, closed="[)")


def test_closed_intervals_that_touch_are_one() -> None:
    pieces = [(F(0), F(1)), (F(1), F(2)), (F(3), F(4)), (F(9), F(12))]
    assert TimeSet.closed(F(10), pieces) == interval(0, 2) | interval(3, 4) | interval(9, 10)
    assert TimeSet.all(F(10)).complement == TimeSet(F(10)) == TimeSet.closed(F(10), [])


def test_sets_of_different_horizons_do_not_mix() -> None:
    with pytest.raises(ValueError, match="horizons"):
        _ = TimeSet.all(F(1)) | TimeSet.all(F(2))
