"""A module's own dynamics: what it means, and every way to get it wrong."""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from itertools import permutations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from grammar_lang import ir
from grammar_lang.load import load_text

Check = Callable[[str], list[tuple[str, str]]]

DOFS = "dof q: revolute z; dof d: prismatic x;"
MODULE = f"module M {{ role joint; {DOFS} param b in [0, 1] N*m*s; const c = 2 kg; "


def module(body: str) -> ir.Module:
    loaded = load_text(f"module M {{ role joint; {body} }}", "t")
    assert loaded.program is not None, loaded.diagnostics
    return loaded.program.modules["M"]


def num(value: str) -> ir.Num:
    return ir.Num(Fraction(value))


def plus(left: ir.Expr, right: ir.Expr) -> ir.Expr:
    return ir.Binary("+", left, right)


def minus(left: ir.Expr, right: ir.Expr) -> ir.Expr:
    return ir.Binary("-", left, right)


def times(left: ir.Expr, right: ir.Expr) -> ir.Expr:
    return ir.Binary("*", left, right)


VOLTAGE = ir.InputOf(ir.THIS, "v")
CURRENT = ir.StateOf(ir.THIS, "i")
RATE = ir.RateOf(ir.THIS, "q")


def test_a_motor() -> None:
    """L di/dt = v - R i - k dq/dt, torque k i - b dq/dt, with R = 2 ohm, L = 0.1 H, k = 0.5."""
    found = module(
        "dof q: revolute z; const R = 2 V/A; const k = 0.5 N*m/A; param b in [1, 2] N*m*s;"
        "input v in [-24, 24] V; state i A = 500; der(i) = (v - R*i - k*rate(q)) / (0.1 V*s/A);"
        "torque(q) = k*i - b*rate(q);"
    )
    drop = minus(minus(VOLTAGE, times(num("2"), CURRENT)), times(num("1/2"), RATE))
    assert found.inputs == (ir.Input("v", ir.Interval(num("-24"), num("24")), "V"),)
    assert found.states == (ir.State("i", "A", num("500"), ir.Binary("/", drop, num("1/10"))),)
    friction = times(ir.ParameterOf(ir.THIS, "b"), RATE)
    assert found.torques == (ir.Torque("q", minus(times(num("1/2"), CURRENT), friction)),)


def test_what_names_mean() -> None:
    found = module(
        f"{DOFS} state s; state t m; der(s) = t / (1 m*s); der(t) = rate(d) + d / (1 s);"
        "torque(q) = u + q * (1 N*m) + sin(pi * s) * (1 N*m); torque(d) = u - 1 N*s/m * rate(d);"
    )
    one, pi = num("1"), ir.Pi()
    s, t = ir.StateOf(ir.THIS, "s"), ir.StateOf(ir.THIS, "t")
    q, d = ir.DofOf(ir.THIS, "q"), ir.DofOf(ir.THIS, "d")
    rate = ir.RateOf(ir.THIS, "d")
    assert [state.derivative for state in found.states] == [
        ir.Binary("/", t, one),
        plus(rate, ir.Binary("/", d, one)),
    ]
    wave = times(ir.Unary("sin", times(pi, s)), one)
    assert found.torques == (
        ir.Torque("q", plus(plus(ir.EffortOf(ir.THIS, "q"), times(q, one)), wave)),
        ir.Torque("d", minus(ir.EffortOf(ir.THIS, "d"), times(one, rate))),
    )


def test_the_input_of_the_only_degree_of_freedom() -> None:
    found = module("dof q: revolute z; state e J; der(e) = u * rate(q); torque(q) = u - e;")
    assert found.states[0].derivative == times(ir.EffortOf(ir.THIS, "q"), RATE)


@pytest.mark.parametrize(
    ("text", "unit", "initial"),
    [
        ("s", "1", None),
        ("s = 2 * 3", "1", "6"),
        ("s m", "m", None),
        ("s cm = 50", "m", "1/2"),
        ("s cm = 50 m", "m", "50"),
        ("s cm = 50 * k", "m", "100"),
        ("s min = 1", "s", "60"),
        ("s rad = 1", "rad", "1"),
        ("s V = 0", "V", "0"),
    ],
)
def test_states_and_their_initial_values(text: str, unit: str, initial: str | None) -> None:
    [state] = module(f"state {text}; der(s) = 0; const k = 2 m;").states
    assert (state.name, state.unit, state.derivative) == ("s", unit, num("0"))
    assert state.initial == (None if initial is None else num(initial))


def test_a_degree_in_the_unit_of_a_state() -> None:
    [state] = module("state s deg = 90; der(s) = 1;").states
    assert (state.unit, state.initial) == ("rad", times(num("1/2"), ir.Pi()))


