"""What a certificate of *impossible* claims of all words of a condition at once: a lemma.

``condition`` is in the syntax of ``accept``; numbers are decimals or quotients, in SI units.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from compiler.expressions.exact_numbers import exact_number
from compiler.lemmas.effector_bounds import BallBound, EffectorBound, HalfSpaceBound
from solvers.verifier.claims.json_fields import objects, text, texts

TOO_FAR, TOO_NEAR = "too far", "too near"


@dataclass(frozen=True, slots=True)
class LemmaClaim:
    """No robot of the family whose word satisfies the ``condition`` has an effector in ``region``.

    ``argument`` is "too far": no effector is farther than ``bound`` along ``vector``, and all of
    the region is; or "too near": none is nearer than ``bound`` to the point ``vector``, and all of
    the region is.
    """

    argument: str
    condition: str
    region: str
    vector: tuple[str, ...]
    bound: str
    kind: str = "lemma"


def lemma_claim(item: dict[str, Any]) -> LemmaClaim:
    """The lemma of a JSON object.

    Raises:
        TypeError, KeyError, ValueError: it is malformed.
    """
    (fields,) = objects([item], LemmaClaim)
    if fields["argument"] not in (TOO_FAR, TOO_NEAR):
        raise ValueError(f"a lemma is `{TOO_FAR}` or `{TOO_NEAR}`")
    return LemmaClaim(
        text(fields["argument"]), text(fields["condition"]), text(fields["region"]),
        texts(fields["vector"]), text(fields["bound"]),
    )  # fmt: skip


def lemma_text(claim: LemmaClaim) -> str:
    """A lemma in words."""
    which = f"no robot with `{claim.condition}` has an effector in `{claim.region}`"
    return f"{which}, {claim.argument} for it"


def effector_bound(claim: LemmaClaim) -> EffectorBound:
    """The bound that a lemma states of effectors.

    Raises:
        ValueError: a number is none.
    """
    vector = tuple(exact_number(x) for x in claim.vector)
    bound = exact_number(claim.bound)
    return HalfSpaceBound(vector, bound) if claim.argument == TOO_FAR else BallBound(vector, bound)
