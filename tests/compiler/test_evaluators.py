"""Every evaluator on the same random graphs, against mpmath and Fractions computed beside them."""

from __future__ import annotations

import math
import random
from collections.abc import Callable
from dataclasses import dataclass
from fractions import Fraction

import casadi as ca
import mpmath as mp
import numpy as np
import pytest
from flint import arb

from compiler.discretisation.batched_function import BatchedFunction
from compiler.dynamics.symbolic_evaluator import SymbolicEvaluator
from compiler.encodings.graph_terms import TermEvaluator
from compiler.encodings.region_terms import RealScript
from compiler.expressions.evaluator import METHODS, Evaluator, evaluate_expression
from compiler.expressions.evaluators.balls import BallEvaluator, SeriesEvaluator, working_precision
from compiler.expressions.evaluators.exact import ExactEvaluator, NotExact, PiLinear
from compiler.expressions.evaluators.floats import FloatEvaluator
from compiler.expressions.evaluators.intervals import BatchedIntervalEvaluator, IntervalEvaluator
from compiler.expressions.evaluators.trigonometric import CanonicalEvaluator, NamingEvaluator
from compiler.expressions.scalars import (
    MonomialEvaluator,
    ScalarTable,
    evaluate_constant,
    evaluate_scalars,
)
from compiler.expressions.tape import tape
from compiler.expressions.trigonometric_polynomial import Abbreviation, PolynomialRing
from grammar_lang import ir
from tests.oracles.exact_chain import DIGITS, contains
from tests.oracles.polynomial_values import value as polynomial_value

SEEDS = range(12)
INPUTS = 3


@dataclass(frozen=True)
class Entry:
    """One value: a number of mpmath, and a Fraction where all below it is rational."""

    number: mp.mpf
    exact: Fraction | None


def number_of(value: Fraction) -> mp.mpf:
    return mp.mpf(value.numerator) / value.denominator


def applied(name: str, *arguments: Entry) -> Entry | None:
    """The value by mpmath and Fractions; None where there is none, or an ill-conditioned one."""
    numbers = [item.number for item in arguments]
    exact = [item.exact for item in arguments]
    functions: dict[str, Callable[..., mp.mpf]] = {
        "neg": lambda a: -a, "fabs": abs, "sq": lambda a: a * a, "twice": lambda a: a + a,
        "inv": lambda a: 1 / a, "add": lambda a, b: a + b, "sub": lambda a, b: a - b,
        "mul": lambda a, b: a * b, "div": lambda a, b: a / b,
    }  # fmt: skip
    if name in ("div", "inv") and abs(numbers[-1]) < 0.1:
        return None
    if name == "sqrt" and numbers[0] < 0.1:
        return None
    if name == "tan" and abs(mp.cos(numbers[0])) < 0.1:
        return None
    found = functions[name](*numbers) if name in functions else getattr(mp, name)(*numbers)
    rational = name in functions and None not in exact
    return Entry(found, functions[name](*exact) if rational else None) if abs(found) < 50 else None


UNARY = ("neg", "fabs", "sq", "twice", "inv", "sqrt", "sin", "cos", "tan")
BINARY = ("add", "sub", "mul", "div")
WRITTEN: dict[str, Callable[..., ca.SX]] = {
    "neg": lambda a: -a, "fabs": ca.fabs, "sq": lambda a: a * a, "twice": lambda a: 2 * a,
    "inv": lambda a: 1 / a, "sqrt": ca.sqrt, "sin": ca.sin, "cos": ca.cos, "tan": ca.tan,
    "add": lambda a, b: a + b, "sub": lambda a, b: a - b, "mul": lambda a, b: a * b,
    "div": lambda a, b: a / b,
}  # fmt: skip


@dataclass(frozen=True)
class Graph:
    """A function of three inputs, a point, and its outputs there."""

    function: ca.Function
    point: list[Fraction]
    expected: list[Entry]


