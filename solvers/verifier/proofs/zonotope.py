"""Sets of states: a point, a box, an affine image of a box, a zonotope."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from flint import arb, arb_mat

from compiler.arrays import Array
from compiler.expressions.evaluators.balls import SIGNS
from compiler.expressions.machine.ball_array import LEAST, BallArray

# --- A set of initial states: a point, a box, or an affine image of a box -------------------------
#
# .. math:: \{\, m + G r : |r_i| \le \rho_i \,\}
#
# A robot whose motion is written in coordinates y with q = D y, but whose start is known in q,
# starts in such a set with G = D^{-1} for both coordinates and rates; any box of y would be larger.


@dataclass(frozen=True, slots=True)
class InitialSet:
    """The states ``centre`` + ``generators`` r with ``|r_i| <= radii[i]``.

    ``centre`` has an entry per state (coordinates, rates, modules' own states); ``generators`` a
    row per state with a column per radius. All are balls, and the set covers all their values. A
    point has no generators.

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
    """The box of balls, with a generator along each axis where the ball has a positive radius."""
    wide = [i for i, item in enumerate(state) if not item.is_exact()]
    centre = tuple(item.mid() for item in state)
    rows = tuple(tuple(arb(int(i == j)) for j in wide) for i in range(len(state)))
    return InitialSet(centre, rows if wide else (), tuple(state[j].rad() for j in wide))


# --- The set of states at an instant: a zonotope, the affine image of a box -----------------------
#
# .. math:: X = \{\, m + G r : |r_j| \le 1 \,\}
#
# with m exact and G of doubles.  Like Lohner's representation m + C r + Q e (1987) it moves with
# the flow without a new enclosure.  The box that a segment adds becomes new columns of G.  It is
# not turned into the axes Q at once, where shears would widen it; only the columns that lose least
# by this are put into such a box.  Under a map x -> p + (P + Z)(x - m) + d,
#
# .. math:: m' \approx p, \qquad G' \approx (P G,\ D), \qquad
#     D = \operatorname{diag}\bigl(|p - m'| + |Z (x - m)| + |P G - G'| 1 + |d|\bigr),
#
# so that no rounding of m' and G' can lose a state: products of doubles are off by no more than
# n u |P| |G|, in whatever order their n terms are added (Higham, *Accuracy and stability of
# numerical algorithms*, 2002, section 3.1).  If there are too many columns, the shortest are
# replaced by the box along their principal axes that contains them (Girard, *Reachability of
# uncertain linear systems using zonotopes*, 2005; Kopetzki, Schuermann & Althoff, *Methods for
# order reduction of zonotopes*, 2017); long ones stay, so that wrapping does not feed on itself
# (Kuhn, *Rigorously computed orbits of dynamical systems without the wrapping effect*, 1998).


@dataclass(frozen=True, slots=True)
class OrderLimits:
    """Limits of the order of a zonotope: the number of columns divided by the size of a state.

    Above the order ``most`` a zonotope is reduced to ``kept``, unless that widens the set; above
    ``largest`` in any case, to ``left``.
    """

    most: int
    kept: int
    largest: int
    left: int


def exactly(order: int) -> OrderLimits:
    """Limits that always reduce a set to the given order."""
    return OrderLimits(order, order, order, order)


LIMITS = OrderLimits(30, 25, 120, 100)
LEAST_LOSS = 0.03
"""A reduction widens a set if its sums grow by more than this fraction. Such growth in all segments
of a sample feeds on itself: columns have to stay until feedback has acted on them."""

UNIT = 2.0**-52
"""Twice the relative error u of an operation that rounds to the nearest double; it bounds the error
of rounding in any direction."""


@dataclass(frozen=True)
class Zonotope:
    """m, exact, and G (size, c), exact doubles; a point has no columns."""

    middle: list[arb]
    columns: Array

    @staticmethod
    def point(middle: list[arb]) -> Zonotope:
        """A single state, exact."""
        return Zonotope(middle, np.zeros((len(middle), 0)))

    @cached_property
    def matrix(self) -> arb_mat:
        """G as balls."""
        size, count = self.columns.shape
        return arb_mat(size, count, [arb(x) for x in self.columns.ravel().tolist()])

    @cached_property
    def radii(self) -> list[arb]:
        """Bounds of |x - m|, entry by entry."""
        return [arb(x) for x in _sums(self.columns).tolist()]

    def radii_under(self, matrix: arb_mat) -> list[arb]:
        """Bounds of |P (x - m)|, entry by entry."""
        near, off = _moved(BallArray.of_matrix(matrix), self.columns)
        return [arb(x) + arb(o) for x, o in zip(_sums(near).tolist(), off.tolist(), strict=True)]

    def hull(self) -> list[arb]:
        """The smallest balls about m that contain the set."""
        return [m + SIGNS * r for m, r in zip(self.middle, self.radii, strict=True)]

    def values(self, weights: Sequence[Sequence[int]]) -> list[arb]:
        """Enclosures of weighted sums of the entries, one per row of weights."""
        matrix = arb_mat([[arb(w) for w in row] for row in weights])
        middle = (matrix * arb_mat([[x] for x in self.middle])).entries()
        return [m + SIGNS * r for m, r in zip(middle, self.radii_under(matrix), strict=True)]

    def first(self, size: int) -> Zonotope:
        """The set of the first entries of its states."""
        return Zonotope(self.middle[:size], self.columns[:size])

    def reduced(self, limits: OrderLimits) -> Zonotope:
        """A set that contains this one, of an order within limits."""
        return Zonotope(self.middle, _reduced(self.columns, limits))

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
        columns = [np.zeros((len(middle), 0))]
        parts = [_moved(BallArray.of_matrix(matrix), self.columns)] if self.columns.shape[1] else []
        if steady is not None:
            known = BallArray.of_matrix(steady)
            parts.append(_finite(known.middle, _sums(known.radius)))
        for near, off in parts:
            columns.append(near)
            rest = [r + arb(o) for r, o in zip(rest, off.tolist(), strict=True)]
        return Zonotope(middle, _reduced(np.hstack([*columns, _box(rest)]), LIMITS))


def zonotope(initial: InitialSet) -> Zonotope:
    """The zonotope of an initial set."""
    middle = [item.mid() for item in initial.centre]
    rest = [item.rad() for item in initial.centre]
    columns = np.zeros((len(middle), len(initial.radii)))
    for j, radius in enumerate(initial.radii):
        for i, row in enumerate(initial.generators):
            wide = row[j] * radius
            columns[i, j] = float(wide)
            rest[i] += abs(wide - columns[i, j].item())
    return Zonotope(middle, np.hstack([columns, _box(rest)]))


UNHEEDED = np.errstate(invalid="ignore", over="ignore")
"""NaN and overflow are handled where they occur."""


@UNHEEDED
def _moved(matrix: BallArray, columns: Array) -> tuple[Array, Array]:
    """Doubles near P G, (m, c), and bounds of the total error of all columns, row by row."""
    middle, sizes, terms = np.abs(matrix.middle), _sums(columns), columns.shape[0]
    # A row of zeros and a single 1 has no error.
    copied = ~matrix.radius.any(axis=1) & (np.count_nonzero(middle, axis=1) <= 1)
    copied &= ((middle == 0) | (middle == 1)).all(axis=1)
    # The relative bound of a single product may underflow.
    sums = (middle + matrix.radius) * sizes
    off = _sums(matrix.radius * sizes + (terms + 4) * UNIT * sums)
    off += LEAST * ((middle + matrix.radius != 0) @ (sizes != 0))
    return _finite(matrix.middle @ columns, np.where(copied, 0.0, off))


def _finite(near: Array, off: Array) -> tuple[Array, Array]:
    """The arguments, with rows that are not numbers replaced by zeros with an infinite error."""
    known = np.isfinite(near).all(axis=1) & np.isfinite(off)
    return np.where(known[:, None], near, 0.0), np.where(known, off, np.inf)


@UNHEEDED
def _sums(terms: Array) -> Array:
    """Bounds of the sums of absolute values, row by row."""
    sizes = np.abs(terms)
    sums: Array = sizes.sum(axis=1) * (1 + (terms.shape[1] + 4) * UNIT)
    # Errors of subnormal numbers add up to less than this.
    sums[(sizes > 0).any(axis=1)] += LEAST
    return sums


def _box(radii: Sequence[arb]) -> Array:
    """The columns (size, c) of a box."""
    ends = [_above(radius) for radius in radii]
    columns: Array = np.diag(ends)[:, np.flatnonzero(ends)]
    return columns


def _above(bound: arb) -> float:
    """A double that is at least as large."""
    upper = bound.upper()
    near = float(upper)
    return math.nextafter(near, math.inf) if upper > near else near


def _reduced(columns: Array, limits: OrderLimits) -> Array:
    """The columns, or fewer of them if there are many."""
    size, count = columns.shape
    if count <= limits.most * size:
        return columns
    fewer = _longest(columns, limits.kept)
    if limits.left == limits.kept and count > limits.largest * size:
        return fewer
    if bool((_sums(fewer) <= (1 + LEAST_LOSS) * _sums(columns)).all()):
        return fewer
    if count <= limits.largest * size:
        return columns
    return _longest(columns, limits.left)


@UNHEEDED
def _longest(columns: Array, kept: int) -> Array:
    """The longest columns and a box for the others, so that ``kept`` times the size remain."""
    size, most = columns.shape
    if most <= kept * size:
        return columns
    scales = _sums(columns)
    scales[scales == 0] = 1.0
    shares = columns / scales[:, None]
    ordered = np.argsort((shares**2).sum(axis=0), kind="stable")
    count = most - (kept - 1) * size
    short = ordered[:count]
    box = _aligned_box(columns[:, short], shares[:, short], scales)
    return np.hstack([columns[:, ordered[count:]], box])


@UNHEEDED
def _aligned_box(columns: Array, shares: Array, scales: Array) -> Array:
    """The columns of a box that contains the set of ``columns``, along their principal axes.

    ``shares`` (size, c) are their entries over ``scales``; they determine the axes A. For any B, G
    = A B + R: the box has the sums of |B|, which are about 1, along A, and those of |R| along the
    axes of the states.
    """
    try:
        turn = np.linalg.eigh(shares @ shares.T)[1]
    except np.linalg.LinAlgError:
        return np.diag(_sums(columns))
    parts = turn.T @ shares
    lengths = _sums(parts)
    wide = scales[:, None] * turn * lengths
    parts /= np.where(lengths == 0, 1.0, lengths)[:, None]
    near, off = _moved(BallArray(wide, np.zeros_like(wide)), parts)
    beyond = np.maximum(_sums(parts) - 1, 0.0)
    rest = _sums(np.stack([_sums(columns - near), off, _sums(wide * beyond)], axis=1)) + LEAST
    found = np.hstack([wide, np.diag(rest)])
    return found if np.isfinite(found).all() else np.diag(_sums(columns))
