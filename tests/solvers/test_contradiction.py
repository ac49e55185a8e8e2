"""Contradictory tasks, against the meaning of formulas on all signals over a fine grid."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from grammar_lang import ir
from grammar_lang.diagnostics.diagnostic import Code, Sink
from solvers.conflicts.vacuity import contradictions, formula_diagnostics
from tests.oracles.formula_semantics import Meaning, signals
from tests.oracles.formulas import KINDS, SHAPES, TWO_ARMS, formulas, program, spec
from tests.oracles.some_cases import examples

REGIONS = """
region S box [-0.5, 0] x [-0.5, 0] m;
region A box [0.5, 1] x [0.5, 1] m; region C box [0.8, 1.5] x [0.5, 1] m;
obstacle O box [2, 3] x [2, 3] m; region Inner box [2.2, 2.5] x [2.2, 2.5] m;
obstacle Left box [0, 1] x [2, 3] m; obstacle Right box [1, 2] x [2, 3] m;
region Bridge box [0.5, 1.5] x [2.2, 2.8] m;
region Far box [9, 10] x [0, 1] m;
target T box [3, 3.5] x [0, 0.5] m;
"""


def marked(clauses: str, **other: str) -> list[tuple[str, list[str]]]:
    """For each error the marked text, and the texts that its notes mark."""
    text = spec(clauses, REGIONS, **other)
    found = program(text)
    sink = Sink()
    formula_diagnostics(found, sink)
    assert all(d.hint for d in sink.found)
    return [
        (
            text[d.span.start : d.span.end],
            [text[span.start : span.end] for span, _ in d.notes],
        )
        for d in sink.found
        if d.code is Code.CONTRADICTORY_TASK
    ]


START, REACH = "start in S;", "reach T;"
AVOID = "avoid O with effector;"


@pytest.mark.parametrize(
    ("formula", "parts"),
    [
        ("always O and eventually not O", ["always O", "eventually not O"]),
        (
            "A and eventually[0 s, 3 s] A and always[0 s, 4 s] not A",
            ["A", "always[0 s, 4 s] not A"],
        ),
        (
            "eventually[0 s, 3 s] A and always[0 s, 4 s] not A",
            ["eventually[0 s, 3 s] A", "always[0 s, 4 s] not A"],
        ),
        ("eventually (A and S)", []),
        ("not (always not A or not eventually S) and always A", None),
        ("eventually[4.5 s, 9 s] A", []),  # after the horizon
        ("last[0] next A", []),
        ("eventually[4 s, 4 s] next A", []),
        ("always next A", []),
        ("eventually Far", []),  # outside the bounds
        ("A until S and not S", ["A until S", "not S"]),  # no effector jumps
        ("(not A until A) and always not A", ["not A until A", "always not A"]),
        ("always[0, 1] A and always[1, 2] S", ["always[0, 1] A", "always[1, 2] S"]),
        ("always (A implies next not A) and always A", None),
        ("always eventually[0, 1] A and always[1, 3] not A", None),
        ("last[2] A and eventually[2, 4] always[0, 1] not A", None),
    ],
)
def test_a_formula_alone(formula: str, parts: list[str] | None) -> None:
    [(text, notes)] = marked(f"start at (0); satisfy {formula};")
    if parts is None:
        assert formula.startswith(text) or formula.endswith(text)
    else:
        assert text == formula
        assert notes == parts


@pytest.mark.parametrize(
    ("clauses", "last", "others"),
    [
        (f"{START} {REACH} satisfy last[1 s] S;", "satisfy last[1 s] S", [REACH]),
        (f"{START} {REACH} satisfy always not S;", "satisfy always not S", [START]),
        (f"{START} {AVOID} satisfy eventually Inner;", "satisfy eventually Inner", [AVOID]),
        (f"satisfy eventually Inner; {START} {AVOID}", AVOID, ["eventually Inner"]),
        (
            f"{START} avoid Left, O, Right with effector; satisfy eventually Bridge;",
            "satisfy eventually Bridge",
            ["avoid Left, O, Right with effector;"],
        ),
        (
            (
                f"{START} satisfy always (A implies eventually C); satisfy eventually A; "
                "satisfy always not C;"
            ),
            "satisfy always not C",
            ["always (A implies eventually C)", "eventually A"],
        ),
        (f"{START} satisfy S until A;", "satisfy S until A", [START]),
        ("start in S; reach S; satisfy not last[0] S;", "satisfy not last[0] S", ["reach S;"]),
    ],
)
def test_clauses_together(clauses: str, last: str, others: list[str]) -> None:
    assert marked(clauses) == [(last.removeprefix("satisfy "), others)]


def test_every_contradiction_is_told() -> None:
    found = marked(
        f"{START} {REACH} satisfy eventually Far; satisfy always not S; satisfy eventually A; "
        "satisfy last[1] A; satisfy next (A and S);"
    )
    assert sorted(found) == [
        ("always not S", [START]),
        ("eventually Far", []),
        ("last[1] A", [REACH]),
        ("next (A and S)", []),
    ]


@pytest.mark.parametrize(
    "clauses",
    [
        f"{START} {REACH} satisfy eventually A and eventually C and always not O;",
        f"{START} {REACH} {AVOID} satisfy eventually (A and C);",
        f"{START} {REACH} satisfy not T until A;",
        f"{START} {REACH} satisfy eventually[0 s, 3 s] A and always[3.5 s, 4 s] not A;",
        f"{START} avoid Inner with effector; satisfy eventually O;",
        f"{START} avoid O with body; satisfy eventually Inner;",  # the effector is no body
        f"{START} avoid Left with effector; satisfy eventually Bridge;",
        f"{START} {REACH} satisfy always[9, 10] A;",  # nothing is left of the window
        f"{START} {REACH} satisfy last[9] not A;",
        f"{START} satisfy always (A or not A);",
        "start at (0); satisfy always (A implies next not A);",
        f"{START} {REACH} satisfy always not Far;",
    ],
)
def test_what_can_be_done(clauses: str) -> None:
    assert marked(clauses) == []


def test_an_end_that_is_avoided_is_told_elsewhere() -> None:
    assert marked("start in Inner; avoid O with effector; satisfy eventually A;") == []


def test_which_effector() -> None:
    """Of several effectors, any may start or reach where the task names none."""
    one = "satisfy always not S by effector 1;"
    assert marked(f"{START} {REACH} {one}", arms=TWO_ARMS) == []
    assert len(marked(f"{START} reach T by effector 1; {one}", arms=TWO_ARMS)) == 1
    assert len(marked(f"start in S by effector 1; {REACH} {one}", arms=TWO_ARMS)) == 1
    assert marked(f"start in S by effector 2; {REACH} {one}", arms=TWO_ARMS) == []
    assert len(marked(f"{START} {REACH} {one}")) == 1
    both = "satisfy eventually (A by effector 1 and S by effector 2);"
    assert marked(f"start at (0); {both}", arms=TWO_ARMS) == []


def test_too_long_to_be_looked_at() -> None:
    contradictory = "start at (0); satisfy always[0, 3 s] A and eventually[0, 0.01 s] not A;"
    assert len(marked(contradictory, horizon="1 steps of 1 s")) == 1
    assert marked(contradictory, horizon="100000 steps of 1 s") == []


def test_many_regions() -> None:
    """More cells than can be looked at: those of what is only avoided are left out."""
    boxes = [f"region R{k} box [{k}, {k + 40}] x [0, 9] cm;" for k in range(70)]
    names = ", ".join(f"R{k}" for k in range(70))
    text = spec(
        f"start at (0); avoid {names} with effector; satisfy eventually (S and A);",
        REGIONS + " ".join(boxes),
    )
    found = program(text)
    assert len(contradictions(found, found.tasks["P"])) == 1


PROGRAMS = {name: program(spec("start at (0); satisfy A;", SHAPES[name])) for name in SHAPES}


def told(name: str, formula: ir.Formula, seconds: int) -> bool:
    found = PROGRAMS[name]
    task = replace(
        found.tasks["P"], satisfy=(ir.Satisfy(formula),), steps=seconds, step=Fraction(1)
    )
    return bool(contradictions(found, task))


def some_signal(name: str, formula: ir.Formula, seconds: int, effectors: tuple[int, ...]) -> bool:
    """Whether a signal that is constant between the multiples of half a second satisfies it."""
    half = Fraction(1, 2)
    kinds = [frozenset(kind) for kind in KINDS[name]]
    return any(
        Meaning(signal, half, Fraction(1)).holds(formula)
        for signal in signals(kinds, 4 * seconds + 1, effectors)
    )


@settings(max_examples=examples(10, 50), deadline=None)
@given(st.data())
def test_no_signal_does_what_is_told_to_be_impossible(data: st.DataObject) -> None:
    name = data.draw(st.sampled_from(sorted(SHAPES)))
    seconds = data.draw(st.integers(1, 2))
    parts = data.draw(st.tuples(*[formulas(seconds, 1, deep=4)] * 3))
    formula = ir.And(parts)
    if told(name, formula, seconds):
        assert not some_signal(name, formula, seconds, (1,))


@settings(max_examples=examples(8, 15), deadline=None)
@given(st.data())
def test_nor_do_two_effectors(data: st.DataObject) -> None:
    formula = ir.And(data.draw(st.tuples(*[formulas(1, 2, deep=4)] * 3)))
    if told("disjoint", formula, 1):
        assert not some_signal("disjoint", formula, 1, (1, 2))


@settings(max_examples=examples(8, 30), deadline=None)
@given(st.data())
def test_windows_of_one_region_are_decided(data: st.DataObject) -> None:
    """Without nesting nothing is lost: what no signal does is told."""
    name = data.draw(st.sampled_from(sorted(SHAPES)))
    literal = st.builds(lambda r, n: ir.Not(ir.Atom(r, 1)) if n else ir.Atom(r, 1),
                        st.sampled_from("AC"), st.booleans())  # fmt: skip
    bound = st.integers(0, 3).map(Fraction)
    window = st.tuples(bound, bound).map(lambda p: ir.Window(min(p), max(p)))
    part = st.builds(ir.Always, literal, window) | st.builds(ir.Eventually, literal, window)
    formula = ir.And(tuple(data.draw(st.lists(part, min_size=2, max_size=4))))
    assert told(name, formula, 2) is not some_signal(name, formula, 2, (1,))


@pytest.mark.slow
@settings(max_examples=2000, deadline=None)
@given(st.data())
def test_no_signal_in_many_examples(data: st.DataObject) -> None:
    name = data.draw(st.sampled_from(sorted(SHAPES)))
    seconds = data.draw(st.integers(1, 2))
    formula = ir.And(data.draw(st.tuples(*[formulas(seconds, 1, deep=6)] * 2)))
    if told(name, formula, seconds):
        assert not some_signal(name, formula, seconds, (1,))