def random_graph(seed: int, *, rational: bool) -> Graph:
    rng = random.Random(seed)
    symbols = ca.SX.sym("x", INPUTS)
    point = [Fraction(rng.choice([-1, 1]) * rng.randint(3, 30), 11) for _ in range(INPUTS)]
    found = [(symbols[i], Entry(number_of(v), v)) for i, v in enumerate(point)]
    found += [(ca.SX(n), Entry(mp.mpf(n), Fraction(n))) for n in (2, -3)]
    unary = UNARY[:5] if rational else UNARY
    while len(found) < 25:
        name = rng.choice([*unary, *BINARY, *BINARY])
        chosen = [rng.choice(found[-8:] if rng.random() < 0.6 else found)
                  for _ in range(2 if name in BINARY else 1)]  # fmt: skip
        entry = applied(name, *(item for _, item in chosen))
        # CasADi folds what is constant, in doubles.
        if entry is not None and not all(item.is_constant() for item, _ in chosen):
            found.append((WRITTEN[name](*(item for item, _ in chosen)), entry))
    kept = found[5:]
    function = ca.Function("f", [symbols], [ca.densify(ca.vertcat(*(item for item, _ in kept)))])
    return Graph(function, point, [entry for _, entry in kept])


Check = Callable[[object, Entry], bool]


def close(found: object, entry: Entry) -> bool:
    return math.isclose(float(found), float(entry.number), rel_tol=1e-9, abs_tol=1e-9)


def in_ball(found: arb, entry: Entry) -> bool:
    return contains(found, entry.number) and float(found.rad()) < 1e-9


def polynomial(evaluator: CanonicalEvaluator | NamingEvaluator) -> Check:
    def check(found: object, entry: Entry) -> bool:
        known: dict[int, mp.mpf] = {}
        for item in evaluator.ring.symbols:
            if isinstance(item, Abbreviation):
                known[item.number] = polynomial_value(evaluator.ring, item.value, {}, known)
        there = polynomial_value(evaluator.ring, found, {}, known)
        return abs(there - entry.number) < mp.mpf(10) ** -30

    return check


def cases() -> dict[str, tuple[Evaluator, Check]]:
    """An evaluator of each kind, and when a value of its is right."""
    canonical, naming = CanonicalEvaluator(PolynomialRing()), NamingEvaluator(PolynomialRing())
    terms = TermEvaluator(RealScript())
    return {
        "floats": (FloatEvaluator(), close),
        "balls": (BallEvaluator(), in_ball),
        "series": (SeriesEvaluator(), lambda found, entry: in_ball(found[0], entry)),
        "intervals": (IntervalEvaluator(), lambda found, entry: in_ball(found.ball(), entry)),
        "batched intervals": (
            BatchedIntervalEvaluator(),
            lambda found, entry: close(found.low, entry) and close(found.high, entry),
        ),
        "canonical": (canonical, polynomial(canonical)),
        "naming": (naming, polynomial(naming)),
        "terms": (terms, lambda found, entry: contains(terms.quantity(found).ball, entry.number)),
        "symbolic": (SymbolicEvaluator(), lambda found, entry: True),
    }


NAMES = sorted(cases())


@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.parametrize("name", NAMES)
def test_a_graph_has_its_value_in_every_evaluator(name: str, seed: int) -> None:
    with mp.workdps(DIGITS), working_precision(200):
        graph = random_graph(seed, rational=False)
        evaluator, right = cases()[name]
        inputs = [evaluator.constant(value) for value in graph.point]
        found = tape(graph.function).evaluate(inputs, evaluator)
        if isinstance(evaluator, SymbolicEvaluator):
            constants = list(evaluator.symbols)
            known = [float(evaluate_constant(item, FloatEvaluator())) for item in constants]
            both = ca.Function("g", [evaluator.vector()], [ca.vertcat(*found)])
            found, right = list(np.asarray(both(known).full()).ravel()), close
        assert len(found) == len(graph.expected)
        for i, (item, entry) in enumerate(zip(found, graph.expected, strict=True)):
            assert right(item, entry), (i, item, entry)


@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.parametrize("kind", ["exact", "monomials", "terms", "canonical"])
def test_a_rational_graph_has_its_exact_value(kind: str, seed: int) -> None:
    """Where numbers are exact, they are the Fractions."""
    graph = random_graph(seed + 100, rational=True)
    read: dict[str, tuple[Evaluator, Callable]] = {
        "exact": (ExactEvaluator(), lambda item: item.rational),
        "monomials": (MonomialEvaluator(), lambda item: item[0]),
        "terms": (TermEvaluator(RealScript()), lambda item: item.value),
        "canonical": (CanonicalEvaluator(PolynomialRing()), lambda item: item.constant),
    }
    evaluator, fraction = read[kind]
    inputs = [evaluator.constant(value) for value in graph.point]
    program, seen = tape(graph.function), 0
    for i, entry in enumerate(graph.expected):
        single = type(program)(program.nodes, (program.results[i],))
        (found,) = single.evaluate(inputs, evaluator)
        assert fraction(found) == entry.exact
        seen += 1
    assert seen


