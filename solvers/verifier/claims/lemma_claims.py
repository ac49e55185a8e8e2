"""Lemmas: claims of a certificate of *impossible* about all words that satisfy a condition.

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

    ``argument`` is "too far": no effector is farther than ``bound`` along ``vector``, but the whole
    region is; or "too near": no effector is nearer than ``bound`` to the point ``vector``, but the
    whole region is.
    """

    argument: str
    condition: str
    region: str
    vector: tuple[str, ...]
    bound: str
    kind: str = "lemma"


@dataclass(frozen=True, slots=True)
class VariantClaim:
    """All robots of the words with the ``condition`` are variants of one robot, which is refuted.

    This robot is given by its ``word`` and ``derivation``, and refuted by a script (``evidence``),
    by a covering (``boxes``), or by both; these are paths of files. ``argument`` is "variants".
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
    """All robots of words with the ``condition`` are one robot with up to ``most`` of each weight.

    This robot is given by its ``word`` and ``derivation``. Its drives are too weak, however many of
    these weights it has and wherever they are: ``boxes`` is the path of a covering that shows it.
    ``argument`` is "weights".
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
        TypeError, KeyError, ValueError: the object is malformed.
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
    which = "" if claim.condition == EVERY_WORD else f" with `{claim.condition}`"
    nobody = f"no robot of the family{which}"
    if isinstance(claim, WeightsClaim):
        word = " ".join(claim.word)
        return f"{nobody} is brought there: the drives of {word} are too weak, with any weights"
    if isinstance(claim, VariantClaim):
        return f"{nobody} has poses that {' '.join(claim.word)}, refuted, has not"
    return f"{nobody} has an effector in `{claim.region}`, {claim.argument} for it"


def effector_bound(claim: DistanceClaim) -> EffectorBound:
    """The bound on the positions of effectors that a lemma states.

    Raises:
        ValueError: a number is malformed.
    """
    vector = tuple(exact_number(x) for x in claim.vector)
    bound = exact_number(claim.bound)
    return HalfSpaceBound(vector, bound) if claim.argument == TOO_FAR else BallBound(vector, bound)
