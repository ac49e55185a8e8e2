"""Which regions a point can be in together, where enclosures do not decide one by one.

At the instant at which it enters a region a point is on its boundary, and which side it is on can
never be decided.  Still it is on one of them; and between two regions that touch it is in one.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction

from flint import arb

from compiler.workspaces.partition import remainder
from compiler.workspaces.polytope import Polytope
from grammar_lang import ir
from solvers.verifier.proofs.tube_checks import Slice

THICKNESS = Fraction(1, 2**60)
"""Metres by which a box is widened along an axis along which a point does not move at all."""


def box_around(time: Slice, point: int) -> Polytope | None:
    """An exact box, with interior, around the positions in a slice; None if not bounded."""
    dimension = len(time.points[point])
    rows = []
    for axis in range(dimension):
        normal = [Fraction(axis == other) for other in range(dimension)]
        value = time.form([arb(int(entry)) for entry in normal], point)[0]
        if not value.is_finite():
            return None
        low, high = _exact(value.lower()), _exact(value.upper())
        if low == high:
            low, high = low - THICKNESS, high + THICKNESS
        rows.append(ir.HalfSpace(tuple(normal), high))
        rows.append(ir.HalfSpace(tuple(-entry for entry in normal), -low))
    return Polytope(tuple(rows))


def may_be(box: Polytope, within: Sequence[Polytope], without: Sequence[Polytope]) -> bool:
    """Whether a point of a box might be in some closed regions and in none of others.

    Never False where one is: a False is proved exactly.
    """
    place = box
    for region in within:
        place = place.intersection(region)
        if place.is_empty:
            return False
    if not place.has_interior:
        return not any(region.contains(place) for region in without)
    parts = (region.intersection(place) for region in without)
    return bool(remainder(place.irredundant(), [part for part in parts if part.has_interior]))


def _exact(value: arb) -> Fraction:
    """The rational that a ball without radius is."""
    mantissa, exponent = value.man_exp()
    return Fraction(int(mantissa)) * Fraction(2) ** int(exponent)
