"""Contradictory tasks for ever, against the meaning of formulas on signals that repeat."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from grammar_lang import ir
from grammar_lang.diagnostics.diagnostic import Code, Severity, Sink
from grammar_lang.source import Span
from solvers.conflicts.vacuity import contradictions, formula_diagnostics
from tests.oracles.formula_semantics import signals
from tests.oracles.formulas import KINDS, SHAPES, program, spec, windows, without_window
from tests.oracles.lasso_semantics import Endless
from tests.oracles.some_cases import examples

START = "start in A;"


def marked(clauses: str, shapes: str = "disjoint") -> list[tuple[str, str, list[str]]]:
    """For each finding its severity, the marked text, and the texts that its notes mark."""
    text = spec(f"{clauses} repeat;", SHAPES[shapes])
    sink = Sink()
    formula_diagnostics(program(text), sink)
    assert {d.code for d in sink.found} <= {Code.CONTRADICTORY_TASK, Code.VACUOUS_FORMULA}
    assert all("horizon" not in d.hint for d in sink.found)
    return [
        (
            d.severity.value,
            text[d.span.start : d.span.end],
            [text[span.start : span.end] for span, _ in d.notes],
        )
        for d in sink.found
    ]


@pytest.mark.parametrize(
    ("formula", "parts"),
    [
        ("always A and eventually not A", ["always A", "eventually not A"]),
        (
            "eventually always not A and always eventually A",
            ["eventually always not A", "always eventually A"],
        ),
        ("eventually always A and eventually always C", None),
        ("eventually always A and always eventually C", None),
        ("always (A implies eventually C) and always eventually A and always not C", None),
        ("always eventually[0, 2] A and eventually always[0, 3] not A", None),
        ("always eventually[0, 99] A and eventually always not A", None),
        ("always[5, 9] A and eventually[6, 7] C", ["always[5, 9] A", "eventually[6, 7] C"]),
        ("(A until C) and always not C", ["A until C", "always not C"]),
        ("always (A until C) and eventually always A", None),
        ("always next A and eventually always not A", None),
        ("always (A implies next C) and eventually always A", None),
        ("always (A and C)", []),
        ("always eventually always A and always eventually C", None),
    ],
)
def test_a_formula_alone(formula: str, parts: list[str] | None) -> None:
    [(severity, text, notes)] = marked(f"start at (0); satisfy {formula};")
    assert severity == "error"
    assert text == formula or text in formula
    assert parts is None or notes == parts


def test_many_windows_of_one_part() -> None:
    """Each says of the next, and the last of the part that excludes it."""
    windows = " and ".join(f"always eventually[0 s, {k} s] A" for k in range(1, 30))
    formula = f"{windows} and eventually always[0 s, 30 s] not A"
    [(severity, text, notes)] = marked(f"start at (0); satisfy {formula};")
    assert (severity, text) == ("error", formula)
    assert len(notes) == 2


@pytest.mark.parametrize(
    ("clauses", "last", "others"),
    [
        (f"{START} reach C; satisfy always not C;", "always not C", ["reach C;"]),
        (f"{START} satisfy (C or not A) and A;", "(C or not A) and A", ["C or not A", "A"]),
        (f"{START} satisfy not A until C;", "not A until C", [START]),
        (
            f"{START} satisfy always eventually C; avoid C with effector;",
            "avoid C with effector;",
            ["always eventually C"],
        ),
        (
            f"{START} satisfy always eventually A; satisfy eventually always C;",
            "eventually always C",
            ["always eventually A"],
        ),
    ],
)
def test_clauses_together(clauses: str, last: str, others: list[str]) -> None:
    shapes = SHAPES["disjoint"].replace("region C", "obstacle C") if "avoid" in clauses else ""
    text = spec(f"{clauses} repeat;", shapes or SHAPES["disjoint"])
    sink = Sink()
    formula_diagnostics(program(text), sink)
    [found] = sink.found
    assert found.code is Code.CONTRADICTORY_TASK
    assert text[found.span.start : found.span.end] == last
    assert [text[span.start : span.end] for span, _ in found.notes] == others


@pytest.mark.parametrize(
    "clauses",
    [
        f"{START} satisfy always eventually A and always eventually C;",
        f"{START} satisfy eventually always C;",
        f"{START} reach C; satisfy always eventually A;",
        f"{START} satisfy always (A implies eventually C) and always (C implies eventually A);",
        f"{START} satisfy always eventually[0, 99] A and always eventually[0, 99] C;",
        f"{START} satisfy always eventually[0, 2] A and eventually always[0, 1] not A;",
        f"{START} satisfy always eventually[50, 60] C;",  # beyond the horizon, which only repeats
        f"{START} satisfy eventually[0, 3] C and always[9, 12] not C;",
        f"{START} satisfy eventually not A and always eventually A;",
        f"{START} satisfy A until C or A until not C;",
        f"{START} satisfy always (next C or next not C);",
    ],
)
def test_what_can_be_done(clauses: str) -> None:
    assert [each for each in marked(clauses) if each[0] == "error"] == []


def test_what_asks_for_nothing() -> None:
    assert marked(f"{START} reach C; satisfy eventually C;") == [
        ("warning", "eventually C", ["reach C;"])
    ]
    assert marked(f"{START} satisfy always eventually C; satisfy eventually C;") == []
    nested = f"{START} satisfy always eventually (A implies A or C);"
    assert [each[:2] for each in marked(nested)] == [
        ("warning", "always eventually (A implies A or C)")
    ]


def test_a_start_against_a_formula_is_told_once() -> None:
    text = spec(f"{START} satisfy always C; repeat;", SHAPES["disjoint"])
    at = text.index("C; repeat")
    sink = Sink()
    sink.error(Code.START_OUTSIDE_LOOP, "the motion starts outside", Span(at, at + 1), "", [])
    formula_diagnostics(program(text), sink)
    assert len(sink.found) == 1
    assert sink.found[0].severity is Severity.ERROR


# --- Against the definitions ----------------------------------------------------------------------


PROGRAMS = {
    name: program(spec("start at (0); satisfy A; repeat;", SHAPES[name])) for name in SHAPES
}


def told(name: str, formula: ir.Formula) -> bool:
    found = PROGRAMS[name]
    task = replace(
        found.tasks["P"], satisfy=(ir.Satisfy(formula),), steps=5, step=Fraction(1), repeat=True
    )
    return bool(contradictions(found, task))


def endless_formulas(*, deep: int) -> st.SearchStrategy[ir.Formula]:
    atoms: st.SearchStrategy[ir.Formula] = st.builds(ir.Atom, st.sampled_from("AC"), st.just(1))
    ever = st.just(ir.Window(Fraction(0), None))

    def grown(f: st.SearchStrategy[ir.Formula]) -> st.SearchStrategy[ir.Formula]:
        return st.one_of(
            *without_window(f),
            st.builds(ir.Always, f, windows(2)),
            st.builds(ir.Eventually, f, windows(2)),
            st.builds(ir.Always, f, ever),
            st.builds(ir.Eventually, f, ever),
        )

    return st.recursive(atoms, grown, max_leaves=deep)


def some_lasso(name: str, formula: ir.Formula, seconds: int) -> bool:
    """Whether a signal that is constant between multiples of half a second satisfies it."""
    half = Fraction(1, 2)
    kinds = [frozenset(kind) for kind in KINDS[name]]
    parts = 4 * seconds
    for signal in signals(kinds, parts + 1, (1,)):
        for loop in range(0, parts, 2):
            # The end of the round is the first instant of the next.
            if signal[parts] == signal[loop] and Endless(
                signal[:parts], loop, half, Fraction(1)
            ).holds(formula):
                return True
    return False


@settings(max_examples=examples(10, 300), deadline=None)
@given(st.data())
def test_no_lasso_does_what_is_told_to_be_impossible(data: st.DataObject) -> None:
    name = data.draw(st.sampled_from(sorted(SHAPES)))
    formula = ir.And(data.draw(st.tuples(*[endless_formulas(deep=4)] * 3)))
    if told(name, formula):
        assert not some_lasso(name, formula, 1)


@settings(max_examples=examples(20, 3000), deadline=None)
@given(st.data())
def test_what_a_drawn_signal_does_is_not_refused(data: st.DataObject) -> None:
    """Formulas that are made to hold of a signal: each is taken, or its negation."""
    name = data.draw(st.sampled_from(sorted(SHAPES)))
    kinds = [frozenset(kind) for kind in KINDS[name]]
    count = data.draw(st.integers(2, 6))
    instants = data.draw(st.lists(st.sampled_from(kinds), min_size=count, max_size=count))
    loop = data.draw(st.integers(0, count - 1))
    signal = []
    for k, kind in enumerate(instants):
        after = instants[k + 1] if k + 1 < count else instants[loop]
        between = [each for each in kinds if each <= kind and each <= after]
        signal += [{1: kind}, {1: data.draw(st.sampled_from(between))}]
    meaning = Endless(signal, 2 * loop, Fraction(1, 2), Fraction(1))
    drawn = data.draw(st.lists(endless_formulas(deep=6), min_size=3, max_size=6))
    true = tuple(each if meaning.holds(each) else ir.Not(each) for each in drawn)
    assert not told(name, ir.And(true))
