"""Each operation pinned from both sides: the true value is allowed, a wrong one is not."""

from __future__ import annotations

from fractions import Fraction

import pytest

from compiler.encodings.region_terms import RealScript, between
from compiler.encodings.scalar_terms import ScalarTerms
from compiler.expressions.evaluators.balls import working_precision
from grammar_lang import ir
from solvers.backends.smt import solve_script
from solvers.verdict import Fails, Holds
from tests.oracles.arms import ArmBuilder, number


def verdict(arm, scalar, lower, upper):
    """Whether some parameters give the scalar a value in an interval."""
    script = RealScript()
    with working_precision(128):
        terms = ScalarTerms(arm.model(), script)
        terms.define({scalar[0]})
        bounds = Fraction(lower), Fraction(upper)
        script.assertion(*between(bounds, terms.term(scalar[0])))
    return solve_script("(set-logic QF_NRA)\n" + "\n".join(script.lines) + "\n(check-sat)\n")


def arm_with(*domain):
    arm = ArmBuilder()
    return arm, arm.parameter(*domain)


POLYNOMIALS = {
    # operation -> scalar of a parameter t in [2, 3], least and greatest value
    "t + 1": (lambda a, t: a.apply("+", t, 1), 3, 4),
    "1 - t": (lambda a, t: a.apply("-", 1, t), -2, -1),
    "-t": (lambda a, t: a.apply("neg", t), -3, -2),
    "t * t": (lambda a, t: a.apply("*", t, t), 4, 9),
    "t / 2": (lambda a, t: a.apply("/", t, 2), 1, "3/2"),
    "6 / t": (lambda a, t: a.apply("/", 6, t), 2, 3),
    "t ^ 5": (lambda a, t: [a.table.power(t[0], 5)], 32, 243),
    "t ^ -2": (lambda a, t: [a.table.power(t[0], -2)], "1/9", "1/4"),
    "|t|": (lambda a, t: a.apply("abs", t), 2, 3),
    "|-t|": (lambda a, t: a.apply("abs", a.apply("neg", t)), 2, 3),
    "|t - 5/2|": (lambda a, t: a.apply("abs", a.apply("-", t, "5/2")), 0, "1/2"),
    "sqrt(t * t)": (lambda a, t: a.apply("sqrt", a.apply("*", t, t)), 2, 3),
    "sqrt(6 t - 3)": (
        lambda a, t: a.apply("sqrt", a.apply("-", a.apply("*", 6, t), 3)),
        3,
        "3.873",
    ),
}


@pytest.mark.parametrize("name", POLYNOMIALS)
def test_algebraic_operations_are_exact(name):
    build, least, greatest = POLYNOMIALS[name]
    arm, t = arm_with(2, 3)
    scalar = build(arm, t)
    gap = Fraction(1, 1000)
    least, greatest = Fraction(least), Fraction(greatest)
    assert verdict(arm, scalar, least, greatest - gap) == Holds(None)
    assert verdict(arm, scalar, greatest - gap, greatest) == Holds(None)
    assert verdict(arm, scalar, greatest + gap, greatest + 1) == Fails(None)
    assert verdict(arm, scalar, least - 1, least - gap) == Fails(None)


CONSTANTS = {
    "pi": (lambda a: [a.table.pi()], "3.14159265", "3.14159266"),
    "cos 1": (lambda a: a.apply("cos", 1), "0.540302305", "0.540302306"),
    "sin 1": (lambda a: a.apply("sin", 1), "0.841470984", "0.841470985"),
    "tan 1": (lambda a: a.apply("tan", 1), "1.55740771", "1.55740774"),
    "sqrt 2": (lambda a: a.apply("sqrt", 2), "1.41421355", "1.41421357"),
    "cos 45 deg": (lambda a: a.apply("cos", a.degrees(45)), "0.70710677", "0.70710679"),
    "cos 60 deg": (lambda a: a.apply("cos", a.degrees(60)), "0.5", "0.5"),
    "sin -90 deg": (lambda a: a.apply("sin", a.degrees(-90)), "-1", "-1"),
    "sqrt 9/4": (lambda a: a.apply("sqrt", "9/4"), "1.5", "1.5"),
}


@pytest.mark.parametrize("name", CONSTANTS)
def test_constants_are_where_they_belong(name):
    build, lower, upper = CONSTANTS[name]
    arm = ArmBuilder()
    scalar = build(arm)
    gap = Fraction(1, 10**7)
    lower, upper = Fraction(lower), Fraction(upper)
    assert verdict(arm, scalar, lower, upper) == Holds(None)
    assert verdict(arm, scalar, lower - 10, lower - gap) == Fails(None)
    assert verdict(arm, scalar, upper + gap, upper + 10) == Fails(None)


def test_cosine_and_sine_of_a_parameter_share_the_circle():
    arm, t = arm_with(0, 1)
    c, s = arm.apply("cos", t), arm.apply("sin", t)
    total = arm.apply("+", arm.apply("*", c, c), arm.apply("*", s, s))
    assert verdict(arm, total, 1, 1) == Holds(None)
    assert verdict(arm, total, "1.001", 2) == Fails(None)
    assert verdict(arm, c, 0, "0.5") == Fails(None)  # cos 1 = 0.5403
    assert verdict(arm, s, "-1", "-0.001") == Fails(None)


def test_the_opposite_angle_has_the_opposite_sine():
    arm, t = arm_with(-1, 1)
    total = arm.apply("+", arm.apply("sin", t), arm.apply("sin", arm.apply("neg", t)))
    assert verdict(arm, total, 0, 0) == Holds(None)
    assert verdict(arm, total, "0.001", 2) == Fails(None)


def test_choices_are_a_disjunction():
    root = ir.Unary("sqrt", number(2))
    arm, t = arm_with(ir.Choices((number(1), root, number(3))))
    assert verdict(arm, t, 1, 1) == Holds(None)
    assert verdict(arm, t, "1.4142", "1.4143") == Holds(None)
    assert verdict(arm, t, "1.01", "1.41") == Fails(None)
    assert verdict(arm, t, "1.42", "2.99") == Fails(None)


def test_irrational_ends_are_rounded_outwards():
    arm, t = arm_with(ir.Unary("sqrt", number(2)), ir.Pi())
    assert verdict(arm, t, "1.4142135623", "1.4142135624") == Holds(None)
    assert verdict(arm, t, "3.1415926535", "3.1415926536") == Holds(None)
    assert verdict(arm, t, 0, "1.4142") == Fails(None)
    assert verdict(arm, t, "3.1416", 9) == Fails(None)


def test_values_at_which_an_expression_is_undefined_are_no_robots():
    arm, t = arm_with(0, 0)
    assert verdict(arm, arm.apply("/", 1, t), -9, 9) == Fails(None)
    arm, t = arm_with(-2, -1)
    assert verdict(arm, arm.apply("sqrt", t), -9, 9) == Fails(None)


def test_a_doubled_expression_does_not_double_the_script():
    arm, t = arm_with(1, 2)
    for _ in range(200):
        t = arm.apply("+", t, t)
    script = RealScript()
    terms = ScalarTerms(arm.model(), script)
    terms.define({t[0]})
    assert len("\n".join(script.lines)) < 20_000
