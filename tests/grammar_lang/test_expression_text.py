"""Updates as text: read again, they give the same intermediate representation."""

from __future__ import annotations

from decimal import Decimal
from fractions import Fraction
from pathlib import Path

import pytest
from hypothesis import assume, example, given, settings
from hypothesis import strategies as st

from grammar_lang import ir
from grammar_lang.ir.expression_text import (
    expression_text,
    number_text,
    occurrence_names,
    updates_text,
)
from grammar_lang.load import Loaded, load_text
from tests.oracles.some_cases import examples

ROOT = Path(__file__).parents[2]
SPECS = (
    *(ROOT / "specs" / f"{name}.srg" for name in (
        "planar_arm", "planar_arm_paper", "two_arm", "right_linear", "nested"
    )),
    ROOT / "tests" / "oracles" / "complete.srg",
)  # fmt: skip
BLOCKS = """
module J {{ role joint; dof q: revolute z in [-1, 1]; param k in [1, 2]; }}
module P {{ role joint; dof s: prismatic -x in [0, 1] m; param length in [1, 2] m; }}
module L {{ role link; param length in [1, 2] m; }}
edge eps;
grammar G {{
  start S;
  two: S -> J eps one:A J eps A P;
  rest: A -> L;
}}
semantics G {{
  two {{
    {two}
  }}
  rest {{ this.n = 0.25; this.v = (L.length, 1, 0.125); this.tip = this.at; }}
}}
"""


def loaded(text: str) -> Loaded:
    return load_text(text, "t.srg")


def again(text: str, program: ir.Program) -> ir.Program:
    """The program of the text with every block of semantics written anew from the program.

    What a mounted module brings along stands in the module, and in no block.
    """
    blocks = [
        (block.span, production.label, updates_text(production, block))
        for grammar in program.grammars.values()
        for production in grammar.productions
        for block in [(grammar.semantics or {})[production.label]]
        if not any("." in rule.target.name for rule in block.rules)
    ]
    for span, label, updates in sorted(blocks, key=lambda found: -found[0].start):
        assert span.file == 0
        block = f"{label} {{ {' '.join(f'{update};' for update in updates)} }}"
        text = text[: span.start] + block + text[span.end :]
    found = loaded(text)
    assert found.program is not None, (found.diagnostics, text)
    return found.program


def semantics(program: ir.Program) -> dict[str, object]:
    return {name: grammar.semantics for name, grammar in program.grammars.items()}


@pytest.mark.parametrize("path", SPECS, ids=lambda path: path.stem)
def test_the_blocks_of_the_shipped_specifications_can_be_read_again(path: Path) -> None:
    text = path.read_text(encoding="utf-8")
    program = loaded(text).program
    assert program is not None
    assert semantics(again(text, program)) == semantics(program)
    assert any(block for grammar in program.grammars.values() for block in grammar.semantics or ())


# --- random expressions -------------------------------------------------------------------------

numbers = st.one_of(
    st.sampled_from(("0", "1", "2", "0.5", "0.001", "3e-9", "12500000000000", "1/3", "7/11")),
    st.decimals(min_value=0, max_value=9, places=4).map(str),
)
scalars = st.recursive(
    st.one_of(numbers, st.sampled_from(("pi", "J1.k", "J2.k", "one.n", "A2.n"))),
    lambda inner: st.one_of(
        st.tuples(inner, st.sampled_from(("+", "-", "*", "/")), inner).map(
            lambda parts: "(" + " ".join(parts) + ")"
        ),
        st.tuples(inner, st.sampled_from(("+", "-", "*", "/")), inner).map(" ".join),
        st.tuples(inner, st.sampled_from(("^2", "^-1", "^(-3)"))).map(lambda p: f"({p[0]}){p[1]}"),
        st.tuples(st.sampled_from(("sin", "cos", "tan", "sqrt", "abs")), inner).map(
            lambda parts: f"{parts[0]}({parts[1]})"
        ),
        inner.map(lambda text: f"-{text}"),
        inner.map(lambda text: f"-({text})"),
    ),
    max_leaves=12,
)
axes = st.sampled_from(("x", "y", "z", "-x", "-y", "-z"))
frames = st.recursive(
    st.one_of(
        st.sampled_from(("world", "this.frame", "one.tip", "A2.tip")),
        st.tuples(axes, scalars).map(lambda parts: f"rot({parts[0]}, {parts[1]})"),
        st.tuples(axes, scalars).map(lambda parts: f"move({parts[0]}, P.length * ({parts[1]}))"),
        st.sampled_from(("move(A2.v)", "move((P.length, 1, -2 * P.length))", "move((1, 0))")),
    ),
    lambda inner: st.one_of(
        st.tuples(inner, inner).map(" * ".join),
        st.tuples(inner, inner).map(lambda parts: f"({parts[0]}) * ({parts[1]})"),
    ),
    max_leaves=5,
)


