"""Consequences of formulas, against the meaning of formulas on all signals over a fine grid."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from fractions import Fraction

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from compiler.tasks.necessary import (
    Place,
    necessary_visits,
    permanently_avoided,
    task_avoidance,
    task_visits,
)
from grammar_lang import ir
from tests.oracles.formula_semantics import Meaning, Signal, signals
from tests.oracles.formulas import KINDS, TWO_ARMS, formulas, program, spec
from tests.oracles.some_cases import examples

REGIONS = """
region S box [-0.5, 0] x [-0.5, 0] m; region A box [0.5, 1] x [0.5, 1] m;
region C box [1, 1.5] x [0.5, 1] m; obstacle O box [2, 3] x [2, 3] m;
"""
HALF, SECOND = Fraction(1, 2), Fraction(1)


def task(clauses: str) -> ir.Task:
    return program(spec(f"start in S; {clauses}", REGIONS, arms=TWO_ARMS)).tasks["P"]


def places(found: Iterable[Place]) -> str:
    return " ".join(f"{place.region}{place.effector}" for place in found)


def plain(formula: str) -> str:
    """Plain regions are those of effector 1."""
    for name in "ACO":
        formula = formula.replace(name, f"{name} by effector 1")
    return formula.replace("1 by effector 1", "1")


@pytest.mark.parametrize(
    ("formula", "visits"),
    [
        ("A and eventually C", "A1 C1"),
        ("A or C", ""),
        ("(A and C) or eventually C", "C1"),
        ("A until C", "C1"),
        ("(A and O) until (C and A)", "A1 C1"),
        ("not (not A or not eventually C)", "A1 C1"),
        ("not (A implies always not C)", "A1 C1"),
        ("A implies C", ""),
        ("eventually[0 s, 3 s] (A and eventually C) and last[1 s] C", "A1 C1"),
        ("always[4 s, 9 s] A", "A1"),
        ("always[5 s, 9 s] A", ""),  # nothing is left of the window
        ("eventually[0 s, 2 s] always[3 s, 9 s] A", ""),
        ("eventually[0 s, 1 s] always[3 s, 9 s] A", "A1"),
        ("always eventually[0 s, 1 s] A", "A1"),
        ("eventually always[3 s, 9 s] A", ""),
        ("last[9 s] always[4 s, 9 s] A", "A1"),
        ("last[1 s] always[4 s, 9 s] A", ""),
        ("next next A", "A1"),
        ("not next not A", "A1"),
        ("eventually not next not A", ""),  # so it is at T
        ("not last[1 s] not A", "A1"),
        ("not (C until not A)", "A1"),
        ("not A until C", "C1"),
        ("always (A implies eventually C)", ""),
    ],
)
def test_visits(formula: str, visits: str) -> None:
    assert places(task_visits(task(f"satisfy {plain(formula)};"))) == visits


@pytest.mark.parametrize(
    ("formula", "deadlines"),
    [
        ("A and eventually C", "A1 0 C1 4"),
        ("eventually[1 s, 3 s] A", "A1 3"),
        ("eventually[0 s, 1 s] (A and eventually[0 s, 2 s] C)", "A1 1 C1 3"),
        ("eventually[0 s, 9 s] A", "A1 4"),
        ("eventually[0 s, 1 s] A or eventually[0 s, 2 s] A", "A1 2"),
        ("eventually[0 s, 1 s] A and eventually[0 s, 2 s] A", "A1 1"),
        ("always[2 s, 3 s] A", "A1 2"),
        ("last[1 s] A", "A1 3"),
        ("always eventually[0 s, 1 s] A", "A1 1"),
        ("C until A", "A1 4"),
        ("A until A", "A1 0"),
        ("next next A", "A1 1"),
        ("not always[0 s, 2 s] not A", "A1 2"),
    ],
)
def test_deadlines(formula: str, deadlines: str) -> None:
    found = task(f"satisfy {plain(formula)};")
    assert found.steps * found.step == 4
    times = task_visits(found).items()
    assert " ".join(f"{place.region}{place.effector} {by}" for place, by in times) == deadlines
    for_ever = task_visits(replace(found, repeat=True)).values()
    assert set(for_ever) == {Fraction(4)}


@pytest.mark.parametrize(
    ("formula", "avoided"),
    [
        ("always not A", "A"),
        ("always[0 s, 4 s] not A", "A"),
        ("always[0 s, 3.5 s] not A", ""),
        ("always[0.5 s, 9 s] not A", ""),
        ("not eventually (A or C)", "A C"),
        ("always (not A and (C implies O) and (not O or not O))", "A O"),
        ("not A until C", ""),
        ("last[4 s] not A and last[3 s] not C", "A"),
        ("always last[4 s] not A", "A"),
        ("always not A or always not C", ""),
        ("always (not A and not C) or always not C", "C"),
        ("always always[0 s, 1 s] not A", "A"),
        ("always always[1 s, 2 s] not A", ""),
        ("always (not A until not A)", "A"),
        ("always not (C until A)", "A"),
        ("always next not A", ""),
        ("always eventually not A", ""),
    ],
)
def test_avoidance(formula: str, avoided: str) -> None:
    found = task(f"satisfy {plain(formula)};")
    assert " ".join(task_avoidance(found, 1)) == avoided
    assert task_avoidance(found, 2) == task_avoidance(found, None) == ()


@pytest.mark.parametrize(
    ("formula", "avoided", "for_ever"),
    [
        ("always not A", "A", "A"),
        ("always[0 s, 10 s] not A", "A", ""),
        ("always always[0 s, 1 s] not A", "A", "A"),
        ("always (not A until not A)", "A", "A"),
    ],
)
def test_avoidance_for_ever(formula: str, avoided: str, for_ever: str) -> None:
    """What is not entered within the horizon may be entered in a later round."""
    found = task(f"satisfy {plain(formula)};")
    assert " ".join(task_avoidance(found, 1)) == avoided
    assert " ".join(task_avoidance(replace(found, repeat=True), 1)) == for_ever


def test_who() -> None:
    """`avoid` binds all effectors, a formula the one it names; clauses add up."""
    found = task(
        "avoid O with effector; avoid C with body; satisfy eventually A by effector 2; "
        "satisfy eventually A by effector 1 and always not C by effector 2;"
    )
    assert places(task_visits(found)) == "A1 A2"
    avoided = [task_avoidance(found, effector) for effector in (None, 1, 2, 3)]
    assert avoided == [("O",), ("O",), ("C", "O"), ("O",)]


def until(signal: Signal, by: Fraction) -> Signal:
    """The instants and open intervals of a signal, half a second each, that begin by a time."""
    return [
        part
        for number, part in enumerate(signal)
        if number // 2 * HALF < by or (number % 2 == 0 and number // 2 * HALF == by)
    ]


def holds_of_all(formula: ir.Formula, seconds: int, effectors: tuple[int, ...]) -> None:
    """Every signal that satisfies a formula does what is said to be necessary."""
    visits = necessary_visits(formula, Fraction(seconds), SECOND)
    avoided = permanently_avoided(formula, Fraction(seconds))
    if not visits and not avoided:
        return
    kinds = [frozenset(kind) for kind in KINDS["overlapping" if seconds == 1 else "disjoint"]]
    for signal in signals(kinds, 4 * seconds + 1, effectors):
        if Meaning(signal, HALF, SECOND).holds(formula):
            for place, by in visits.items():
                assert any(place.region in part[place.effector] for part in until(signal, by))
            for place in avoided:
                assert not any(place.region in part[place.effector] for part in signal)


@settings(max_examples=examples(15, 60), deadline=None)
@given(st.data())
def test_every_signal_that_satisfies_a_formula(data: st.DataObject) -> None:
    seconds = data.draw(st.integers(1, 2))
    formula = data.draw(formulas(seconds, 1, deep=5))
    holds_of_all(formula, seconds, (1,))
    holds_of_all(ir.Always(formula, ir.Window(Fraction(0), None)), seconds, (1,))


@settings(max_examples=examples(4, 8), deadline=None)
@given(st.data())
def test_of_two_effectors(data: st.DataObject) -> None:
    holds_of_all(data.draw(formulas(1, 2, deep=3)), 1, (1, 2))


@pytest.mark.slow
@settings(max_examples=1500, deadline=None)
@given(st.data())
def test_in_many_examples(data: st.DataObject) -> None:
    seconds = data.draw(st.integers(1, 2))
    formula = data.draw(formulas(seconds, 1, deep=8))
    holds_of_all(formula, seconds, (1,))
    holds_of_all(ir.Always(formula, ir.Window(Fraction(0), None)), seconds, (1,))


# --- Motions that may end at several times --------------------------------------------------------


def agrees_with_each_end(found: ir.Task) -> None:
    """What any number of steps makes necessary is necessary for each number of them."""
    each = [found.lasting(steps) for steps in range(1, found.steps + 1)]
    visits = [set(task_visits(one)) for one in each]
    assert set(task_visits(found)) == set.intersection(*visits)
    for effector in (1, 2):
        avoided = [set(task_avoidance(one, effector)) for one in each]
        assert set(task_avoidance(found, effector)) == set.intersection(*avoided)


@settings(max_examples=examples(60, 600), deadline=None)
@given(st.data())
def test_motions_of_any_number_of_steps(data: st.DataObject) -> None:
    seconds = data.draw(st.integers(1, 3))
    parts = data.draw(st.sampled_from([1, 2, 3]))
    asked = data.draw(st.lists(formulas(seconds, 2, deep=6), min_size=1, max_size=2))
    found = replace(
        task("reach S;"), satisfy=tuple(map(ir.Satisfy, asked)), at_most=True,
        step=Fraction(1, parts), steps=seconds * parts,
    )  # fmt: skip
    agrees_with_each_end(found)
    agrees_with_each_end(replace(found, repeat=True))


@settings(max_examples=examples(10, 40), deadline=None)
@given(st.data())
def test_every_signal_of_any_length(data: st.DataObject) -> None:
    """Whatever its end, a signal that satisfies a formula does what is said to be necessary."""
    formula = data.draw(formulas(2, 1, deep=5))
    found = replace(
        task("reach S;"), satisfy=(ir.Satisfy(formula),), at_most=True, step=SECOND, steps=2
    )
    kinds = [frozenset(kind) for kind in KINDS["disjoint"]]
    for seconds in (1, 2):
        for signal in signals(kinds, 4 * seconds + 1, (1,)):
            if Meaning(signal, HALF, SECOND).holds(formula):
                for place, by in task_visits(found).items():
                    assert any(place.region in part[place.effector] for part in until(signal, by))
                for region in task_avoidance(found, 1):
                    assert not any(region in part[1] for part in signal)


def test_the_end_of_a_window_may_lie_after_that_of_the_motion() -> None:
    clauses = {
        "satisfy always[4 s, 9 s] A by effector 1;": ("A1", "", ""),
        "satisfy eventually[3 s, 4 s] A by effector 1;": ("A1", "A1", ""),
        "satisfy last[3 s] not A by effector 1;": ("", "", ""),
        "satisfy last[4 s] not A by effector 1;": ("", "", "A"),
    }
    for clause, (fixed, open_ended, avoided) in clauses.items():
        found = task(clause)
        assert found.steps * found.step == 4
        shorter = replace(found, at_most=True)
        assert (places(task_visits(found)), places(task_visits(shorter))) == (fixed, open_ended)
        assert " ".join(task_avoidance(shorter, 1)) == avoided
