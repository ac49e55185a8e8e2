"""Slots and subformulas.

That the clauses of whole formulas are necessary conditions is tested in
``tests/solvers/test_contradiction.py``.
"""

from __future__ import annotations

from contextlib import closing
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from compiler.tasks.formula_slots import Slots, common_step
from compiler.tasks.region_slots import TRUE, TooManySlotsError
from solvers.backends.cadical import SatSolver
from solvers.verdict import Fails

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


def test_a_motion_does_not_jump_between_disjoint_regions() -> None:
    """A with B in it, and C apart: four instants; only what starts in A or B stays there."""
    nowhere, a, b, c = 0, 0b001, 0b011, 0b100
    for signatures, jumps in (((nowhere, a, b, c), False), ((nowhere, a, b, c, a | c), True)):
        slots = Slots(3, signatures, (1,))
        regions = [slots.region(1, number) for number in range(3)]
        either = slots.row(slots.disjunction(regions))
        with closing(SatSolver()) as solver:
            for clause in slots.clauses:
                solver.add(np.array([clause], dtype=np.int64))
            start, end = slots.row(regions[1]).some[0], slots.row(regions[2]).some[-1]
            stays = [each for k, each in enumerate(either.every) if k % 2]
            assert not isinstance(solver.solve([start, end], conflicts=1000), Fails)
            assert (
                isinstance(solver.solve([start, end, *stays], conflicts=1000), Fails) is not jumps
            )
