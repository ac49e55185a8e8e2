"""Formulas without influence, against the meaning of formulas on all signals over a fine grid."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from compiler.tasks.necessary_conditions import conjuncts, necessary_conditions
from grammar_lang import ir
from grammar_lang.diagnostics.diagnostic import Code, Severity, Sink
from grammar_lang.ir.formula_parts import occurrences, strengthened
from solvers.conflicts.vacuity import (
    ConditionConflicts,
    Entailment,
    always_holds,
    contradictions_among,
    formula_diagnostics,
    without_influence,
)
from tests.oracles.formula_semantics import Meaning, Signal, signals
from tests.oracles.formulas import KINDS, SHAPES, TWO_ARMS, formulas, program, spec
from tests.oracles.some_cases import examples

POSED = "aligned x to (0, 1) within 5 deg"
OTHER = "aligned y to (0, 1) within 5 deg"
REGIONS = """
region S box [-0.5, 0] x [-0.5, 0] m;
region A box [0.5, 1] x [0.5, 1] m; region Inner box [0.6, 0.7] x [0.6, 0.7] m;
region B box [1.5, 2] x [0.5, 1] m; obstacle C box [2.5, 3] x [0.5, 1] m;
region Far box [9, 10] x [0, 1] m; target T box [3, 3.5] x [0, 0.5] m;
"""
HALF, SECOND = Fraction(1, 2), Fraction(1)


def told(clauses: str, **other: str) -> list[tuple[str, str, list[str]]]:
    """For each warning whether the formula asks for nothing or a part is idle, where, and why."""
    text = spec(clauses, REGIONS, **other)
    found = program(text)
    sink = Sink()
    formula_diagnostics(found, sink)
    assert all(d.code is Code.VACUOUS_FORMULA for d in sink.found)
    assert all(d.severity is Severity.WARNING and d.hint for d in sink.found)
    return [
        (
            "nothing" if "requires nothing" in d.message else d.message.rpartition("is ")[2],
            text[d.span.start : d.span.end],
            [text[span.start : span.end] for span, _ in d.notes],
        )
        for d in sink.found
    ]


START, AVOID = "start in S;", "avoid C with effector;"


@pytest.mark.parametrize(
    ("clauses", "formula", "because"),
    [
        (f"{START} {AVOID} satisfy", "always (C implies eventually B)", [AVOID]),
        (f"{START} satisfy", "always[5 s, 9 s] A", []),  # T is 4 s
        (f"{START} satisfy", "not eventually Far", []),
        (f"{START} satisfy", "always (Inner implies A)", []),
        (f"{START} satisfy", "always not (A and B)", []),
        (f"{START} satisfy", "S or eventually B", [START]),
        (f"{START} reach T; satisfy", "eventually T", ["reach T;"]),
        (f"{START} reach T; satisfy", "eventually (T or B) and not A",
         [START, "reach T;"]),
        (f"{START} {AVOID} satisfy eventually B and", "always not C", [AVOID]),
        (f"{START} satisfy", f"always not (A {POSED} and B)", []),
        (f"{START} satisfy", f"always (A {POSED} implies A)", []),
    ],
)  # fmt: skip
def test_a_formula_that_asks_for_nothing(clauses: str, formula: str, because: list[str]) -> None:
    assert told(f"{clauses} {formula};") == [("nothing", formula, because)]


@pytest.mark.parametrize(
    ("clauses", "truth", "part", "because"),
    [
        (f"{AVOID} satisfy eventually C or eventually B;", "never", "eventually C", [AVOID]),
        ("satisfy always not C; satisfy always (C implies eventually B);", "never",
         "eventually B", ["always not C"]),
        ("satisfy always not C and always (C implies eventually B);", "never",
         "eventually B", ["always not C"]),
        ("satisfy always (A implies eventually B); satisfy last[1 s] B;", "always", "A",
         ["last[1 s] B"]),
        ("satisfy eventually (A or Inner);", "never", "Inner", []),
        ("satisfy eventually B or eventually[5 s, 9 s] (A and eventually B);", "never",
         "eventually[5 s, 9 s] (A and eventually B)", []),  # the largest part, not its atoms
        (f"{AVOID} satisfy eventually ((C or A) until B);", "never", "C or A", []),
    ],
)  # fmt: skip
def test_a_part_without_influence(clauses: str, truth: str, part: str, because: list[str]) -> None:
    assert told(f"{START} {clauses}") == [(f"{truth} true", part, because)]


@pytest.mark.parametrize(
    "clauses",
    [
        f"{START} satisfy eventually[0 s, 3 s] (A and eventually B) and last[1 s] B;",
        f"{START} reach T; {AVOID} satisfy eventually A and eventually B;",
        f"{START} satisfy not B until A;",
        f"{START} satisfy eventually B; satisfy always (A implies eventually[0 s, 1 s] not A);",
        f"{START} satisfy always (A implies next not A);",
        f"{START} {AVOID} satisfy always (A implies eventually B);",
        f"{START} avoid C with body; satisfy always (C implies eventually B);",  # no body
        f"{START} reach T; satisfy last[1 s] T;",
        f"{START} satisfy eventually Inner and eventually A;",  # the first says more
        f"{START} reach T; satisfy eventually (T {POSED});",
        f"{START} reach T; satisfy always not (T {POSED});",
        f"{START} satisfy always (S implies S {POSED});",
        f"{START} satisfy eventually (A {POSED}) and not A until B;",
        f"{START} satisfy always (Inner {POSED} implies A {OTHER});",
    ],
)
def test_what_has_influence(clauses: str) -> None:
    assert told(clauses) == []


@pytest.mark.parametrize(("effector", "idle"), [(1, True), (2, False)])
def test_effectors_have_their_own_regions(effector: int, idle: bool) -> None:
    never = "satisfy always not A by effector 1;"
    then = f"satisfy always (A by effector {effector} implies eventually B by effector 1);"
    found = told(f"{START} {never} {then}", arms=TWO_ARMS)
    assert [where for _, where, _ in found] == ["eventually B by effector 1"] * idle


def test_errors_come_first() -> None:
    text = spec(f"{START} satisfy always not S; satisfy always not Far;", REGIONS)
    sink = Sink()
    formula_diagnostics(program(text), sink)
    assert [d.code for d in sink.found] == [Code.CONTRADICTORY_TASK]


@pytest.mark.parametrize("formula", [f"eventually (Far {POSED})", f"always (A {POSED} and B)"])
def test_poses_do_not_hide_a_contradiction(formula: str) -> None:
    sink = Sink()
    formula_diagnostics(program(spec(f"{START} satisfy {formula};", REGIONS)), sink)
    assert [d.code for d in sink.found] == [Code.CONTRADICTORY_TASK]


def test_one_finding_for_a_formula() -> None:
    found = told(f"{START} {AVOID} satisfy eventually B or eventually C or eventually Far;")
    assert len(found) == 1
    found = told(f"{START} satisfy always not Far; satisfy eventually B or eventually Far;")
    assert [where for _, where, _ in found] == ["always not Far", "eventually Far"]


def test_nothing_is_said_beyond_the_budget(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("solvers.conflicts.vacuity.EXTRA_CLAUSES", 0)
    assert told(f"{START} {AVOID} satisfy always (C implies eventually B);") == []


# --- occurrences ---------------------------------------------------------------------------------


@settings(max_examples=examples(30, 60), deadline=None)
@given(formulas(1, 1, deep=5), st.data())
def test_a_strengthened_formula_is_stronger(formula: ir.Formula, data: st.DataObject) -> None:
    parts = list(occurrences(formula))
    assert parts[0].formula == formula
    part = data.draw(st.sampled_from(parts))
    stronger = strengthened(formula, part)
    kinds = [frozenset(kind) for kind in KINDS["overlapping"]]
    for signal in signals(kinds, 5, (1,)):
        meaning = Meaning(signal, HALF, SECOND)
        assert meaning.holds(formula) or not meaning.holds(stronger)


# --- soundness -----------------------------------------------------------------------------------


PROGRAMS = {name: program(spec("start at (0); satisfy A;", SHAPES[name])) for name in SHAPES}


def judged(name: str, given_formulas: tuple[ir.Formula, ...], seconds: int) -> int:
    """How many vacuities are found, each of which holds of all signals."""
    found = PROGRAMS[name]
    satisfy = tuple(map(ir.Satisfy, given_formulas))
    task = replace(found.tasks["P"], satisfy=satisfy, steps=seconds, step=SECOND)
    asked = necessary_conditions(found, task)
    assert asked is not None
    conflicts = ConditionConflicts(asked)
    if contradictions_among(task, asked.demands, conflicts):
        conflicts.close()
        return 0
    entailment, count = Entailment(asked, conflicts), 0
    for number, formula in enumerate(given_formulas):
        for part in conjuncts(formula):
            if always_holds(part, entailment) is not None:
                count += 1
                assert all(Meaning(s, HALF, SECOND).holds(part) for s in motions(name, seconds))
            idle = without_influence(part, number, entailment)
            if idle is not None:
                count += 1
                stronger = strengthened(part, idle[0])
                whole = ir.And((*given_formulas, ir.Not(stronger)))
                assert not any(
                    Meaning(s, HALF, SECOND).holds(whole) for s in motions(name, seconds)
                )
    conflicts.close()
    return count


def motions(name: str, seconds: int) -> list[Signal]:
    return list(signals([frozenset(kind) for kind in KINDS[name]], 4 * seconds + 1, (1,)))


@settings(max_examples=examples(20, 60), deadline=None)
@given(st.data())
def test_what_is_told_holds_of_all_signals(data: st.DataObject) -> None:
    name = data.draw(st.sampled_from(sorted(SHAPES)))
    judged(name, data.draw(st.tuples(*[formulas(1, 1, deep=4)] * 2)), 1)


@settings(max_examples=examples(12, 25), deadline=None)
@given(st.data())
def test_the_same_with_what_is_idle_by_construction(data: st.DataObject) -> None:
    """`A or eventually (A and F)`, and a window after the end: what is told of F is true."""
    name = data.draw(st.sampled_from(sorted(SHAPES)))
    inner = data.draw(formulas(1, 1, deep=3))
    late = ir.Eventually(inner, ir.Window(Fraction(2), None))
    atom = ir.Atom("A", 1)
    first = ir.Or((ir.Eventually(atom, ir.Window(Fraction(0), None)), late))
    assert judged(name, (first,), 1) > 0


@pytest.mark.slow
@settings(max_examples=800, deadline=None)
@given(st.data())
def test_in_many_examples(data: st.DataObject) -> None:
    name = data.draw(st.sampled_from(sorted(SHAPES)))
    seconds = data.draw(st.integers(1, 2)) if name in ("disjoint", "nested") else 1
    judged(name, data.draw(st.tuples(*[formulas(seconds, 1, deep=6)] * 2)), seconds)
