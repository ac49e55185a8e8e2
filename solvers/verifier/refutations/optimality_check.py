"""Check objectives: the stated values, and that no robot has less than the stated least.

Which words may have less is a question about languages, answered by :mod:`word_coverage`: each of
them satisfies a lemma or is listed. For listed words, every derivation is refuted by a covering, or
its robots have at least as much for all parameters. A covering may leave out parameters with which
a robot has at least as much.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from pathlib import Path

from compiler.expressions.exact_numbers import exact_text
from compiler.objectives.cheaper_robots import CheaperRobots, Less
from compiler.objectives.least_values import Amount, amounts
from compiler.objectives.objective_text import amount_text, value_text
from compiler.objectives.values import MotionValues, value_bounds
from compiler.robots.candidate import Candidate, candidates_of
from compiler.robots.normal_form import RobotFamily, family_of
from compiler.robots.robot import RobotModel
from compiler.tasks.tightened import shortened
from compiler.words.structures import InfiniteAmbiguityError
from grammar_lang import ir
from solvers.verifier.claims.certificate import FoundClaim, ImpossibleClaim, claimed_values, exact
from solvers.verifier.claims.objective_claims import ObjectivesClaim, TimeClaim
from solvers.verifier.proofs.checked_condition import NO_MARGIN, CheckedCondition
from solvers.verifier.proofs.scene import Watch
from solvers.verifier.proofs.tube_checks import Status
from solvers.verifier.refutations.impossibility_check import check_impossible, refuted_structures
from solvers.verifier.refutations.lemma_check import checked_lemma
from solvers.verifier.refutations.structure_evidence import Evidence, FalseClaim
from solvers.verifier.refutations.word_coverage import (
    Reader,
    listed,
    reader,
    weighing,
    within,
    word_left,
)
from solvers.verifier.report import Refused

CLOSELY = Fraction(1, 10**9)
"""The tolerance for a value that is not rational, relative to it or to one unit."""
SEGMENTS = Fraction(1, 10**5)
"""The tolerance for energies, which depend on how a tube is divided into segments."""


@dataclass(frozen=True, slots=True)
class _Stated:
    """An objective with its claimed numbers, exact and in SI units."""

    amount: Amount
    value: Fraction
    least: Fraction

    @property
    def most(self) -> Fraction:
        """The most that a robot may have of this objective to be compared in later ones.

        The robot of the claim is within this limit.
        """
        return max(self.value, self.least * (1 + self.amount.objective.within))


def objective_conditions(
    folder: Path,
    found: FoundClaim,
    claim: ObjectivesClaim,
    program: ir.Program,
    task: ir.Task,
    model: RobotModel,
    motion: MotionValues,
    watch: Watch,
) -> tuple[CheckedCondition, ...]:
    """Check the claim of each objective and return the conditions that they state.

    Args:
        folder: the result folder, with the coverings.
        found: the claim of the robot.
        claim: the claim of the objectives.
        program: the program, without maps.
        task: its task, without maps.
        model: the robot.
        motion: the proved values of its motion.
        watch: receives the number of structures that are done.

    Raises:
        Refused: a value is misstated, or the evidence does not prove a least.
    """
    known = amounts(program, task)
    if [amount.text for amount in known] != [each.objective for each in claim.values]:
        raise Refused("the objectives of the certificate are not those of the task")
    stated = [
        _Stated(amount, exact(each.value), exact(each.least))
        for amount, each in zip(known, claim.values, strict=True)
    ]
    for each in stated:
        _check_value(each, found, model, motion)
    try:
        _check_least(folder, found, claim, program, task, stated, watch)
        # No motion has fewer steps than the task allows.
        shortest = task.fewest_steps * task.step
        for each in stated:
            if each.amount.objective.kind == "time" and each.least > shortest:
                _check_time(folder, found, claim.time, program, task, each.least, watch)
    except (FalseClaim, InfiniteAmbiguityError) as error:
        raise Refused(f"it is not proved that no robot has less: {error}") from None
    said = (_says(each, stated[:k], _modules(claim, task, each)) for k, each in enumerate(stated))
    return tuple(CheckedCondition(text, Status.HOLDS, NO_MARGIN, "") for text in said)


def _modules(claim: ObjectivesClaim, task: ir.Task, stated: _Stated) -> int | None:
    """The bound on modules of a least, if the task has none itself; None without a bound."""
    if task.modules is not None:
        return None
    if stated.amount.objective.kind == "time":
        return None if claim.time is None else claim.time.modules
    return claim.modules


def _says(stated: _Stated, before: Sequence[_Stated], modules: int | None) -> str:
    """The proved statement about an objective, in words: for which robots and how many modules."""
    objective = stated.amount.objective
    value = amount_text(objective, stated.value)
    if not stated.least > 0:
        return value
    # The least time is proved for all robots, whatever they have of other objectives.
    weighed = [each for each in before if each.amount.weights and objective.kind != "time"]
    limits = [amount_text(each.amount.objective, each.most, "up to") for each in weighed]
    limits += [] if modules is None else [f"up to {modules} modules"]
    robots = f"no robot with {' and '.join(limits)}" if limits else "no robot"
    if stated.least == stated.value:
        return f"{value}: {robots} has less"
    return f"{value}: {robots} has less than {value_text(objective, stated.least)}"


def _check_value(
    stated: _Stated, found: FoundClaim, model: RobotModel, motion: MotionValues
) -> None:
    """Check that the value is the robot's; a rational value has to be stated exactly."""
    values = claimed_values(found, model)
    bounds = value_bounds(stated.amount, found.word, model, values, motion)
    if bounds is None:
        raise Refused(f"`{stated.amount.text}` has no finite value")
    low, high = bounds
    is_energy = stated.amount.objective.kind == "energy"
    close = (SEGMENTS if is_energy else CLOSELY) * max(Fraction(1), abs(high))
    exactly = low == high and stated.amount.objective.kind not in ("effort", "energy")
    # A value below the true one would exclude the robot itself from the limits of later objectives.
    least = low if stated.amount.is_ordering else low - close
    near = stated.value == low if exactly else least <= stated.value <= high + close
    if not near:
        is_value = exact_text(low) if exactly else f"about {float(high):.12g}"
        raise Refused(
            f"`{stated.amount.text}` is {is_value}, not {exact_text(stated.value)} "
            "as the certificate says"
        )


