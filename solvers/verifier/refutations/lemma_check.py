"""The check of lemmas: of each, for every word of its condition; then that nothing is left over.

That effectors keep to the bound of a lemma is computed anew, from the grammar and its semantics,
over all derivations of all words of the condition.  That the words of lemmas and of the structures
that are listed are all words of the family is a question about languages, answered by
:mod:`word_coverage`.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace

from compiler.lemmas.effector_bounds import keep_to, place_of, placements_of
from compiler.robots.normal_form import RobotFamily
from compiler.tasks.necessary import stops
from compiler.time_limits.time_limit import check_time
from compiler.workspaces.polytope import Polytope
from grammar_lang import ir
from grammar_lang.conditions import condition_of
from solvers.verifier.claims.lemma_claims import LemmaClaim, effector_bound
from solvers.verifier.refutations.structure_evidence import FalseClaim
from solvers.verifier.refutations.word_coverage import Reader, listed, reader, within, word_left


def checked_condition(
    number: int, claim: LemmaClaim, family: RobotFamily, task: ir.Task
) -> ir.Accept:
    """The condition of a lemma, which is proved.

    Raises:
        FalseClaim: it is not.
    """
    check_time()
    try:
        condition = condition_of(claim.condition, family.language.srg.terminals)
        bound = effector_bound(claim)
    except ValueError as error:
        raise FalseClaim(f"lemma {number}: {error}") from None
    if all(stop.region != claim.region for stop in stops(family.program, task)):
        raise FalseClaim(f"lemma {number} is about a region that the task does not make one visit")
    place = place_of(family.program.workspaces[task.workspace], claim.region)
    if len(claim.vector) != place.dimension:
        raise FalseClaim(f"lemma {number}: the vector is not one of {place.dimension} coordinates")
    if not _bounded(place) or not bound.excludes(place):
        raise FalseClaim(f"lemma {number} does not exclude `{claim.region}`")
    try:
        placements = placements_of(family, condition)
    except ValueError as error:
        raise FalseClaim(f"lemma {number} cannot be checked: {error}") from None
    if not keep_to(bound, placements):
        raise FalseClaim(f"lemma {number} is not true: `{claim.condition}` allows more")
    return condition


def _bounded(place: Polytope) -> bool:
    """Whether a place has vertices that tell where it is; none is anywhere if it is empty."""
    return place.is_empty or place.is_bounded


def check_covered(
    family: RobotFamily,
    task: ir.Task,
    conditions: Sequence[ir.Accept],
    words: Iterable[Sequence[str]],
) -> None:
    """All words of the family, up to the task's bound, satisfy a condition or are listed.

    Raises:
        FalseClaim: one does not.
    """
    asked = [reader(family.grammar.accept), reader(ir.Count(None, ">=", 1))]
    if task.modules is not None:
        asked.append(within(family.program.modules, task.modules))
    covered: list[Reader] = [reader(condition) for condition in conditions]
    covered.append(listed(words))
    if word_left(family.grammar, asked, covered):
        raise FalseClaim("there are words that no lemma and no structure is about")


def without(family: RobotFamily, conditions: Sequence[ir.Accept]) -> RobotFamily:
    """The robots of a family whose words satisfy none of some conditions."""
    if not conditions:
        return family
    left = (family.grammar.accept, *(ir.NotAccept(condition) for condition in conditions))
    return replace(family, grammar=replace(family.grammar, accept=ir.AllOf(left)))
