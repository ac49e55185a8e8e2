"""`carry` in tasks: what it means, and what is reported."""

from __future__ import annotations

from fractions import Fraction

import pytest

from grammar_lang import ir
from grammar_lang.diagnostics.diagnostic import Sink
from grammar_lang.formatting.formatter import canonical
from grammar_lang.ir.formula_parts import formula_text
from tests.grammar_lang.test_poses import read
from tests.oracles.small_specs import TURNER, replaced


def carries(clauses: str) -> tuple[ir.Carry, ...]:
    task, diagnostics = read(clauses)
    assert task is not None, diagnostics
    assert not [each for each in diagnostics if each.severity.name == "ERROR"], diagnostics
    return task.carries


def test_a_load() -> None:
    (found,) = carries("reach T; carry 500 g from S to T;")
    assert (found.mass, found.effector) == (Fraction(1, 2), None)
    assert (found.source, found.target) == ("S", "T")
    assert found.rates.bound == Fraction(1, 1000)


def test_effectors_and_rates() -> None:
    found = carries(
        "reach T by effector 2; carry 1 kg from S to T rates <= 3 deg/s;"
        " carry (1/3) kg from T to S by effector 1;"
    )
    assert [(each.mass, each.effector) for each in found] == [(1, 2), (Fraction(1, 3), 1)]
    # Three degrees: below pi / 60, as the bound has to hold.
    assert 0.052359877 < float(found[0].rates.bound) <= 0.0523598776


def test_what_a_load_asks_of_a_motion_as_a_formula() -> None:
    (found,) = carries("reach T; carry 1 kg from S to T by effector 1;")
    text = "eventually (S by effector 1 and eventually T by effector 1)"
    assert formula_text(found.visits) == text


def test_loads_count_for_robust_payload() -> None:
    task, diagnostics = read("reach T; carry 1 kg from S to T; robust payload 5 %;")
    assert task is not None, diagnostics
    assert task.robust is not None
    assert task.robust.payload == Fraction(1, 20)


@pytest.mark.parametrize(
    ("clauses", "said"),
    [
        ("reach T; carry 0 kg from S to T;", "the load is not positive"),
        ("reach T; carry 2 m from S to T;", "expected a mass (kg)"),
        ("reach T; carry 1 kg from S to Nowhere;", "no region `Nowhere`"),
        ("reach T; carry 1 kg from S to T; carry 2 kg from S to T;", "a second `carry`"),
        (
            "reach T by effector 1; carry 1 kg from S to T; carry 2 kg from S to T by effector 1;",
            "a second `carry`",
        ),
        (
            "reach T; carry 1 kg from S to T; carry 1 kg from T to S by effector 1;",
            "a second `carry`",
        ),
        ("reach T; carry 1 kg from S to T by effector 0;", "at least 1"),
        ("reach T; carry 1 kg from S to T rates <= 0;", "write more than zero"),
        ("reach T; carry 1 kg from S to T rates <= 3 m;", "expected"),
        ("reach T; carry 1 kg from S to T; repeat;", "for ever cannot `carry`"),
        ("reach T; carry 1 kg from S;", "expected `to`"),
        ("reach T; carry from S to T;", "from"),
    ],
)
def test_loads_that_are_none(clauses: str, said: str) -> None:
    _, diagnostics = read(clauses)
    errors = [each for each in diagnostics if each.severity.name == "ERROR"]
    assert errors
    assert any(said in f"{each.message} {each.hint}" for each in errors), diagnostics
    assert all(each.hint for each in errors), diagnostics


def test_names_that_are_words_elsewhere() -> None:
    """`from`, `to`, `carry` are names of regions, too."""
    text = replaced(TURNER, "target T", "region to box [0, 1] x [0, 1] m; target T")
    task, diagnostics = read("reach T; carry 1 kg from to to T;", text)
    assert task is not None, diagnostics
    assert task.carries[0].source == "to"


def test_canonical_form() -> None:
    loose = "reach T; carry   2kg from  S to T by   effector 1 rates<=0.1 ;"
    written = canonical(replaced(TURNER, "reach T;", loose), Sink())
    assert written is not None
    assert "  carry 2 kg from S to T by effector 1 rates <= 0.1;\n" in written
