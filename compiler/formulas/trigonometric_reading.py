"""The reading of a robot's graph as trigonometric polynomials, for people.

Where an expression would get too long, intermediate results get names: the reading is then a
straight-line program whose steps are short polynomials.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import casadi as ca

from compiler.arithmetic.scalars import Constant
from compiler.dynamics.equations_of_motion import RobotGraph
from compiler.dynamics.tape import tape
from compiler.formulas.trigonometric_polynomial import (
    Abbreviation,
    Opaque,
    Pi,
    PolynomialRing,
    Symbol,
    TrigonometricPolynomial,
    Variable,
)

MOST_TERMS = 120
"""An entry with more terms is not shown in one piece."""
MOST_PRODUCTS = 10_000
"""So many products of terms are formed in search of the canonical form of one function."""
MOST_TERMS_NAMED = 8
"""From so many terms on, an intermediate result gets a name."""


class TooManyTerms(ArithmeticError):
    """The canonical form is longer than anybody would read."""


@dataclass(slots=True)
class CanonicalArithmetic:
    """Trigonometric polynomials as the numbers of a tape.

    Raises:
        TooManyTerms: a number or the work as a whole gets too long.
    """

    ring: PolynomialRing
    products: int = 0

    def integer(self, value: int) -> TrigonometricPolynomial:
        """An integer constant."""
        return self.ring.rational(value)

    def unary(self, name: str, argument: TrigonometricPolynomial) -> TrigonometricPolynomial:
        """A function of one number."""
        return _unary(self, self.ring, name, argument)

    def binary(
        self, name: str, left: TrigonometricPolynomial, right: TrigonometricPolynomial
    ) -> TrigonometricPolynomial:
        """An operation on two numbers."""
        if name == "add":
            return self._bounded(self.ring.add(left, right))
        if name == "sub":
            return self._bounded(self.ring.add(left, _negative(self.ring, right)))
        if name == "div":
            right = self.ring.inverse(right)
        self.products += len(left.terms) * len(right.terms)
        if self.products > MOST_PRODUCTS:
            raise TooManyTerms
        return self._bounded(self.ring.multiply(left, right))

    def _bounded(self, number: TrigonometricPolynomial) -> TrigonometricPolynomial:
        if len(number.terms) > 4 * MOST_TERMS:
            raise TooManyTerms
        return number


@dataclass(slots=True)
class NamingArithmetic:
    """The same, where intermediate results that get long are named."""

    ring: PolynomialRing
    named: list[Abbreviation] = field(default_factory=list[Abbreviation])

    def integer(self, value: int) -> TrigonometricPolynomial:
        """An integer constant."""
        return self.ring.rational(value)

    def unary(self, name: str, argument: TrigonometricPolynomial) -> TrigonometricPolynomial:
        """A function of one number."""
        if name not in {"neg", "twice", "sq", "cos", "sin"} and len(argument.terms) > 1:
            argument = self._name(argument)
        return _unary(self, self.ring, name, argument)

    def binary(
        self, name: str, left: TrigonometricPolynomial, right: TrigonometricPolynomial
    ) -> TrigonometricPolynomial:
        """An operation on two numbers."""
        if name == "add":
            return self._sum(left, right)
        if name == "sub":
            return self._sum(left, _negative(self.ring, right))
        if name == "div":
            right = self.ring.inverse(self._name(right) if len(right.terms) > 1 else right)
        if 2 * len(left.terms) * len(right.terms) > MOST_TERMS_NAMED:
            left, right = (self._name(n) if len(n.terms) > 1 else n for n in (left, right))
        return self.ring.multiply(left, right)

    def _sum(
        self, left: TrigonometricPolynomial, right: TrigonometricPolynomial
    ) -> TrigonometricPolynomial:
        total = self.ring.add(left, right)
        if len(total.terms) <= MOST_TERMS_NAMED:
            return total
        longer, other = (left, right) if len(left.terms) >= len(right.terms) else (right, left)
        return self.ring.add(self._name(longer), other)

    def _name(self, number: TrigonometricPolynomial) -> TrigonometricPolynomial:
        known = len(self.ring.symbols)
        symbol = Abbreviation(len(self.named) + 1, number)
        if self.ring.number(symbol) == known:
            self.named.append(symbol)
        return self.ring.symbol(symbol)


def _negative(ring: PolynomialRing, number: TrigonometricPolynomial) -> TrigonometricPolynomial:
    return ring.multiply(number, ring.rational(-1))


def _unary(
    arithmetic: CanonicalArithmetic | NamingArithmetic,
    ring: PolynomialRing,
    name: str,
    argument: TrigonometricPolynomial,
) -> TrigonometricPolynomial:
    match name:
        case "neg":
            return _negative(ring, argument)
        case "twice":
            return ring.multiply(argument, ring.rational(2))
        case "sq":
            return arithmetic.binary("mul", argument, argument)
        case "inv":
            return ring.inverse(argument)
        case "fabs":
            return ring.absolute(argument)
        case _:
            pass
    functions = {"sqrt": ring.root, "sin": ring.sine, "cos": ring.cosine, "tan": ring.tangent}
    return functions[name](argument)


@dataclass(frozen=True, slots=True)
class Formulas:
    """The outputs of a function of the graph, and the named results they are made of, in order."""

    ring: PolynomialRing
    named: tuple[Abbreviation, ...]
    outputs: tuple[TrigonometricPolynomial, ...]


def formulas(
    graph: RobotGraph,
    function: ca.Function,
    wanted: Sequence[int] | None = None,
) -> Formulas:
    """A function of (q, theta, k) or (q, v, theta, k) of a graph in joint coordinates.

    In canonical form, or with named intermediate results where that is too long; ``wanted`` are
    the outputs to read, by default all.
    """
    program, rates = tape(function), function.n_in() == 4
    ring = PolynomialRing()
    try:
        found = program.run(_inputs(graph, ring, rates=rates), CanonicalArithmetic(ring))
        found = found if wanted is None else [found[i] for i in wanted]
        if all(len(number.terms) <= MOST_TERMS for number in found):
            return Formulas(ring, (), tuple(found))
    except TooManyTerms:
        pass
    naming = NamingArithmetic(PolynomialRing())
    found = program.run(_inputs(graph, naming.ring, rates=rates), naming)
    found = found if wanted is None else [found[i] for i in wanted]
    return _used(naming.ring, naming.named, found)


def _inputs(
    graph: RobotGraph, ring: PolynomialRing, *, rates: bool
) -> list[TrigonometricPolynomial]:
    """The inputs of a function; coordinates first, so that angles begin with them."""
    n, p = len(graph.model.dofs), len(graph.model.parameters)
    coordinates = [ring.symbol(Variable("coordinate", i)) for i in range(n)]
    parameters = [ring.symbol(Variable("parameter", i)) for i in range(p)]
    velocities = [ring.symbol(Variable("rate", i)) for i in range(n if rates else 0)]
    constants = [
        ring.rational(constant.value) if isinstance(constant, Constant) else ring.symbol(Pi())
        for constant in graph.constants
    ]
    return [*coordinates, *velocities, *parameters, *constants]


def _used(
    ring: PolynomialRing,
    named: Sequence[Abbreviation],
    outputs: Sequence[TrigonometricPolynomial],
) -> Formulas:
    """Only the named results that the outputs need, numbered again."""
    needed: set[int] = set()
    todo = list(outputs)
    while todo:
        for symbol in symbols_of(ring, todo.pop()):
            match symbol:
                case Abbreviation(number, value) if number not in needed:
                    needed.add(number)
                    todo.append(value)
                case Opaque(_, argument):
                    todo.append(argument)
                case _:
                    pass
    kept = tuple(item for item in named if item.number in needed)
    return Formulas(ring, kept, tuple(outputs))


def symbols_of(ring: PolynomialRing, number: TrigonometricPolynomial) -> list[Symbol]:
    """The symbols of a polynomial, its angles included, in ascending order."""
    found = {s for (_, monomial) in number.terms for s, _ in monomial}
    for (_, angle), _ in number.terms:
        found.update(s for monomial, _ in angle for s, _ in monomial)
    return [ring.symbols[s] for s in sorted(found)]
