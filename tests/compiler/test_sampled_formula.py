"""Formulas on samples: their meaning on words, and that they suffice in continuous time."""

from __future__ import annotations

import random
from fractions import Fraction

import pytest
from hypothesis import event, given, settings
from hypothesis import strategies as st

from compiler.tasks.sampled_formula import holds, is_timed, sampled
from compiler.tasks.word_formula import nodes
from grammar_lang import ir
from tests.oracles.formula_semantics import Meaning, Signal
from tests.oracles.formulas import KINDS, formulas
from tests.oracles.plans import untimed
from tests.oracles.some_cases import examples
from tests.oracles.word_semantics import Cells, signal_of, true_at, words

A, C = ir.Atom("A", 1), ir.Atom("C", 1)
A2 = ir.Atom("A", 2)
EVER = ir.Window(Fraction(0), None)
STEP, PARTS = Fraction(2), 4
"""Samples are 2 s apart, times of formulas whole seconds, changes of cell multiples of 0.5 s."""


class Remembered(Meaning):
    """As ``Meaning``, each subformula and part once."""

    def __init__(self, signal: Signal) -> None:
        super().__init__(signal, STEP / PARTS, STEP)
        self.known: dict[tuple[int, int], bool] = {}

    def holds(self, formula: ir.Formula, part: int = 0) -> bool:
        key = id(formula), part
        if key not in self.known:
            self.known[key] = super().holds(formula, part)
        return self.known[key]


def kinds(shape: str) -> list[frozenset[str]]:
    return [frozenset(kind) for kind in KINDS[shape]]


def some_words(shape: str, steps: int, effectors: int, seed: int) -> list[Cells]:
    every = list(words(kinds(shape), steps, range(1, effectors + 1)))
    rng = random.Random(seed)
    return rng.sample(every, 150) if len(every) > 150 else every


def motions(word: Cells, seed: int) -> list[Signal]:
    """Motions that follow a word, with changes late, early, in the middle and anywhere."""
    rng = random.Random(seed)
    every: list[list[dict[int, int]]] = [
        [dict.fromkeys(word[0], at) for _ in word] for at in range(1, PARTS)
    ]
    every += [[{e: rng.randrange(1, PARTS) for e in word[0]} for _ in word] for _ in range(4)]
    return [signal_of(word, PARTS, changes) for changes in every]


CASES = st.tuples(
    st.sampled_from(sorted(KINDS)), st.integers(1, 3), st.integers(1, 2), st.integers(0, 10**6)
).flatmap(lambda case: st.tuples(st.just(case), formulas(2 * case[1], case[2], deep=5)))


@settings(max_examples=examples(10, 35), deadline=None)
@given(CASES)
def test_words_that_satisfy_it_are_followed_by_motions_that_satisfy_the_formula(
    case: tuple[tuple[str, int, int, int], ir.Formula],
) -> None:
    (shape, steps, effectors, seed), formula = case
    strengthened = sampled(formula, STEP, steps)
    satisfying = [w for w in some_words(shape, steps, effectors, seed) if holds(strengthened, w)]
    event(f"satisfied: {bool(satisfying)}")
    for word in satisfying[:25]:
        for motion in motions(word, seed):
            assert Remembered(motion).holds(formula), word


@settings(max_examples=examples(8, 25), deadline=None)
@given(CASES)
def test_the_meaning_on_words_is_that_of_the_definitions(
    case: tuple[tuple[str, int, int, int], ir.Formula],
) -> None:
    (shape, steps, effectors, seed), formula = case
    strengthened = sampled(formula, STEP, steps)
    for word in some_words(shape, steps, effectors, seed)[:30]:
        for i in range(steps + 1):
            assert holds(strengthened, word, i) is true_at(strengthened, word, i)


@settings(max_examples=35, deadline=None)
@given(
    st.sampled_from(sorted(KINDS)),
    formulas(4, 1, deep=5).map(untimed),
    st.integers(0, 3),
    st.integers(0, 10**6),
)
def test_without_times_it_does_not_matter_when_positions_are_entered(
    shape: str, formula: ir.Formula, changes: int, seed: int
) -> None:
    strengthened = sampled(formula, Fraction(1), changes)
    rng, parts = random.Random(seed), 9
    for positions in some_words(shape, changes, 1, seed):
        if not holds(strengthened, positions):
            continue
        instants = [0, *sorted(rng.sample(range(1, parts), changes))]
        signal = []
        for part in range(2 * parts + 1):
            there = [i for i, at in enumerate(instants) if 2 * at <= part]
            here = positions[there[-1]][1]
            if there[-1] and 2 * instants[there[-1]] == part:
                here |= positions[there[-2]][1]
            signal.append({1: here})
        assert Meaning(signal, Fraction(1), Fraction(1)).holds(formula), positions


def word(text: str) -> Cells:
    """One effector: ``A AC -``."""
    return [{1: frozenset(cell.strip("-"))} for cell in text.split()]


def within(lower: Fraction | int, upper: Fraction | int) -> ir.Window:
    return ir.Window(Fraction(lower), Fraction(upper))


