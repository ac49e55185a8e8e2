"""Algorithm 1: structures, paths, parameters and controls, until a verdict can be proved.

    S.Synthesis -> P.Planning -> P.Synthesis -> certificate, counterexamples flowing back.

``found`` is claimed only for a motion that the verifier's own proof accepts; ``impossible`` only if
every structure up to an explicit bound is refuted: by a script that a solver answered ``unsat``,
by a covering that the verifier's own replay accepts, or by both.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

from compiler.robots.candidate import Candidate, candidates
from compiler.robots.normal_form import RobotFamily, family_of
from compiler.robots.robot import RobotModel
from compiler.robots.robot_key import robot_key_in_task
from compiler.tasks.obstacle_pieces import expanded
from compiler.tasks.specification import recorded_effector
from compiler.tasks.word_formula import SampledFormula
from compiler.time_limits.time_limit import OutOfTimeError, check_time
from compiler.words.derivation import Derivation
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
from solvers.search.round_task import task_on_samples
from solvers.search.structure_search import BlockedPrefix, StructureSearch
from solvers.verdict import Verdict
from solvers.verifier.claims.certificate import SeparationClaim

OUT_OF_TIME = "the time limit was reached"
BEGUN = "srgc was started and the spec was read"
NOT_COVERED = f"{OUT_OF_TIME} before every refutation had a second proof"
NUMERIC_FAULTS = (OverflowError, ZeroDivisionError, FloatingPointError, MemoryError)
TOO_LARGE = "the numbers of the task are too large or too small for the search"
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
    trying all structures then.  ``unfinished``: the time limit was reached, and another run can go
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
    formula: SampledFormula | None
    every: bool
    records: list[StructureRecord] = field(default_factory=list[StructureRecord])
    counts: dict[str, int] = field(default_factory=lambda: dict(NO_COUNTS))
    before: dict[str, int] = field(default_factory=dict[str, int])
    """What they were when the last structure was begun."""
    designs: list[Proved] = field(default_factory=list[Proved])
    samples: list[PathSamples] = field(default_factory=list[PathSamples])
    blocked: list[BlockedPrefix] = field(default_factory=list[BlockedPrefix])
    without_success: int = 0
    stopped: str | None = None
    search: StructureSearch | None = None
    """The search that is under way."""

    # --- structures -----------------------------------------------------------------------------

    def structures(self) -> None:
        """Try structures in order; the first proved design ends the search, unless all are due."""
        seen: dict[str, int] = {}
        bound, robots = module_bound(self.family, self.task), robot_limit(self.family, self.task)
        drawn = candidates(self.family, bound, self.task.origin)
        ahead = Prefetch(drawn, self.program, self.task, self.context)
        for candidate in ahead:
            if self.at_limit(len(seen), robots):
                return
            self.context.check_time()
            number, derivation = candidate.number, candidate.derivation
            self.context.reporter.structure(number, derivation.word)
            self.counts["structures"] += 1
            if candidate.model is None:
                self.record(derivation, "inadmissible", candidate.fault)
                continue
            key = robot_key_in_task(candidate.model, self.task)
            if key in seen:
                first = self.records[seen[key]]
                self.record(derivation, "same", first.reason, same=seen[key])
                continue
            seen[key] = number
            self.before = dict(self.counts)
            design = self.structure(ahead, candidate, candidate.model, key)
            if design is not None:
                self.keep(number, design)
                if not self.every:
                    return

    def keep(self, number: int, design: Design) -> None:
        """Keep the design of a structure, with what its search took."""
        taken = {name: self.counts[name] - self.before[name] for name in self.before}
        self.designs.append(Proved(number, design, {**taken, "structures": 1}))

    def at_limit(self, tried: int, robots: int | None) -> bool:
        """Whether a limit ends the search; both are counts, so that verdicts repeat."""
        if self.without_success >= MOTION_SEARCHES:
            self.stopped = (
                f"the search ended at its limit of {MOTION_SEARCHES} robots that no motion was "
                "found for: narrow `accept`, or weaken the task"
            )
        elif robots is not None and tried >= robots:
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

    def record(
        self,
        derivation: Derivation,
        verdict: StructureVerdict,
        reason: str,
        script: str | None = None,
        same: int | None = None,
        boxes: str | None = None,
    ) -> None:
        word, labels = derivation.word, derivation.labels
        self.records.append(StructureRecord(word, labels, verdict, reason, script, same, boxes))

    def structure(
        self, ahead: Prefetch, candidate: Candidate, model: RobotModel, key: str
    ) -> Design | None:
        """Refute a structure, or search it."""
        derivation, screened = candidate.derivation, ahead.screening(candidate)
        answer = screened.refutation
        self.counts["smt"] += answer.solver_calls
        if answer.refuted:
            self.record(derivation, "refuted", answer.reason, answer.script, boxes=answer.boxes)
            return None
        if screened.inadmissible is not None:
            self.record(derivation, "inadmissible", screened.inadmissible)
            return None
        search = StructureSearch(
            self.program, self.task, self.context, self.abstraction, self.formula, self.counts,
            derivation, ahead.numeric(candidate), candidate.number, key,
        )  # fmt: skip
        self.search = search
        try:
            design, reason = self.motion(search, self.effectors(model, answer))
        except OutOfTimeError:
            if search.incumbent is not None:
                self.keep(candidate.number, search.incumbent)
                self.record(derivation, "found", "proved")
            raise
        finally:
            self.samples += search.samples
            self.blocked += search.blocked
        self.search = None
        if design is None:
            late = out_of_reach_of_drives(candidate, self.program, self.task, self.context)
            if late is not None:
                self.record(derivation, "refuted", late.reason, boxes=late.boxes)
                return None
            self.without_success += 1
            self.record(derivation, "unresolved", reason)
            return None
        self.record(derivation, "found", "proved")
        return design

    def motion(
        self, search: StructureSearch, effectors: Sequence[int]
    ) -> tuple[Design | None, str]:
        """The first design in which one of the effectors starts and reaches, or why none."""
        reason = "it has no effector that the task asks for"
        for effector in effectors:
            try:
                design, reason = search.design(effector)
            except NUMERIC_FAULTS as fault:
                return None, f"{TOO_LARGE} ({type(fault).__name__}: {fault})"
            if design is not None:
                return design, "proved"
        return None, reason + (search.obstacle or search.stuck)

    def effectors(self, model: RobotModel, answer: Refutation) -> list[int]:
        """The effectors that may start and reach, the one of the witness poses first."""
        bound = recorded_effector(self.task)
        if bound is not None:
            return [bound] if bound < len(model.effectors) else []
        order = list(range(len(model.effectors)))
        return sorted(order, key=lambda e: (e != answer.effector, e))


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
    run = _Run(program, task, context, family, finer, task_on_samples(task), every)
    try:
        run.structures()
        if run.designs:
            check_time()
            return _result(run, "found", None, cells)
        verdict, reason = conclude(run.records, family, task, run.stopped)
    except OutOfTimeError as late:
        return _result(run, "unknown", OUT_OF_TIME + _under_way(run.search), cells, late)
    uncovered = None
    if verdict == "impossible":
        run.records, uncovered = covered(run.records, family, task, context)
    if uncovered is not None:
        reason = f"{reason}; {NOT_COVERED}"
    return _result(run, verdict, reason, cells, uncovered)


def _under_way(search: StructureSearch | None) -> str:
    """What the time limit interrupted, to follow its name."""
    if search is None:
        return ""
    word = " ".join(search.derivation.word)
    if search.top < 0:
        return f" while a motion of {word} was searched"
    return f" while a motion of {word}, of robustness {search.top:.4g}, was proved or improved"


def _result(
    run: _Run,
    verdict: Verdict,
    reason: str | None,
    cells: Abstraction,
    late: OutOfTimeError | None = None,
) -> Synthesis:
    """The result; whatever ended the search, with a design the verdict is found."""
    ended = run.stopped if late is None else OUT_OF_TIME
    design = run.designs[0].design if run.designs else None
    if design is not None:
        verdict, reason, cells = "found", None, design.abstraction
    return Synthesis(
        verdict, reason, design, tuple(run.records), cells, run.counts,
        designs=tuple(run.designs), samples=tuple(run.samples), blocked=tuple(run.blocked),
        ended=ended if run.every else None, unfinished=late is not None,
        last_step="" if late is None else late.step,
    )  # fmt: skip