def _needed(program: object) -> list[tuple[str, tuple[int, ...]]]:
    todo, found = list(program.results), set()
    while todo:
        i = todo.pop()
        if i not in found:
            found.add(i)
            name, arguments = program.nodes[i]
            todo += [] if name in ("input", "constant") else list(arguments)
    return [program.nodes[i] for i in found]


@pytest.mark.parametrize("seed", SEEDS)
def test_the_compiled_forms_have_the_same_values(seed: int) -> None:
    """CasADi's own evaluation, and the one of many samples at once."""
    graph = random_graph(seed, rational=False)
    x = ca.SX.sym("x", INPUTS)
    shared = ca.SX.sym("s", 0)
    batched = BatchedFunction.of(ca.Function("g", [x, shared], [graph.function(x)]))
    point = np.array([float(value) for value in graph.point])
    expected = [float(entry.number) for entry in graph.expected]
    alone = np.asarray(graph.function(point).full()).ravel()
    many = batched((np.tile(point, (5, 1)),), np.zeros(0))
    np.testing.assert_allclose(alone, expected, rtol=1e-9, atol=1e-9)
    np.testing.assert_allclose(many[:, :, 0], [expected] * 5, rtol=1e-9, atol=1e-9)


def written(rng: random.Random, depth: int) -> tuple[ir.Expr, Entry]:
    """A closed expression with its value."""
    if not depth or rng.random() < 0.2:
        if rng.random() < 0.3:
            return ir.Pi(), Entry(+mp.pi, None)
        value = Fraction(rng.randint(-20, 20), 7)
        return ir.Num(value), Entry(number_of(value), value)
    operation = rng.choice([name for name in METHODS if name != "^"])
    first = written(rng, depth - 1)
    if operation in "+-*/":
        second = written(rng, depth - 1)
        expression: ir.Expr = ir.Binary(operation, first[0], second[0])  # type: ignore[arg-type]
        entry = applied(METHODS[operation], first[1], second[1])
    else:
        expression = ir.Unary(operation, first[0])  # type: ignore[arg-type]
        entry = applied(METHODS[operation], first[1])
    return (expression, entry) if entry is not None else first


@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.parametrize("name", [name for name in NAMES if name != "symbolic"])
def test_scalars_and_written_expressions_have_the_same_value(name: str, seed: int) -> None:
    with mp.workdps(DIGITS), working_precision(200):
        evaluator, right = cases()[name]
        expression, entry = written(random.Random(seed), 5)
        assert right(evaluate_expression(expression, evaluator), entry)
        table = ScalarTable()
        scalar = evaluate_expression(expression, _Tabled(table))
        assert right(evaluate_scalars(table.nodes, evaluator, [])[scalar], entry)


class _Tabled(Evaluator[int]):
    """Values are the scalars of a table."""

    def __init__(self, table: ScalarTable) -> None:
        self.table = table
        self.constant, self.pi = table.constant, table.pi

    def __getattribute__(self, name: str) -> object:
        written = {method: operation for operation, method in METHODS.items()}
        if name not in written:
            return object.__getattribute__(self, name)
        table = self.table
        if name in BINARY:
            return lambda a, b: table.binary(written[name], a, b)
        return lambda a: table.unary(written[name], a)


def test_powers_are_products() -> None:
    with mp.workdps(DIGITS), working_precision(200):
        for name, (evaluator, right) in cases().items():
            if name == "symbolic":
                continue
            for exponent in (-3, -1, 0, 1, 2, 5):
                base = Fraction(-5, 3)
                found = evaluator.power(evaluator.constant(base), exponent)
                assert right(found, Entry(number_of(base**exponent), None)), (name, exponent)


def test_what_is_not_of_the_kind_is_refused() -> None:
    exact = ExactEvaluator()
    with pytest.raises(NotExact):
        exact.sqrt(PiLinear(Fraction(2)))
    with pytest.raises(NotExact):
        exact.power(exact.constant(0), -1)
    with pytest.raises(ValueError, match="sign"):
        CanonicalEvaluator(PolynomialRing()).sign(None)
    assert MonomialEvaluator().add(None, (Fraction(1), 0)) is None


def test_a_long_expression_is_evaluated_without_recursion() -> None:
    expression: ir.Expr = ir.Num(Fraction(1))
    for _ in range(20_000):
        expression = ir.Binary("+", ir.Num(Fraction(1)), expression)
    assert evaluate_expression(expression, FloatEvaluator()) == 20_001
