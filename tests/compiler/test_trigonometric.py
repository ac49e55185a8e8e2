"""The canonical form and the listing of a robot's functions have the graph's values."""

from __future__ import annotations

import re
from fractions import Fraction

import mpmath as mp
import numpy as np
import pytest

from compiler.arrays import Array
from compiler.descriptions.expression_printer import ExpressionPrinter, TextNotation
from compiler.descriptions.model_formulas import Formulas, formulas, symbols_of
from compiler.descriptions.model_symbols import model_symbols
from compiler.dynamics.equations_of_motion import RobotGraph, robot_graph
from compiler.expressions.evaluators import trigonometric
from compiler.expressions.scalars import Constant
from compiler.expressions.trigonometric_polynomial import CONSTANT, COSINE, Abbreviation, Variable
from compiler.robots.robot import WORLD, RobotModel
from tests.oracles.polynomial_values import value
from tests.oracles.random_robots import random_robot
from tests.oracles.robots import Builder, rod_chain

NAMES = ("mass_matrix", "centrifugal", "gravitational", "effectors")
PULL = (Fraction("1.5"), Fraction("-9.81"), Fraction("0.7"))


class Point:
    """A random state and parameters of a robot."""

    def __init__(self, model: RobotModel, seed: int) -> None:
        rng = np.random.default_rng(seed)
        n, p = len(model.dofs), len(model.parameters)
        self.q, self.v = rng.uniform(-2, 2, n), rng.uniform(-3, 3, n)
        self.theta = rng.uniform(0.3, 1.7, p)
        columns = {"coordinate": self.q, "rate": self.v, "parameter": self.theta}
        self.variables = {
            Variable(kind, i): mp.mpf(float(item))  # type: ignore[arg-type]
            for kind, column in columns.items()
            for i, item in enumerate(column)
        }

    def floats(self, graph: RobotGraph, name: str) -> Array:
        k = [float(c.value) if isinstance(c, Constant) else np.pi for c in graph.constants]
        columns = [self.q, self.v] if name == "centrifugal" else [self.q]
        found = getattr(graph, name)(*columns, self.theta, np.array(k))
        return np.asarray(found.full()).ravel(order="F")


def values(found: Formulas, point: Point) -> list[float]:
    known: dict[int, mp.mpf] = {}
    with mp.workdps(30):
        for item in found.named:
            known[item.number] = value(found.ring, item.value, point.variables, known)
        return [float(value(found.ring, o, point.variables, known)) for o in found.outputs]


