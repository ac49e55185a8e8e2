"""Obligations: every word that meets them satisfies the formula, whatever else it does."""

from __future__ import annotations

from fractions import Fraction

from hypothesis import given
from hypothesis import strategies as st

from compiler.tasks.sampled_formula import sampled
from compiler.tasks.word_formula import (
    Literal,
    Obligation,
    Throughout,
    Until,
    Word,
    holds,
    obligations,
)
from grammar_lang import ir
from tests.oracles.formulas import formulas

STEPS, EFFECTORS = 6, 2
LETTERS = st.sampled_from([frozenset(names) for names in ("", "A", "C", "AC")])
WORDS = st.lists(
    st.fixed_dictionaries({e + 1: LETTERS for e in range(EFFECTORS)}),
    min_size=STEPS + 1,
    max_size=STEPS + 1,
)


def meets(word: Word, needed: tuple[Obligation, ...]) -> bool:
    return all(
        (item.region in word[sample][item.effector + 1]) is item.inside
        for item in needed
        for sample in range(item.first, item.last + 1)
    )


@given(formulas(STEPS, EFFECTORS, deep=6), WORDS, WORDS)
def test_what_meets_the_obligations_satisfies(formula: ir.Formula, word: Word, other: Word) -> None:
    discrete = sampled(formula, Fraction(1), STEPS)
    needed = obligations(discrete, word)
    assert (needed is None) is not holds(discrete, word)
    if needed is None:
        return
    assert meets(word, needed)
    # Another word, changed only where it breaks an obligation.
    mended = [dict(letter) for letter in other]
    for item in needed:
        for sample in range(item.first, item.last + 1):
            letter = mended[sample][item.effector + 1] - {item.region}
            mended[sample][item.effector + 1] = letter | ({item.region} if item.inside else set())
    assert meets(mended, needed)
    assert holds(discrete, mended)


def letters(text: str) -> Word:
    return [{1: frozenset(letter.strip("-"))} for letter in text]


A, NOT_C = Literal("A", 1, positive=True), Literal("C", 1, positive=False)


def test_the_needs_of_an_until_end_where_it_is_fulfilled() -> None:
    assert obligations(Until(NOT_C, A), letters("---AC")) == (
        Obligation("A", 0, True, 3, 3),
        Obligation("C", 0, False, 0, 2),
    )


def test_of_a_window_the_middle_of_a_visit_is_needed() -> None:
    visit = sampled(
        ir.Eventually(ir.Atom("A", 1), ir.Window(Fraction(0), Fraction(4))), Fraction(1), 8
    )
    assert obligations(visit, letters("-AAA--A--")) == (Obligation("A", 0, True, 2, 2),)
    assert obligations(visit, letters("------A--")) is None


def test_samples_in_a_row_are_one_obligation() -> None:
    assert obligations(Throughout(NOT_C, 1, 3), letters("C---C")) == (
        Obligation("C", 0, False, 1, 3),
    )
