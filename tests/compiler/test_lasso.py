"""Formulas on motions that go on for ever, against the definitions on infinite signals."""

from __future__ import annotations

from fractions import Fraction

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from compiler.tasks.lasso import Lasso
from compiler.tasks.monitor import AtomKey, Verdicts, monitor
from compiler.tasks.time_set import TimeSet
from grammar_lang import ir
from tests.oracles.formulas import windows, without_window
from tests.oracles.lasso_semantics import Endless
from tests.oracles.some_cases import examples
from tests.oracles.time_grid import marks, time_set

F = Fraction
ATOMS = [AtomKey("A", 1), AtomKey("C", 1)]
SECONDS = 5
PARTS = 2 * SECONDS
END = F(SECONDS)
MARKS = st.lists(st.booleans(), min_size=PARTS, max_size=PARTS)
LOOPS = st.integers(0, SECONDS - 1)
A, C = ir.Atom("A", 1), ir.Atom("C", 1)
EVER = ir.Window(F(0), None)


def in_window(formula: ir.Formula, lower: int, upper: int) -> ir.Formula:
    return ir.Eventually(formula, ir.Window(F(lower), F(upper)))


def endless_formulas() -> st.SearchStrategy[ir.Formula]:
    """Formulas without ``last``, whose windows may be longer than the loop, and than the motion."""
    atoms: st.SearchStrategy[ir.Formula] = st.sampled_from([A, C])

    def grown(f: st.SearchStrategy[ir.Formula]) -> st.SearchStrategy[ir.Formula]:
        wide = windows(3 * SECONDS)
        return st.one_of(
            *without_window(f),
            st.builds(ir.Always, f, wide),
            st.builds(ir.Eventually, f, wide),
            st.builds(ir.Always, f, st.just(EVER)),
            st.builds(ir.Eventually, f, st.just(EVER)),
        )

    return st.recursive(atoms, grown, max_leaves=8)


def settled(signals: list[list[bool]]) -> list[dict[int, frozenset[str]]]:
    return [
        {1: frozenset(name for (name, *_), values in zip(ATOMS, signals, strict=True) if values[p])}
        for p in range(PARTS)
    ]


def expected(formula: ir.Formula, signals: list[list[bool]], loop: int, step: int) -> list[bool]:
    meaning = Endless(settled(signals), 2 * loop, F(1), F(step))
    return [meaning.holds(formula, part) for part in range(PARTS)]


def given_set(values: list[bool], beyond: bool) -> TimeSet:
    """The set of the parts that are marked; ``beyond`` is said of the instant T, and ignored."""
    return time_set([*values, beyond])


def found_in(times: TimeSet) -> list[bool]:
    return marks(times)[:PARTS]


@settings(max_examples=examples(300, 2000), deadline=None)
@given(
    endless_formulas(), st.lists(MARKS, min_size=2, max_size=2), LOOPS, st.integers(1, 12),
    st.booleans(),
)  # fmt: skip
def test_formulas_hold_when_the_definitions_say(
    formula: ir.Formula, signals: list[list[bool]], loop: int, step: int, beyond: bool
) -> None:
    sets = [given_set(values, beyond) for values in signals]
    exact = {atom: Verdicts(times, times) for atom, times in zip(ATOMS, sets, strict=True)}
    found = monitor(formula, exact, END, F(step), loop=F(loop))
    assert found_in(found.must) == expected(formula, signals, loop, step)
    assert found_in(found.may) == found_in(found.must)


@settings(max_examples=examples(200, 1000), deadline=None)
@given(
    endless_formulas(), st.lists(MARKS, min_size=2, max_size=2),
    st.lists(MARKS, min_size=2, max_size=2), LOOPS, st.data(),
)  # fmt: skip
def test_what_is_certain_holds_in_every_round_whatever_each_of_them_does(
    formula: ir.Formula,
    lower: list[list[bool]],
    upper: list[list[bool]],
    loop: int,
    data: st.DataObject,
) -> None:
    """Rounds may differ where an atom is not certain: signals of four rounds, drawn one by one."""
    must = [
        [a and b for a, b in zip(*rows, strict=True)] for rows in zip(lower, upper, strict=True)
    ]
    may = [[a or b for a, b in zip(*rows, strict=True)] for rows in zip(lower, upper, strict=True)]
    verdicts = {
        atom: Verdicts(time_set([*a, False]), time_set([*b, True]))
        for atom, a, b in zip(ATOMS, must, may, strict=True)
    }
    found = monitor(formula, verdicts, END, F(1), loop=F(loop))
    rounds = 4
    own = [
        list(range(PARTS)) + [p for _ in range(rounds - 1) for p in range(2 * loop, PARTS)]
        for _ in ATOMS
    ]
    drawn = [
        [must[i][p] or (may[i][p] and data.draw(st.booleans())) for p in parts]
        for i, parts in enumerate(own)
    ]
    signal = [
        {1: frozenset(atom.region for atom, row in zip(ATOMS, drawn, strict=True) if row[p])}
        for p in range(len(own[0]))
    ]
    # The last of the rounds that were drawn comes again and again.
    last = len(signal) - (PARTS - 2 * loop)
    meaning = Endless(signal, last, F(1), F(1))
    for part in range(PARTS):
        if marks(found.must)[part]:
            assert meaning.holds(formula, part)
        if not marks(found.may)[part]:
            assert not meaning.holds(formula, part)


@pytest.mark.parametrize(
    ("formula", "word", "loop", "value"),
    [
        # One letter a second: what effector 1 is in all along.
        (ir.Always(ir.Eventually(A, EVER), EVER), "-A--C", 0, True),
        (ir.Always(ir.Eventually(A, EVER), EVER), "-A--C", 2, False),
        (ir.Eventually(ir.Always(A, EVER), EVER), "C--AA", 3, True),
        (ir.Eventually(ir.Always(A, EVER), EVER), "C--AA", 2, False),
        (ir.Until(A, C), "AAAAA", 1, False),  # the least fixpoint: C never comes
        (ir.Until(A, C), "AC-AA", 1, True),
        (ir.Always(ir.Implies(A, in_window(C, 0, 4)), EVER), "A---C", 0, True),
        (
            ir.Always(ir.Implies(A, in_window(C, 5, 5)), EVER),
            "AC---",
            0,
            False,
        ),
        (ir.Always(in_window(A, 10**9, 10**9 + 5), EVER), "A----", 0, True),
        (ir.Always(in_window(A, 10**9, 10**9 + 3), EVER), "A----", 0, False),
        (ir.Next(A), "----A", 4, True),
    ],
)
def test_known_words(formula: ir.Formula, word: str, loop: int, value: bool) -> None:
    signals = [[letter == name for letter in word for _ in range(2)] for name in "AC"]
    sets = {
        atom: Verdicts(given_set(row, False), given_set(row, False))
        for atom, row in zip(ATOMS, signals, strict=True)
    }
    step = F(4) if isinstance(formula, ir.Next) else F(1)
    found = monitor(formula, sets, END, step, loop=F(loop))
    assert (0 in found.must, 0 in found.may) == (value, value)


def test_there_is_no_last_part() -> None:
    everywhere = Verdicts(TimeSet.all(END), TimeSet.all(END))
    with pytest.raises(ValueError, match="no last part"):
        monitor(ir.Last(F(1), A), {AtomKey("A", 1): everywhere}, END, F(1), loop=F(0))
    for start, end in ((F(1), F(1)), (F(-1), F(1))):
        with pytest.raises(ValueError, match="takes some time"):
            Lasso(start, end)
