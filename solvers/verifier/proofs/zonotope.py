"""Sets of states: a point, a box, an affine image of a box, a zonotope."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from flint import arb, arb_mat

from compiler.arrays import Array
from compiler.expressions.evaluators.balls import SIGNS, column

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
# so that no rounding of m' and G' can lose a state.  Where there are too many columns, the shortest
# are replaced by the box along their principal axes that holds them (Girard, *Reachability of
# uncertain linear systems using zonotopes*, 2005; Kopetzki, Schuermann & Althoff, *Methods for
# order reduction of zonotopes*, 2017); long ones stay, so that wrapping does not feed on itself
# (Kuhn, *Rigorously computed orbits of dynamical systems without the wrapping effect*, 1998).


@dataclass(frozen=True, slots=True)
class OrderLimits:
    """Limits of the order of a zonotope: its columns over the size of a state.

    Above the order ``most`` it is reduced to ``kept``, unless that widens the set; above
    ``largest`` in any case, to ``left``.
    """

    most: int
    kept: int
    largest: int
    left: int


def exactly(order: int) -> OrderLimits:
    """Limits that always reduce a set to that order."""
    return OrderLimits(order, order, order, order)


LIMITS = OrderLimits(30, 25, 120, 100)
LEAST_LOSS = 0.03
"""A set is wider from this part of it on.  Where that counts in all segments of a sample, it feeds
on itself: columns have to stay until feedback has acted on them."""

Column = list[arb]


@dataclass(frozen=True)
class Zonotope:
    """m, exact, and the columns of G, exact."""

    middle: list[arb]
    columns: list[Column]

    @cached_property
    def matrix(self) -> arb_mat:
        """G (size, c); a point has no columns."""
        return _matrix(self.columns) if self.columns else arb_mat(len(self.middle), 0)

    @cached_property
    def radii(self) -> list[arb]:
        """Bounds of |x - m|, entry by entry."""
        if not self.columns:
            return [arb(0)] * len(self.middle)
        return _sums(self.matrix)

    def radii_under(self, matrix: arb_mat) -> list[arb]:
        """Bounds of |P (x - m)|, entry by entry."""
        if not self.columns:
            return [arb(0)] * matrix.nrows()
        return _sums(matrix * self.matrix)

    def hull(self) -> list[arb]:
        """The smallest balls about m that hold the set."""
        return [m + SIGNS * r for m, r in zip(self.middle, self.radii, strict=True)]

    def values(self, weights: Sequence[Sequence[int]]) -> list[arb]:
        """Enclosures of weighted sums of the entries, a row of weights each."""
        matrix = arb_mat([[arb(w) for w in row] for row in weights])
        middle = (matrix * arb_mat([[x] for x in self.middle])).entries()
        return [m + SIGNS * r for m, r in zip(middle, self.radii_under(matrix), strict=True)]

    def widened(self, radii: Sequence[arb]) -> Zonotope:
        """The set of all x + d with all |d| <= ``radii``."""
        columns = [*self.columns, *_box(radii)]
        return Zonotope(self.middle, _reduced(columns, len(self.middle), LIMITS))

    def reduced(self, limits: OrderLimits) -> Zonotope:
        """A set that holds this one, of an order within limits."""
        return Zonotope(self.middle, _reduced(self.columns, len(self.middle), limits))

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
        images = [matrix * self.matrix] if self.columns else []
        for image in images if steady is None else [*images, steady]:
            near, off = _rounded(image)
            columns += near
            rest = [r + o for r, o in zip(rest, off, strict=True)]
        return Zonotope(middle, _reduced([*columns, *_box(rest)], len(middle), LIMITS))


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


def _rounded(matrix: arb_mat) -> tuple[list[Column], list[arb]]:
    """Exact columns near those of a matrix, and bounds of what all are off together, row by row."""
    near = matrix.mid()
    return [list(each) for each in near.transpose().tolist()], _sums(matrix - near)


def _sizes(columns: Sequence[Column], size: int) -> list[arb]:
    return _sums(_matrix(columns)) if columns else [arb(0)] * size


def _sums(matrix: arb_mat) -> list[arb]:
    """Bounds of the sums of absolute values, row by row."""
    # With factors in [-1, 1] each, a product's radius is the sum of what they multiply.
    spread = (matrix * column([SIGNS] * matrix.ncols())).entries()
    return [item.abs_upper() if item.is_finite() else arb("inf") for item in spread]


def _box(radii: Sequence[arb]) -> list[Column]:
    """The columns of a box."""
    ends = [radius.upper() for radius in radii]
    return [
        [end if i == j else arb(0) for i in range(len(ends))]
        for j, end in enumerate(ends)
        if end != 0
    ]


def _reduced(columns: list[Column], size: int, limits: OrderLimits) -> list[Column]:
    """The columns, or fewer of them where there are many."""
    if len(columns) <= limits.most * size:
        return columns
    fewer = _longest(columns, size, limits.kept)
    if limits.left == limits.kept and len(columns) > limits.largest * size:
        return fewer
    before, after = _sizes(columns, size), _sizes(fewer, size)
    if all(bool(a <= (1 + LEAST_LOSS) * b) for a, b in zip(after, before, strict=True)):
        return fewer
    if len(columns) <= limits.largest * size:
        return columns
    return _longest(columns, size, limits.left)


def _longest(columns: list[Column], size: int, kept: int) -> list[Column]:
    """A box instead of the shortest columns, so that ``kept`` times the size of them are left."""
    if len(columns) <= kept * size:
        return columns
    scales = np.array([float(item) or 1.0 for item in _sizes(columns, size)])
    shares = np.array([[float(x) for x in column] for column in columns]) / scales
    ordered = np.argsort((shares**2).sum(axis=1), kind="stable").tolist()
    count = len(columns) - (kept - 1) * size
    short = ordered[:count]
    return [
        *(columns[i] for i in ordered[count:]),
        *_aligned_box([columns[i] for i in short], shares[short], scales),
    ]


def _aligned_box(columns: Sequence[Column], shares: Array, scales: Array) -> list[Column]:
    """The columns of a box that holds the set of ``columns``, along their principal axes.

    ``shares`` (columns, size) are about their entries over ``scales``: they decide which box it is,
    and not whether it holds the set.
    """
    size, matrix = len(scales), _matrix(columns)
    try:
        axes = np.linalg.eigh(shares.T @ shares)[1]
        turn = arb_mat(size, size, [arb(x) for x in axes.ravel().tolist()])
        stretch = [arb(x) for x in scales.tolist()]
        back = [[x / s for x, s in zip(row, stretch, strict=True)] for row in turn.inv().tolist()]
        lengths = _sums(arb_mat(back) * matrix)
        pairs = zip(turn.tolist(), stretch, strict=True)
        found = arb_mat(
            [[x * s * w for x, w in zip(row, lengths, strict=True)] for row, s in pairs]
        )
    except (ArithmeticError, ValueError):
        return _box(_sizes(columns, size))
    near, off = _rounded(found)
    return [*near, *_box(off)]
