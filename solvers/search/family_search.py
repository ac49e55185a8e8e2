"""The search of a family of robots: structures enter in order, take turns, and leave."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from fractions import Fraction

from compiler.lemmas.variants import is_about_poses
from compiler.objectives.least_values import Amount, amounts
from compiler.robots.candidate import Candidate
from compiler.robots.normal_form import RobotFamily
from compiler.robots.robot import RobotModel
from compiler.robots.robot_key import robot_key_in_task
from compiler.tasks.specification import recorded_effector
from compiler.workspaces.abstraction import Abstraction
from grammar_lang import ir
from solvers.conclusion import (
    DEFAULT_DESIGNS,
    MOTION_SEARCHES,
    StructureRecord,
    StructureVerdict,
    robot_limit,
    with_lemmas,
)
from solvers.impossibility.box_evidence import out_of_reach_of_drives
from solvers.impossibility.drive_search import AFTER_MOTIONS, DriveEffort
from solvers.impossibility.structure_refutation import Refutation
from solvers.lemma import Lemma
from solvers.run_context import RunContext
from solvers.search.design_values import design_values, limits_of
from solvers.search.narrowed_family import NoBoundError, Tried
from solvers.search.objective_search import ObjectiveSearch
from solvers.search.path_search import StructureTask
from solvers.search.path_task import Design, robustness_share
from solvers.search.prefetch import Prefetch
from solvers.search.robustness_bound import FINER, RobustnessBound, robustness_bound
from solvers.search.search_queue import SearchQueue, StructureUnderWay
from solvers.search.structure_search import StructureSearch
from solvers.search.structures_left import StructuresLeft
from solvers.verifier.claims.bound_claims import gap_above

NO_COUNTS = {"structures": 0, "smt": 0, "paths": 0, "evaluations": 0}


@dataclass(frozen=True, slots=True)
class Proved:
    """A design, the number of its structure, and the counts of its own search."""

    number: int
    design: Design
    counts: dict[str, int]


@dataclass(slots=True)
class FamilySearch:
    """The search of a family in progress; with ``every``, it continues after a design.

    ``family`` contains the robots that no lemma in ``lemmas`` covers.  ``told`` is called with the
    search whenever a design is proved.  With a ``gap``, the search continues until no design can be
    more robust than the best one by more than that share of it.
    """

    program: ir.Program
    task: ir.Task
    context: RunContext
    family: RobotFamily
    abstraction: Abstraction
    every: bool
    told: Callable[[FamilySearch], None]
    gap: Fraction | None = None
    whole: RobotFamily = field(init=False)
    """The family before any lemma."""
    bound: RobustnessBound | None = None
    unbounded: str | None = None
    """Why there is no bound, once one has been sought."""
    queue: SearchQueue = field(init=False)
    smt: int = 0
    records: dict[int, StructureRecord] = field(default_factory=dict[int, StructureRecord])
    seen: dict[str, int] = field(default_factory=dict[str, int])
    """Maps the key of a robot to the first structure that has it."""
    searched: list[StructureUnderWay] = field(default_factory=list[StructureUnderWay])
    """The structures whose search has ended, in the order in which it ended."""
    stopped: str | None = None
    unanswered: dict[int, str] = field(default_factory=dict[int, str])
    """Maps the number of a structure to the solver that gave no answer, and why."""
    lemmas: list[Lemma] = field(default_factory=list[Lemma])
    amounts: tuple[Amount, ...] = field(init=False)
    """The quantities to minimise."""
    valued: dict[int, tuple[Design, tuple[Fraction, ...]]] = field(
        default_factory=dict[int, tuple[Design, tuple[Fraction, ...]]]
    )
    """Maps the id of a design to the design and its values."""

    def __post_init__(self) -> None:
        self.every |= self.gap is not None
        self.queue, self.whole = SearchQueue(self.every), self.family
        self.amounts = amounts(self.program, self.task)

    def structures(self) -> None:
        """Let structures take turns until one is proved, or all of them if all are wanted."""
        left = StructuresLeft(self.program, self.task, self.context, self.family, self.lemmas)
        for _ in self.turns(left):
            if self.designs and (not self.every or self.is_closed()):
                return
        if self.designs and self.bound is not None and not self.is_closed():
            self.seek_bound(FINER)

    def turns(
        self, left: StructuresLeft, prepare: Callable[[], None] = lambda: None
    ) -> Iterator[None]:
        """Let structures take turns; yield after each structure whose search has ended.

        ``prepare`` is called before each turn.
        """
        while True:
            prepare()
            if left.following is None and not self.queue.under_way:
                return
            self.context.check_time()
            if left.following is not None and self.may_enter():
                if self.at_limit():
                    left.stop()
                    continue
                candidate = left.taken()
                self.enter(left.ahead, candidate)
                left.go_on()
                self.learn(left, candidate)
                continue
            structure = self.queue.turn()
            if structure.state.design is not None:
                self.queue.finish(structure)
            if structure.state.is_over:
                self.leave(structure)
                self.learn(left, structure.candidate)
                yield

    # --- how much more robust a design may be ---------------------------------------------------

    def is_closed(self) -> bool:
        """Whether no design can be more robust than the best one by more than the given gap."""
        if self.gap is None:
            return False
        if self.bound is None and self.unbounded is None:
            self.seek_bound(AFTER_MOTIONS)
        bound = self.bound
        above = None if bound is None else gap_above(bound.share, self.best_share)
        return above is not None and above <= self.gap

    def seek_bound(self, effort: DriveEffort) -> None:
        """Seek a bound on all designs; keep the previous bound unless the new one is smaller."""
        best = self.best_share
        if best is None:
            self.unbounded = "no input has a choice"
            return
        tried = Tried(self.all_records(""), tuple(self.lemmas))
        try:
            found = robustness_bound(self.whole, self.task, self.context, tried, best, effort)
        except NoBoundError as why:
            self.unbounded = str(why)
            return
        if self.bound is None or found.share < self.bound.share:
            self.bound = found

    @property
    def best_share(self) -> float | None:
        """The share of their bounds that the inputs of the best design leave free."""
        designs = self.designs
        return robustness_share(designs[0].design, self.task) if designs else None

    def learn(self, left: StructuresLeft, candidate: Candidate) -> None:
        """Narrow the remaining family by what the refutation of a structure implies."""
        record = self.records.get(candidate.number)
        if record is None or record.verdict != "refuted":
            return
        boxes = record.boxes
        by_poses = record.script is not None or (boxes is not None and is_about_poses(boxes))
        left.learn(candidate, by_poses=by_poses)
        self.family = left.family

    # --- a structure enters and leaves ----------------------------------------------------------

    def may_enter(self) -> bool:
        """Whether a new structure takes the next turn."""
        full = self.without_success + len(self.queue.under_way) >= MOTION_SEARCHES
        return not self.queue.under_way if full else self.queue.wants_another()

    def at_limit(self) -> bool:
        """Whether a limit ends the search; all limits are counts, so verdicts are reproducible."""
        robots = robot_limit(self.family, self.task)
        if self.without_success >= MOTION_SEARCHES:
            self.stopped = (
                f"the search ended at its limit of {MOTION_SEARCHES} robots that no motion was "
                "found for: narrow `accept`, or weaken the task"
            )
        elif robots is not None and len(self.seen) >= robots:
            self.stopped = (
                f"the search ended at its limit of {robots} different robots: say `modules <= n` "
                "in the task to try all up to a bound"
            )
        elif robots is not None and len(self.designs) >= DEFAULT_DESIGNS:
            self.stopped = (
                f"the search ended at its limit of {DEFAULT_DESIGNS} designs: say `modules <= n` "
                "in the task to have all up to a bound"
            )
        return self.stopped is not None

    def enter(self, ahead: Prefetch, candidate: Candidate) -> None:
        """Refute a structure, or queue it for the search."""
        self.context.reporter.structure(candidate.number, candidate.derivation.word)
        if candidate.model is None:
            self.record(candidate, "inadmissible", candidate.fault)
            return
        key = robot_key_in_task(candidate.model, self.task)
        if self.amounts:
            # The same robot can have several costs, depending on its word.
            word = candidate.derivation.word
            key += f"|{[str(amount.of_word(word)) for amount in self.amounts]}"
        if key in self.seen:
            self.record(candidate, "same", "", same=self.seen[key])
            return
        self.seen[key] = candidate.number
        screened = ahead.screening(candidate)
        answer = screened.refutation
        self.smt += answer.solver_calls
        if answer.unanswered:
            self.unanswered[candidate.number] = answer.unanswered
            self.context.reporter.note(answer.unanswered)
        if answer.refuted:
            self.record(candidate, "refuted", answer.reason, answer.script, boxes=answer.boxes)
            return
        if screened.inadmissible is not None:
            self.record(candidate, "inadmissible", screened.inadmissible)
            return
        entered = StructureUnderWay(
            self.queue.entered, candidate, answer.solver_calls, lambda: self.told(self)
        )
        if self.amounts:
            entered.best_of = self.best_of
        given = StructureTask(
            program=self.program,
            task=self.task,
            context=self.context,
            derivation=candidate.derivation,
            numeric=ahead.numeric(candidate),
            number=candidate.number,
            robot=robot_key_in_task(candidate.model, self.task),
            listener=entered,
        )
        effectors = self.effectors(candidate.model, answer)
        search = ObjectiveSearch if self.task.at_most or self.amounts else StructureSearch
        self.queue.enter(entered, search(given, self.abstraction).states(effectors))

    def leave(self, structure: StructureUnderWay) -> None:
        """Record the result of a structure whose search has ended."""
        self.queue.leave(structure)
        self.searched.append(structure)
        candidate, state = structure.candidate, structure.state
        if structure.incumbent is not None:
            self.record(candidate, "found", "proved")
            return
        late = out_of_reach_of_drives(candidate, self.program, self.task, self.context)
        if late is not None:
            self.record(candidate, "refuted", late.reason, boxes=late.boxes)
            return
        tried = f"; {state.tried}" if state.attempts else ""
        unanswered = self.unanswered.get(candidate.number)
        refuter = "" if unanswered is None else f"; {unanswered}"
        self.record(candidate, "unresolved", f"{state.reason}{tried}{state.obstacle}{refuter}")

    def effectors(self, model: RobotModel, answer: Refutation) -> list[int]:
        """The effectors that may start and reach, beginning with the one in the witness poses."""
        bound = recorded_effector(self.task)
        if bound is not None:
            return [bound] if bound < len(model.effectors) else []
        order = list(range(len(model.effectors)))
        return sorted(order, key=lambda e: (e != answer.effector, e))

    def record(
        self,
        candidate: Candidate,
        verdict: StructureVerdict,
        reason: str,
        script: str | None = None,
        *,
        same: int | None = None,
        boxes: str | None = None,
    ) -> None:
        """Record the verdict on a structure."""
        found = record_of(candidate, verdict, reason)
        self.records[candidate.number] = replace(
            found, script=script, same_robot_as=same, boxes=boxes
        )

    # --- results --------------------------------------------------------------------------------

    @property
    def without_success(self) -> int:
        """The number of structures whose search ended without a design or a refutation."""
        return sum(self.records[each.number].verdict == "unresolved" for each in self.searched)

    @property
    def all_searched(self) -> list[StructureUnderWay]:
        """The structures that were or are being searched, in order."""
        known = [*self.searched, *self.queue.under_way, *self.queue.parked]
        return sorted(known, key=lambda each: each.number)

    @property
    def every_design(self) -> tuple[Proved, ...]:
        """The best design of each structure, in order."""
        found = ((each, each.incumbent) for each in self.all_searched)
        return tuple(proved(each, design) for each, design in found if design is not None)

    @property
    def designs(self) -> tuple[Proved, ...]:
        """The best design by the objectives, followed by the others if all are asked for.

        Without objectives, the best designs of all structures, in order.  With a gap, only the most
        robust design.
        """
        found = self.every_design
        if self.gap is not None and found:
            best = max(found, key=lambda each: robustness_share(each.design, self.task) or 0.0)
            return (best,)
        if not self.amounts or not found:
            return found
        every = [proved(each, design) for each in self.all_searched for design in each.proved]
        _, first = limits_of([self.values(each.design) for each in every], self.amounts)
        best = every[first or 0]
        others = (each for each in found if each.number != best.number)
        return (best, *others) if self.every else (best,)

    def best_of(self, designs: Sequence[Design]) -> Design:
        """The best of some designs by the objectives; the most robust of equal ones."""
        ranked = sorted(designs, key=lambda design: -design.robustness)
        _, first = limits_of([self.values(design) for design in ranked], self.amounts)
        return ranked[first or 0]

    def values(self, design: Design) -> tuple[Fraction, ...]:
        """The value of a design in each objective."""
        known = self.valued.get(id(design))
        if known is None:
            known = design, design_values(design, self.amounts, self.task)
            self.valued[id(design)] = known
        return known[1]

    @property
    def all_values(self) -> list[tuple[Fraction, ...]]:
        """The values of all proved designs."""
        return [self.values(design) for each in self.all_searched for design in each.proved]

    @property
    def counts(self) -> dict[str, int]:
        """The total counts of what was tried."""
        found = {**NO_COUNTS, "structures": len(self.records), "smt": self.smt}
        for each in self.all_searched:
            for name, count in spent(each).items():
                found[name] += count
        return found

    def all_records(self, why: str) -> tuple[StructureRecord, ...]:
        """The verdicts on all structures, in order; equal robots share their reasons.

        ``why`` says what ended the search of the structures that are still under way.
        """
        found = dict(self.records)
        for each in (*self.queue.under_way, *self.queue.parked):
            if each.incumbent is not None:
                found[each.number] = record_of(each.candidate, "found", "proved")
                continue
            reason = f"{each.state.tried} when {why}{each.state.obstacle}"
            found[each.number] = record_of(each.candidate, "unresolved", reason)
        shared = (
            record
            if record.same_robot_as is None
            else replace(record, reason=found[record.same_robot_as].reason)
            for _, record in sorted(found.items())
        )
        return with_lemmas(list(shared), self.lemmas)


def proved(structure: StructureUnderWay, design: Design) -> Proved:
    """A design of a structure, with the effort of its search."""
    counts = {"structures": 1, "smt": structure.smt, **spent(structure)}
    return Proved(structure.number, design, counts)


def record_of(candidate: Candidate, verdict: StructureVerdict, reason: str) -> StructureRecord:
    """The record of a structure without evidence."""
    word, labels = candidate.derivation.word, candidate.derivation.labels
    return StructureRecord(word, labels, verdict, reason)


def spent(structure: StructureUnderWay) -> dict[str, int]:
    """The number of paths tried for a structure, and of parameters evaluated."""
    attempts = structure.state.evaluated
    evaluations = sum(len(each.samples) for each in attempts)
    return {"paths": len(attempts), "evaluations": evaluations}
