"""Formulas proved along tubes, against dense samples of the same motions by scipy.

Two rods of different lengths start with both joints turning and are driven by random torques; the
regions are squares with sides of slope 3/4, and one is asked of the elbow too.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from fractions import Fraction
from functools import lru_cache

import numpy as np
import pytest
from hypothesis import given, settings

from compiler.expressions.evaluators.balls import working_precision
from compiler.tasks.monitor import AtomKey
from compiler.tasks.specification import task_formula
from grammar_lang import ir
from solvers.verifier.proofs.formula_proof import FormulaProof, FormulaVerdict
from solvers.verifier.proofs.tube_checks import Status
from tests.oracles.driven_tips import (
    ACCURACY,
    FINE,
    STEP,
    STEPS,
    Corners,
    depths,
    polytope,
    proof,
    tilted_square,
    tips,
)
from tests.oracles.formulas import formulas
from tests.oracles.sampled_robustness import robustness
from tests.oracles.some_cases import examples
from tests.oracles.tasks import avoid, task

F = Fraction
SEEDS = (0, 1)
RATE = FINE / STEP
NEAR = 5e-3
"""Metres that a tip may travel between two samples."""
A, C, ELBOW = ir.Atom("A", 1), ir.Atom("C", 1), ir.Atom("A", 2)
KEYS: tuple[AtomKey, ...] = (AtomKey("A", 1), AtomKey("C", 1), AtomKey("A", 2), AtomKey("C", 2))


def regions(seed: int) -> dict[str, Corners]:
    """A where the tip is after 1 s, C where it is at the end."""
    motion = tips(seed)
    return {
        "A": tilted_square(motion.at(F(1), 1), F(3, 10)),
        "C": tilted_square(motion.at(STEPS * STEP, 1), F(1, 4)),
    }


@lru_cache
def proved(seed: int) -> FormulaProof:
    shapes = regions(seed)
    with working_precision(ACCURACY.bits):
        return proof(seed, {key: polytope(shapes[key[0]]) for key in KEYS})


@lru_cache
def sampled(seed: int) -> dict[AtomKey, np.ndarray]:
    shapes, motion = regions(seed), tips(seed)
    return {key: depths(shapes[key.region], motion.points[:, key.effector - 1]) for key in KEYS}


def verdict(seed: int, formula: ir.Formula) -> FormulaVerdict:
    with working_precision(ACCURACY.bits):
        return proved(seed).verdict(formula)


def by_samples(seed: int, formula: ir.Formula) -> float:
    return float(robustness(formula, sampled(seed), RATE, STEP)[0])


def agrees(found: FormulaVerdict, true: float) -> bool:
    """A bound on the right side and close; undecided only where samples cannot tell either."""
    if found.status is Status.UNDECIDED:
        return abs(true) <= NEAR
    if abs(true) == np.inf or abs(found.robustness) == np.inf:
        return found.robustness == true
    sign = 1 if found.status is Status.HOLDS else -1
    bound, size = sign * found.robustness, sign * true
    return 0 <= bound <= size + NEAR and bound >= 0.95 * size - NEAR


@pytest.mark.parametrize("seed", SEEDS)
@settings(max_examples=examples(8, 25), deadline=None)
@given(formulas(3, 2, deep=6))
def test_random_formulas(seed: int, formula: ir.Formula) -> None:
    assert agrees(verdict(seed, formula), by_samples(seed, formula))


def eventually(formula: ir.Formula, low: F | int = 0, high: F | int | None = None) -> ir.Formula:
    return ir.Eventually(formula, ir.Window(F(low), None if high is None else F(high)))


def always(formula: ir.Formula, low: F | int = 0, high: F | int | None = None) -> ir.Formula:
    return ir.Always(formula, ir.Window(F(low), None if high is None else F(high)))


CHOSEN: dict[str, tuple[ir.Formula, Status]] = {
    "there": (eventually(A), Status.HOLDS),
    "in this order": (eventually(ir.And((A, eventually(C)))), Status.HOLDS),
    "not before": (ir.Until(ir.Not(C), A), Status.HOLDS),
    "late": (eventually(A, 2), Status.FAILS),
    "always": (always(A), Status.FAILS),
    "away in time": (always(ir.Implies(A, eventually(ir.Not(A), 0, 1))), Status.HOLDS),
    "elsewhere at last": (ir.Last(F(1, 4), ir.Not(A)), Status.HOLDS),
    "next": (eventually(ir.And((ir.Not(A), ir.Next(A)))), Status.HOLDS),
    "two effectors": (always(ir.Not(ir.And((A, ELBOW)))), Status.HOLDS),
    "nothing asked": (always(A, 4, 5), Status.HOLDS),
}


@pytest.mark.parametrize("name", CHOSEN)
def test_chosen_formulas(name: str) -> None:
    """Both answers occur, as meant."""
    formula, status = CHOSEN[name]
    found = verdict(0, formula)
    assert found.status is status
    assert agrees(found, by_samples(0, formula))


def crossings(seed: int, key: AtomKey) -> list[tuple[float, int]]:
    """The times at which an effector crosses the boundary; +1 inwards.  To about 1e-5 s."""
    values, times = sampled(seed)[key], tips(seed).times
    found = []
    for i in np.flatnonzero(np.diff(np.sign(values))):
        share = values[i] / (values[i] - values[i + 1])
        found.append((times[i] + share * (times[i + 1] - times[i]), int(np.sign(values[i + 1]))))
    return found


MUTATED: dict[str, tuple[Callable[[F, F], ir.Formula], int, int]] = {
    "eventually": (lambda enter, _: eventually(A, 0, enter), 0, 1),
    "not until": (lambda enter, _: always(ir.Not(A), 0, enter), 0, -1),
    "always from": (lambda enter, leave: always(A, enter, leave - F(1, 10)), 0, 1),
    "always to": (lambda enter, leave: always(A, enter + F(1, 10), leave), 1, -1),
    "eventually from": (lambda _, leave: eventually(A, leave, 2), 1, -1),
    "nested": (lambda enter, _: eventually(eventually(A, 0, enter - F(1, 10)), 0, F(1, 10)), 0, 1),
    "last": (lambda _, leave: ir.Last(STEP * STEPS - leave, ir.Not(A)), 1, 1),
}


@pytest.mark.parametrize("name", MUTATED)
@pytest.mark.parametrize("seed", SEEDS)
def test_windows_that_end_just_before_or_after_a_crossing(seed: int, name: str) -> None:
    """A millisecond decides, and at the computed crossing itself nothing wrong is said."""
    make, which, sign = MUTATED[name]
    (enter, inwards), (leave, outwards) = crossings(seed, AtomKey("A", 1))[:2]
    assert (inwards, outwards) == (1, -1)
    times = [F(int(time * 10**6), 10**6) for time in (enter, leave)]

    def moved(by: F) -> Status:
        exact = list(times)
        exact[which] += by
        return verdict(seed, make(*exact)).status

    later, sooner = moved(F(1, 1000)), moved(F(-1, 1000))
    assert (later, sooner) == (
        (Status.HOLDS, Status.FAILS) if sign > 0 else (Status.FAILS, Status.HOLDS)
    )


def test_a_task_as_one_formula_has_the_verdict_of_its_parts() -> None:
    """``reach`` and ``avoid`` as sugar: by depths at the end, and distances all the time."""
    seen = set()
    for seed in SEEDS:
        for target in "AC":
            for avoided in (("A",), ("C",), ()):
                given = replace(task(avoid(*avoided), reach=target), step=STEP, steps=STEPS)
                formula = task_formula(given, 2, 0)
                assert formula is not None
                reached = sampled(seed)[AtomKey(target, 1)][-1]
                gaps = [-sampled(seed)[AtomKey(name, e)].max() for name in avoided for e in (1, 2)]
                found = verdict(seed, formula)
                assert agrees(found, min([reached, *gaps]))
                seen.add(found.status)
    assert seen == {Status.HOLDS, Status.FAILS}


HALF = F(3, 10)


def halves(seed: int, gap: Fraction) -> dict[AtomKey, Corners]:
    """Two tilted rectangles beside the place of the tip after 1 s, so far from each other."""
    x, y = (F(round(float(c) * 10**4), 10**4) for c in tips(seed).at(F(1), 1))
    ahead, across = (HALF * F(4, 5), HALF * F(3, 5)), (-HALF * F(3, 5), HALF * F(4, 5))

    def corner(along: Fraction, beside: Fraction) -> tuple[Fraction, Fraction]:
        return (
            x + along * ahead[0] + beside * across[0],
            y + along * ahead[1] + beside * across[1],
        )

    edge = gap / HALF / 2
    return {
        AtomKey("A", 1): [corner(*c) for c in ((edge, -1), (1, -1), (1, 1), (edge, 1))],
        AtomKey("C", 1): [corner(*c) for c in ((-1, -1), (-edge, -1), (-edge, 1), (-1, 1))],
    }


def between_halves(seed: int, gap: Fraction, formula: ir.Formula) -> tuple[FormulaVerdict, float]:
    """The verdict for halves that far apart, and the robustness by samples."""
    shapes = halves(seed, gap)
    with working_precision(ACCURACY.bits):
        found = proof(seed, {key: polytope(shape) for key, shape in shapes.items()})
        known = {key: depths(shape, tips(seed).points[:, 0]) for key, shape in shapes.items()}
        return found.verdict(formula), float(robustness(formula, known, RATE, STEP)[0])


def test_from_one_region_straight_into_another() -> None:
    """On the common edge neither is certain, but their union is; nothing is to spare."""
    first, second = (A, C) if sampled_half(0, "A") > 0 else (C, A)
    either = always(ir.Or((A, C)), F(9, 10), F(11, 10))
    until = eventually(ir.Until(first, second), F(9, 10), F(9, 10))
    wrong = eventually(ir.Until(second, first), F(9, 10), F(9, 10))
    for formula in (either, until):
        touching, _ = between_halves(0, F(0), formula)
        assert touching == FormulaVerdict(Status.HOLDS, 0.0)
        apart, true = between_halves(0, F(1, 100), formula)
        assert apart.status is Status.FAILS
        assert agrees(apart, true)
        overlapping, true = between_halves(0, F(-1, 10), formula)
        assert overlapping.status is Status.HOLDS
        assert overlapping.robustness > 0.02
        assert agrees(overlapping, true)
    assert between_halves(0, F(0), ir.And((either, until)))[0].status is Status.HOLDS
    assert between_halves(0, F(0), always(A, F(9, 10), F(11, 10)))[0].status is Status.FAILS
    assert between_halves(0, F(1, 100), wrong)[0].status is Status.HOLDS


def sampled_half(seed: int, name: str) -> float:
    """How deep the tip is in a half after 0.9 s."""
    index = int(F(9, 10) * RATE)
    shape = halves(seed, F(0))[AtomKey(name, 1)]
    return float(depths(shape, tips(seed).points[index : index + 1, 0])[0])
