"""Formulas as text: what is printed reads back as the same formula."""

from __future__ import annotations

from fractions import Fraction

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from grammar_lang import ir
from grammar_lang.ir.formula_parts import formula_text
from tests.oracles.formulas import SHAPES, formulas, program, spec
from tests.oracles.some_cases import examples

A, C = ir.Atom("A", 1, numbered=False), ir.Atom("C", 2)
F = Fraction
SIXTH, HALF = (ir.Binary("*", ir.Num(part), ir.Pi()) for part in (F(1, 6), F(1, 2)))
ALIGNED = ir.Aligned("-y", (F(3, 4), F(-1)), SIXTH)
TURNED = ir.Oriented((("z", HALF), ("-z", SIXTH)), SIXTH)
POSES: tuple[tuple[ir.Pose, ...], ...] = ((), (ALIGNED,), (ALIGNED, TURNED))


def written(formula: ir.Formula) -> bool:
    """Whether the language can write its windows: it has none that begin later and never end."""
    match formula:
        case ir.Always(operand=part, window=w) | ir.Eventually(operand=part, window=w):
            return (w.upper is not None or w.lower == 0) and written(part)
        case ir.And(operands=parts) | ir.Or(operands=parts):
            return all(map(written, parts))
        case ir.Until(left=a, right=b) | ir.Implies(left=a, right=b):
            return written(a) and written(b)
        case ir.Not(operand=part) | ir.Next(operand=part) | ir.Last(operand=part):
            return written(part)
        case _:
            return True


def flat(formula: ir.Formula) -> ir.Formula:
    """Conjunctions of conjunctions as one, as their text reads."""
    match formula:
        case ir.And(operands=parts) | ir.Or(operands=parts):
            found: list[ir.Formula] = []
            for part in map(flat, parts):
                same = isinstance(part, type(formula))
                found += part.operands if same and isinstance(part, ir.And | ir.Or) else [part]
            return type(formula)(tuple(found))
        case ir.Until(left=a, right=b) | ir.Implies(left=a, right=b):
            return type(formula)(flat(a), flat(b))
        case ir.Always(operand=part, window=w) | ir.Eventually(operand=part, window=w):
            return type(formula)(flat(part), w)
        case ir.Not(operand=part) | ir.Next(operand=part):
            return type(formula)(flat(part))
        case ir.Last(operand=part, duration=d):
            return ir.Last(d, flat(part))
        case _:
            return formula


def read(text: str) -> ir.Formula:
    clauses = f"start in A by effector 1; satisfy {text};"
    arms = "(eps J eps L)+ eps E (eps J eps L)+ eps E"
    task = program(spec(clauses, SHAPES["overlapping"], horizon="40 steps of 1 s", arms=arms)).tasks
    return task["P"].satisfy[0].formula


@settings(max_examples=examples(30, 60), deadline=None)
@given(formulas(3, 2, deep=6, poses=POSES).filter(written))
def test_text_reads_back(formula: ir.Formula) -> None:
    assert flat(read(formula_text(formula))) == flat(formula)


TEXTS = [
    (ir.And((ir.Or((A, C)), ir.Not(A))), "(A or C by effector 2) and not A"),
    (ir.Until(ir.Until(A, C), ir.And((A, C))),
     "(A until C by effector 2) until (A and C by effector 2)"),
    (ir.Until(A, ir.Until(A, A)), "A until A until A"),
    (ir.Implies(ir.Implies(A, A), ir.Implies(A, A)), "(A implies A) implies A implies A"),
    (ir.Eventually(ir.Always(A, ir.Window(F(0), None)), ir.Window(F(1, 8), F(5, 2))),
     "eventually[0.125 s, 2.5 s] always A"),
    (ir.Last(F(1, 3), ir.Next(ir.Not(A))), "last[1 s / 3] next not A"),
    (ir.Last(F(20), ir.Or((A, ir.And((A, A))))), "last[20 s] (A or A and A)"),
]  # fmt: skip


@pytest.mark.parametrize(("formula", "text"), TEXTS)
def test_no_more_parentheses_than_needed(formula: ir.Formula, text: str) -> None:
    assert formula_text(formula) == text


@given(st.fractions(0, 40, max_denominator=30))
@settings(max_examples=30, deadline=None)
def test_times_are_exact(time: Fraction) -> None:
    found = read(formula_text(ir.And((A, ir.Last(time, A), ir.Not(ir.Atom("C", 2))))))
    assert isinstance(found, ir.And)
    assert found.operands[1] == ir.Last(time, ir.Atom("A", 1))