STATEMENTS = (
    "dof q: revolute z;",
    "const k = 3 N*m;",
    "state s = 1;",
    "input v in [0, k / (1 N*m)];",
    "der(s) = (v - s) / (1 s);",
    "torque(q) = u - k*s;",
)


@pytest.mark.parametrize("first", range(len(STATEMENTS)))
def test_order_has_no_meaning(first: int) -> None:
    due = module("".join(STATEMENTS))
    rest = [s for n, s in enumerate(STATEMENTS) if n != first]
    for tail in list(permutations(rest))[::17]:
        assert module("".join((STATEMENTS[first], *tail))) == due


def test_torques_come_in_the_order_of_the_degrees_of_freedom() -> None:
    found = module(f"torque(d) = u; torque(q) = u; {DOFS}")
    assert [torque.dof for torque in found.torques] == ["q", "d"]


def test_without_dynamics_there_is_none() -> None:
    found = module(DOFS + "param u in [1, 2]; const rate = u;")
    assert (found.states, found.inputs, found.torques) == ((), (), ())


@pytest.mark.parametrize(
    ("body", "found"),
    [
        # Structure.
        ("state s;", [("BAD_DYNAMICS", "s")]),
        ("state speed; der(sped) = 1;", [("UNKNOWN_NAME", "sped")]),
        ("state s; der(t) = 1;", [("BAD_DYNAMICS", "s"), ("UNKNOWN_NAME", "t")]),
        ("der(q) = 1;", [("BAD_DYNAMICS", "q")]),
        ("der(c) = 1;", [("BAD_DYNAMICS", "c")]),
        ("der(b) = 1;", [("BAD_DYNAMICS", "b")]),
        ("input v in [0, 1]; der(v) = 1;", [("BAD_DYNAMICS", "v")]),
        ("state s; der(s) = 1; der(s) = 2;", [("BAD_DYNAMICS", "der(s) = 2;")]),
        ("torque(q) = u; torque(q) = u;", [("BAD_DYNAMICS", "torque(q) = u;")]),
        ("torque(w) = u;", [("UNKNOWN_NAME", "w")]),
        ("torque(c) = u;", [("BAD_DYNAMICS", "c")]),
        ("state s; der(s) = 1; torque(s) = u;", [("BAD_DYNAMICS", "s")]),
        # The rate and the input of a degree of freedom.
        ("torque(d) = rate;", [("BAD_DYNAMICS", "rate")]),
        ("torque(d) = rate(w);", [("UNKNOWN_NAME", "w")]),
        ("torque(d) = rate(b);", [("BAD_DYNAMICS", "b")]),
        ("torque(d) = rate(2 * q);", [("BAD_DYNAMICS", "rate(2 * q)")]),
        ("torque(d) = rate(q, d);", [("BAD_DYNAMICS", "rate(q, d)")]),
        ("torque(d) = rate(of: q);", [("BAD_DYNAMICS", "rate(of: q)")]),
        ("torque(d) = rate();", [("BAD_DYNAMICS", "rate()")]),
        ("state s; der(s) = rate(s);", [("BAD_DYNAMICS", "s")]),
        ("state s J; der(s) = u * rate(q);", [("BAD_DYNAMICS", "u")]),
        # Names.
        ("state s; state s; der(s) = 1;", [("DUPLICATE_NAME", "s")]),
        ("input q in [0, 1];", [("DUPLICATE_NAME", "q")]),
        ("state c; der(c) = 1;", [("DUPLICATE_NAME", "c"), ("BAD_DYNAMICS", "c")]),
        ("const u = 1; torque(d) = u;", [("DUPLICATE_NAME", "u")]),
        ("state rate; der(rate) = 1;", [("DUPLICATE_NAME", "rate")]),
        ("torque(q) = w;", [("UNKNOWN_NAME", "w")]),
        ("torque(q) = M.b;", [("NOT_CONSTANT", "M.b")]),
        ("torque(q) = sine(q);", [("UNKNOWN_NAME", "sine")]),
        ("const k = s; state s; der(s) = 1;", [("NOT_CONSTANT", "s")]),
        ("const k = q;", [("NOT_CONSTANT", "q")]),
        ("input v in [0, w]; input w in [0, 1];", [("NOT_CONSTANT", "w")]),
        # Units and sorts.
        ("state s m; der(s) = 1 m;", [("UNIT_MISMATCH", "1 m")]),
        ("state s; der(s) = rate(d);", [("UNIT_MISMATCH", "rate(d)")]),
        ("state s kg; der(s) = c;", [("UNIT_MISMATCH", "c")]),
        ("torque(q) = 3 N;", [("UNIT_MISMATCH", "3 N")]),
        ("torque(d) = 3 N*m;", [("UNIT_MISMATCH", "3 N*m")]),
        ("torque(d) = u - b*rate(d);", [("UNIT_MISMATCH", "b*rate(d)")]),
        ("torque(d) = q;", [("UNIT_MISMATCH", "q")]),
        ("torque(q) = d;", [("UNIT_MISMATCH", "d")]),
        ("torque(q) = u^2 / u + u;", []),
        ("torque(q) = world;", [("SORT_MISMATCH", "world")]),
        ("torque(q) = (1, 2);", [("SORT_MISMATCH", "(1, 2)")]),
        ("torque(q) = rot(z, q);", [("SORT_MISMATCH", "rot(z, q)")]),
        ("torque(q) = u * (1, 2);", [("SORT_MISMATCH", "(1, 2)")]),
        # Initial values.
        ("state s m = 3 kg; der(s) = 1;", [("UNIT_MISMATCH", "3 kg")]),
        ("state s = 3 m; der(s) = 1;", [("UNIT_MISMATCH", "3 m")]),
        ("state s = b; der(s) = 1;", [("NOT_CONSTANT", "b")]),
        ("state s = t; der(s) = 1; state t; der(t) = 1;", [("NOT_CONSTANT", "t")]),
        ("state s = world; der(s) = 1;", [("SORT_MISMATCH", "world")]),
        # Inputs and what follows from an error: nothing.
        ("input v in [2, 1] V; state s V; der(s) = v;", [("EMPTY_INTERVAL", "[2, 1] V")]),
        ("input v in [1 V, 2 A]; torque(q) = v;", [("UNIT_MISMATCH", "2 A")]),
        ("state s m^13; der(s) = s; torque(q) = s;", [("UNKNOWN_UNIT", "m^13")]),
        ("state s m^13 = t; der(s) = 0;", [("UNKNOWN_UNIT", "m^13"), ("UNKNOWN_NAME", "t")]),
        ("torque(q) = 1 / (1 - 1);", [("BAD_NUMBER", "1 - 1")]),
    ],
)
def test_findings(body: str, found: list[tuple[str, str]], check: Check) -> None:
    assert check(f"{MODULE}{body} }}") == found


