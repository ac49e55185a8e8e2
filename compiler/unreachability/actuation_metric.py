r"""Bounds of the inverse of a mass matrix on a box, and so of the effect of forces there.

With a regular matrix W and a lower bound l > 0 of the eigenvalues of W M W' for every M of the box,

.. math:: W M W^\top \succeq l\, 1 \quad\Rightarrow\quad M^{-1} \preceq \frac{W^\top W}{l}

(so M is positive definite on the box, and W regular). W is the inverse of the Cholesky factor at
the middle, in floating point: any W is valid, a good one brings l close to 1. The eigenvalues of a
symmetric matrix are in Gershgorin's discs. It does not matter how much heavier than at the middle a
robot gets. M is enclosed entry by entry, and by its centred form:

.. math:: W M(x) W^\top \in W M(c) W^\top
    + \sum_k W\, \partial_k M(X)\, W^\top\, (X_k - c_k)

which preserves dependencies between the entries: it is much sharper where W is large.

Source: Horn & Johnson, *Matrix Analysis*, corollary 7.7.4 (inverses reverse the order).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import reduce

from flint import arb, arb_mat

from compiler.expressions.evaluators.intervals import Ends


@dataclass(frozen=True, slots=True)
class EffortGroup:
    """Joints whose inputs share a bound: each |u_i| <= bound, or with ``norm2`` ||u|| <= bound."""

    joints: tuple[int, ...]
    bound: arb
    norm2: bool


@dataclass(frozen=True, slots=True)
class Metric:
    """M^-1 is at most W'W / l on a box; ``scale`` bounds 1 / sqrt(l) from above."""

    factor: arb_mat
    scale: arb

    def size(self, force: Sequence[arb]) -> arb:
        """An upper bound of sqrt(f' M^-1 f) for all forces f within balls."""
        image = self.factor * arb_mat([[item] for item in force])
        return (norm(image.entries()) * self.scale).upper()

    def largest(self, groups: Sequence[EffortGroup]) -> arb:
        r"""An upper bound of sqrt(u' M^-1 u) for all inputs u within their bounds.

        .. math:: u^\top G u \le \sum_{g,h} \lVert G_{gh} \rVert\, U_g U_h, \qquad
            \lVert G_{gh} \rVert^2 \le \lVert G_{gh} \rVert_1 \lVert G_{gh} \rVert_\infty

        for G = W'W, with a separate group for every joint whose input is bounded alone. The bound
        is then attained if the signs of G allow it, as for chains of two links.
        """
        gram = self.factor.transpose() * self.factor
        blocks = [
            (joints, group.bound)
            for group in groups
            for joints in ([group.joints] if group.norm2 else [(j,) for j in group.joints])
        ]
        total = arb(0)
        for rows, one in blocks:
            for columns, other in blocks:
                total += _block_norm(gram, rows, columns) * one * other
        return (total.upper().sqrt() * self.scale).upper()


@dataclass(frozen=True, slots=True)
class EnclosedMass:
    """M over a box, at its middle, and its derivatives with the radii of the box; all by columns.

    A derivative is multiplied by [-r, r] for the radius r of the box in its variable.
    """

    over: Sequence[Ends]
    middle: Sequence[Ends]
    changes: Sequence[tuple[Sequence[Ends], arb]]

    @property
    def finite(self) -> bool:
        """Whether all entries are finite."""
        lists = [self.over, self.middle, *(slopes for slopes, _ in self.changes)]
        return all(entry.finite for entries in lists for entry in entries)


def metric(mass: EnclosedMass, size: int) -> Metric | None:
    """The metric of an enclosed mass matrix; None if the enclosure is too wide."""
    if not mass.finite:
        return None
    middle = _square(mass.middle, size)
    whitening = _whitening([[float(middle[i, j]) for j in range(size)] for i in range(size)])
    if whitening is None:
        return None
    factor = arb_mat([[arb(x) for x in row] for row in whitening])

    def whitened(matrix: arb_mat) -> arb_mat:
        return factor * matrix * factor.transpose()

    centred = whitened(middle)
    for slopes, radius in mass.changes:
        centred += whitened(_square(slopes, size)) * (radius * arb(0, 1))
    enclosures = (whitened(_square(mass.over, size)), centred)
    left = reduce(arb.max, [_least_eigenvalue(each) for each in enclosures]).lower()
    return Metric(factor, (1 / left.sqrt()).upper()) if left > 0 else None


def _square(entries: Sequence[Ends], size: int) -> arb_mat:
    return arb_mat(size, size, [entry.ball() for entry in entries]).transpose()


def _least_eigenvalue(matrix: arb_mat) -> arb:
    """A lower bound of the eigenvalues of a symmetric matrix, from Gershgorin's discs."""
    size = matrix.nrows()
    found = []
    for i in range(size):
        aside = sum((abs(matrix[i, j]).upper() for j in range(size) if j != i), arb(0))
        found.append((matrix[i, i].lower() - aside).lower())
    return reduce(arb.min, found)


def norm(vector: Sequence[arb]) -> arb:
    """An upper bound of the Euclidean norm."""
    sizes = [abs(item).upper() for item in vector]
    return sum((size * size for size in sizes), arb(0)).upper().sqrt().upper()


def kinetic_speed(mass: Sequence[Ends], rates: Sequence[arb]) -> arb:
    """An upper bound of sqrt(v' M v) for rates |v_i| <= rates[i]."""
    total, size = arb(0), len(rates)
    for i, one in enumerate(rates):
        for j, other in enumerate(rates):
            total += abs(mass[j * size + i].ball()).upper() * one * other
    return total.upper().sqrt().upper()


def most_power(groups: Sequence[EffortGroup], rates: Sequence[arb | None]) -> arb | None:
    """An upper bound of u . v for inputs u within bounds and rates |v_i| <= rates[i].

    None if a joint has no such bound.
    """
    total = arb(0)
    for group in groups:
        known = [rate for i in group.joints if (rate := rates[i]) is not None]
        if len(known) < len(group.joints):
            return None
        total += group.bound * (norm(known) if group.norm2 else sum(known, arb(0)))
    return total.upper()


def _block_norm(matrix: arb_mat, rows: Sequence[int], columns: Sequence[int]) -> arb:
    sizes = [[abs(matrix[i, j]).upper() for j in columns] for i in rows]
    by_row = _largest([sum(row, arb(0)) for row in sizes])
    by_column = _largest([sum(column, arb(0)) for column in zip(*sizes, strict=True)])
    return (by_row * by_column).upper().sqrt().upper()


def _largest(values: Sequence[arb]) -> arb:
    result = arb(0)
    for value in values:
        result = result.max(value.upper())
    return result


def _whitening(matrix: list[list[float]]) -> list[list[float]] | None:
    """The inverse of the lower Cholesky factor, in floating point; None if there is none."""
    size = len(matrix)
    lower = [[0.0] * size for _ in range(size)]
    inverse = [[0.0] * size for _ in range(size)]
    for i in range(size):
        for j in range(i):
            partial = sum(lower[i][k] * lower[j][k] for k in range(j))
            lower[i][j] = (matrix[i][j] - partial) / lower[j][j]
        square = matrix[i][i] - sum(x * x for x in lower[i][:i])
        if not square > 0:
            return None
        lower[i][i] = math.sqrt(square)
        for j in range(i + 1):
            partial = sum(lower[i][k] * inverse[k][j] for k in range(j, i))
            inverse[i][j] = ((i == j) - partial) / lower[i][i]
    return inverse
