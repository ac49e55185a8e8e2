"""Identities between the outputs of a graph: equal polynomials in its atoms.

Atoms are the inputs and the functions of equal polynomials; no identity of sines is used, so that
a difference shows nothing.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from fractions import Fraction
from typing import TypeAlias

import casadi as ca

from compiler.dynamics.tape import tape

TERMS = 2000
"""The most monomials of a polynomial; beyond, no identity is shown."""

Monomial: TypeAlias = tuple[tuple[int, int], ...]
Polynomial: TypeAlias = tuple[tuple[Monomial, Fraction], ...]


class TooManyTerms(ArithmeticError):
    """A polynomial has more than ``TERMS`` monomials."""


@dataclass(slots=True)
class PolynomialArithmetic:
    """Polynomials in atoms, with sorted terms, as the numbers of a tape."""

    atoms: dict[tuple[str, Polynomial], int] = field(
        default_factory=dict[tuple[str, Polynomial], int]
    )

    def integer(self, value: int) -> Polynomial:
        """A constant."""
        return (((), Fraction(value)),) if value else ()

    def atom(self, name: str, argument: Polynomial) -> Polynomial:
        """A function of a polynomial as one atom."""
        number = self.atoms.setdefault((name, argument), len(self.atoms))
        return ((((number, 1),), Fraction(1)),)

    def unary(self, name: str, argument: Polynomial) -> Polynomial:
        """A function of one polynomial."""
        match name:
            case "neg":
                return tuple((monomial, -factor) for monomial, factor in argument)
            case "twice":
                return tuple((monomial, 2 * factor) for monomial, factor in argument)
            case "sq":
                return self.binary("mul", argument, argument)
            case _:
                return self.atom(name, argument)

    def binary(self, name: str, left: Polynomial, right: Polynomial) -> Polynomial:
        """An operation on two polynomials; a quotient is a product with an inverse."""
        total: dict[Monomial, Fraction] = {}
        if name == "div":
            return self.binary("mul", left, self.atom("inv", right))
        if name == "mul":
            if len(left) * len(right) > TERMS * TERMS // 4:
                raise TooManyTerms
            for first, a in left:
                for second, b in right:
                    monomial = _times(first, second)
                    total[monomial] = total.get(monomial, Fraction(0)) + a * b
        else:
            sign = 1 if name == "add" else -1
            total = dict(left)
            for monomial, factor in right:
                total[monomial] = total.get(monomial, Fraction(0)) + sign * factor
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
    arithmetic = PolynomialArithmetic()
    count = sum(function.nnz_in(i) for i in range(function.n_in()))
    inputs = [arithmetic.atom(f"input {i}", ()) for i in range(count)]
    try:
        entries = tape(function).run(inputs, arithmetic)
    except TooManyTerms:
        return False
    pairs = ((i, j) for i in range(size) for j in range(i))
    return all(entries[j * size + i] == entries[i * size + j] for i, j in pairs)
