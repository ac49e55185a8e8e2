"""Contradictions in the order of events, whatever the times, against the meaning of formulas."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from compiler.tasks.event_order import EVENT_LIMIT, events, order_conditions
from grammar_lang import ir
from grammar_lang.diagnostics.diagnostic import Code, Sink
from solvers.conflicts.vacuity import ConditionConflicts, formula_diagnostics
from tests.oracles.formula_semantics import Meaning, signals
from tests.oracles.formulas import KINDS, SHAPES, formulas, program, spec, without_window
from tests.oracles.some_cases import examples

HALF = Fraction(1, 2)
REGIONS = """
region S box [-0.5, 0] x [-0.5, 0] m; region A box [0.5, 1] x [0.5, 1] m;
region C box [0.8, 1.5] x [0.5, 1] m; region D box [2, 2.5] x [0, 1] m;
target T box [3, 3.5] x [0, 1] m;
"""
FIXED, AT_MOST = "8 steps of 0.5 s", "at most 8 steps of 0.5 s"
HORIZONS = pytest.mark.parametrize("horizon", [FIXED, AT_MOST, f"{FIXED}; repeat"])


def marked(clauses: str, horizon: str) -> list[tuple[str, list[str]]]:
    """For each error the marked text, and the texts that its notes mark."""
    text = spec(clauses, REGIONS, horizon=horizon)
    sink = Sink()
    formula_diagnostics(program(text), sink)
    return [
        (text[d.span.start : d.span.end], [text[s.start : s.end] for s, _ in d.notes])
        for d in sink.found
        if d.code is Code.CONTRADICTORY_TASK
    ]


@HORIZONS
@pytest.mark.parametrize(
    "parts",
    [
        ["not S until D", "not D until S"],
        ["not S until D", "not D until T", "not T until S"],
        ["eventually (S and eventually D)", "not S until T", "always (T implies always not D)"],
        ["eventually (S or D)", "not S until T", "not D until T", "always not T"],
        ["not always not (S and not always not D)", "always (D implies always D) and always not D"],
        ["S until D", "always (D implies always S)"],
        ["eventually (D and (not T until S))", "always (S implies always T)"],
        ["always (S or D)", "S", "eventually D"],  # no motion jumps
        ["(S or A or C) until D", "S"],
        ["eventually[1 s, 2 s] (S and next D)", "not S until D", "always (D implies always D)"],
    ],
)
def test_parts_of_a_formula(parts: list[str], horizon: str) -> None:
    formula = " and ".join(f"({part})" for part in parts)
    [(text, notes)] = marked(f"start at (0); satisfy {formula};", horizon)
    assert text in formula
    assert notes or text != formula


@HORIZONS
@pytest.mark.parametrize(
    "clauses",
    [
        "start in S; satisfy not A until C; satisfy not C until A;",  # they overlap
        "start in S; satisfy not T until D; satisfy eventually (D and eventually S);",
        "start in S; satisfy eventually (A and eventually (D and eventually A));",
        "start in S; satisfy (not D until T) or (not T until D);",
        "start in S; satisfy always (S implies eventually D) and eventually (D and eventually S);",
        "start in S; satisfy eventually[3 s, 4 s] D and (not D until T);",
        "start in S; satisfy not (D until T) and eventually T;",
        "start in S; satisfy (A or not A) until D;",
    ],
)
def test_what_can_be_done(clauses: str, horizon: str) -> None:
    assert marked(clauses, horizon) == []


@pytest.mark.parametrize("horizon", [FIXED, AT_MOST])
def test_the_end_is_the_last_event(horizon: str) -> None:
    reach = "start in S; reach T;"
    assert marked(f"{reach} satisfy always (T implies eventually D);", horizon)
    assert marked(f"{reach} satisfy eventually (D and always D);", horizon)
    assert marked(f"{reach} satisfy last[1 s] D;", horizon)
    assert not marked(f"{reach} satisfy always (D implies eventually T);", horizon)


def test_the_hint_is_about_the_order() -> None:
    text = spec("start at (0); satisfy (not S until D) and (not D until S);", REGIONS)
    sink = Sink()
    formula_diagnostics(program(text), sink)
    assert [d.hint for d in sink.found] == ["check the order in which it asks for its regions"]


def test_too_many_events() -> None:
    one = "eventually S"
    several = " and ".join([one] * (EVENT_LIMIT - 1))
    contradiction = "(not S until D) and (not D until S)"
    assert marked(f"start at (0); satisfy {contradiction}; satisfy {several};", AT_MOST) == []


# --- Against the definitions ----------------------------------------------------------------------


PROGRAMS = {name: program(spec("start at (0); satisfy A;", SHAPES[name])) for name in SHAPES}


def told(name: str, formula: ir.Formula) -> bool:
    """Whether the order of events, and nothing else, refutes a formula."""
    found = PROGRAMS[name]
    task = replace(found.tasks["P"], satisfy=(ir.Satisfy(formula),), step=Fraction(1))
    asked = order_conditions(found, task)
    assert asked is not None
    conflicts = ConditionConflicts(asked)
    try:
        return conflicts.exclude(asked.demands)
    finally:
        conflicts.close()


def some_signal(name: str, formula: ir.Formula, parts: int) -> bool:
    """Whether a signal that is constant between the multiples of half a second satisfies it."""
    kinds = [frozenset(kind) for kind in KINDS[name]]
    return any(
        Meaning(signal, HALF, Fraction(1)).holds(formula) for signal in signals(kinds, parts, (1,))
    )


@settings(max_examples=examples(12, 600), deadline=None)
@given(st.data())
def test_no_signal_of_any_length_does_what_is_told_to_be_impossible(data: st.DataObject) -> None:
    name = data.draw(st.sampled_from(sorted(SHAPES)))
    formula = ir.And(data.draw(st.tuples(*[formulas(2, 1, deep=4)] * 3)))
    if told(name, formula):
        assert not any(some_signal(name, formula, parts) for parts in (1, 3, 5, 9))


EVER = ir.Window(Fraction(0), None)
LITERALS = st.builds(lambda r, n: ir.Not(ir.Atom(r, 1)) if n else ir.Atom(r, 1),
                     st.sampled_from("AC"), st.booleans())  # fmt: skip
STATES = LITERALS | st.builds(lambda a, b: ir.Or((a, b)), LITERALS, LITERALS)
ORDERS = st.one_of(
    st.builds(ir.Until, STATES, LITERALS),
    st.builds(ir.Always, STATES, st.just(EVER)),
    st.builds(ir.Eventually, LITERALS, st.just(EVER)),
)


@settings(max_examples=examples(25, 400), deadline=None)
@given(st.sampled_from(sorted(SHAPES)), st.lists(ORDERS, min_size=2, max_size=3))
def test_orders_of_events_are_decided(name: str, parts: list[ir.Formula]) -> None:
    """Three events at most, so a signal of five instants shows what can be done."""
    formula = ir.And(tuple(parts))
    assert told(name, formula) is not some_signal(name, formula, 9)


@settings(max_examples=examples(50, 500), deadline=None)
@given(st.recursive(LITERALS, lambda f: st.one_of(*without_window(f)), max_leaves=6))
def test_events_are_counted_in_a_formula_or_its_negation(formula: ir.Formula) -> None:
    assert events(ir.Not(formula)) == events(formula, positive=False)
    assert events(ir.And((formula, ir.Not(formula)))) == events(formula) + events(ir.Not(formula))
