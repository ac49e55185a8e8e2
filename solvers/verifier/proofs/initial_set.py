r"""A set of initial states: a point, a box, or an affine image of a box.

.. math:: \{\, m + G r : |r_i| \le \rho_i \,\}

A robot whose motion is written in coordinates y with q = D y, but whose start is known in q, starts
in such a set with G = D^{-1} for both coordinates and rates; no box of y is as small.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from flint import arb


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
