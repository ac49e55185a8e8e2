"""Identities between the outputs of a graph: equal polynomials in its atoms.

Atoms are the inputs and the functions of equal polynomials; no identity of sines is used, so that
a difference shows nothing.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field
from fractions import Fraction
from typing import TypeAlias

import casadi as ca

from compiler.expressions.evaluator import Evaluator
from compiler.expressions.tape import tape

TERMS = 2000
"""The most monomials of a polynomial; beyond, no identity is shown."""

Monomial: TypeAlias = tuple[tuple[int, int], ...]
Polynomial: TypeAlias = tuple[tuple[Monomial, Fraction], ...]


class TooManyTerms(ArithmeticError):
    """A polynomial has more than ``TERMS`` monomials."""


@dataclass(slots=True)
class PolynomialEvaluator(Evaluator[Polynomial]):
    """Values are polynomials in atoms, with sorted terms."""

    atoms: dict[tuple[str, Polynomial], int] = field(
        default_factory=dict[tuple[str, Polynomial], int]
    )

    def constant(self, value: Fraction | int) -> Polynomial:
        """A rational."""
        return (((), Fraction(value)),) if value else ()

    def pi(self) -> Polynomial:
        """An atom."""
        return self.atom("pi", ())

    def atom(self, name: str, argument: Polynomial) -> Polynomial:
        """A function of a polynomial as one atom."""
        number = self.atoms.setdefault((name, argument), len(self.atoms))
        return ((((number, 1),), Fraction(1)),)

    def neg(self, argument: Polynomial, /) -> Polynomial:
        """The opposite."""
        return tuple((monomial, -factor) for monomial, factor in argument)

    def twice(self, argument: Polynomial, /) -> Polynomial:
        """The double."""
        return tuple((monomial, 2 * factor) for monomial, factor in argument)

    def add(self, left: Polynomial, right: Polynomial, /) -> Polynomial:
        """The sum."""
        return _collected([*left, *right])

    def mul(self, left: Polynomial, right: Polynomial, /) -> Polynomial:
        """The product."""
        if len(left) * len(right) > TERMS * TERMS // 4:
            raise TooManyTerms
        return _collected((_times(a, b), c * d) for a, c in left for b, d in right)

    def inv(self, argument: Polynomial, /) -> Polynomial:
        """An atom, and so are all functions."""
        return self.atom("inv", argument)

    def sqrt(self, argument: Polynomial, /) -> Polynomial:
        """An atom."""
        return self.atom("sqrt", argument)

    def sin(self, argument: Polynomial, /) -> Polynomial:
        """An atom."""
        return self.atom("sin", argument)

    def cos(self, argument: Polynomial, /) -> Polynomial:
        """An atom."""
        return self.atom("cos", argument)

    def tan(self, argument: Polynomial, /) -> Polynomial:
        """An atom."""
        return self.atom("tan", argument)

    def fabs(self, argument: Polynomial, /) -> Polynomial:
        """An atom."""
        return self.atom("fabs", argument)

    def sign(self, argument: Polynomial, /) -> Polynomial:
        """An atom."""
        return self.atom("sign", argument)


def _collected(terms: Iterable[tuple[Monomial, Fraction]]) -> Polynomial:
    total: dict[Monomial, Fraction] = {}
    for monomial, factor in terms:
        total[monomial] = total.get(monomial, Fraction(0)) + factor
    if len(total) > TERMS:
        raise TooManyTerms
    return tuple(sorted((monomial, factor) for monomial, factor in total.items() if factor))


def _times(first: Monomial, second: Monomial) -> Monomial:
    powers = dict(first)
    for atom, power in second:
        powers[atom] = powers.get(atom, 0) + power
    return tuple(sorted(powers.items()))


def symmetric_entries(function: ca.Function, size: int) -> bool:
    """Whether the output, a dense square matrix, is shown to be symmetric for all inputs."""
    evaluator = PolynomialEvaluator()
    count = sum(function.nnz_in(i) for i in range(function.n_in()))
    inputs = [evaluator.atom(f"input {i}", ()) for i in range(count)]
    try:
        entries = tape(function).evaluate(inputs, evaluator)
    except TooManyTerms:
        return False
    pairs = ((i, j) for i in range(size) for j in range(i))
    return all(entries[j * size + i] == entries[i * size + j] for i, j in pairs)