@settings(max_examples=examples(30, 150), deadline=None)
@given(scalar=scalars, frame=frames, length=scalars)
@example("2 - (3 - J1.k) - (1 - (J2.k - 1))", "world * (world * (world * world))", "1")
@example("J1.k / (J2.k / 3) / (2 / J1.k * 5) * (1/3)", "(one.tip * world) * this.frame", "1")
@example("-(J1.k^2) + (-J1.k)^2 - -J2.k", "world", "(2 * J1.k)^-1 - -3")
@example("--J1.k * -2 - -(1/3)", "world", "(J1.k^2)^3 * 90 deg * -pi^2 / pi")
def test_what_is_written_is_read_as_the_same(scalar: str, frame: str, length: str) -> None:
    statements = f"""
    this.n = {scalar};
    one.at = this.frame * rot(z, J1.q) * rot(z, J2.q);
    A2.at = {frame};
    this.slid = one.at * move(-x, P.s);
    rod(frame: {frame}, axis: -y, length: P.length * abs({length}), density: 2, radius: 1 cm);
    solid(frame: this.slid, mass: 2, com: (P.length, 0.25), inertia: (1, 2, 3, 0, 0.1, 0));
    solid(frame: this.slid, mass: 2, com: A2.v, inertia: 1/3);
    point(frame: world, mass: 250 g); effector(frame: one.tip);
    sphere(frame: {frame}, radius: 1/3); box(frame: world, size: (P.length, 2 * abs({length}), 3));
    capsule(frame: world, axis: -z, length: P.length, radius: 0.1);
    cylinder(frame: one.tip, axis: x, length: 1, radius: P.length);
    """
    text = BLOCKS.format(two=statements)
    program = loaded(text).program
    assume(program is not None)
    assert program is not None
    assert semantics(again(text, program)) == semantics(program)


# --- numbers and names --------------------------------------------------------------------------


@given(st.fractions(), st.integers(-40, 40))
def test_numbers_are_exact(value: Fraction, power: int) -> None:
    number = value * Fraction(10) ** power
    text = number_text(number)
    top, _, bottom = text.partition("/")
    assert Fraction(Decimal(top)) / (Fraction(Decimal(bottom)) if bottom else 1) == number


@pytest.mark.parametrize(
    ("value", "text"),
    [
        ("0", "0"), ("1", "1"), ("1000", "1000"), ("1/2", "0.5"), ("-1/8", "-0.125"),
        ("1/3", "1/3"), ("-22/7", "-22/7"), ("2.23", "2.23"), ("0.0001", "0.0001"),
        ("1e-12", "1e-12"), ("25e20", "25e20"), ("12345678901", "12345678901"),
        ("-3e-15", "-3e-15"),
    ],
)  # fmt: skip
def test_numbers_are_short(value: str, text: str) -> None:
    assert number_text(Fraction(value)) == text


def test_names_of_occurrences() -> None:
    kinds: tuple[tuple[str, ir.SymbolKind, str | None], ...] = (
        ("J", "module", None), ("eps", "edge", None), ("A", "nonterminal", "one"),
        ("J", "module", None), ("eps", "edge", None), ("A", "nonterminal", None),
        ("P", "module", None), ("L", "module", "link"),
    )  # fmt: skip
    production = ir.Production("p", "S", tuple(ir.Symbol(*parts) for parts in kinds))
    called = occurrence_names(production)
    assert [called[i] for i in (0, 2, 3, 5, 6, 7)] == ["J1", "one", "J2", "A2", "P", "link"]


def test_updates_of_a_block() -> None:
    text = (ROOT / "specs" / "planar_arm.srg").read_text(encoding="utf-8")
    program = loaded(text).program
    assert program is not None
    grammar = program.grammars["PlanarArm"]
    assert grammar.semantics is not None
    assert updates_text(grammar.productions[2], grammar.semantics["link"]) == (
        "this.frame = N.frame * move(x, L.length)",
        "rod(frame: N.frame, axis: x, length: L.length, density: 1)",
    )


def test_a_module_s_own_dynamics() -> None:
    text = (ROOT / "tests" / "oracles" / "complete.srg").read_text(encoding="utf-8")
    program = loaded(text).program
    assert program is not None
    (torque,) = program.modules["J"].torques
    (state,) = program.modules["J"].states
    assert expression_text(torque.value, str) == "u + h - b * rate(q)"
    assert expression_text(state.derivative, str) == "(1 * v * 1 - h) / 1"


def test_a_negative_base_is_put_in_parentheses() -> None:
    base, exponent = ir.Num(Fraction(-2)), ir.Num(Fraction(-3))
    assert expression_text(ir.Binary("^", base, exponent), str) == "(-2)^-3"
    assert expression_text(ir.Unary("neg", ir.Num(Fraction(1, 3))), str) == "-(1/3)"
