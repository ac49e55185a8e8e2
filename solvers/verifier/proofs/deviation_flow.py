r"""How deviations from a path develop: a matrix polynomial near the fundamental matrix.

Deviations obey e' = A(t) e + c(t) with A = [[0, 1, 0], [N^{-1} R]] (``a_priori.py``).  Let V be
the fundamental matrix, V' = A V, V(0) = 1.  Any matrix polynomial P will do; here it is the
rounded Taylor polynomial about the middle of [0, H] of the midpoints of N and R, times a constant
matrix that makes P(0) nearly 1.  With D = A P - P', Z = V - P solves Z' = A Z + D, so that

.. math:: |Z(t)|\,r \le y(t), \qquad \dot y = J y + |D|\,r, \qquad y(0) = |P(0) - 1|\,r .

For each fixed e, h the matrices N(p(t) + e), R(p(t) + h e) are smooth functions of t, whose Taylor
polynomials of degree K - 1 with Lagrange's remainder hold; at time t the values e = e(t) and h
are among them.  So series with E added to the constant coefficient of p enclose N(t) and R(t),
and N D_w = R P - N P_w' is bounded by its coefficients about the middle (those below K) and about
all of [0, H] (the K-th), as the path's own defect is.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from math import comb

from flint import arb, arb_mat

from compiler.expressions.evaluators.balls import (
    SIGNS,
    absolute,
    both_signs,
    column,
    column_of_ones,
    identity,
    rows,
    stacked,
)
from solvers.verifier.proofs.a_priori import Deviation, comparison
from solvers.verifier.proofs.vector_field import InertiaMatrix, Linearisation, VectorField

# --- A set of initial states: a point, a box, or an affine image of a box -------------------------
#
# .. math:: \{\, m + G r : |r_i| \le \rho_i \,\}
#
# A robot whose motion is written in coordinates y with q = D y, but whose start is known in q,
# starts in such a set with G = D^{-1} for both coordinates and rates; no box of y is as small.


@dataclass(frozen=True, slots=True)
class InitialSet:
    """The states ``centre`` + ``generators`` r with ``|r_i| <= radii[i]``.

    ``centre`` has an entry per state (coordinates, rates, modules' own states); ``generators`` a
    row per state with a column per radius; all are balls, and the set is that of all their values.
    A point has no generators.

    Raises:
        ValueError: the shapes do not agree, or a radius is negative.
    """

    centre: tuple[arb, ...]
    generators: tuple[tuple[arb, ...], ...] = ()
    radii: tuple[arb, ...] = ()

    def __post_init__(self) -> None:
        if self.radii and len(self.generators) != len(self.centre):
            raise ValueError("a set needs a row of generators per state")
        if any(len(row) != len(self.radii) for row in self.generators):
            raise ValueError("a set needs a column of generators per radius")
        if not all(radius >= 0 for radius in self.radii):
            raise ValueError("the radii of a set are not negative")


def box(state: Sequence[arb]) -> InitialSet:
    """The box of balls, with a generator along each axis of which the ball has a radius."""
    wide = [i for i, item in enumerate(state) if not item.is_exact()]
    centre = tuple(item.mid() for item in state)
    rows = tuple(tuple(arb(int(i == j)) for j in wide) for i in range(len(state)))
    return InitialSet(centre, rows if wide else (), tuple(state[j].rad() for j in wide))


@dataclass(frozen=True, slots=True)
class Flow:
    """P by its coefficients about the middle, and the bounds |D| and |P(0) - 1|."""

    powers: list[arb_mat]
    half: arb
    defect: arb_mat
    start: arb_mat
    deviation: Deviation

    def at(self, time: arb) -> arb_mat:
        """P(time)."""
        return _horner(self.powers, time - self.half)

    def added(self, radii: Sequence[arb]) -> list[arb]:
        """Bounds of |Z(t)| r and what the defect adds, at every t in [0, H].

        So is what disturbed inputs add but for their steady part.  All obey the same comparison
        system, whose solutions may be added.
        """
        reach, push = column(radii), column(self.deviation.rest)
        more, start = (self.defect * reach + push).entries(), (self.start * reach).entries()
        return comparison(self.deviation.rates, more, start, 2 * self.half)


def flow(field: VectorField, half: arb, deviation: Deviation) -> Flow:
    """P of the degree of the series in ``deviation``, but at least 1.

    Raises:
        ZeroDivisionError: P is singular.
    """
    middle, over = deviation.middle, deviation.over
    powers = _powers(field, middle if middle.slopes else over, half)
    return _checked(field, powers, half, deviation)


def _powers(field: VectorField, linear: Linearisation, half: arb) -> list[arb_mat]:
    """Exact coefficients of P about the middle, one more than those of N and R."""
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


def _checked(field: VectorField, powers: list[arb_mat], half: arb, deviation: Deviation) -> Flow:
    """The bounds of a P."""
    middle, over = deviation.middle, deviation.over
    n, degree, last = field.dofs, len(powers) - 1, len(over.slopes) - 1
    lower = absolute(_residual(field, over, _over_interval(powers, half), last)) * half**last
    for j in range(last):
        lower = lower + absolute(_residual(field, middle, powers, j)) * half**j
    upper = absolute(rows(powers[degree], n, 2 * n)) * half**degree
    for j in range(degree):
        term = rows(powers[j], n, 2 * n) - rows(powers[j + 1], 0, n) * (j + 1)
        upper = upper + absolute(term) * half**j
    solved = deviation.inertia.solve(both_signs(absolute(lower)))
    return Flow(
        powers,
        half,
        stacked(absolute(upper), absolute(solved)),
        absolute(_horner(powers, -half) - identity(field.size)),
        deviation,
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


# --- The set of states at an instant: a zonotope, the affine image of a box -----------------------
#
# .. math:: X = \{\, m + G r : |r_j| \le 1 \,\}
#
# with m and G exact.  Like Lohner's representation m + C r + Q e (1987) it moves with the flow
# without being enclosed anew.  What is added on a segment, a box, becomes new columns of G instead
# of being turned into the axes Q at once, where shears would widen it; Q is a box of the columns
# that lose least by that.  Under a map x -> p + (P + Z)(x - m) + d,
#
# .. math:: m' \approx p, \qquad G' \approx (P G,\ D), \qquad
#     D = \operatorname{diag}\bigl(|p - m'| + |Z (x - m)| + |P G - G'| 1 + |d|\bigr),
#
# so that no rounding of m' and G' can lose a state.  Where there are too many columns, those
# nearest to being along an axis are replaced by the box that holds them (Girard, *Reachability of
# uncertain linear systems using zonotopes*, 2005); long ones stay, so that wrapping does not feed
# on itself (Kuhn, *Rigorously computed orbits of dynamical systems without the wrapping effect*,
# 1998).


MOST_COLUMNS, KEPT_COLUMNS = 20, 15
"""Times the size of a state: when columns are replaced, and how many are left then."""

Column = list[arb]


@dataclass(frozen=True)
class Zonotope:
    """m, exact, and the columns of G, exact."""

    middle: list[arb]
    columns: list[Column]

    @cached_property
    def radii(self) -> list[arb]:
        """Bounds of |x - m|, entry by entry."""
        return _sizes(self.columns, len(self.middle))

    def radii_under(self, matrix: arb_mat) -> list[arb]:
        """Bounds of |P (x - m)|, entry by entry."""
        if not self.columns:
            return [arb(0)] * matrix.nrows()
        moved = absolute(matrix * _matrix(self.columns))
        return [item.upper() for item in (moved * column_of_ones(len(self.columns))).entries()]

    def hull(self) -> list[arb]:
        """The smallest balls about m that hold the set."""
        return [m + SIGNS * r for m, r in zip(self.middle, self.radii, strict=True)]

    def widened(self, radii: Sequence[arb]) -> Zonotope:
        """The set of all x + d with all |d| <= ``radii``."""
        columns = [*self.columns, *_box(radii)]
        return Zonotope(self.middle, _reduced(columns, len(self.middle)))

    def moved(
        self,
        to: Sequence[arb],
        matrix: arb_mat,
        added: Sequence[arb],
        steady: arb_mat | None = None,
    ) -> Zonotope:
        """The set under x -> ``to`` + P (x - m) + S r + d with all |d| <= ``added``, |r| <= 1."""
        middle = [item.mid() for item in to]
        rest = [abs(t - m) + a for t, m, a in zip(to, middle, added, strict=True)]
        columns: list[Column] = []
        if self.columns:
            image = matrix * _matrix(self.columns)
            for i, row in enumerate(image.tolist()):
                rest[i] = sum((item.rad() for item in row), rest[i])
            columns = [list(column) for column in image.mid().transpose().tolist()]
        if steady is not None:
            for i, row in enumerate(steady.tolist()):
                rest[i] = sum((item.rad() for item in row), rest[i])
            columns += [list(column) for column in steady.mid().transpose().tolist()]
        return Zonotope(middle, _reduced([*columns, *_box(rest)], len(middle)))


def zonotope(initial: InitialSet) -> Zonotope:
    """The representation of an initial set."""
    middle = [item.mid() for item in initial.centre]
    rest = [item.rad() for item in initial.centre]
    columns: list[Column] = []
    for j, radius in enumerate(initial.radii):
        wide = [row[j] * radius for row in initial.generators]
        columns.append([item.mid() for item in wide])
        rest = [r + item.rad() for r, item in zip(rest, wide, strict=True)]
    return Zonotope(middle, [*columns, *_box(rest)])


def _matrix(columns: Sequence[Column]) -> arb_mat:
    return arb_mat(columns).transpose()


def _sizes(columns: Sequence[Column], size: int) -> list[arb]:
    if not columns:
        return [arb(0)] * size
    sums = absolute(_matrix(columns)) * column_of_ones(len(columns))
    return [item.upper() for item in sums.entries()]


def _box(radii: Sequence[arb]) -> list[Column]:
    """The columns of a box."""
    ends = [radius.upper() for radius in radii]
    return [
        [end if i == j else arb(0) for i in range(len(ends))]
        for j, end in enumerate(ends)
        if end != 0
    ]


def _reduced(columns: list[Column], size: int) -> list[Column]:
    """No more than ``MOST_COLUMNS`` times the size."""
    if len(columns) <= MOST_COLUMNS * size:
        return columns
    scales = [float(item) or 1.0 for item in _sizes(columns, size)]

    def loss(column: Column) -> float:
        shares = [abs(float(x)) / scale for x, scale in zip(column, scales, strict=True)]
        return sum(shares) - max(shares)

    ordered = sorted(columns, key=loss)
    count = len(columns) - (KEPT_COLUMNS - 1) * size
    return [*ordered[count:], *_box(_sizes(ordered[:count], size))]
