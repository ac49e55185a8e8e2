"""Names of symbols, ranges as text, and how expressions look in either notation."""

from __future__ import annotations

import re
from fractions import Fraction

import pytest

from compiler.descriptions.document import (
    TEXT_WIDTH,
    Entry,
    Equation,
    Fact,
    Remark,
    Section,
    section_of_lines,
    to_latex,
    to_text,
)
from compiler.descriptions.expression_printer import (
    ExpressionPrinter,
    LatexNotation,
    Notation,
    TextNotation,
)
from compiler.descriptions.model_formulas import model_formulas, motion_sections, robot_sections
from compiler.descriptions.model_symbols import domain_text, model_symbols
from compiler.dynamics.equations_of_motion import robot_graph
from compiler.expressions.trigonometric_polynomial import (
    Abbreviation,
    Opaque,
    Pi,
    PolynomialRing,
    TrigonometricPolynomial,
    Variable,
)
from compiler.robots.robot import WORLD, RobotModel, RobotParameter
from grammar_lang import ir
from srgc.chosen_robot import is_planar
from tests.oracles.random_robots import random_robot
from tests.oracles.robots import Builder, interval, rod_chain

Q1, Q2, V1, L, M = (
    Variable("coordinate", 0),
    Variable("coordinate", 1),
    Variable("rate", 0),
    Variable("parameter", 0),
    Variable("parameter", 1),
)
NAMES = {Q1: "q1", Q2: "q2", V1: "qd1", L: "l", M: "m"}


def number(value: int) -> ir.Expr:
    return ir.Num(Fraction(value))


def with_names(*names: str) -> RobotModel:
    builder = Builder()
    domain = interval(0, 1)
    builder.parameters = [RobotParameter(i, "X", name, domain, "m") for i, name in enumerate(names)]
    return builder.build()


@pytest.mark.parametrize(
    ("names", "plain", "latex"),
    [
        (["length", "length"], ["l1", "l2"], [r"\ell_{1}", r"\ell_{2}"]),
        (["length", "mass", "length"], ["l1", "m1", "l2"], [r"\ell_{1}", "m_{1}", r"\ell_{2}"]),
        (["length", "load"], ["length1", "load1"], [r"\mathrm{length}_{1}", r"\mathrm{load}_{1}"]),
        (["alpha"], ["a1"], [r"\alpha_{1}"]),
        (["quota", "u", "width"], ["quota1", "u_1", "width1"], None),
        (["l1", "l_x"], ["l1_1", "l_x1"], [r"\mathrm{l1}_{1}", r"\mathrm{l\_x}_{1}"]),
        (["x1", "x1_1", "x"], ["x1_1", "x1_1_1", "x1"], None),
        (["b", "b_"], ["b1", "b_1"], None),
    ],
)
def test_parameters_have_short_names(
    names: list[str], plain: list[str], latex: list[str] | None
) -> None:
    symbols = model_symbols(with_names(*names)).parameters
    assert [text for text, _ in symbols] == plain
    assert latex is None or [text for _, text in symbols] == latex


def test_no_two_parameters_have_one_name() -> None:
    names = ["x", "x_", "x1", "x_1", "x1_", "q", "q1", "q_", "xx", "pi2", "s", "s_1", "e"] * 3
    symbols = model_symbols(with_names(*names)).parameters
    for found in zip(*symbols, strict=True):
        assert len(set(found)) == len(names)
    own = {
        f"{kind}{i}"
        for kind in ("q", "qd", "qdd", "s", "u", "w", "c", "g", "tau")
        for i in range(99)
    }
    assert not own & {text for text, _ in symbols}


def ninety(sign: int) -> ir.Expr:
    return ir.Binary("*", number(sign), ir.Binary("/", ir.Pi(), number(2)))


@pytest.mark.parametrize(
    ("domain", "unit", "text"),
    [
        (None, "rad", "unbounded"),
        (interval(Fraction(1, 2), 5), "m", "in [0.5, 5] m"),
        (ir.Interval(ninety(-1), ninety(1)), "rad", "in [-90, 90] deg"),
        (ir.Interval(number(0), ninety(3)), "rad/s", "in [0, 270] deg/s"),
        (ir.Interval(number(0), number(2)), "rad", "in [0, 2] rad"),
        (ir.Interval(number(1), ir.Pi()), "rad", "in [1, pi] rad"),
        (ir.Choices((number(1), number(3))), "kg", "in {1, 3} kg"),
        (ir.Interval(number(0), ir.Unary("sqrt", number(2))), "m", "in [0, sqrt(2)] m"),
        (
            ir.Interval(ir.Binary("+", ninety(-1), ninety(-1)), ninety(1)),
            "rad",
            "in [-180, 90] deg",
        ),
        (interval(0, 1), "", "in [0, 1]"),
    ],
)
def test_ranges(domain: ir.Interval | ir.Choices | None, unit: str, text: str) -> None:
    assert domain_text(domain, unit) == text


