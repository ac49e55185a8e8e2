"""The monitor against the definitions on a grid; what is certain against all that may be."""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from compiler.tasks.monitor import AtomKey, Verdicts, monitor, satisfied
from compiler.tasks.time_set import TimeSet
from grammar_lang import ir
from tests.oracles.formula_semantics import Meaning
from tests.oracles.formulas import formulas
from tests.oracles.some_cases import examples
from tests.oracles.time_grid import marks, time_set

F = Fraction
ATOMS = [AtomKey("A", 1), AtomKey("C", 1), AtomKey("A", 2), AtomKey("C", 2)]
SECONDS = 4
PARTS = 2 * SECONDS + 1
END = F(SECONDS)
MARKS = st.lists(st.booleans(), min_size=PARTS, max_size=PARTS)
A, C = ir.Atom("A", 1), ir.Atom("C", 1)


def settled(signals: list[list[bool]]) -> list[dict[int, frozenset[str]]]:
    """The signal of the oracle."""
    return [
        {
            effector: frozenset(
                region
                for (region, owner, _), values in zip(ATOMS, signals, strict=True)
                if owner == effector and values[part]
            )
            for effector in (1, 2)
        }
        for part in range(PARTS)
    ]


def expected(formula: ir.Formula, signals: list[list[bool]], step: int = 1) -> list[bool]:
    meaning = Meaning(settled(signals), F(1), F(step))
    return [meaning.holds(formula, part) for part in range(PARTS)]


def exact(signals: list[list[bool]]) -> dict[AtomKey, TimeSet]:
    return {atom: time_set(values) for atom, values in zip(ATOMS, signals, strict=True)}


@settings(max_examples=examples(100, 200), deadline=None)
@given(formulas(SECONDS, 2, deep=8), st.lists(MARKS, min_size=4, max_size=4), st.integers(1, 5))
def test_formulas_hold_when_the_definitions_say(
    formula: ir.Formula, signals: list[list[bool]], step: int
) -> None:
    found = satisfied(formula, exact(signals), END, F(step))
    assert marks(found) == expected(formula, signals, step)


def by_sign(formula: ir.Formula, *, positive: bool = True) -> ir.Formula:
    """Atoms below an odd number of negations are given other names."""

    def same(part: ir.Formula) -> ir.Formula:
        return by_sign(part, positive=positive)

    def other(part: ir.Formula) -> ir.Formula:
        return by_sign(part, positive=not positive)

    match formula:
        case ir.Atom(region=region, effector=effector):
            return formula if positive else ir.Atom(region + "?", effector)
        case ir.Not(operand=part):
            return ir.Not(other(part))
        case ir.Implies(left=left, right=right):
            return ir.Implies(other(left), same(right))
        case ir.And(operands=parts) | ir.Or(operands=parts):
            return type(formula)(tuple(same(part) for part in parts))
        case ir.Until(left=left, right=right):
            return ir.Until(same(left), same(right))
        case ir.Always(operand=part, window=window) | ir.Eventually(operand=part, window=window):
            return type(formula)(same(part), window)
        case ir.Last(operand=part, duration=duration):
            return ir.Last(duration, same(part))
        case _:
            return ir.Next(same(formula.operand))


VALUES = st.sampled_from([(True, True), (False, True), (False, False)])
UNSURE = st.lists(st.lists(VALUES, min_size=PARTS, max_size=PARTS), min_size=4, max_size=4)


@settings(max_examples=examples(70, 150), deadline=None)
@given(formulas(SECONDS, 2, deep=8), UNSURE, st.data())
def test_what_is_certain_holds_whatever_the_signals(
    formula: ir.Formula, unsure: list[list[tuple[bool, bool]]], data: st.DataObject
) -> None:
    """Certain means: with every positive atom at its worst and every negated one at its best."""
    known = {
        atom: Verdicts(time_set(m for m, _ in values), time_set(m for _, m in values))
        for atom, values in zip(ATOMS, unsure, strict=True)
    }
    found = monitor(formula, known, END, F(1))
    signal = [
        {
            effector: frozenset(
                name
                for (region, owner, _), values in zip(ATOMS, unsure, strict=True)
                for name, is_in in zip((region, region + "?"), values[part], strict=True)
                if owner == effector and is_in
            )
            for effector in (1, 2)
        }
        for part in range(PARTS)
    ]
    meaning = Meaning(signal, F(1), F(1))
    worst = by_sign(formula)
    assert marks(found.must) == [meaning.holds(worst, part) for part in range(PARTS)]
    assert found.must <= found.may
    between = [[m if m == n else data.draw(st.booleans()) for m, n in values] for values in unsure]
    true = expected(formula, between)
    assert all(t or not m for m, t in zip(marks(found.must), true, strict=True))
    assert all(m or not t for m, t in zip(marks(found.may), true, strict=True))


