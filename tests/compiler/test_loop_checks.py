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
        ("start at (0); satisfy always C by effector 1;", []),
    ],
)
def test_who_starts(clauses: str, marked: list[str]) -> None:
    assert found(f"{clauses} repeat;", arms=TWO_ARMS) == marked
