"""Slots and subformulas.

That the clauses of whole formulas are necessary conditions is tested in
``tests/solvers/test_contradiction.py``.
"""

from __future__ import annotations

from fractions import Fraction

import pytest
from hypothesis import given
from hypothesis import strategies as st

from compiler.tasks.formula_slots import TRUE, Slots, TooManySlotsError, common_step

TIMES = st.fractions(min_value=Fraction(1, 50), max_value=20, max_denominator=50)


@given(st.lists(TIMES, min_size=1, max_size=5))
def test_the_step_divides_all_times_and_none_is_greater(times: list[Fraction]) -> None:
    step = common_step(times)
    assert all((time / step).denominator == 1 for time in times)
    factors = [(time / step).numerator for time in times]
    assert not any(all(f % prime == 0 for f in factors) for prime in (2, 3, 5, 7, 11, 13))


def test_equal_subformulas_are_one() -> None:
    slots = Slots(2, (0, 1, 2), (1,))
    a, c = slots.region(1, 0), slots.region(1, 1)
    assert slots.disjunction((a, c)) == slots.disjunction((c, a)) == -slots.conjunction((-a, -c))
    assert slots.conjunction((a, c)) == -slots.true  # no point is in both
    assert slots.disjunction((a, -a)) == slots.true
    later = slots.eventually(a, 0, 5)
    assert later == slots.eventually(a, 0, 2)
    assert slots.always(-a, 0, 9) == -later
    assert slots.disjunction((later, slots.disjunction((c, a)))) == slots.disjunction((c, a, later))


def test_windows_beyond_the_end() -> None:
    slots = Slots(2, (0, 1), (1,))
    a = slots.region(1, 0)
    assert slots.eventually(a, 3, 4) == -slots.true
    assert slots.always(a, 3, 4) == slots.true
    row, shifted = slots.row(a), slots.row(slots.eventually(a, 1, 1))
    assert shifted.some == (*row.some[2:], -TRUE, -TRUE)
    assert shifted.every == (*row.every[2:], -TRUE, -TRUE)


def test_too_many_clauses() -> None:
    with pytest.raises(TooManySlotsError):
        Slots(10_000, tuple(range(64)), (1,))
    slots = Slots(1000, (0, 1), (1,))
    a = slots.region(1, 0)

    def all_windows() -> None:
        for lower in range(1000):
            slots.eventually(a, lower, lower + 7)

    with pytest.raises(TooManySlotsError):
        all_windows()
