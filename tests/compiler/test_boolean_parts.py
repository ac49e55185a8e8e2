"""The parts of formulas about one instant, and their truth tables."""

from __future__ import annotations

from fractions import Fraction
from itertools import product

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from compiler.tasks.monitor import AtomKey, boolean_parts, boolean_value
from grammar_lang import ir
from grammar_lang.ir.formula_parts import atoms, subformulas
from tests.oracles.formula_semantics import Meaning
from tests.oracles.formulas import formulas

A, C = ir.Atom("A", 1), ir.Atom("C", 1)
EITHER, BOTH = ir.Or((A, C)), ir.And((A, ir.Not(C)))
TEMPORAL = ir.Until | ir.Always | ir.Eventually | ir.Next | ir.Last


def test_the_largest_ones_are_found() -> None:
    always = ir.Always(EITHER, ir.Window(Fraction(0), None))
    assert boolean_parts(ir.And((always, ir.Not(ir.Until(EITHER, BOTH)), BOTH))) == (EITHER, BOTH)
    assert boolean_parts(ir.Implies(EITHER, BOTH)) == (ir.Implies(EITHER, BOTH),)
    assert boolean_parts(ir.Next(A)) == boolean_parts(A) == ()
    assert boolean_parts(ir.Or((ir.Next(A), ir.Not(A), C))) == (ir.Not(A),)


@given(formulas(3, 1, deep=8))
def test_they_are_timeless_and_no_atoms(formula: ir.Formula) -> None:
    for part in boolean_parts(formula):
        assert not isinstance(part, ir.Atom)
        assert not any(isinstance(inner, TEMPORAL) for inner in subformulas(part))


@settings(deadline=None)
@given(st.recursive(st.sampled_from([A, C]), lambda f: st.one_of(
    st.builds(ir.Not, f), st.builds(ir.Implies, f, f),
    st.builds(lambda a, b: ir.And((a, b)), f, f), st.builds(lambda a, b: ir.Or((a, b)), f, f),
)))  # fmt: skip
def test_truth_tables(formula: ir.Formula) -> None:
    for a, c in product((True, False), repeat=2):
        signal = [{1: frozenset("A" * a + "C" * c)}]
        expected = Meaning(signal, Fraction(1), Fraction(1)).holds(formula)
        assert boolean_value(formula, {AtomKey("A", 1): a, AtomKey("C", 1): c}) == expected


def test_formulas_in_time_have_no_such_value() -> None:
    with pytest.raises(ValueError, match="several instants"):
        boolean_value(ir.Next(A), {AtomKey("A", 1): True})


def test_atoms_are_listed_once_in_order() -> None:
    other = ir.Atom("A", 2)
    assert atoms(ir.Until(C, ir.Not(A)), ir.Or((C, other, A))) == (C, A, other)
