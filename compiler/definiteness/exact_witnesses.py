"""Exact witnesses against definiteness, before any box is divided.

First a vector v with M v = 0 as an identity: the vectors that M annihilates at a few points (by
floating point) are made rational, and M v is compared with zero as a trigonometric polynomial.
Then the natural points of the box, which subdivision would not meet: zero, corners, right angles
and centres, one or two variables at a time.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import combinations, islice

import numpy as np

from compiler.arrays import Array
from compiler.definiteness.boxes import Box, Side
from compiler.definiteness.enclosed_matrix import EnclosedMatrix
from compiler.definiteness.indefiniteness import Refuter, Witness, integral
from compiler.expressions.evaluators.exact import PiLinear
from compiler.expressions.evaluators.trigonometric import CanonicalEvaluator, TooManyTerms
from compiler.expressions.trigonometric_polynomial import (
    Pi,
    PolynomialRing,
    TrigonometricPolynomial,
    Variable,
)

POINTS = 400
"""The most natural points that are tried."""
SHARES = (Fraction(3, 17), Fraction(11, 19), Fraction(5, 23), Fraction(19, 29), Fraction(9, 31))
SINGULAR = 1e-9
DENOMINATOR = 1000


@dataclass(frozen=True, slots=True)
class ExactWitnesses:
    """Looks for a witness in a whole box; ``matrix`` is symmetric."""

    matrix: EnclosedMatrix
    box: Box

    def witness(self) -> Witness | None:
        """A witness, or None where none was found."""
        return self._identical() or self._natural()

    def _identical(self) -> Witness | None:
        """One for all points of the box."""
        points = list(_scattered(self.box))
        values = [self.matrix.at([float(item) for item in point]) for point in points]
        if not all(np.all(np.isfinite(value)) for value in values):
            return None
        vectors = null_vectors(values)
        if not vectors:
            return None
        ring = PolynomialRing()
        inputs = [ring.symbol(Variable("coordinate", i)) for i in range(len(self.box))]
        vector = self._annihilated(vectors, ring, inputs)
        if vector is None:
            return None
        point = tuple(side.central for side in self.box)
        return Witness(point, vector, throughout=True, box=self.box, identically=True)

    def _natural(self) -> Witness | None:
        """One at a natural point."""
        refuter = Refuter(self.matrix)
        for point in islice(natural_points(self.box, self.matrix.active), POINTS):
            vector = refuter.vector(point) or self._singular(point)
            if vector is not None:
                return refuter.extended(self.box, point, vector)
        return None

    def _singular(self, point: Sequence[PiLinear]) -> tuple[Fraction, ...] | None:
        """A vector that M annihilates at a point, by algebra with roots."""
        value = self.matrix.at([float(item.ball()) for item in point])
        if not np.all(np.isfinite(value)):
            return None
        vectors = null_vectors([value])
        if not vectors:
            return None
        ring = PolynomialRing()
        return self._annihilated(vectors, ring, [_number(ring, item) for item in point])

    def _annihilated(
        self,
        vectors: Sequence[tuple[Fraction, ...]],
        ring: PolynomialRing,
        inputs: Sequence[TrigonometricPolynomial],
    ) -> tuple[Fraction, ...] | None:
        """The first of some vectors with M v = 0 as an identity."""
        if self.matrix.values.uses("sign"):
            return None
        constants = [_number(ring, item) for item in self.matrix.exact_constants]
        try:
            entries = self.matrix.values.evaluate([*inputs, *constants], CanonicalEvaluator(ring))
        except TooManyTerms:
            return None
        for vector in vectors:
            if not any(row.terms for row in _product(ring, entries, vector)):
                return vector
        return None


def _product(
    ring: PolynomialRing, entries: Sequence[TrigonometricPolynomial], vector: Sequence[Fraction]
) -> Iterator[TrigonometricPolynomial]:
    n = len(vector)
    for i in range(n):
        total = ring.rational(0)
        for j, item in enumerate(vector):
            total = ring.add(total, ring.scaled(entries[j * n + i], item)) if item else total
        yield total


def _number(ring: PolynomialRing, value: PiLinear) -> TrigonometricPolynomial:
    turns = ring.scaled(ring.symbol(Pi()), value.pis) if value.pis else ring.rational(0)
    return ring.add(ring.rational(value.rational), turns)


def null_vectors(matrices: Sequence[Array]) -> list[tuple[Fraction, ...]]:
    """Short integer vectors that all matrices seem to annihilate, in floating point."""
    n = len(matrices[0])
    # What is exactly zero may be rounded to a little more, which is not to be scaled up.
    sizes = [max(float(np.abs(matrix).max()), SINGULAR) for matrix in matrices]
    stacked = np.vstack([matrix / size for matrix, size in zip(matrices, sizes, strict=True)])
    _, singular, rows = np.linalg.svd(stacked)
    found: list[tuple[Fraction, ...]] = []
    for row in _reduced(rows[[i for i in range(n) if singular[i] < SINGULAR]]):
        short = [Fraction(float(item)).limit_denominator(DENOMINATOR) for item in row]
        first = next((item for item in short if item), None)
        if first is not None:
            found.append(integral([item / first for item in short]))
    return found


def _reduced(rows: Array) -> Array:
    """The reduced row echelon form, with the largest pivots."""
    rows = np.array(rows)
    for i in range(len(rows)):
        column = int(np.argmax(np.abs(rows[i])))
        rows[i] /= rows[i, column]
        for k in range(len(rows)):
            if k != i:
                rows[k] -= rows[k, column] * rows[i]
    return rows


def _scattered(box: Box) -> Iterator[tuple[Fraction, ...]]:
    """A few points of no particular kind, the same on every call."""
    for number in range(len(SHARES)):
        yield tuple(
            _between(side, SHARES[(number + 2 * i) % len(SHARES)] + Fraction(i, 101 + i))
            for i, side in enumerate(box)
        )


def _between(side: Side, share: Fraction) -> Fraction:
    share %= 1
    if side.elements:
        item = side.elements[int(share * len(side.elements))]
        return (item.low + item.high) / 2
    low = side.low if side.low is not None else (side.high or Fraction(0)) - 1
    high = side.high if side.high is not None else low + 1
    return low + (high - low) * share


def natural_points(box: Box, active: Sequence[int]) -> Iterator[tuple[PiLinear, ...]]:
    """The simplest point of a box, and those that differ in one or two active variables."""
    base = tuple(side.simple for side in box)
    options = [_natural_values(side) for side in box]
    for count in range(3):
        for chosen in combinations(active, count):
            yield from _varied(box, base, options, chosen)


def _varied(
    box: Box,
    base: tuple[PiLinear, ...],
    options: Sequence[Sequence[PiLinear]],
    chosen: Sequence[int],
) -> Iterator[tuple[PiLinear, ...]]:
    points = [base]
    for i in chosen:
        points = [(*p[:i], value, *p[i + 1 :]) for p in points for value in options[i]]
    for point in points:
        if all(side.contains(value) for side, value in zip(box, point, strict=True)):
            yield point


def _natural_values(side: Side) -> list[PiLinear]:
    """Zero, right angles, ends and the centre, as far as they are values of a side."""
    if side.elements:
        return [item.value for item in side.elements if item.value is not None]
    found = [PiLinear(Fraction(0))]
    if side.angle:
        found += [PiLinear(Fraction(0), Fraction(k, 2)) for k in (1, -1, 2, -2, 3, -3, 4, -4)]
    found += [end for end in (side.first, side.last) if end is not None]
    found.append(side.central)
    return [value for value in dict.fromkeys(found) if side.contains(value)]