def when(formula: ir.Formula, a: list[tuple[str, str]], c: list[tuple[str, str]]) -> TimeSet:
    """On [0, 10] with steps of 0.5 s, A and C in closed intervals."""
    signals = {
        AtomKey("A", 1): TimeSet.closed(F(10), [(F(x), F(y)) for x, y in a]),
        AtomKey("C", 1): TimeSet.closed(F(10), [(F(x), F(y)) for x, y in c]),
    }
    return satisfied(formula, signals, F(10), F(1, 2))


def within(low: F | int, high: F | int, formula: ir.Formula) -> ir.Formula:
    return ir.Eventually(formula, ir.Window(F(low), F(high)))


def throughout(low: F | int, high: F | int, formula: ir.Formula) -> ir.Formula:
    return ir.Always(formula, ir.Window(F(low), F(high)))


EXACT: dict[str, tuple[Callable[[F], ir.Formula], F, int]] = {
    "eventually": (lambda t: within(0, t, A), F(1, 3), 1),
    "always, its end": (lambda t: throughout(F(1, 3), t, A), F(3), -1),
    "always, its beginning": (lambda t: throughout(t, 3, A), F(1, 3), 1),
    "last": (lambda t: ir.Last(t, C), F(6), -1),
    "eventually twice": (lambda t: within(0, 1, within(1, t, C)), F(3), 1),
    "always eventually": (lambda t: throughout(3, 4, within(0, t, C)), F(1), 1),
    "eventually with": (lambda t: within(0, 9, ir.And((A, within(0, t, C)))), F(1), 1),
    "eventually always": (lambda t: within(0, 2, throughout(0, t, A)), F(3) - F(1, 3), -1),
}


@pytest.mark.parametrize("name", EXACT)
def test_windows_are_exact_at_their_ends(name: str) -> None:
    """A in [1/3, 3], C from 4 on: one part in 10^30 changes every answer."""
    make, limit, sign = EXACT[name]
    near = F(1, 10**30)
    a, c = [("1/3", "3")], [("4", "10")]
    assert 0 in when(make(limit), a, c)
    assert 0 in when(make(limit + sign * near), a, c)
    assert 0 not in when(make(limit - sign * near), a, c)


def test_next_is_one_step_later_exactly() -> None:
    """Steps of 0.5 s: A from 1/2 on counts at 0, A from just after does not."""
    assert 0 in when(ir.Next(A), [("1/2", "1")], [])
    assert 0 not in when(ir.Next(A), [(f"{10**30 + 2}/{2 * 10**30}", "1")], [])
    whole = when(ir.Next(A), [("0", "10")], [])
    assert F(19, 2) in whole
    assert F(19, 2) + F(1, 10**30) not in whole
    # Its negation holds where there is no next step.
    assert 10 in when(ir.Not(ir.Next(A)), [("0", "10")], [])


def test_until_is_strong_and_exact() -> None:
    """A up to 2; C from 2 on is in time, C from just after is not, C never neither."""
    until = ir.Until(A, C)
    assert 0 in when(until, [("0", "2")], [("2", "3")])
    assert 0 not in when(until, [("0", "2")], [(f"{2 * 10**30 + 1}/{10**30}", "3")])
    assert 0 not in when(until, [("0", "10")], [])
    # The left side is not needed where the right one holds at once.
    assert 0 in when(until, [], [("0", "0")])


def test_last_is_absolute_and_at_most_the_whole_trace() -> None:
    last = ir.Last(F(12), A)
    assert when(last, [("0", "10")], []) == TimeSet.all(F(10))
    assert not when(last, [("1/100", "10")], [])
    assert 0 in when(ir.Last(F(0), A), [("10", "10")], [])


def test_known_instants_count_besides_what_follows() -> None:
    """Neither A nor C is certain on [4, 5], but that one of them holds is."""
    either = ir.Or((A, C))
    sure = {
        AtomKey("A", 1): Verdicts(
            TimeSet.closed(F(10), [(F(0), F(4))]), TimeSet.closed(F(10), [(F(0), F(5))])
        ),
        AtomKey("C", 1): Verdicts(
            TimeSet.closed(F(10), [(F(5), F(10))]), TimeSet.closed(F(10), [(F(4), F(10))])
        ),
    }
    always = ir.Always(either, ir.Window(F(0), None))
    assert 0 not in monitor(always, sure, F(10), F(1)).must
    known = {either: Verdicts(TimeSet.closed(F(10), [(F(4), F(5))]), TimeSet.all(F(10)))}
    assert 0 in monitor(always, sure, F(10), F(1), known).must