def _check_least(
    folder: Path,
    found: FoundClaim,
    claim: ObjectivesClaim,
    program: ir.Program,
    task: ir.Task,
    stated: Sequence[_Stated],
    watch: Watch,
) -> None:
    """Check that no robot within the limits of the objectives before has less than the least.

    Raises:
        FalseClaim: this is not proved.
    """
    if task.modules is not None and claim.modules != task.modules:
        raise FalseClaim("the bound on modules is not the task's")
    asked = replace(task, modules=claim.modules)
    family = family_of(program, asked)
    evidence = Evidence(folder, program, asked, ())
    lemmas = [
        checked_lemma(number, lemma, family, evidence)
        for number, lemma in enumerate(claim.lemmas, 1)
    ]
    if not all(lemma.by_boxes is not False for lemma in lemmas):
        raise FalseClaim("a lemma about objectives has no scripts as evidence")
    conditions = tuple(lemma.condition for lemma in lemmas)
    words = tuple(dict.fromkeys([*(each.word for each in claim.structures), *claim.dearer]))
    due = [
        _due(stated[: k + 1])
        for k in range(len(stated))
        if stated[k].least > 0 and stated[k].amount.objective.kind != "time"
    ]
    _check_words(family, asked, conditions, words, due)
    left = family.with_condition(ir.NotAccept(ir.AnyOf(conditions)))
    open_words = [word for word in words if left.language.accepts(word)]
    candidates = _not_dearer(candidates_of(left, open_words, task.origin), stated)

    def cheaper(candidate: Candidate) -> CheaperRobots | None:
        if candidate.model is None:
            return None
        places = [k for k in range(len(stated)) if _may_be_less(candidate, stated[: k + 1])]
        less = tuple(_less(stated[: k + 1]) for k in places)
        return CheaperRobots(candidate.derivation.word, candidate.model, less)

    impossible = ImpossibleClaim(
        found.task, found.spec, found.spec_sha256, claim.modules, claim.structures, None,
        claim.lemmas,
    )  # fmt: skip
    if not all(refuted_structures(evidence, impossible, candidates, watch, cheaper)):
        raise FalseClaim("structures have no scripts as evidence")