def printed_values(found: Formulas, model: RobotModel, point: Point) -> list[float]:
    """What the printed lines say, read by Python."""
    symbols = model_symbols(model)
    numbers = {item.number: i for i, item in enumerate(found.named, 1)}
    printer = ExpressionPrinter(found.ring, TextNotation(), symbols.text, numbers)
    names: dict[str, object] = {
        "sin": mp.sin, "cos": mp.cos, "tan": mp.tan, "sqrt": mp.sqrt, "abs": abs, "pi": +mp.pi,
    }  # fmt: skip
    names |= {symbols.text(variable): number for variable, number in point.variables.items()}

    def read(text: str) -> mp.mpf:
        exact = re.sub(r"(?<![\w.])(\d+\.?\d*(?:e-?\d+)?)", r"number('\1')", text)
        exact = re.sub(r"\^number\('(\d+)'\)", r"**\1", exact)
        return eval(exact, {"number": mp.mpf}, names)

    with mp.workdps(30):
        for item in found.named:
            names[f"w{numbers[item.number]}"] = read(printer.text(item.value))
        return [float(read(printer.text(output))) for output in found.outputs]


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize(
    ("seed", "dimension", "joints"),
    [(s, 2, 1 + s % 4) for s in range(8)] + [(s, 3, 1 + s % 2) for s in range(6)] + [(0, 3, 3)],
)
def test_random_robots_read_as_their_graphs(
    seed: int, dimension: int, joints: int, name: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    model = random_robot(seed, dimension, joints)
    graph, point = robot_graph(model, PULL[:dimension]), Point(model, seed)
    expected = point.floats(graph, name)
    scale = max(1.0, float(np.abs(expected).max()))
    for products in (10_000, 0):
        monkeypatch.setattr(trigonometric, "MOST_PRODUCTS", products)
        found = formulas(graph, getattr(graph, name))
        np.testing.assert_allclose(values(found, point), expected, rtol=0, atol=1e-12 * scale)
        read = printed_values(found, model, point)
        np.testing.assert_allclose(read, expected, rtol=0, atol=1e-12 * scale)


def awkward() -> RobotModel:
    """Lengths and angles that are no polynomials of the parameters."""
    builder = Builder()
    table, a, b = builder.table, builder.parameter(), builder.parameter(name="bend")
    total = table.binary("+", a, table.binary("*", builder.number(2), b))
    size = table.unary("abs", table.binary("-", a, builder.number(1)))
    frame = builder.turn(WORLD, "z", table.unary("tan", table.binary("-", a, b)))
    frame = builder.link(builder.joint(frame), table.binary("/", builder.number(3), total))
    frame = builder.turn(frame, "z", table.unary("sin", b))
    frame = builder.link(builder.joint(frame), table.unary("sqrt", total))
    frame = builder.turn(frame, "z", table.binary("*", a, b))
    slide = builder.joint(frame, "x", "prismatic")
    builder.point(slide, table.binary("+", size, table.power(b, -2)))
    root = table.unary("sqrt", builder.number(Fraction(12, 5)))
    builder.effector(builder.link(slide, table.binary("*", root, table.unary("cos", a))))
    return builder.build()


@pytest.mark.parametrize("name", NAMES)
def test_what_is_no_polynomial_is_kept(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    model = awkward()
    graph, point = robot_graph(model, PULL[:2]), Point(model, 7)
    expected = point.floats(graph, name)
    for products in (10_000, 0):
        monkeypatch.setattr(trigonometric, "MOST_PRODUCTS", products)
        found = formulas(graph, getattr(graph, name))
        np.testing.assert_allclose(values(found, point), expected, rtol=1e-12, atol=1e-12)
        read = printed_values(found, model, point)
        np.testing.assert_allclose(read, expected, rtol=1e-12, atol=1e-12)


def test_two_rods_have_the_corrected_mass_matrix_of_the_paper() -> None:
    """Correction 4.6: D12 starts with l2^3/3; density 3/2."""
    d = Fraction(3, 2)
    graph = robot_graph(rod_chain(2, [d, d]))
    found = formulas(graph, graph.mass_matrix)
    number = found.ring.number
    l1, l2 = (number(Variable("parameter", i)) for i in range(2))
    q2 = (((number(Variable("coordinate", 1)), 1),), Fraction(1))
    turning = ((COSINE, (q2,)), ((l1, 1), (l2, 2)))
    cube, square = (CONSTANT, ((l2, 3),)), (CONSTANT, ((l1, 2), (l2, 1)))
    d22 = {cube: d / 3}
    d12 = {cube: d / 3, turning: d / 2}
    d11 = {(CONSTANT, ((l1, 3),)): d / 3, square: d, cube: d / 3, turning: d}
    assert [output.terms for output in found.outputs] == [d11, d12, d12, d22]
    assert found.named == ()


def test_the_reference_values_of_the_contract() -> None:
    graph = robot_graph(rod_chain(2))
    point = Point(graph.model, 0)
    for i, length in enumerate(("1", "0.5")):
        point.variables[Variable("parameter", i)] = mp.mpf(length)
    point.variables[Variable("coordinate", 1)] = mp.mpf("0.4")
    found = values(formulas(graph, graph.mass_matrix), point)
    expected = [1.1052652485, 0.1567992909, 0.1567992909, 0.0416666667]
    np.testing.assert_allclose(found, expected, rtol=0, atol=1e-10)


def test_five_rods_are_canonical_and_seven_joints_in_space_a_listing() -> None:
    five = robot_graph(rod_chain(5))
    assert formulas(five, five.mass_matrix).named == ()
    bias = formulas(five, five.centrifugal)
    assert bias.named == ()
    assert max(len(output.terms) for output in bias.outputs) <= trigonometric.MOST_TERMS
    point = Point(five.model, 1)
    np.testing.assert_allclose(values(bias, point), point.floats(five, "centrifugal"), rtol=1e-10)
    seven = robot_graph(random_robot(2, 3, 7))
    mass = formulas(seven, seven.mass_matrix)
    assert mass.named
    lengths = [len(item.value.terms) for item in mass.named] + [len(o.terms) for o in mass.outputs]
    assert max(lengths) <= 4 * trigonometric.MOST_TERMS_NAMED
    assert formulas(seven, seven.mass_matrix, [48]).named == ()
    corner = formulas(seven, seven.mass_matrix, [24])
    assert corner.outputs == mass.outputs[24:25]
    assert 0 < len(corner.named) < len(mass.named)
    below = [symbols_of(corner.ring, item.value) for item in corner.named]
    used = {symbol.number for s in below for symbol in s if isinstance(symbol, Abbreviation)}
    tops = symbols_of(corner.ring, corner.outputs[0])
    used |= {symbol.number for symbol in tops if isinstance(symbol, Abbreviation)}
    assert used == {item.number for item in corner.named}
    numbers = [item.number for item in mass.named]
    assert numbers == sorted(set(numbers))
    point = Point(seven.model, 1)
    np.testing.assert_allclose(
        values(mass, point), point.floats(seven, "mass_matrix"), rtol=1e-10, atol=1e-10
    )


def test_the_reading_repeats() -> None:
    model = random_robot(4, 3, 3)
    symbols = model_symbols(model)

    def texts() -> list[str]:
        graph = robot_graph(model, PULL)
        found = formulas(graph, graph.centrifugal)
        printer = ExpressionPrinter(found.ring, TextNotation(), symbols.text, {})
        return [printer.text(output) for output in found.outputs]

    assert texts() == texts()
