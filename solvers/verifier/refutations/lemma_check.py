"""Check lemmas, each for every word of its condition, and that they leave no word uncovered.

That effectors keep to the bound of a lemma is computed again, from the grammar and its semantics,
over all derivations of all words of the condition; so is that all robots are variants of one.
Whether the words of the lemmas and of the listed structures are all words of the family is a
question about languages, answered by :mod:`word_coverage`.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from compiler.lemmas.effector_bounds import keep_to, place_of, placements_of
from compiler.lemmas.variants import holds_of_variants, holds_of_weighted, is_about_poses
from compiler.lemmas.weighted import weighted_robot
from compiler.robots.attributes import SemanticsError
from compiler.robots.candidate import robot_in_task
from compiler.robots.normal_form import RobotFamily
from compiler.tasks.necessary import stops
from compiler.time_limits.time_limit import check_time
from compiler.words.derivation import BadDerivation
from compiler.workspaces.polytope import Polytope
from grammar_lang import ir
from grammar_lang.conditions import condition_of
from solvers.verifier.claims.lemma_claims import (
    DistanceClaim,
    LemmaClaim,
    VariantClaim,
    WeightsClaim,
    effector_bound,
)
from solvers.verifier.refutations.structure_evidence import Evidence, FalseClaim
from solvers.verifier.refutations.word_coverage import Reader, listed, reader, within, word_left


@dataclass(frozen=True, slots=True)
class CheckedLemma:
    """The condition of a valid lemma; ``by_boxes``: whether boxes refute its robot, if any."""

    condition: ir.Accept
    by_boxes: bool | None


def checked_lemma(
    number: int, claim: LemmaClaim, family: RobotFamily, evidence: Evidence
) -> CheckedLemma:
    """A lemma, proved except for a solver's answer to its script.

    Raises:
        FalseClaim: the lemma is not proved.
        Refused: a trusted solver does not answer.
    """
    check_time()
    try:
        condition = condition_of(claim.condition, family.language.srg.terminals)
        if isinstance(claim, VariantClaim):
            return CheckedLemma(condition, _variants(claim, condition, family, evidence))
        if isinstance(claim, WeightsClaim):
            return CheckedLemma(condition, _weights(claim, condition, family, evidence))
        _distance(claim, condition, family, evidence.task)
    except FalseClaim as fault:
        raise FalseClaim(f"lemma {number}: {fault}") from None
    except ValueError as error:
        raise FalseClaim(f"lemma {number} cannot be checked: {error}") from None
    return CheckedLemma(condition, None)


def _distance(
    claim: DistanceClaim, condition: ir.Accept, family: RobotFamily, task: ir.Task
) -> None:
    """Check that effectors of the condition's robots keep to a bound that excludes the region."""
    bound = effector_bound(claim)
    if all(stop.region != claim.region for stop in stops(family.program, task)):
        raise FalseClaim("it is about a region that the task does not make an effector visit")
    place = place_of(family.program.workspaces[task.workspace], claim.region)
    if len(claim.vector) != place.dimension:
        raise FalseClaim(f"its vector is not one of {place.dimension} coordinates")
    if not _bounded(place) or not bound.excludes(place):
        raise FalseClaim(f"its bound does not exclude `{claim.region}`")
    if not keep_to(bound, placements_of(family, condition)):
        raise FalseClaim(f"robots with `{claim.condition}` go beyond its bound")


def _variants(
    claim: VariantClaim, condition: ir.Accept, family: RobotFamily, evidence: Evidence
) -> bool:
    """Check that all derivations of the condition are variants of one; whether boxes refute it."""
    task = evidence.task
    try:
        base = family.replay(claim.derivation)
        model = robot_in_task(family, task.origin, base)
    except (BadDerivation, SemanticsError) as error:
        raise FalseClaim(f"its derivation is of no robot: {error}") from None
    if base.word != claim.word:
        raise FalseClaim("its derivation does not derive its word")
    if not holds_of_variants(family, task, base, condition):
        raise FalseClaim(f"robots with `{claim.condition}` are not all variants of its robot")
    if claim.boxes is not None and not is_about_poses(
        evidence.content(claim.boxes).decode("ascii", "replace")
    ):
        raise FalseClaim("its boxes are about drives, not about poses alone")
    return evidence.refutes("its robot", claim.evidence, claim.boxes, model)


def _weights(
    claim: WeightsClaim, condition: ir.Accept, family: RobotFamily, evidence: Evidence
) -> bool:
    """Check that the condition's robots are one robot with weights, and that boxes refute it."""
    task = evidence.task
    try:
        base = family.replay(claim.derivation)
        model = weighted_robot(family, task, base, claim.most)
    except (BadDerivation, SemanticsError) as error:
        raise FalseClaim(f"its derivation is of no robot: {error}") from None
    if base.word != claim.word:
        raise FalseClaim("its derivation does not derive its word")
    if model is None or not holds_of_weighted(family, task, base, condition, claim.most):
        raise FalseClaim(f"robots with `{claim.condition}` are not all its robot with weights")
    return evidence.refutes("its robot with weights", None, claim.boxes, model)


def _bounded(place: Polytope) -> bool:
    """Whether a place has vertices that determine it; an empty place counts as bounded."""
    return place.is_empty or place.is_bounded


def check_covered(
    family: RobotFamily,
    task: ir.Task,
    conditions: Sequence[ir.Accept],
    words: Iterable[Sequence[str]],
) -> None:
    """Check that all words of the family, up to the task's bound, are listed or have a condition.

    Raises:
        FalseClaim: a word is neither listed nor satisfies a condition.
    """
    asked = [reader(family.grammar.accept), reader(ir.Count(None, ">=", 1))]
    if task.modules is not None:
        asked.append(within(family.program.modules, task.modules))
    covered: list[Reader] = [reader(condition) for condition in conditions]
    covered.append(listed(words))
    if word_left(family.grammar, asked, covered):
        raise FalseClaim("there are words that no lemma and no structure is about")