def _check_time(
    folder: Path,
    found: FoundClaim,
    claim: TimeClaim | None,
    program: ir.Program,
    task: ir.Task,
    least: Fraction,
    watch: Watch,
) -> None:
    """Check that no robot does the task in less time, whatever it has of other objectives.

    Raises:
        FalseClaim: this is not proved.
    """
    if claim is None or (claim.steps + 1) * task.step < least:
        raise FalseClaim("there is no evidence for the least time")
    if not task.at_most or not task.fewest_steps <= claim.steps <= task.steps:
        raise FalseClaim("the task does not allow its number of steps")
    if task.modules is not None and claim.modules != task.modules:
        raise FalseClaim("the bound on modules is not the task's")
    narrow = replace(shortened(task, claim.steps), modules=claim.modules)
    impossible = ImpossibleClaim(
        found.task, found.spec, found.spec_sha256, claim.modules, claim.structures, None,
        claim.lemmas,
    )  # fmt: skip
    proved = check_impossible(folder, impossible, program, narrow, (), watch)
    if isinstance(proved, str):
        raise FalseClaim(proved)
    if not proved.complete:
        raise FalseClaim("a bound on the time has no scripts as evidence")


def _due(stated: Sequence[_Stated]) -> list[Reader]:
    """Readers of the words that may have less of the last objective, within the other limits."""
    *before, last = stated
    readers = [weighing(each.amount.weights, each.most, strict=False) for each in before]
    return [*readers, weighing(last.amount.weights, last.least, strict=True)]


def _check_words(
    family: RobotFamily,
    task: ir.Task,
    conditions: Sequence[ir.Accept],
    words: Sequence[Sequence[str]],
    due: Sequence[Sequence[Reader]],
) -> None:
    """Check that all words that may have less satisfy a condition or are listed.

    Raises:
        FalseClaim: a word does neither.
    """
    common = [reader(family.grammar.accept), reader(ir.Count(None, ">=", 1))]
    if task.modules is not None:
        common.append(within(family.program.modules, task.modules))
    covered = [*(reader(condition) for condition in conditions), listed(words)]
    for readers in due:
        if word_left(family.grammar, [*common, *readers], covered):
            raise FalseClaim("there are words that no lemma and no structure is about")


def _not_dearer(candidates: Iterator[Candidate], stated: Sequence[_Stated]) -> Iterator[Candidate]:
    """The structures that may have less, renumbered."""
    number = 0
    for candidate in candidates:
        if any(_may_be_less(candidate, stated[: k + 1]) for k in range(len(stated))):
            yield replace(candidate, number=number)
            number += 1


def _less(stated: Sequence[_Stated]) -> Less:
    """Less than the least of the last objective, within the limits of the objectives before it."""
    *before, last = stated
    return Less(tuple((each.amount, each.most) for each in before), last.amount, last.least)


def _may_be_less(candidate: Candidate, stated: Sequence[_Stated]) -> bool:
    if stated[-1].amount.objective.kind == "time":
        return False
    return _less(stated).is_open(candidate.derivation.word, candidate.model)
