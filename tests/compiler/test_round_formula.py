"""What is asked of one round is enough for all of them: signals on a grid, read both ways."""

from __future__ import annotations

from fractions import Fraction

from hypothesis import given, settings
from hypothesis import strategies as st

from compiler.tasks.round_formula import on_one_round
from grammar_lang import ir
from tests.compiler.test_lasso import (
    EVER,
    LOOPS,
    PARTS,
    SECONDS,
    A,
    C,
    endless_formulas,
    settled,
)
from tests.oracles.formula_semantics import Meaning
from tests.oracles.lasso_semantics import Endless
from tests.oracles.some_cases import examples

F = Fraction
MARKS = st.lists(st.booleans(), min_size=PARTS, max_size=PARTS)


@settings(max_examples=examples(300, 3000), deadline=None)
@given(endless_formulas(), st.lists(MARKS, min_size=2, max_size=2), LOOPS, st.integers(1, 3))
def test_one_round_is_enough(
    formula: ir.Formula, signals: list[list[bool]], loop: int, step: int
) -> None:
    """The last instant of the round is the first one of the loop."""
    signal = settled(signals)
    closed = [*signal, signal[2 * loop]]
    asked = on_one_round(formula, F(loop), F(SECONDS))
    if Meaning(closed, F(1), F(step)).holds(asked):
        assert Endless(signal, 2 * loop, F(1), F(step)).holds(formula)


def holds(word: str, loop: int, formula: ir.Formula) -> bool:
    """Whether what is asked of a round is true of one letter a second."""
    signals = [[letter == name for letter in word for _ in range(2)] for name in "AC"]
    signal = settled(signals)
    closed = [*signal, signal[2 * loop]]
    return Meaning(closed, F(1), F(1)).holds(on_one_round(formula, F(loop), F(SECONDS)))


def test_usual_formulas_are_asked_in_full() -> None:
    again = ir.Always(ir.And((ir.Eventually(A, EVER), ir.Eventually(C, EVER))), EVER)
    assert holds("A-C--", 0, again)
    assert not holds("A-C--", 1, again)
    stays = ir.Eventually(ir.Always(A, EVER), EVER)
    assert holds("C-AAA", 2, stays)
    assert not holds("C-AAA", 1, stays)
    answered = ir.Always(ir.Implies(A, ir.Eventually(C, EVER)), EVER)
    # The answer to the last A comes in the next round.
    assert holds("-C-A-", 0, answered)
    assert not holds("C--A-", 1, answered)
    until = ir.Always(ir.Until(ir.Not(A), C), EVER)
    assert holds("--C-C", 0, until)
    assert not holds("--C-A", 0, until)