@pytest.mark.parametrize(
    ("formula", "satisfied", "violated"),
    [
        # Straight from one region into the next.
        (ir.Until(A, C), "A A C", "A - C"),
        (ir.Until(ir.Not(C), A), "- - A", "- C A"),
        # After the change of cells there is no first instant without A.
        (ir.Until(A, ir.And((C, ir.Not(A)))), "C A A", "A AC C"),
        (ir.Always(ir.Or((A, C)), EVER), "A C A", "A - C"),
        # At the instant of change from C to A both hold.
        (ir.Always(ir.Or((ir.Not(A), ir.Not(C))), EVER), "A - C", "A C C"),
        (ir.Always(ir.Implies(A, ir.Eventually(C, EVER)), EVER), "A - C", "C A -"),
        (ir.Always(ir.Eventually(A, EVER), EVER), "- - A", "A A -"),
        (ir.Eventually(ir.Always(A, EVER), EVER), "- - A", "A A -"),
        (ir.Last(Fraction(0), A), "- - A", "A A -"),
        (ir.Last(Fraction(2), A), "- A A", "- - A"),
        # From 3 s before the end, which is no sample: from the one before.
        (ir.Last(Fraction(3), A), "A A A", "- A A"),
        (ir.Not(ir.Last(Fraction(3), A)), "A - A", "- A A"),
        (ir.Eventually(A, within(2, 3)), "- A -", "- - A"),
        # Between two samples: all the way.
        (ir.Eventually(A, within(1, 1)), "A A -", "A - -"),
        (ir.Always(A, within(1, 3)), "A A A", "- A A"),
        (ir.Always(A, within(2, 2)), "- A -", "A - A"),
        (ir.Next(A), "- A -", "A - A"),
        (ir.Next(ir.Next(ir.Next(A))), "", "A A A"),
        (ir.Not(ir.Next(ir.Next(ir.Next(A)))), "A A A", ""),
        (ir.Always(ir.Next(A), EVER), "", "A A A"),
        (ir.Always(ir.Not(ir.Next(ir.Not(A))), EVER), "- A A", "- - A"),
        # At every instant within the next 4 s: each sample serves those before it.
        (ir.Always(ir.Eventually(A, within(0, 4)), EVER), "A - A", "A - -"),
        (ir.Always(ir.Eventually(A, within(0, 2)), within(0, 2)), "A A A", "A - A"),
        (ir.Not(ir.Until(A, C)), "A - C", "A A C"),
        (ir.Not(ir.Until(A, C)), "A A A", "C A A"),
    ],
)  # fmt: skip
def test_what_is_asked_of_three_samples(formula: ir.Formula, satisfied: str, violated: str) -> None:
    strengthened = sampled(formula, STEP, 2)
    if satisfied:
        assert holds(strengthened, word(satisfied))
    if violated:
        assert not holds(strengthened, word(violated))


def always(part: ir.Formula) -> ir.Formula:
    return ir.Always(part, EVER)


NOT_BOTH = ir.Or((ir.Not(A), ir.Not(C)))
EXACTLY_ONE = ir.Or((ir.And((A, ir.Not(C))), ir.And((C, ir.Not(A)))))


@pytest.mark.parametrize(
    "formula",
    [
        always(NOT_BOTH),
        always(ir.Or((NOT_BOTH, ir.Eventually(A, within(0, 2))))),
        ir.Until(NOT_BOTH, A),
        ir.Until(A, NOT_BOTH),
        always(ir.Until(A, C)),
        always(ir.Until(ir.Not(A), ir.Not(C))),
        always(ir.Until(A, ir.Not(C))),
        always(ir.Not(ir.Until(A, C))),
        ir.Not(ir.Until(A, ir.And((A, C)))),
        ir.Until(ir.Eventually(A, within(0, 2)), C),
        ir.Eventually(always(EXACTLY_ONE), EVER),
        always(ir.Eventually(A, within(0, 2))),
        ir.Always(ir.Eventually(A, within(1, 4)), within(0, 2)),
        always(ir.Implies(A, ir.Eventually(C, within(1, 3)))),
        always(ir.Implies(A, ir.Always(C, within(1, 3)))),
        ir.Always(ir.Next(ir.Or((A, C))), within(0, 3)),
        ir.Last(Fraction(3), NOT_BOTH),
    ],
)
def test_all_motions_along_all_words_of_some_formulas(formula: ir.Formula) -> None:
    strengthened = sampled(formula, STEP, 3)
    satisfying = [
        w
        for shape in ("touching", "nested")
        for w in words(kinds(shape), 3, [1])
        if holds(strengthened, w)
    ]
    assert satisfying
    for word in random.Random(1).sample(satisfying, min(60, len(satisfying))):
        for motion in motions(word, 1):
            assert Remembered(motion).holds(formula), word


def test_effectors_change_cells_one_by_one() -> None:
    """(A1 and A2) or neither: while one has changed and the other has not, it is false."""
    both = ir.And((A, A2))
    neither = ir.And((ir.Not(A), ir.Not(A2)))
    formula = sampled(ir.Always(ir.Or((both, neither)), EVER), STEP, 1)
    inside, outside = frozenset("A"), frozenset[str]()
    assert holds(formula, [{1: inside, 2: inside}] * 2)
    assert not holds(formula, [{1: inside, 2: inside}, {1: outside, 2: outside}])


def test_what_is_timed() -> None:
    untimed = ir.Until(ir.Always(A, EVER), ir.Implies(ir.Eventually(C, EVER), ir.Not(A)))
    assert not is_timed(untimed)
    assert not is_timed(ir.Last(Fraction(0), ir.Or((untimed, ir.And((A, C))))))
    timed = [
        ir.Next(A),
        ir.Last(Fraction(1), A),
        ir.Always(A, within(0, 3)),
        ir.Eventually(A, ir.Window(Fraction(1), None)),
    ]
    for part in timed:
        for whole in (part, ir.Not(part), ir.Or((A, part)), ir.Until(A, part), ir.Implies(part, A)):
            assert is_timed(whole)


def test_deep_formulas_are_small_graphs() -> None:
    formula: ir.Formula = A
    for k in range(40):
        formula = ir.Until(ir.Not(formula), C) if k % 2 else ir.Always(ir.Or((formula, C)), EVER)
    strengthened = sampled(formula, STEP, 5)
    assert not holds(strengthened, word("- - - - - -"))
    assert sum(1 for _ in nodes(strengthened)) < 2000