def test_no_input_without_a_degree_of_freedom(check: Check) -> None:
    text = "module M { role link; state s N*m; der(s) = u; }"
    assert check(text) == [("BAD_DYNAMICS", "u")]


def test_the_hint_names_the_state_that_was_meant() -> None:
    [found] = load_text("module M { role link; state speed; der(sped) = 1; }", "t").diagnostics
    assert found.hint == "did you mean `speed`?"


def test_too_large_expressions_are_refused(check: Check) -> None:
    doubled = "".join(f"const c{n + 1} = c{n} * c{n};" for n in range(11))
    [found] = check(
        f"module M {{ role link; param a in [1, 2]; const c0 = a + 1; {doubled}"
        "state s; der(s) = (c11 * c11) * (c11 * c11) * (c11 * c11); }"
    )
    assert found == ("TOO_DEEP", "(c11 * c11) * (c11 * c11) * (c11 * c11)")


@pytest.mark.parametrize(
    ("member", "message"),
    [
        ("D.i", "the state `D.i` cannot be read in the semantics"),
        ("D.v", "the input `D.v` cannot be read in the semantics"),
    ],
)
def test_semantics_read_no_dynamics(member: str, message: str) -> None:
    text = f"""
module D {{ role joint; dof q: revolute z; state i A; input v in [0, 1] V;
  der(i) = v * (1 A/V) / (1 s); torque(q) = i * (1 N*m/A); }}
grammar G {{ start S; a: S -> D; }}
semantics G {{ a {{ effector(frame: rot(z, D.q) * move(x, {member})); }} }}"""
    [found] = load_text(text, "t").diagnostics
    assert (found.code.name, found.message) == ("WRONG_KIND", message)
    assert text[found.span.start : found.span.end] == member


@given(st.sampled_from(["s", "A", "m", "kg", "N", "rad", "V"]), st.integers(-12, 12))
def test_a_derivative_is_per_second(unit: str, power: int) -> None:
    """der(s) = s / (1 s) has the right unit, whatever that of s; der(s) = s has not."""
    text = "module M {{ role link; state w {0}^{1}; der(w) = w{2}; }}"
    assert load_text(text.format(unit, power, " / (1 s)"), "t").program is not None
    [found] = load_text(text.format(unit, power, ""), "t").diagnostics
    assert found.code.name == "UNIT_MISMATCH"
    assert found.hint == "`der(w)` has the unit of `w` per second"
