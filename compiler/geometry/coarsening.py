"""Few large convex pieces of what several make up together."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction

from compiler.geometry.overlaps import candidates, interiors_meet
from compiler.geometry.partition import glue
from compiler.geometry.polytope import Polytope
from compiler.geometry.reflex_cuts import convex_pieces


def coarsened(pieces: Sequence[Polytope]) -> tuple[Polytope, ...]:
    """Few convex pieces with the same union.

    Pieces with a convex union are glued.  In the plane the union is also divided afresh, by cuts at
    its reflex corners, which does not depend on how it was divided before: that is taken where
    it has no more pieces, of boxes where it has fewer.
    """
    glued = glue(pieces)
    if len(glued) < 3 or glued[0].dimension != 2:
        return glued  # two that cannot be glued have a union that is not convex
    afresh = glue(convex_pieces(glued))
    boxes = all(0 in row.normal for piece in glued for row in piece.rows)
    if len(afresh) + boxes > len(glued):
        return glued
    if not is_division(afresh, glued):
        raise AssertionError("pieces made afresh have the union of those before")
    return afresh


def is_division(parts: Sequence[Polytope], wholes: Sequence[Polytope]) -> bool:
    """Whether polygons have disjoint interiors and the union of others that have; exact.

    Proofs rest on cells: this check shares nothing with how the parts were made.
    """
    covered = Fraction(0)
    for i, j in candidates((*parts, *wholes)):
        if j < len(parts):
            if interiors_meet(parts[i], parts[j]):
                return False
        elif i < len(parts):
            covered += parts[i].intersection(wholes[j - len(parts)]).volume
    return covered == sum(part.volume for part in parts) == sum(whole.volume for whole in wholes)
