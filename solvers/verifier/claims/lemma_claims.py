"""What a certificate of *impossible* claims of all words of a condition at once: a lemma.

``condition`` is in the syntax of ``accept``; numbers are decimals or quotients, in SI units.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, TypeAlias

from compiler.expressions.exact_numbers import exact_number
from compiler.lemmas.effector_bounds import BallBound, EffectorBound, HalfSpaceBound
from solvers.verifier.claims.json_fields import number, objects, text, texts

EVERY_WORD = "length >= 1"
"""The condition that all words satisfy."""
TOO_FAR, TOO_NEAR, VARIANTS, WEIGHTS = "too far", "too near", "variants", "weights"


@dataclass(frozen=True, slots=True)
class DistanceClaim:
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


@dataclass(frozen=True, slots=True)
class VariantClaim:
    """All robots of the words with the ``condition`` are variants of one that is refuted.

    That one is given by its ``word`` and its ``derivation``, and refuted by a script
    (``evidence``), by a covering (``boxes``), or by both: paths of files.  ``argument`` is
    "variants".
    """

    argument: str
    condition: str
    word: tuple[str, ...]
    derivation: tuple[str, ...]
    evidence: str | None
    boxes: str | None
    kind: str = "lemma"


@dataclass(frozen=True, slots=True)
class WeightsClaim:
    """All robots of the words with the ``condition`` are one with up to ``most`` of each weight.

    The drives of that one, given by its ``word`` and its ``derivation``, are too weak whatever of
    these weights it has where: ``boxes``, the path of a covering of all of it.  ``argument`` is
    "weights".
    """

    argument: str
    condition: str
    word: tuple[str, ...]
    derivation: tuple[str, ...]
    most: int
    boxes: str
    kind: str = "lemma"


LemmaClaim: TypeAlias = DistanceClaim | VariantClaim | WeightsClaim


def lemma_claim(item: dict[str, Any]) -> LemmaClaim:
    """The lemma of a JSON object.

    Raises:
        TypeError, KeyError, ValueError: it is malformed.
    """
    argument = text(item.get("argument"))
    if argument == VARIANTS:
        (fields,) = objects([item], VariantClaim)
        return VariantClaim(
            argument, text(fields["condition"]), texts(fields["word"]), texts(fields["derivation"]),
            None if fields["evidence"] is None else text(fields["evidence"]),
            None if fields["boxes"] is None else text(fields["boxes"]),
        )  # fmt: skip
    if argument == WEIGHTS:
        (fields,) = objects([item], WeightsClaim)
        return WeightsClaim(
            argument, text(fields["condition"]), texts(fields["word"]), texts(fields["derivation"]),
            number(fields["most"]), text(fields["boxes"]),
        )  # fmt: skip
    if argument not in (TOO_FAR, TOO_NEAR):
        known = ", ".join(f"`{each}`" for each in (TOO_FAR, TOO_NEAR, VARIANTS, WEIGHTS))
        raise ValueError(f"the argument of a lemma is one of {known}")
    (fields,) = objects([item], DistanceClaim)
    return DistanceClaim(
        argument, text(fields["condition"]), text(fields["region"]),
        texts(fields["vector"]), text(fields["bound"]),
    )  # fmt: skip


def lemma_text(claim: LemmaClaim) -> str:
    """A lemma in words."""
    if isinstance(claim, WeightsClaim):
        return (
            f"no robot with `{claim.condition}` is brought there: the drives of "
            f"{' '.join(claim.word)} are too weak, with any weights"
        )
    if isinstance(claim, VariantClaim):
        word = " ".join(claim.word)
        return f"no robot with `{claim.condition}` has poses that {word}, refuted, has not"
    which = "of the family" if claim.condition == EVERY_WORD else f"with `{claim.condition}`"
    return f"no robot {which} has an effector in `{claim.region}`, {claim.argument} for it"


def effector_bound(claim: DistanceClaim) -> EffectorBound:
    """The bound that a lemma states of effectors.

    Raises:
        ValueError: a number is none.
    """
    vector = tuple(exact_number(x) for x in claim.vector)
    bound = exact_number(claim.bound)
    return HalfSpaceBound(vector, bound) if claim.argument == TOO_FAR else BallBound(vector, bound)
