r"""How deviations from a path evolve: a matrix polynomial near the fundamental matrix.

Deviations obey e' = A(t) e + c(t) with A = [[0, 1, 0], [N^{-1} R]] (``a_priori.py``).  Let V be the
fundamental matrix, V' = A V, V(0) = 1.  Any matrix polynomial P may be used; here it is the rounded
Taylor polynomial about the middle of [0, H] of the midpoints of N and R, times a constant matrix
that makes P(0) nearly 1.  With D = A P - P', Z = V - P solves Z' = A Z + D, so that

.. math:: |Z(t)|\,r \le y(t), \qquad \dot y = J y + |D|\,r, \qquad y(0) = |P(0) - 1|\,r .

For each fixed e, h the matrices N(p(t) + e), R(p(t) + h e) are smooth functions of t, whose Taylor
polynomials of degree K - 1 with Lagrange's remainder hold; at time t the values e = e(t) and h are
among them.  So series with E added to the constant coefficient of p enclose N(t) and R(t), and N
D_w = R P - N P_w' is bounded by its coefficients about the middle (those below K) and about all of
[0, H] (the K-th), just as the path's own defect is.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import comb

from flint import arb, arb_mat

from compiler.expressions.evaluators.balls import (
    absolute,
    both_signs,
    column,
    identity,
    rows,
    stacked,
)
from solvers.verifier.proofs.a_priori import LinearPart, comparison
from solvers.verifier.proofs.linearisation import InertiaMatrix, Linearisation
from solvers.verifier.proofs.vector_field import VectorField


@dataclass(frozen=True, slots=True)
class Flow:
    """The coefficients of P about the middle, and the bounds |D| and |P(0) - 1|."""

    powers: list[arb_mat]
    half: arb
    defect: arb_mat
    start: arb_mat
    rates: arb_mat

    def at(self, time: arb) -> arb_mat:
        """P(time)."""
        return _horner(self.powers, time - self.half)

    def added(self, radii: Sequence[arb], push: Sequence[arb]) -> list[arb]:
        """Bounds of |Z(t)| r plus the response to ``push``, at every t in [0, H].

        Both obey the same comparison system, so their bounds are added.
        """
        reach = column(radii)
        more = (self.defect * reach + column(push)).entries()
        return comparison(self.rates, more, (self.start * reach).entries(), 2 * self.half)


def flow(field: VectorField, half: arb, linear: LinearPart) -> Flow:
    """P, with the degree of the series in ``linear``, but at least 1.

    Raises:
        ZeroDivisionError: P is singular.
    """
    middle, over = linear.middle, linear.over
    powers = _powers(field, middle if middle.slopes else over, half)
    return _checked(field, powers, half, linear)


def _powers(field: VectorField, linear: Linearisation, half: arb) -> list[arb_mat]:
    """Exact coefficients of P about the middle, one more than N and R have."""
    n, degree = field.dofs, len(linear.slopes)
    inertia = [item.mid() for item in linear.inertia]
    slopes = [item.mid() for item in linear.slopes]
    solver = InertiaMatrix(inertia[0])
    powers = [identity(field.size)]
    grown: list[arb_mat] = []
    for j in range(degree):
        right = slopes[0] * powers[j]
        for i in range(1, j + 1):
            right = right + slopes[i] * powers[j - i] - inertia[i] * grown[j - i]
        grown.append(solver.solve(right).mid())
        rates = stacked(rows(powers[j], n, 2 * n), grown[j])
        powers.append((rates * (arb(1) / (j + 1))).mid())
    turn = _horner(powers, -half).mid().inv().mid()
    return [(power * turn).mid() for power in powers]


def _checked(field: VectorField, powers: list[arb_mat], half: arb, linear: LinearPart) -> Flow:
    """A polynomial P with its bounds."""
    middle, over = linear.middle, linear.over
    n, degree, last = field.dofs, len(powers) - 1, len(over.slopes) - 1
    lower = absolute(_residual(field, over, _over_interval(powers, half), last)) * half**last
    for j in range(last):
        lower = lower + absolute(_residual(field, middle, powers, j)) * half**j
    upper = absolute(rows(powers[degree], n, 2 * n)) * half**degree
    for j in range(degree):
        term = rows(powers[j], n, 2 * n) - rows(powers[j + 1], 0, n) * (j + 1)
        upper = upper + absolute(term) * half**j
    solved = linear.inertia.solve(both_signs(absolute(lower)))
    return Flow(
        powers,
        half,
        stacked(absolute(upper), absolute(solved)),
        absolute(_horner(powers, -half) - identity(field.size)),
        linear.rates,
    )


def _residual(field: VectorField, linear: Linearisation, powers: list[arb_mat], j: int) -> arb_mat:
    """The j-th coefficient of R P - N P_w'."""
    n, size = field.dofs, field.size
    total = linear.slopes[j] * powers[0]
    for i in range(j):
        if j - i < len(powers):
            total = total + linear.slopes[i] * powers[j - i]
    for i in range(j + 1):
        if j - i + 1 < len(powers):
            rates = rows(powers[j - i + 1], n, size) * (j - i + 1)
            total = total - linear.inertia[i] * rates
    return total


def _over_interval(powers: list[arb_mat], half: arb) -> list[arb_mat]:
    """Enclosures of the coefficients about every s with |s| <= half."""
    sizes = [absolute(power) for power in powers]
    found = []
    for j, power in enumerate(powers):
        total = power
        for k in range(j + 1, len(powers)):
            total = total + both_signs(sizes[k] * (comb(k, j) * half ** (k - j)))
        found.append(total)
    return found


def _horner(powers: list[arb_mat], since: arb) -> arb_mat:
    value = powers[-1]
    for power in reversed(powers[:-1]):
        value = value * since + power
    return value
