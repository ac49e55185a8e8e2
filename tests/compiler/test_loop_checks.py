"""Starts that a loop cannot meet, and starts that it can."""

from __future__ import annotations

import pytest

from compiler.checks.loop_checks import loop_diagnostics
from grammar_lang.diagnostics.diagnostic import Code, Sink
from tests.oracles.formulas import ONE_ARM, SHAPES, TWO_ARMS, program, spec


def found(clauses: str, shapes: str = "disjoint", arms: str = ONE_ARM) -> list[str]:
    """The texts that are marked."""
    text = spec(clauses, SHAPES[shapes], arms=arms)
    sink = Sink([])
    loop_diagnostics(program(text), sink)
    assert {each.code for each in sink.found} <= {Code.START_OUTSIDE_LOOP}
    assert all(each.notes and each.hint for each in sink.found)
    return [text[each.span.start : each.span.end] for each in sink.found]


@pytest.mark.parametrize(
    ("formula", "marked"),
    [
        ("always C", ["C"]),
        ("always[0 s, 1 s] C", ["C"]),
        ("always not A", ["A"]),
        ("C", ["C"]),
        ("not eventually A", ["A"]),
        ("not (A implies C until A)", []),
        ("not (C implies A)", ["C", "A"]),
        ("always (C and not A)", ["C", "A"]),
        ("always A", []),
        ("always[1 s, 2 s] C", []),
        ("eventually C", []),
        ("eventually always C", []),
        ("always (C or A)", []),
        ("always eventually C", []),
        ("A until C", []),
        ("next C", []),
    ],
)
def test_starts(formula: str, marked: list[str]) -> None:
    clauses = f"start in A; satisfy {formula};"
    assert found(f"{clauses} repeat;") == marked
    assert found(clauses) == []


@pytest.mark.parametrize(
    ("shapes", "formula", "marked"),
    [
        # Only the start that meets a region nowhere is wrong, or one that is all within it.
        ("touching", "always C", []),
        ("overlapping", "always C", []),
        ("overlapping", "always not C", []),
        ("nested", "always not C", []),
        ("nested", "always C", []),
    ],
)
def test_starts_that_a_motion_may_choose(shapes: str, formula: str, marked: list[str]) -> None:
    assert found(f"start in A; satisfy {formula}; repeat;", shapes) == marked


def test_a_start_inside_what_is_never_entered() -> None:
    assert found("start in C; satisfy always not A; repeat;", "nested") == ["A"]


@pytest.mark.parametrize(
    ("clauses", "marked"),
    [
        ("start in A by effector 1; satisfy always C by effector 1;", ["C by effector 1"]),
        ("start in A by effector 2; satisfy always C by effector 1;", []),
        ("start in A; satisfy always C by effector 1;", []),
    ],
)
def test_who_starts(clauses: str, marked: list[str]) -> None:
    assert found(f"{clauses} repeat;", arms=TWO_ARMS) == marked


FEW = "eps J eps L eps E"
"""One robot: a link of 0.5 to 2 m."""


@pytest.mark.parametrize(
    ("start", "formula", "marked"),
    [
        # By the cosine and the sine of 30 degrees it is within (0.43, 0.25) and (1.74, 1).
        ("(30 deg)", "always C", ["C"]),
        ("(30 deg)", "always not C", []),
        ("(30 deg)", "always A", []),
        ("(30 deg)", "always not A", []),
        # Longer links than 1 m end outside of A.
        ("(0 deg)", "always A", []),
        ("(150 deg)", "always A", ["A"]),
        ("(150 deg)", "not eventually A", []),
        ("(150 deg)", "always (A or C)", []),
        ("(150 deg)", "eventually always A", []),
        # On the face of A for all lengths: neither side is certain.
        ("(90 deg)", "always A", []),
        ("(90 deg)", "always not A", []),
        # As many values as no robot has.
        ("(30 deg, 10 deg)", "always C", []),
    ],
)
def test_given_starts(start: str, formula: str, marked: list[str]) -> None:
    clauses = f"start at {start}; satisfy {formula};"
    assert found(f"{clauses} repeat;", arms=FEW) == marked
    assert found(clauses, arms=FEW) == []


def test_a_given_start_inside_what_is_never_entered() -> None:
    """The tip is at 45 degrees, 0.35 to 1.4 m off in x and y; a square of 3 m holds all of that."""
    wide = "region A box [0, 3] x [0, 3] m; region C box [0.5, 1] x [0.5, 1] m;"
    text = spec("start at (45 deg); satisfy always not A; repeat;", wide, arms=FEW)
    sink = Sink([])
    loop_diagnostics(program(text), sink)
    (only,) = sink.found
    assert (only.code, text[only.span.start : only.span.end]) == (Code.START_OUTSIDE_LOOP, "A")
    assert only.message == "the motion starts inside `A`, but this must hold at all times"
    undecided = text.replace("always not A", "always not C")
    sink = Sink([])
    loop_diagnostics(program(undecided), sink)
    assert sink.found == []


def test_families_without_end() -> None:
    """Those robots count that have as many joints as values are given."""
    assert found("start at (150 deg, 0 deg); satisfy always A; repeat;") == ["A"]
    bounded = "start at (150 deg, 0 deg); satisfy always A; repeat; modules <= 6;"
    assert found(bounded) == ["A"]
    # Any number of links may follow a joint.
    clauses = "start at (150 deg); satisfy always A; repeat;"
    assert found(clauses, arms="eps J (eps L)+ eps E") == []