class Terms:
    def __init__(self) -> None:
        self.ring = PolynomialRing()
        self.q1, self.q2, self.v1, self.l, self.m = map(self.ring.symbol, (Q1, Q2, V1, L, M))
        self.pi = self.ring.symbol(Pi())

    def times(
        self, factor: Fraction | str, *items: TrigonometricPolynomial
    ) -> TrigonometricPolynomial:
        total = self.ring.rational(Fraction(factor))
        for item in items:
            total = self.ring.multiply(total, item)
        return total

    def plus(self, *items: TrigonometricPolynomial) -> TrigonometricPolynomial:
        total = self.ring.rational(0)
        for item in items:
            total = self.ring.add(total, item)
        return total

    def printed(self, item: TrigonometricPolynomial, notation: Notation) -> str:
        numbers = {s.number: s.number for s in self.ring.symbols if isinstance(s, Abbreviation)}
        return ExpressionPrinter(self.ring, notation, NAMES.__getitem__, numbers).text(item)


def test_expressions_in_both_notations() -> None:
    t = Terms()
    r, x, m, one = t.ring, t.l, t.m, t.ring.rational(1)
    wave = r.cosine(t.plus(t.q1, t.times("-2", t.q2), t.times("1/9", t.pi)))
    total = t.plus(x, m)
    small = r.symbol(Abbreviation(4, total))
    cases = [
        (r.rational(0), "0", "0"),
        (t.times("-1"), "-1", "-1"),
        (t.times("-1/3", x, x), "-l^2/3", r"-\frac{l^{2}}{3}"),
        (t.times("9.81", x), "9.81*l", "9.81 l"),
        (t.times("1/10", x), "0.1*l", "0.1 l"),
        (t.times("22/7", x), "22*l/7", r"\frac{22 l}{7}"),
        (t.times("1/17", x), "l/17", r"\frac{l}{17}"),
        (t.times("2/3", x, r.inverse(m)), "2*l/(3*m)", r"\frac{2 l}{3 m}"),
        (r.inverse(t.times("1", m, m)), "1/m^2", r"\frac{1}{m^{2}}"),
        (t.times("1", wave), "cos(q1 - 2*q2 + pi/9)",
         r"\cos\left(q1 - 2 q2 + \frac{\pi}{9}\right)"),
        (t.times("-1/2", total, t.v1, r.sine(t.q2)), "-qd1*(l + m)*sin(q2)/2",
         r"-\frac{qd1}{2} \left(l + m\right) \sin\left(q2\right)"),
        (t.times("1", r.root(r.rational(2)), r.sine(t.q1)), "sqrt(2)*sin(q1)",
         r"\sqrt{2} \sin\left(q1\right)"),
        (t.times("1", x, r.inverse(total)), "l/(l + m)", r"\frac{l}{\left(l + m\right)}"),
        (r.absolute(t.plus(x, t.times("-1", one))), "abs(l - 1)",
         r"\left\lvert l - 1 \right\rvert"),
        (r.tangent(x), "tan(l)", r"\tan\left(l\right)"),
        (t.times("3", small, small), "3*w4^2", "3 w_{4}^{2}"),
        (t.times("1", t.v1, t.v1), "qd1^2", "qd1^{2}"),
        (t.times("1", t.plus(t.times("1", x, r.inverse(m)), one), r.cosine(t.q1)),
         "(1 + l/m)*cos(q1)", r"\left(1 + \frac{l}{m}\right) \cos\left(q1\right)"),
    ]  # fmt: skip
    for item, text, latex in cases:
        assert t.printed(item, TextNotation()) == text
        assert t.printed(item, LatexNotation()) == latex


def test_equal_atoms_are_found_again() -> None:
    t = Terms()
    first = t.ring.root(t.plus(t.l, t.m))
    count = len(t.ring.symbols)
    assert t.ring.root(t.plus(t.m, t.l)) == first
    assert len(t.ring.symbols) == count
    assert isinstance(t.ring.symbols[-1], Opaque)


