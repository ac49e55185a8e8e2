"""Algorithm 1: structures, paths, parameters and controls, until a verdict can be proved.

    S.Synthesis -> P.Planning -> P.Synthesis -> certificate, counterexamples flowing back.

``found`` is claimed only for a motion that the verifier's own proof accepts; ``impossible`` only if
every structure up to an explicit bound is refuted: by a script that a solver answered ``unsat``,
by a covering that the verifier's own replay accepts, or by both.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

from compiler.robots.candidate import Candidate, candidates
from compiler.robots.normal_form import RobotFamily, family_of
from compiler.robots.robot import RobotModel
from compiler.robots.robot_key import robot_key_in_task
from compiler.tasks.obstacle_pieces import expanded
from compiler.tasks.specification import recorded_effector
from compiler.time_limits.time_limit import OutOfTimeError, check_time
from compiler.workspaces.abstraction import Abstraction, abstract
from compiler.workspaces.bisection import bisections
from grammar_lang import ir
from solvers.conclusion import (
    DEFAULT_DESIGNS,
    MOTION_SEARCHES,
    StructureRecord,
    StructureVerdict,
    conclude,
    module_bound,
    robot_limit,
)
from solvers.impossibility.box_evidence import covered, out_of_reach_of_drives
from solvers.impossibility.disconnection import disconnected, separation_text
from solvers.impossibility.structure_refutation import Refutation
from solvers.run_context import RunContext
from solvers.search.configuration_search import PathSamples
from solvers.search.path_task import Design
from solvers.search.prefetch import Prefetch
from solvers.search.search_queue import SearchQueue, StructureUnderWay
from solvers.search.search_state import BlockedPrefix, NearestMotion
from solvers.search.structure_search import StructureSearch
from solvers.verdict import Verdict
from solvers.verifier.claims.certificate import SeparationClaim

OUT_OF_TIME = "the time limit was reached"
BEGUN = "srgc was started and the spec was read"
NOT_COVERED = f"{OUT_OF_TIME} before every refutation had a second proof"
PUT_OFF = "put off, as another structure was proved"
NO_COUNTS = {"structures": 0, "smt": 0, "paths": 0, "evaluations": 0}


@dataclass(frozen=True, slots=True)
class Proved:
    """A design, the number of its structure, and what its search took (a part of all counts)."""

    number: int
    design: Design
    counts: dict[str, int]


@dataclass(frozen=True, slots=True)
class Synthesis:
    """The verdict with everything that was tried.

    ``abstraction`` has the cells of the design, else those without cuts.  A ``separation`` proves
    the task impossible before anything is tried.  ``design`` is the first of ``designs``, which
    are more than one only where all were asked for; ``ended`` says what kept the search from
    trying all structures then.  ``nearest`` is the motion that came nearest to a design without
    being proved.  ``unfinished``: the time limit was reached, and another run can go
    on; ``last_step`` is what then took so long, if that could not be interrupted.
    """

    verdict: Verdict
    reason: str | None
    design: Design | None
    records: tuple[StructureRecord, ...]
    abstraction: Abstraction
    counts: dict[str, int]
    separation: SeparationClaim | None = None
    designs: tuple[Proved, ...] = ()
    samples: tuple[PathSamples, ...] = ()
    blocked: tuple[BlockedPrefix, ...] = ()
    nearest: NearestMotion | None = None
    ended: str | None = None
    unfinished: bool = False
    last_step: str = ""


@dataclass(slots=True)
class _Run:
    """One synthesis in progress; ``every``: it goes on after a design."""

    program: ir.Program
    task: ir.Task
    context: RunContext
    family: RobotFamily
    abstraction: Abstraction
    every: bool
    queue: SearchQueue
    smt: int = 0
    records: dict[int, StructureRecord] = field(default_factory=dict[int, StructureRecord])
    seen: dict[str, int] = field(default_factory=dict[str, int])
    """By the key of a robot the first structure that has it."""
    searched: list[StructureUnderWay] = field(default_factory=list[StructureUnderWay])
    """The structures that were searched, as they ended."""
    stopped: str | None = None

    def structures(self) -> None:
        """Let structures have their turns until one is proved, unless all are due."""
        bound = module_bound(self.family, self.task)
        drawn = candidates(self.family, bound, self.task.origin)
        ahead = Prefetch(drawn, self.program, self.task, self.context)
        left = iter(ahead)
        following = next(left, None)
        while following is not None or self.queue.under_way:
            self.context.check_time()
            if following is not None and self.may_enter():
                if self.at_limit():
                    following = None
                    continue
                self.enter(ahead, following)
                following = next(left, None)
                continue
            structure = self.queue.turn()
            if structure.state.design is not None:
                self.queue.finish(structure)
            if structure.state.is_over:
                self.leave(structure)
                if self.designs and not self.every:
                    return

    # --- a structure comes and goes -------------------------------------------------------------

    def may_enter(self) -> bool:
        """Whether another structure has the next turn."""
        full = self.without_success + len(self.queue.under_way) >= MOTION_SEARCHES
        return not self.queue.under_way if full else self.queue.wants_another()

    def at_limit(self) -> bool:
        """Whether a limit ends the search; all are counts, so that verdicts repeat."""
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
        """Refute a structure, or have it searched."""
        self.context.reporter.structure(candidate.number, candidate.derivation.word)
        if candidate.model is None:
            self.record(candidate, "inadmissible", candidate.fault)
            return
        key = robot_key_in_task(candidate.model, self.task)
        if key in self.seen:
            self.record(candidate, "same", "", same=self.seen[key])
            return
        self.seen[key] = candidate.number
        screened = ahead.screening(candidate)
        answer = screened.refutation
        self.smt += answer.solver_calls
        if answer.refuted:
            self.record(candidate, "refuted", answer.reason, answer.script, boxes=answer.boxes)
            return
        if screened.inadmissible is not None:
            self.record(candidate, "inadmissible", screened.inadmissible)
            return
        entered = self.queue.enter(candidate, answer.solver_calls)
        search = StructureSearch(
            self.program, self.task, self.context, self.abstraction, candidate.derivation,
            ahead.numeric(candidate), candidate.number, key, entered.keep, entered.see,
        )  # fmt: skip
        entered.states = search.states(self.effectors(candidate.model, answer))

    def leave(self, structure: StructureUnderWay) -> None:
        """A structure is searched to its end."""
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
        self.record(candidate, "unresolved", f"{state.reason}{state.obstacle}")

    def break_off(self, why: str) -> None:
        """The structures that are under way are not searched any more."""
        for structure in self.queue.under_way:
            if structure.incumbent is not None:
                self.record(structure.candidate, "found", "proved")
            else:
                paths = len(structure.state.attempts)
                tried = "1 path tried" if paths == 1 else f"{paths} paths tried"
                reason = f"{why}; {tried} before{structure.state.obstacle}"
                self.record(structure.candidate, "unresolved", reason)
        self.searched += self.queue.under_way
        self.queue.under_way = []

    def effectors(self, model: RobotModel, answer: Refutation) -> list[int]:
        """The effectors that may start and reach, the one of the witness poses first."""
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
        same: int | None = None,
        boxes: str | None = None,
    ) -> None:
        """What became of a structure."""
        derivation = candidate.derivation
        self.records[candidate.number] = StructureRecord(
            derivation.word, derivation.labels, verdict, reason, script, same, boxes
        )

    # --- what there is in the end ---------------------------------------------------------------

    @property
    def without_success(self) -> int:
        """How many structures were searched to their end without a design or a refutation."""
        return sum(self.records[each.number].verdict == "unresolved" for each in self.searched)

    @property
    def all_searched(self) -> list[StructureUnderWay]:
        """The structures that were searched, or are, in their order."""
        return sorted([*self.searched, *self.queue.under_way], key=lambda each: each.number)

    @property
    def designs(self) -> tuple[Proved, ...]:
        """The designs of all structures, in their order."""
        return tuple(
            Proved(each.number, each.incumbent, {"structures": 1, "smt": each.smt, **tried(each)})
            for each in self.all_searched
            if each.incumbent is not None
        )

    @property
    def counts(self) -> dict[str, int]:
        """What was tried."""
        found = {**NO_COUNTS, "structures": len(self.records), "smt": self.smt}
        for each in self.all_searched:
            for name, count in tried(each).items():
                found[name] += count
        return found

    def all_records(self) -> list[StructureRecord]:
        """What became of the structures, in their order; equal robots share their reasons."""
        found = [record for _, record in sorted(self.records.items())]
        return [
            record
            if record.same_robot_as is None
            else replace(record, reason=found[record.same_robot_as].reason)
            for record in found
        ]


def tried(structure: StructureUnderWay) -> dict[str, int]:
    """How many paths were tried for a structure, and how many parameters evaluated."""
    attempts = structure.state.evaluated
    evaluations = sum(len(each.samples) for each in attempts)
    return {"paths": len(attempts), "evaluations": evaluations}


def synthesise(
    program: ir.Program,
    task: ir.Task,
    context: RunContext,
    least_cells: int | None = None,
    *,
    every: bool = False,
) -> Synthesis:
    """Run Algorithm 1 on a task, from at least so many cells on if that is asked.

    With ``every`` the search goes on after a design, over all structures up to the bound.

    Raises:
        MapFault: a map of obstacles cannot be used.
    """
    program, task = expanded(program, task)
    cells = Abstraction(program.workspaces[task.workspace].dimension, (), {})
    try:
        check_time(BEGUN)
        cells = abstract(program.workspaces[task.workspace])
        separation = disconnected(program, task, cells)
        if separation is not None:
            reason = separation_text(program, task, separation)
            return Synthesis("impossible", reason, None, (), cells, dict(NO_COUNTS), separation)
        finer = cells if least_cells is None else cells.cut(bisections(cells, least_cells))
        family = family_of(program, task)
    except OutOfTimeError as late:
        return Synthesis(
            "unknown", OUT_OF_TIME, None, (), cells, dict(NO_COUNTS),
            unfinished=True, last_step=late.step,
        )  # fmt: skip
    run = _Run(program, task, context, family, finer, every, SearchQueue(every))
    try:
        run.structures()
        run.break_off(PUT_OFF)
        if run.designs:
            check_time()
            return _result(run, "found", None, cells)
        verdict, reason = conclude(run.all_records(), family, task, run.stopped)
    except OutOfTimeError as late:
        under_way = _under_way(run.queue.current)
        run.break_off(OUT_OF_TIME)
        return _result(run, "unknown", OUT_OF_TIME + under_way, cells, late)
    records, uncovered = run.all_records(), None
    if verdict == "impossible":
        records, uncovered = covered(records, family, task, context)
    if uncovered is not None:
        reason = f"{reason}; {NOT_COVERED}"
    return _result(run, verdict, reason, cells, uncovered, records)


def _under_way(structure: StructureUnderWay | None) -> str:
    """What the time limit interrupted, to follow its name."""
    if structure is None or structure.state.is_over:
        return ""
    word = " ".join(structure.derivation.word)
    if structure.waiting < 0:
        return f" while a motion of {word} was searched"
    return f" while a motion of {word}, of robustness {structure.waiting:.4g}, was proved"


def _result(
    run: _Run,
    verdict: Verdict,
    reason: str | None,
    cells: Abstraction,
    late: OutOfTimeError | None = None,
    records: Sequence[StructureRecord] | None = None,
) -> Synthesis:
    """The result; whatever ended the search, with a design the verdict is found."""
    ended = run.stopped if late is None else OUT_OF_TIME
    designs = run.designs
    if designs:
        verdict, reason, cells = "found", None, designs[0].design.abstraction
    searched = run.all_searched
    names = {
        each.number: [p.label for p in model.parameters]
        for each in searched
        if (model := each.candidate.model) is not None
    }
    nearest = [each.state.nearest for each in searched if each.state.nearest is not None]
    return Synthesis(
        verdict,
        reason,
        designs[0].design if designs else None,
        tuple(run.all_records() if records is None else records),
        cells,
        run.counts,
        designs=designs,
        samples=tuple(s for e in searched for s in e.state.samples(e.number, names[e.number])),
        blocked=tuple(b for each in searched for b in each.state.blocked(each.number)),
        nearest=max(nearest, key=lambda motion: motion.rank, default=None),
        ended=ended if run.every else None,
        unfinished=late is not None,
        last_step="" if late is None else late.step,
    )
