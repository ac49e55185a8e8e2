"""Algorithm 1: structures, paths, parameters and controls, until a verdict can be proved.

    S.Synthesis -> P.Planning -> P.Synthesis -> certificate, counterexamples flowing back.

``found`` is claimed only for a motion that the verifier's own proof accepts; ``impossible`` only if
every structure up to an explicit bound is refuted by a script that a solver answered ``unsat``.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from fractions import Fraction
from typing import Literal

import numpy as np

from compiler.discretisation.float_reading import FloatReading
from compiler.dynamics.equations_of_motion import robot_graph
from compiler.geometry.abstraction import Abstraction, abstract
from compiler.grammars.derivation import Derivation
from compiler.languages.structures import structures
from compiler.robots.parameter_values import stated_value
from compiler.robots.robot import RobotModel
from compiler.robots.robot_key import robot_key
from compiler.semantics.attributes import SemanticsError
from compiler.semantics.family import RobotFamily, family_of
from grammar_lang import ir
from solvers.admissibility import inadmissible
from solvers.certificate import ParameterClaim, decimal
from solvers.conclusion import (
    MOTION_SEARCHES,
    StructureRecord,
    StructureVerdict,
    conclude,
    module_bound,
    robot_limit,
)
from solvers.configuration_search import (
    Configuration,
    resolved,
    search_configuration,
    within_limits,
)
from solvers.control import NOT_FINITE
from solvers.counterexample import infeasible_prefix
from solvers.fine_motion import fine_motion
from solvers.parameter_search import exact_text
from solvers.path_following import LEAST_MARGIN, SUBSTEPS, Follower
from solvers.planner import Planner, path_planner
from solvers.progress import Conduct, OutOfTimeError
from solvers.standing_robot import standing_configurations
from solvers.stiffness import stable_parts
from solvers.structure_refutation import Refutation, refute_structure
from solvers.task_limits import motion_limits, parameter_bounds
from solvers.trajectory_proof import Motion, prove_motion, scene_of
from solvers.tube_checks import Status
from solvers.verdict import Holds, Unknown

PATHS_PER_STRUCTURE = 6
MARGINS = (LEAST_MARGIN, 5e-3, 1.5e-2, 4e-2)


@dataclass(frozen=True, slots=True)
class Design:
    """A proved robot: exact decimals, with the trajectory in floats for tables and pictures."""

    derivation: Derivation
    model: RobotModel
    parameters: tuple[ParameterClaim, ...]
    effector: int
    start: tuple[str, ...]
    inputs: tuple[tuple[str, ...], ...]
    path: tuple[tuple[str, ...], ...]
    configuration: Configuration


@dataclass(frozen=True, slots=True)
class Synthesis:
    """The verdict with everything that was tried."""

    verdict: Literal["found", "impossible", "unknown"]
    reason: str | None
    design: Design | None
    records: tuple[StructureRecord, ...]
    abstraction: Abstraction
    counts: dict[str, int]


@dataclass(slots=True)
class _Run:
    """One synthesis in progress."""

    program: ir.Program
    task: ir.Task
    conduct: Conduct
    family: RobotFamily
    abstraction: Abstraction
    records: list[StructureRecord] = field(default_factory=list[StructureRecord])
    counts: dict[str, int] = field(
        default_factory=lambda: {"structures": 0, "smt": 0, "paths": 0, "evaluations": 0}
    )
    searched: int = 0
    stopped: str | None = None
    obstacle: str = ""
    """What stood in the way of the last motion of this structure that was tried."""

    # --- structures -----------------------------------------------------------------------------

    def structures(self) -> Design | None:
        """Try structures in order; the first proved design ends the search."""
        seen: dict[str, int] = {}
        bound, robots = module_bound(self.task), robot_limit(self.family, self.task)
        for number, derivation in enumerate(structures(self.family.language, bound)):
            if self.at_limit(len(seen), robots):
                return None
            self.conduct.check_time()
            self.conduct.reporter.structure(number, derivation.word)
            self.counts["structures"] += 1
            try:
                model = self.family.robot(derivation)
            except SemanticsError as error:
                self.record(derivation, "inadmissible", str(error))
                continue
            key = robot_key(model)
            if key in seen:
                first = self.records[seen[key]]
                self.record(derivation, "same", first.reason, same=seen[key])
                continue
            seen[key] = number
            design = self.structure(derivation, model, number)
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

    def structure(self, derivation: Derivation, model: RobotModel, number: int) -> Design | None:
        """Refute a structure, or search it."""
        reading = FloatReading(robot_graph(model, self.task.gravity))
        answer = refute_structure(model, reading, self.program, self.task, self.conduct)
        self.counts["smt"] += answer.solver_calls
        if answer.refuted:
            self.record(derivation, "refuted", answer.reason, answer.script)
            return None
        blocked = inadmissible(model, reading)
        if blocked is not None:
            self.record(derivation, "inadmissible", blocked)
            return None
        self.searched += 1
        self.obstacle = ""
        reason = "it has no effector that the task asks for"
        for effector in self.effectors(model, answer):
            if model.dofs:
                design, reason = self.paths(derivation, reading, effector, number)
            else:
                design, reason = self.standing(derivation, reading, effector)
            if design is not None:
                self.record(derivation, "found", "proved")
                return design
        self.record(derivation, "unresolved", reason + self.obstacle)
        return None

    def effectors(self, model: RobotModel, answer: Refutation) -> list[int]:
        """The effectors that may reach, the one of the witness poses first."""
        named = self.task.goal.effector
        if named is not None:
            return [named - 1] if named <= len(model.effectors) else []
        order = list(range(len(model.effectors)))
        return sorted(order, key=lambda e: (e != answer.effector, e))

    def standing(
        self, derivation: Derivation, reading: FloatReading, effector: int
    ) -> tuple[Design | None, str]:
        """A robot that cannot move does the task where it stands, or not at all."""
        workspace = self.program.workspaces[self.task.workspace]
        seed = self.conduct.seed
        found = standing_configurations(
            reading, workspace, self.task, self.abstraction, effector, seed
        )
        for cell, configuration in found:
            follower = self.follower(reading, effector, (cell,))
            design = self.certified(derivation, follower, configuration)
            if design is not None:
                return design, "proved"
        return None, "the robot cannot move, and no place to stand was found for it"

    # --- paths ----------------------------------------------------------------------------------

    def paths(
        self, derivation: Derivation, reading: FloatReading, effector: int, number: int
    ) -> tuple[Design | None, str]:
        """Try paths, fewest region changes first; counterexamples prune."""
        starts = start_cells(self.abstraction, self.task, reading, effector)
        planner = path_planner(self.abstraction, self.task, starts)
        cells = self.abstraction.cells
        best = -np.inf
        for _ in range(PATHS_PER_STRUCTURE):
            match planner.next_path():
                case Holds(witness=path):
                    pass
                case Unknown(reason=reason):
                    return None, f"planning: {reason.value}"
                case _:
                    return None, self.exhausted(planner, best)
            self.conduct.check_time()
            self.counts["paths"] += 1
            self.conduct.reporter.path(tuple(cells[cell].name for cell in path.cells))
            label = f"{number}|{effector}|{path.cells}"
            design, robustness, prefix = self.follow(
                derivation, reading, effector, path.cells, label
            )
            if design is not None:
                return design, "proved"
            best = max(best, robustness)
            if prefix:
                planner.block_prefix(path.cells[:prefix], f"robustness {robustness:.4g}")
        return None, f"{PATHS_PER_STRUCTURE} paths tried, best robustness {best:.4g}"

    def exhausted(self, planner: Planner, best: float) -> str:
        if not planner.blocked and not planner.complete:
            return (
                "no path of cells leads from the start to the target with a sample in each; "
                f"the task has {self.task.steps + 1} samples"
            )
        if not planner.blocked:
            return "no path of cells leads from the start to the target"
        return (
            f"no path is left after {len(planner.blocked)} counterexamples; "
            f"best robustness {best:.4g}"
        )

    def follow(
        self,
        derivation: Derivation,
        reading: FloatReading,
        effector: int,
        cells: tuple[int, ...],
        label: str,
    ) -> tuple[Design | None, float, int]:
        """A proved design for a path; else the best robustness and the prefix to block."""
        follower = self.follower(reading, effector, cells)
        found = search_configuration(follower, label, self.conduct)
        self.counts["evaluations"] += found.evaluations
        if found.outcome.status == NOT_FINITE:
            self.obstacle = "; the equations of motion have no finite value where the search begins"
        if not found.outcome.feasible:
            prefix = infeasible_prefix(follower, found.outcome, found.entries)
            return None, found.outcome.robustness, prefix
        follower = replace(follower, cells=found.cells)
        for margin in MARGINS:
            wider = follower.with_margin(margin).refined(found.outcome.trajectory)
            if (wider.margin, wider.substeps) != (follower.margin, follower.substeps):
                follower = wider
                found = resolved(follower, found)
            follower, found = within_limits(follower, found)
            if not found.outcome.feasible:
                break
            design = self.certified(derivation, follower, found)
            if design is not None:
                return design, found.outcome.robustness, 0
            self.conduct.reporter.note("the proof did not go through; trying a wider margin")
        return None, found.outcome.robustness, 0

    def follower(self, reading: FloatReading, effector: int, cells: tuple[int, ...]) -> Follower:
        """The follower of a path at the first margin."""
        return Follower(
            reading,
            self.program.workspaces[self.task.workspace],
            self.task,
            self.abstraction,
            effector,
            cells,
            MARGINS[0],
            self.conduct.seed,
            substeps=stable_parts(reading, float(self.task.step), SUBSTEPS),
        )

    def certified(
        self, derivation: Derivation, follower: Follower, found: Configuration
    ) -> Design | None:
        """The design, if the continuous-time nonlinear robot is proved to do the task."""
        trajectory, model = found.outcome.trajectory, follower.model
        design = Design(
            derivation,
            model,
            tuple(
                ParameterClaim(p.symbol, p.name, exact_text(p.domain, value))
                for p, value in zip(model.parameters, trajectory.theta, strict=True)
            ),
            follower.effector,
            tuple(decimal(value) for value in trajectory.x[0, : 2 * len(model.dofs)]),
            tuple(tuple(decimal(value) for value in row) for row in trajectory.u),
            tuple(tuple(names) for names in follower.cell_names(trajectory, found.entries)),
            found,
        )
        scene = scene_of(self.program, self.task, model, self.abstraction)
        motion = motion_of(design)
        if motion is None:
            return None
        findings = prove_motion(scene, motion, self.conduct.check_time)
        unproved = [f for f in findings if f.status is not Status.HOLDS]
        if unproved:
            self.obstacle = f"; last proof tried: {unproved[0].name}: {unproved[0].status.value}"
            return None
        fine = fine_motion(follower.reading, trajectory, float(self.task.step))
        outcome = replace(found.outcome, trajectory=fine)
        return replace(design, configuration=replace(found, outcome=outcome))


def motion_of(design: Design) -> Motion | None:
    """The exact numbers of a design; None if a parameter is in no range."""
    theta = []
    for parameter, claim in zip(design.model.parameters, design.parameters, strict=True):
        value = stated_value(parameter.domain, Fraction(claim.value))
        if value is None:
            return None
        theta.append(value)
    return Motion(
        tuple(theta),
        tuple(Fraction(value) for value in design.start),
        tuple(tuple(Fraction(value) for value in row) for row in design.inputs),
        design.effector,
        design.path,
    )


def start_cells(
    abstraction: Abstraction, task: ir.Task, reading: FloatReading, effector: int
) -> tuple[int, ...] | None:
    """The cells an effector may start in; None: those of the start region.

    For a start pose they depend on the parameters, which are sampled.
    """
    start = task.start
    if isinstance(start, ir.StartIn):
        own = start.effector in (None, effector + 1)
        return None if own else tuple(range(len(abstraction.cells)))
    values = motion_limits(reading.graph.model, task).start_values
    bounds = np.array(parameter_bounds(reading.graph.model)).reshape(-1, 2)
    found: set[int] = set()
    for theta in np.random.default_rng(0).uniform(bounds[:, 0], bounds[:, 1], (64, len(bounds))):
        if values is not None:
            point = reading.points(values[None, :], theta).value[0, effector]
            cell = abstraction.locate(point)
            found |= set() if cell is None else {cell}
    return tuple(sorted(found))


def synthesise(program: ir.Program, task: ir.Task, conduct: Conduct) -> Synthesis:
    """Run Algorithm 1 on a task."""
    family = family_of(program, task)
    abstraction = abstract(program.workspaces[task.workspace])
    run = _Run(program, task, conduct, family, abstraction)
    try:
        design = run.structures()
    except OutOfTimeError:
        return _result(run, "unknown", "the time limit was reached", None)
    if design is not None:
        return _result(run, "found", None, design)
    verdict, reason = conclude(run.records, family, task, run.stopped)
    return _result(run, verdict, reason, None)


def _result(
    run: _Run,
    verdict: Literal["found", "impossible", "unknown"],
    reason: str | None,
    design: Design | None,
) -> Synthesis:
    return Synthesis(verdict, reason, design, tuple(run.records), run.abstraction, run.counts)