def test_documents() -> None:
    pieces = [(True, "a"), (False, "b"), *[(True, "x" * 30)] * 4]
    sections = [
        Section("Facts & more", (Fact("name", "50 %"), Fact("longer", "a_b"))),
        Section("Symbols", (Entry(("q1", "q_{1}"), "first", "in {1, 2}"), Remark("that is #1"))),
        Section("Sums", (Equation(("y", "y_{1}"), (pieces, pieces)),)),
        section_of_lines("Checks", ["M > 0", "done"]),
    ]
    text, latex = to_text(sections), to_latex(sections)
    assert "name    50 %\nlonger  a_b\n" in text
    assert "q1  first  in {1, 2}\nthat is #1\n" in text
    assert "y = -a + b - xxx" in text
    assert max(map(len, text.splitlines())) <= TEXT_WIDTH
    assert "M > 0\ndone\n" in text
    assert r"\section*{Facts \& more}" in latex
    assert r"name & 50 \% \\" in latex
    assert r"a\_b" in latex
    assert r"$q_{1}$ & first & in \{1, 2\} \\" in latex
    assert latex.count(r"\begin{align*}") == latex.count(r"\end{align*}") == 1
    assert r"M \textgreater{} 0\par" in latex


def balanced(latex: str) -> bool:
    depth = 0
    for brace in re.findall(r"(?<!\\)[{}]", latex.replace(r"\\", "")):
        depth += 1 if brace == "{" else -1
        if depth < 0:
            return False
    return depth == 0 and latex.count(r"\left") == latex.count(r"\right")


@pytest.mark.parametrize(("seed", "dimension"), [(0, 2), (3, 2), (1, 3), (6, 3)])
def test_every_symbol_of_the_equations_is_in_the_legend(seed: int, dimension: int) -> None:
    model = random_robot(seed, dimension, 3 if dimension == 2 else 2)
    word = ["X"] * 40
    described = model_formulas(model, (Fraction(1), Fraction(2), Fraction(3))[:dimension])
    sections = [*robot_sections(model, word, None), *motion_sections(described)]
    for latex in (to_latex(sections), to_latex(motion_sections(described))):
        assert balanced(latex)
    entries = [item for s in sections for item in s.items if isinstance(item, Entry)]
    equations = [item for s in sections for item in s.items if isinstance(item, Equation)]
    known = {entry.symbol[0] for entry in entries} | {e.left[0] for e in equations} | {"tau"}
    known |= {name.replace("q", "qd", 1) for name in known if re.fullmatch(r"q\d+", name)}
    known |= {"sin", "cos", "tan", "sqrt", "abs", "pi"}
    known_latex = {entry.symbol[1] for entry in entries} | {e.left[1] for e in equations}
    for equation in equations:
        text, latex_pieces = equation.right
        for _, piece in text:
            assert set(re.findall(r"[a-zA-Z]\w*", piece)) <= known, piece
        for _, piece in latex_pieces:
            plain = re.sub(r"\\dot\{q\}", "q", piece)
            found = set(re.findall(r"(?:\\?[a-zA-Z]+|\\mathrm\{\w+\})_\{\d+\}", plain))
            assert found <= known_latex, piece
    assert {"q1", "u1"} <= known


def test_planar_robots() -> None:
    assert is_planar(rod_chain(2))
    assert all(is_planar(random_robot(seed, 2, 4)) for seed in range(10))
    tilted = Builder(dimension=3)
    tilted.effector(tilted.link(tilted.joint(WORLD, "x"), tilted.number(1)))
    assert not is_planar(tilted.build())
    raised = Builder(dimension=3)
    raised.effector(
        raised.link(raised.move(raised.joint(WORLD), "z", raised.number(1)), raised.number(1))
    )
    assert not is_planar(raised.build())
    upright = Builder(dimension=3)
    upright.rod(upright.joint(WORLD), "z", upright.number(1))
    assert not is_planar(upright.build())
    solid = Builder(dimension=3)
    solid.solid(solid.joint(WORLD), 1, (1, 0, 0), (1, 1, 1, 0, 0, 0))
    assert not is_planar(solid.build())


def test_a_robot_without_joints() -> None:
    builder = Builder()
    builder.effector(builder.link(WORLD, builder.parameter()))
    sections = motion_sections(model_formulas(builder.build(), (Fraction(0), Fraction(-1))))
    assert [section.title for section in sections] == ["Positions of the effectors, in m"]
    assert to_text(sections).splitlines()[-2:] == ["e1_x = l1", "e1_y = 0"]
    assert robot_graph(builder.build()).mass_matrix.numel_out(0) == 0
