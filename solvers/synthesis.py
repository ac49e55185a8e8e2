"""Algorithm 1: structures, paths, parameters and controls, until a verdict can be proved.

    S.Synthesis -> P.Planning -> P.Synthesis -> certificate, counterexamples flowing back.

``found`` is claimed only for a motion that the verifier's own proof accepts; ``impossible`` only if
every structure up to an explicit bound is refuted by a script that a solver answered ``unsat``.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal, TypeAlias

from compiler.candidates.candidate import candidates
from compiler.discretisation.float_reading import FloatReading
from compiler.dynamics.equations_of_motion import robot_graph
from compiler.geometry.abstraction import Abstraction, abstract
from compiler.geometry.bisection import bisections
from compiler.grammars.derivation import Derivation
from compiler.maps.obstacle_pieces import expanded
from compiler.robots.robot import RobotModel
from compiler.robots.robot_key import robot_key
from compiler.semantics.family import RobotFamily, family_of
from compiler.specifications.sampled_formula import sampled
from compiler.specifications.task_formula import recorded_effector
from compiler.specifications.word_formula import SampledFormula, every
from grammar_lang import ir
from solvers.claims.certificate import SeparationClaim
from solvers.claims.disconnection import disconnected, separation_text
from solvers.conclusion import (
    MOTION_SEARCHES,
    StructureRecord,
    StructureVerdict,
    conclude,
    module_bound,
    robot_limit,
)
from solvers.design import Design
from solvers.examination import examine
from solvers.progress import Conduct, OutOfTimeError
from solvers.refutation.structure_refutation import Refutation
from solvers.structure_search import StructureSearch

Verdict: TypeAlias = Literal["found", "impossible", "unknown"]
NO_COUNTS = {"structures": 0, "smt": 0, "paths": 0, "evaluations": 0}


@dataclass(frozen=True, slots=True)
class Synthesis:
    """The verdict with everything that was tried.

    ``abstraction`` has the cells of the design, else those without cuts.  A ``separation`` proves
    the task impossible before anything is tried.
    """

    verdict: Verdict
    reason: str | None
    design: Design | None
    records: tuple[StructureRecord, ...]
    abstraction: Abstraction
    counts: dict[str, int]
    separation: SeparationClaim | None = None


@dataclass(slots=True)
class _Run:
    """One synthesis in progress."""

    program: ir.Program
    task: ir.Task
    conduct: Conduct
    family: RobotFamily
    abstraction: Abstraction
    formula: SampledFormula | None
    records: list[StructureRecord] = field(default_factory=list[StructureRecord])
    counts: dict[str, int] = field(default_factory=lambda: dict(NO_COUNTS))
    searched: int = 0
    stopped: str | None = None

    # --- structures -----------------------------------------------------------------------------

    def structures(self) -> Design | None:
        """Try structures in order; the first proved design ends the search."""
        seen: dict[str, int] = {}
        bound, robots = module_bound(self.task), robot_limit(self.family, self.task)
        for candidate in candidates(self.family, bound):
            if self.at_limit(len(seen), robots):
                return None
            self.conduct.check_time()
            number, derivation = candidate.number, candidate.derivation
            self.conduct.reporter.structure(number, derivation.word)
            self.counts["structures"] += 1
            if candidate.model is None:
                self.record(derivation, "inadmissible", candidate.fault)
                continue
            key = robot_key(candidate.model)
            if key in seen:
                first = self.records[seen[key]]
                self.record(derivation, "same", first.reason, same=seen[key])
                continue
            seen[key] = number
            design = self.structure(derivation, candidate.model, number, key)
            if design is not None:
                return design
        return None

    def at_limit(self, tried: int, robots: int | None) -> bool:
        """Whether a limit ends the search; both are counts, so that verdicts repeat."""
        if self.searched >= MOTION_SEARCHES:
            self.stopped = (
                f"the search ended at its limit of {MOTION_SEARCHES} robots that no motion was "
                "found for: narrow `accept`, or weaken the task"
            )
        elif robots is not None and tried >= robots:
            self.stopped = (
                f"the search ended at its limit of {robots} different robots: say `modules <= n` "
                "in the task to try all up to a bound"
            )
        return self.stopped is not None

    def record(
        self,
        derivation: Derivation,
        verdict: StructureVerdict,
        reason: str,
        script: str | None = None,
        same: int | None = None,
    ) -> None:
        self.records.append(
            StructureRecord(derivation.word, derivation.labels, verdict, reason, script, same)
        )

    def structure(
        self, derivation: Derivation, model: RobotModel, number: int, key: str
    ) -> Design | None:
        """Refute a structure, or search it."""
        reading = FloatReading(robot_graph(model, self.task.gravity))
        examined = examine(model, reading, self.program, self.task, self.conduct)
        answer = examined.refutation
        self.counts["smt"] += answer.solver_calls
        if answer.refuted:
            self.record(derivation, "refuted", answer.reason, answer.script)
            return None
        if examined.inadmissible is not None:
            self.record(derivation, "inadmissible", examined.inadmissible)
            return None
        self.searched += 1
        search = StructureSearch(
            self.program, self.task, self.conduct, self.abstraction, self.formula, self.counts,
            derivation, reading, number, key,
        )  # fmt: skip
        reason = "it has no effector that the task asks for"
        for effector in self.effectors(model, answer):
            design, reason = search.design(effector)
            if design is not None:
                self.record(derivation, "found", "proved")
                return design
        self.record(derivation, "unresolved", reason + search.obstacle)
        return None

    def effectors(self, model: RobotModel, answer: Refutation) -> list[int]:
        """The effectors that may start and reach, the one of the witness poses first."""
        bound = recorded_effector(self.task)
        if bound is not None:
            return [bound] if bound < len(model.effectors) else []
        order = list(range(len(model.effectors)))
        return sorted(order, key=lambda e: (e != answer.effector, e))


def task_on_samples(task: ir.Task) -> SampledFormula | None:
    """What the formulas of a task ask of the samples; None without one."""
    if not task.satisfy:
        return None
    return every(sampled(clause.formula, task.step, task.steps) for clause in task.satisfy)


def synthesise(
    program: ir.Program, task: ir.Task, conduct: Conduct, least_cells: int | None = None
) -> Synthesis:
    """Run Algorithm 1 on a task, from at least so many cells on if that is asked.

    Raises:
        MapFault: a map of obstacles cannot be used.
    """
    program, task = expanded(program, task)
    cells = abstract(program.workspaces[task.workspace])
    separation = disconnected(program, task, cells)
    if separation is not None:
        reason = separation_text(program, task, separation)
        return Synthesis("impossible", reason, None, (), cells, dict(NO_COUNTS), separation)
    finer = cells if least_cells is None else cells.cut(bisections(cells, least_cells))
    family = family_of(program, task)
    run = _Run(program, task, conduct, family, finer, task_on_samples(task))
    try:
        design = run.structures()
    except OutOfTimeError:
        return _result(run, "unknown", "the time limit was reached", cells)
    if design is not None:
        return _result(run, "found", None, design.abstraction, design)
    verdict, reason = conclude(run.records, family, task, run.stopped)
    return _result(run, verdict, reason, cells)


def _result(
    run: _Run,
    verdict: Verdict,
    reason: str | None,
    cells: Abstraction,
    design: Design | None = None,
) -> Synthesis:
    return Synthesis(verdict, reason, design, tuple(run.records), cells, run.counts)
