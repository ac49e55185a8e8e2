"""Refutation of positive definiteness: a point of a box and a vector v with v'Mv <= 0 there.

The value is calculated exactly where M is rational at the point (which alone can show that M is
singular), else enclosed in a ball.  Floating point only says where to look.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import reduce
from math import gcd, lcm

import numpy as np
from flint import arb

from compiler.arrays import Array
from compiler.definiteness.boxes import Box, Side
from compiler.definiteness.enclosed_matrix import EnclosedMatrix
from compiler.expressions.evaluators.balls import BALLS, ball, working_precision
from compiler.expressions.evaluators.exact import ExactEvaluator, NotExact, PiLinear
from compiler.expressions.evaluators.intervals import INTERVALS, Ends

PRECISION = 128
HALVINGS = 16
DOUBTFUL = 1e-9

Rationals = list[list[Fraction]]


@dataclass(frozen=True, slots=True)
class Witness:
    """``v'Mv <= 0`` at a point; ``throughout``: at every point of ``box``, which contains it.

    ``identically``: M v = 0 is an identity.
    """

    point: tuple[PiLinear, ...]
    vector: tuple[Fraction, ...]
    throughout: bool
    box: Box
    identically: bool = False


@dataclass(frozen=True, slots=True)
class Refuter:
    """Looks for a witness in a box; ``matrix`` is symmetric."""

    matrix: EnclosedMatrix

    def refute(self, box: Box) -> Witness | None:
        """A witness, or None where none was found."""
        for point in (tuple(s.simple for s in box), tuple(s.central for s in box)):
            if not all(side.contains(value) for side, value in zip(box, point, strict=True)):
                continue
            vector = self.vector(point)
            if vector is not None:
                return self.extended(box, point, vector)
        return None

    def vector(self, point: Sequence[PiLinear]) -> tuple[Fraction, ...] | None:
        """A vector v with v'Mv <= 0 at a point, or None where none was found."""
        matrix = self.matrix.at([float(value.ball()) for value in point])
        if not np.all(np.isfinite(matrix)) or not _doubtful(matrix):
            return None
        exact = self._exact(point)
        if exact is not None:
            return indefinite_vector(exact)
        for candidate in _candidates(matrix):
            if self._value(point, candidate) <= 0:
                return candidate
        return None

    def _exact(self, point: Sequence[PiLinear]) -> Rationals | None:
        """The matrix at a point where it is rational."""
        try:
            entries = self.matrix.values.evaluate(
                [*point, *self.matrix.exact_constants], ExactEvaluator()
            )
        except NotExact:
            return None
        if any(entry.pis for entry in entries):
            return None
        n = self.matrix.shape[0]
        return [[entries[j * n + i].rational for j in range(n)] for i in range(n)]

    def _value(self, point: Sequence[PiLinear], vector: Sequence[Fraction]) -> arb:
        with working_precision(PRECISION):
            numbers = [*point, *self.matrix.exact_constants]
            inputs = [number.ball() for number in numbers]
            entries = self.matrix.values.evaluate(inputs, BALLS)
            return _form([ball(item) for item in vector], entries)

    def extended(
        self, box: Box, point: tuple[PiLinear, ...], vector: tuple[Fraction, ...]
    ) -> Witness:
        """The largest of some boxes around the point in which the vector serves everywhere."""
        for halving in range(HALVINGS):
            around = tuple(
                _around(side, value, Fraction(1, 2**halving))
                for side, value in zip(box, point, strict=True)
            )
            if self._throughout(around, vector):
                return Witness(point, vector, throughout=True, box=around)
        exactly = tuple(
            _around(side, value, Fraction(0)) if i in self.matrix.active else side
            for i, (side, value) in enumerate(zip(box, point, strict=True))
        )
        return Witness(point, vector, throughout=False, box=exactly)

    def _throughout(self, box: Box, vector: Sequence[Fraction]) -> bool:
        entries = self.matrix.enclosed([side.ends for side in box])
        run, n = INTERVALS, len(vector)
        total = run.constant(0)
        for i in range(n):
            for j in range(n):
                weight = ball(vector[i] * vector[j])
                term = run.mul(Ends(weight.lower(), weight.upper()), entries[j * n + i])
                total = run.add(total, term)
        return bool(total.high <= 0)


def _around(side: Side, value: PiLinear, share: Fraction) -> Side:
    """The part of a side within a share of its width from a value."""
    if side.elements:
        kept = tuple(item for item in side.elements if item.value == value)
        return replace(side, low=kept[0].low, high=kept[0].high, elements=kept)
    if side.low is None or side.high is None:
        width = Fraction(1)
        low, high = side.low, side.high
    else:
        width, low, high = side.high - side.low, side.low, side.high
    about = value.rational if not value.pis else Fraction(float(value.ball()))
    slack = Fraction(1, 10**9) if value.pis else Fraction(0)
    lower, upper = about - width * share - slack, about + width * share + slack
    return replace(
        side,
        low=lower if low is None else max(low, lower),
        high=upper if high is None else min(high, upper),
    )


def _doubtful(matrix: Array) -> bool:
    diagonal = np.diag(matrix)
    # Not only relative to itself: where it is exactly zero it may be rounded to above zero.
    if not np.all(diagonal > DOUBTFUL):
        return True
    scale = 1 / np.sqrt(diagonal)
    return bool(np.linalg.eigvalsh(matrix * np.outer(scale, scale))[0] < DOUBTFUL)


def _candidates(matrix: Array) -> list[tuple[Fraction, ...]]:
    """The unit vectors, and short rationals near the eigenvector of the least eigenvalue."""
    n = len(matrix)
    units = [tuple(Fraction(int(i == j)) for j in range(n)) for i in range(n)]
    vector = np.linalg.eigh((matrix + matrix.T) / 2)[1][:, 0]
    vector = vector / np.max(np.abs(vector))
    near = [
        tuple(Fraction(float(item)).limit_denominator(bound) for item in vector)
        for bound in (16, 1024, 10**6, 10**12)
    ]
    return [
        *(unit for unit, entry in zip(units, np.diag(matrix), strict=True) if entry <= 0),
        *near,
    ]


def _form(vector: Sequence[arb], entries: Sequence[arb]) -> arb:
    n, total = len(vector), arb(0)
    for i in range(n):
        for j in range(n):
            total += vector[i] * vector[j] * entries[j * n + i]
    return total


def indefinite_vector(matrix: Rationals) -> tuple[Fraction, ...] | None:
    """A vector v other than zero with v'Mv <= 0 of a symmetric matrix; None if there is none.

    The LDL^T factorisation: at the first pivot d <= 0, v is the column of L^-T, and v'Mv = d.
    """
    n = len(matrix)
    rest = [list(row) for row in matrix]
    # Row k of `inverse` is row k of L^-1: rest = inverse * M * inverse' on what is not eliminated.
    inverse = [[Fraction(int(i == j)) for j in range(n)] for i in range(n)]
    for k in range(n):
        if rest[k][k] <= 0:
            return integral(inverse[k])
        for i in range(k + 1, n):
            factor = rest[i][k] / rest[k][k]
            rest[i] = [a - factor * b for a, b in zip(rest[i], rest[k], strict=True)]
            inverse[i] = [a - factor * b for a, b in zip(inverse[i], inverse[k], strict=True)]
    return None


def integral(vector: Sequence[Fraction]) -> tuple[Fraction, ...]:
    """The multiple of a vector with coprime integer entries."""
    scale = reduce(lcm, (item.denominator for item in vector), 1)
    common = reduce(gcd, (int(item * scale) for item in vector), 0)
    return tuple(item * scale / common for item in vector)
