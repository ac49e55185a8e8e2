"""The claim, in a certificate of *found*, that no robot's inputs can spare a larger share.

Its evidence is that of an impossibility: the task with tighter input bounds cannot be done.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from math import inf
from typing import Any

from compiler.expressions.exact_numbers import exact_number, exact_text
from solvers.verifier.claims.json_fields import number, objects, text
from solvers.verifier.claims.lemma_claims import LemmaClaim, lemma_claim
from solvers.verifier.claims.structure_claims import StructureClaim, structure_claims


@dataclass(frozen=True, slots=True)
class BoundClaim:
    """No robot with at most ``modules`` modules (None: of any size) keeps more than ``share``.

    ``share`` is a decimal: the distance of the inputs from their bounds, relative to the largest
    possible one. ``structures`` and ``lemmas`` are as in an ``ImpossibleClaim``, about the task
    with bounds that are tighter by this share. All structures are refuted by coverings, so no
    solver has to be trusted.
    """

    share: str
    modules: int | None
    structures: tuple[StructureClaim, ...]
    lemmas: tuple[LemmaClaim, ...]
    kind: str = "bound"


def bound_claim(item: dict[str, Any]) -> BoundClaim:
    """The bound of a JSON object.

    Raises:
        TypeError, KeyError, ValueError: the object is malformed.
    """
    (fields,) = objects([item], BoundClaim)
    if not 0 <= exact_number(text(fields["share"])) < 1:
        raise ValueError("the share of a bound is at least 0 and less than 1")
    lemmas = fields["lemmas"]
    if not isinstance(lemmas, list) or not all(isinstance(each, dict) for each in lemmas):
        raise TypeError("a list of lemmas is expected")
    return BoundClaim(
        fields["share"],
        None if fields["modules"] is None else number(fields["modules"]),
        structure_claims(fields["structures"]),
        tuple(lemma_claim(each) for each in lemmas),
    )


def bound_text(claim: BoundClaim) -> str:
    """A bound in words."""
    return share_text(exact_number(claim.share), claim.modules)


def share_text(share: Fraction, modules: int | None) -> str:
    """A bound in words, from its share and its number of modules."""
    percent = exact_text(100 * share)
    which = "of the family" if modules is None else f"of at most {modules} modules"
    return f"no robot {which} has more than {percent} %"


def gap_above(bound: Fraction, share: float | None) -> Fraction | None:
    """The relative gap between a bound and the share of a design; None if the share is unknown.

    It is exact for the share as stated.
    """
    if share is None or not 0 < share < inf:
        return None
    return bound / Fraction(share) - 1


def bound_entry(claim: BoundClaim, share: object) -> dict[str, Any]:
    """The entry of ``design.json`` for a bound and its gap above the ``share`` of the design."""
    bound = exact_number(claim.share)
    gap = gap_above(bound, share if isinstance(share, float) else None)
    return {
        "share": float(bound),
        "modules": claim.modules,
        "gap": None if gap is None else float(gap),
    }
