r"""The set of states at an instant: a zonotope, the affine image of a box.

.. math:: X = \{\, m + G r : |r_j| \le 1 \,\}

with m and G exact.  Like Lohner's representation m + C r + Q e (1987) it moves with the flow
without being enclosed anew.  What is added on a segment, a box, becomes new columns of G instead
of being turned into the axes Q at once, where shears would widen it; Q is a box of the columns
that lose least by that.  Under a map x -> p + (P + Z)(x - m) + d,

.. math:: m' \approx p, \qquad G' \approx (P G,\ D), \qquad
    D = \operatorname{diag}\bigl(|p - m'| + |Z (x - m)| + |P G - G'| 1 + |d|\bigr),

so that no rounding of m' and G' can lose a state.  Where there are too many columns, those nearest
to being along an axis are replaced by the box that holds them (Girard, *Reachability of uncertain
linear systems using zonotopes*, 2005); long ones stay, so that wrapping does not feed on itself
(Kuhn, *Rigorously computed orbits of dynamical systems without the wrapping effect*, 1998).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

from flint import arb, arb_mat

from compiler.expressions.ball_matrices import SIGNS, absolute, column_of_ones
from solvers.verifier.proofs.initial_set import InitialSet

MOST_COLUMNS, KEPT_COLUMNS = 8, 5
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
            return [arb(0)] * len(self.middle)
        moved = absolute(matrix * _matrix(self.columns))
        return [item.upper() for item in (moved * column_of_ones(len(self.columns))).entries()]

    def hull(self) -> list[arb]:
        """The smallest balls about m that hold the set."""
        return [m + SIGNS * r for m, r in zip(self.middle, self.radii, strict=True)]

    def moved(self, to: Sequence[arb], matrix: arb_mat, added: Sequence[arb]) -> Zonotope:
        """The set under x -> ``to`` + P (x - m) + d with all |d| <= ``added``."""
        middle = [item.mid() for item in to]
        rest = [abs(t - m) + a for t, m, a in zip(to, middle, added, strict=True)]
        columns: list[Column] = []
        if self.columns:
            image = matrix * _matrix(self.columns)
            for i, row in enumerate(image.tolist()):
                rest[i] = sum((item.rad() for item in row), rest[i])
            columns = [list(column) for column in image.mid().transpose().tolist()]
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
