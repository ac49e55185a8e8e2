"""The further claims of format 4: controllers, loops, lemmas, bounds and objectives."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import Any, TypeAlias

from compiler.expressions.exact_numbers import exact_number
from solvers.verifier.claims.bound_claims import BoundClaim, bound_claim
from solvers.verifier.claims.json_fields import number, objects, rows, text, texts
from solvers.verifier.claims.lemma_claims import LemmaClaim, lemma_claim
from solvers.verifier.claims.objective_claims import ObjectivesClaim, objectives_claim
from solvers.verifier.proofs.checked_condition import NO_MARGIN, CheckedCondition
from solvers.verifier.proofs.control_law import ControlLaw
from solvers.verifier.proofs.loop_set import Loop
from solvers.verifier.proofs.tube_checks import Status


@dataclass(frozen=True, slots=True)
class ControllerClaim:
    """At sample k the inputs are the stated ones minus gains times the deviation from a reference.

    ``reference`` holds coordinates, then rates, a row per step; ``gains`` a row per input and step.
    ``rounding`` has one tolerance per input: how far the inputs may be from this law because a
    computer that evaluates it rounds. None: no tolerance.
    """

    reference: tuple[tuple[str, ...], ...]
    gains: tuple[tuple[tuple[str, ...], ...], ...]
    rounding: tuple[str, ...] | None = None
    kind: str = "controller"


@dataclass(frozen=True, slots=True)
class LoopClaim:
    """The motion goes on for ever: the last step is followed by the step of the sample ``first``.

    ``centre`` and the rows of ``generators`` state the set of states at that sample: coordinates
    and rates of the joints, then the modules' own states. ``turns`` has one integer per joint: the
    full turns by which the joint is farther after a round; the next round is counted from there.
    None: every joint comes back without turns.
    """

    first: int
    centre: tuple[str, ...]
    generators: tuple[tuple[str, ...], ...]
    turns: tuple[int, ...] | None = None
    kind: str = "loop"


@dataclass(frozen=True, slots=True)
class UnknownClaim:
    """A claim of a kind that this verifier does not know; what depends on it stays undecided."""

    kind: str
    content: Mapping[str, Any]


def exact_law(claim: ControllerClaim) -> ControlLaw:
    """The control law that a claim states.

    Raises:
        ValueError: a number is malformed.
    """
    return ControlLaw(
        tuple(tuple(exact_number(x) for x in row) for row in claim.reference),
        tuple(tuple(tuple(exact_number(x) for x in row) for row in gain) for gain in claim.gains),
        tuple(exact_number(x) for x in claim.rounding or ()),
    )


def exact_loop(claim: LoopClaim) -> Loop:
    """The loop that a claim states.

    Raises:
        ValueError: a number is malformed, the shapes do not agree, or the generators are dependent.
    """
    return Loop(
        claim.first,
        tuple(exact_number(x) for x in claim.centre),
        tuple(tuple(exact_number(x) for x in row) for row in claim.generators),
        claim.turns or (),
    )


FurtherClaim: TypeAlias = (
    ControllerClaim | LoopClaim | LemmaClaim | BoundClaim | ObjectivesClaim | UnknownClaim
)


def further_claims(items: object) -> tuple[FurtherClaim, ...]:
    """Further claims: any number of lemmas, and at most one claim of each other known kind.

    Raises:
        TypeError, KeyError, ValueError: the claims are malformed.
    """
    if not isinstance(items, (list, tuple)) or not all(isinstance(item, dict) for item in items):
        raise TypeError("a list of claims is expected")
    found: list[FurtherClaim] = []
    for item in items:
        match text(item.get("kind")):
            case "controller":
                found.append(_controller(item))
            case "loop":
                found.append(_loop(item))
            case "lemma":
                found.append(lemma_claim(item))
            case "bound":
                found.append(bound_claim(item))
            case "objectives":
                found.append(objectives_claim(item))
            case kind:
                found.append(UnknownClaim(kind, item))
    for kind in ("controller", "loop", "bound", "objectives"):
        if sum(claim.kind == kind for claim in found) > 1:
            raise ValueError(f"more than one {kind} is claimed")
    return tuple(found)


def _controller(item: dict[str, Any]) -> ControllerClaim:
    (fields,) = objects([{"rounding": None, **item}], ControllerClaim)
    if not isinstance(fields["gains"], list):
        raise TypeError("a list of gains is expected")
    gains = tuple(rows(gain) for gain in fields["gains"])
    rounding = texts(fields["rounding"]) if "rounding" in item else None
    return ControllerClaim(rows(fields["reference"]), gains, rounding)


def _loop(item: dict[str, Any]) -> LoopClaim:
    (fields,) = objects([{"turns": None, **item}], LoopClaim)
    turns = None
    if "turns" in item:
        if not isinstance(fields["turns"], list):
            raise TypeError("a list of turns is expected")
        turns = tuple(map(number, fields["turns"]))
    first, centre = number(fields["first"]), texts(fields["centre"])
    return LoopClaim(first, centre, rows(fields["generators"]), turns)


def claim_content(claim: FurtherClaim) -> dict[str, Any]:
    """The JSON object of a claim."""
    if isinstance(claim, UnknownClaim):
        return dict(claim.content)
    content = asdict(claim)
    if isinstance(claim, ControllerClaim | LoopClaim):
        return {key: value for key, value in content.items() if value is not None}
    return content


def unknown_claims(claims: Sequence[FurtherClaim]) -> list[CheckedCondition]:
    """An open condition for each claim of an unknown kind."""
    return [
        CheckedCondition(
            f"claim `{claim.kind}`", Status.UNDECIDED, -NO_MARGIN, "",
            why=f"the certificate claims a `{claim.kind}`, of which this verifier knows nothing",
        )
        for claim in claims
        if isinstance(claim, UnknownClaim)
    ]  # fmt: skip
