"""P.Planning and P.Synthesis for one structure: plans, motions along them, counterexamples, cuts.

Plans come from the SAT solver, fewest changes of cell first.  A plan whose beginning cannot be
followed is excluded with all that begin so; where that leaves none, a cell at which it happened is
cut in two and the planning goes on, with the counterexamples that say nothing of that cell.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import partial

import numpy as np

from compiler.discretisation.numeric_robot import NumericRobot
from compiler.tasks.specification import PlanningProblem, planning_problem
from compiler.tasks.word_formula import SampledFormula
from compiler.words.derivation import Derivation
from compiler.workspaces.abstraction import Abstraction
from compiler.workspaces.bisection import halving
from grammar_lang import ir
from solvers.planner import CounterExample, Plan, Planner
from solvers.run_context import RunContext
from solvers.search.calm_motion import calmer
from solvers.search.cell_timing import timed
from solvers.search.certified_design import certified_design, early_design
from solvers.search.closed_loop import feedback_choices, needs_feedback, unbearable_noise
from solvers.search.configuration_search import (
    Configuration,
    PathSamples,
    calmed,
    resolved,
    search_configuration,
    searched_further,
    within_limits,
)
from solvers.search.path_task import (
    Attempt,
    ConstraintTightening,
    Design,
    PathTask,
    exhausted_text,
    nearest_text,
    no_margin_text,
)
from solvers.search.round_task import RoundTask, closing, round_tasks
from solvers.search.sampled_cells import (
    clear_of_bodies,
    standing_configurations,
    start_cells,
    within_reach,
)
from solvers.trajectory.control import CONVEX_STEP, NOT_FINITE
from solvers.trajectory.control_problem import ControlOutcome
from solvers.trajectory.corridor import polyline
from solvers.trajectory.counterexample import infeasible_prefix, infeasible_sample
from solvers.trajectory.fine_motion import refined, unstable
from solvers.trajectory.path_following import PathProblem
from solvers.trajectory.trajectory import Trajectory
from solvers.verdict import Holds, Unknown

PLANS = (6, 3)
"""How many plans are tried, and how many after each cut of a cell."""


@dataclass(frozen=True, slots=True)
class BlockedPrefix:
    """A counterexample: no path that begins with these cells is tried again (ZEROPREFIX).

    ``structure`` and ``path`` are those of the samples it was found with, ``effector`` (from 0) is
    the one that could not follow.  ``sample`` is the first that the most robust motion cannot be
    brought to, None where it is not known; ``robustness`` is what that motion has.
    """

    structure: int
    path: int
    effector: int
    cells: tuple[str, ...]
    sample: int | None
    robustness: float


@dataclass(slots=True)
class StructureSearch:
    """The search of one structure; ``number`` is its place among all, ``robot`` its key.

    ``task`` is what is searched, ``proved`` what is proved of what is found: they differ where
    motions go on for ever, whose loops begin at the sample ``loop``.
    """

    program: ir.Program
    task: ir.Task
    context: RunContext
    cells: Abstraction
    formula: SampledFormula | None
    counts: dict[str, int]
    derivation: Derivation
    numeric: NumericRobot
    number: int
    robot: str
    proved: ir.Task = field(init=False)
    shape: RoundTask = field(init=False)
    loop: int | None = None
    obstacle: str = ""
    """What stood in the way of the last motion that was tried."""
    note: str = ""
    """The same in a few words."""
    lacking: float = 0.0
    """How much wider its margin has to be for what the task says of disturbances."""
    beyond: float = 0.0
    """By what part of it motions leave the set of their loop."""
    ended: bool = False
    """Whether the enclosure of the last motion that was tried ended before the motion did."""
    incumbent: Design | None = None
    """A proved design, while better ones are looked for."""
    at_once: bool = False
    """Whether a feasible motion has been tried as it was found."""
    stuck: str = ""
    """Where the most robust motion that was found for a path could not go on."""
    best: float = -np.inf
    known: list[CounterExample] = field(default_factory=list[CounterExample])
    """The counterexamples found, of cells as they are now."""
    samples: list[PathSamples] = field(default_factory=list[PathSamples])
    blocked: list[BlockedPrefix] = field(default_factory=list[BlockedPrefix])
    """All counterexamples, as they were found."""
    top: float = -np.inf
    """The best robustness of all paths."""

    def __post_init__(self) -> None:
        self.proved, self.shape = self.task, RoundTask(self.task)

    @property
    def place(self) -> PathTask:
        """The robot in its task."""
        context = self.context
        return PathTask(
            self.program, self.task, self.numeric, self.formula, context.seed, context.solver,
            self.loop,
        )  # fmt: skip

    def design(self, recorded: int) -> tuple[Design | None, str]:
        """A proved design in which that effector starts and reaches; else why there is none."""
        design, reason = None, ""
        for part in round_tasks(self.proved, recorded):
            self.shape = part
            if part.loop is not None:
                self.task, self.loop, self.formula = part.task, part.loop, part.formula
            design, reason = self.design_of_round(recorded)
            if design is not None:
                break
        return design, reason

    def design_of_round(self, recorded: int) -> tuple[Design | None, str]:
        """The same for one shape of a motion."""
        if not self.numeric.graph.model.dofs:
            return self.standing(recorded)
        self.best, self.known = -np.inf, []
        cells, reason = self.cells, ""
        for budget in PLANS:
            design, reason = self.plans(cells, recorded, budget)
            finer = None if design is not None else self.cut(cells)
            if finer is None:
                return design, reason
            cells = finer
        return None, reason

    def standing(self, recorded: int) -> tuple[Design | None, str]:
        """A robot that cannot move does the task where it stands, or not at all."""
        workspace = self.program.workspaces[self.task.workspace]
        found = standing_configurations(
            self.numeric, workspace, self.task, self.cells, recorded, self.context.seed
        )
        for cell, configuration in found:
            path_problem = self.place.path_problem(self.cells, recorded, recorded, (cell,))
            design = self.certified(path_problem, configuration)
            if design is not None:
                return design, "proved"
        return None, "the robot cannot move, and no place to stand was found for it"

    # --- plans ----------------------------------------------------------------------------------

    def plans(self, cells: Abstraction, recorded: int, budget: int) -> tuple[Design | None, str]:
        """Try plans until one leads to a design, none is left or the budget is used up.

        Where no plan goes through cells alone for which poses are found, others are tried, too.
        """
        starts = start_cells(cells, self.task, self.numeric)
        problem = planning_problem(cells, self.task, recorded, starts)
        problem = clear_of_bodies(problem, self.numeric, cells, self.task)
        design, reason = None, "the task leaves no cell to start in"
        for closed in closing(problem, self.shape):
            reachable = within_reach(closed, self.numeric, cells, self.context.seed)
            design, reason, tried = self.plans_of(reachable, cells, recorded, budget)
            if not tried and reachable != closed:
                design, reason, _ = self.plans_of(closed, cells, recorded, budget)
            if design is not None:
                break
        return design, reason

    def plans_of(
        self, problem: PlanningProblem, cells: Abstraction, recorded: int, budget: int
    ) -> tuple[Design | None, str, int]:
        """The same for one problem, with the number of plans that were tried."""
        planner = Planner(problem)
        for counterexample in self.known:
            planner.block(counterexample)
        for number in range(budget):
            match planner.next_plan():
                case Holds(witness=plan):
                    pass
                case Unknown(reason=limit):
                    return None, f"planning: {limit.value}", number
                case ended:
                    return None, exhausted_text(ended.counterexample, self.best, self.task), number
            self.context.check_time()
            self.counts["paths"] += 1
            attempt = self.attempt(cells, plan, recorded)
            if attempt.design is not None:
                return attempt.design, "proved", number + 1
            self.best = max(self.best, attempt.robustness)
            if attempt.excluded is not None:
                self.known.append(attempt.excluded)
                planner.block(attempt.excluded)
        reason = f"{self.counts['paths']} paths tried, best robustness {self.best:.4g}"
        return None, reason, budget

    def cut(self, cells: Abstraction) -> Abstraction | None:
        """The cells with that one cut at which the shortest excluded plan fails; None without one.

        Counterexamples with that cell are forgotten: they need not hold of its halves.
        """
        if not self.known:
            return None
        failed = min(self.known, key=lambda item: len(item.prefix))
        direction = None
        if len(failed.prefix) > 1:
            line = polyline(cells, failed.prefix).points
            direction = (line[-1] - line[-2]).tolist()
        finer, children = cells.refined([halving(cells, failed.prefix[-1], direction)])
        whole = {cell: parts[0] for cell, parts in enumerate(children) if len(parts) == 1}
        self.known = [
            replace(item, prefix=tuple(whole[cell] for cell in item.prefix))
            for item in self.known
            if all(cell in whole for cell in item.prefix)
        ]
        self.context.reporter.note(
            f"no plan is left: `{cells.cells[failed.prefix[-1]].name}` is cut"
        )
        return finer

    # --- motions along a plan -------------------------------------------------------------------

    def attempt(self, cells: Abstraction, plan: Plan, recorded: int) -> Attempt:
        """A proved design for a plan; else the best robustness and the prefix to exclude."""
        leader = max(plan.paths, key=lambda path: (len(path.cells), path.effector == recorded))
        self.context.reporter.path(tuple(cells.cells[cell].name for cell in leader.cells))
        others = tuple(path for path in plan.paths if path is not leader)
        path_problem = self.place.path_problem(cells, recorded, leader.effector, leader.cells)
        path_problem = timed(replace(path_problem, others=others), leader.entries)
        if needs_feedback(path_problem):
            path_problem = calmer(path_problem)
        label = f"{self.number}|{recorded}|{len(cells.cuts)}|{plan}"
        at_once = partial(self.prove_at_once, path_problem) if self.context.limited else None
        found = search_configuration(path_problem, label, self.context, at_once=at_once)
        self.keep(found)
        if found.outcome.status == NOT_FINITE:
            self.obstacle = "; the equations of motion have no finite value where the search begins"
        if not found.outcome.feasible:
            if found.outcome.status.startswith(CONVEX_STEP):
                self.obstacle = f"; {found.outcome.status}"
            sample = infeasible_sample(path_problem, found.outcome, found.entries)
            prefix = infeasible_prefix(sample, found.entries)
            robustness = found.outcome.robustness
            names = tuple(cells.cells[cell].name for cell in leader.cells[:prefix])
            if robustness > self.best and sample is not None:
                self.stuck = nearest_text(path_problem, found, sample, names)
            place, end = len(self.samples) - 1, (names, sample, robustness)
            self.blocked.append(BlockedPrefix(self.number, place, leader.effector, *end))
            excluded = CounterExample(
                leader.effector, leader.cells[:prefix], f"robustness {robustness:.4g}", self.robot
            )
            return Attempt(None, robustness, excluded)
        attempt = self.widened(path_problem, found, label)
        return attempt if attempt.design is not None else replace(attempt, design=self.incumbent)

    def prove_at_once(self, path_problem: PathProblem, outcome: ControlOutcome) -> None:
        """Prove the first feasible motion, so that there is a design if time runs out."""
        if not self.at_once:
            self.at_once = True
            self.incumbent = early_design(
                self.program, self.proved, self.derivation, path_problem, outcome,
                self.context.check_time,
            )  # fmt: skip

    def keep(self, found: Configuration) -> None:
        """Keep what was evaluated for a path, for tables."""
        self.counts["evaluations"] += len(found.samples)
        names = tuple(p.label for p in self.numeric.graph.model.parameters)
        self.samples.append(PathSamples(self.number, len(self.samples), names, found.samples))
        self.top = max(self.top, found.outcome.robustness)

    def also_evaluated(self, found: Configuration) -> None:
        """Keep what was evaluated for the last path again."""
        self.counts["evaluations"] += len(found.samples)
        last = self.samples[-1]
        self.samples[-1] = replace(last, samples=last.samples + found.samples)

    def widened(self, path_problem: PathProblem, found: Configuration, label: str) -> Attempt:
        """A proved design from a feasible configuration, or from a closer look at parameters."""
        attempt = self.open_or_closed(path_problem, found, label)
        if attempt.design is not None or attempt.noisy:
            return attempt
        closer = searched_further(path_problem, label, self.context)
        if closer is not None:
            self.also_evaluated(closer)
            if closer.outcome.feasible:
                attempt = self.open_or_closed(path_problem, closer, label)
        return attempt

    def open_or_closed(
        self, path_problem: PathProblem, found: Configuration, label: str
    ) -> Attempt:
        """A proved design from a feasible configuration; open loop first, where that may do."""
        attempt = Attempt(None, found.outcome.robustness)
        choices = feedback_choices(path_problem, found.outcome)
        for feedback in (False, True):
            if feedback not in choices and not (feedback and attempt.unstable):
                continue
            if feedback and not found.calmed:
                slower = calmed(path_problem, label, self.context)
                self.also_evaluated(slower)
                found = slower if slower.outcome.feasible else found
            given = calmer(path_problem) if found.calm else path_problem
            along = given.along(found.cells, found.entries)
            closed = replace(along, feedback=feedback, refines=feedback, bound=found.bound)
            attempt = self.with_margins(closed, found)
            if attempt.design is not None:
                break
        return attempt

    def with_margins(self, path_problem: PathProblem, found: Configuration) -> Attempt:
        """A proved design with as much tightening as that takes."""
        tightening: ConstraintTightening | None = ConstraintTightening(path_problem.margin)
        tried = ""
        while tightening is not None:
            wider = self.tightened(path_problem, found.outcome.trajectory, tightening)
            given = path_problem.spread, path_problem.margin, path_problem.substeps
            if (wider.spread, wider.margin, wider.substeps) != given:
                path_problem = wider
                found = resolved(path_problem, found)
            path_problem = replace(path_problem, slack=tightening.slack)
            path_problem, found = within_limits(path_problem, found)
            if not found.outcome.feasible:
                if path_problem.spread is not None:
                    noise = unbearable_noise(path_problem, found.outcome.trajectory)
                    self.obstacle = f"{tried}; {noise or no_margin_text(path_problem.spread)}"
                    return Attempt(None, found.outcome.robustness, noisy=noise is not None)
                break
            if not path_problem.feedback and unstable(path_problem, found.outcome.trajectory):
                self.obstacle = f"{tried}; the motion is unstable: its inputs alone do not cause it"
                return Attempt(None, found.outcome.robustness, unstable=not self.task.control)
            self.lacking, self.beyond, self.ended = 0.0, 0.0, False
            design = self.certified(path_problem, found, last=tightening.is_last)
            if design is not None:
                return Attempt(design, found.outcome.robustness)
            tried = self.obstacle
            if self.ended:
                # No margin makes it calmer; feedback may.
                open_loop = not path_problem.feedback and not self.task.control
                return Attempt(None, found.outcome.robustness, unstable=open_loop)
            self.context.reporter.note(f"{self.note}; trying a wider margin")
            tightening = tightening.wider(self.lacking, path_problem.spread, self.beyond)
        return Attempt(None, found.outcome.robustness)

    def tightened(
        self, path_problem: PathProblem, trajectory: Trajectory, tightening: ConstraintTightening
    ) -> PathProblem:
        """The same task with tightening for what a motion needs of it."""
        wider = refined(path_problem.with_margin(tightening.margin), trajectory)
        wider = replace(wider, slack=tightening.slack)
        return wider.spreading(trajectory, tightening.spreads) if self.task.robust else wider

    def certified(
        self, path_problem: PathProblem, found: Configuration, *, last: bool = True
    ) -> Design | None:
        """The design, if the continuous-time nonlinear robot is proved to do the task."""
        answer = certified_design(
            self.program, self.proved, self.derivation, path_problem, found,
            self.context.check_time, last=last,
        )  # fmt: skip
        if isinstance(answer, Design):
            return answer
        if answer is not None:
            self.obstacle, self.lacking, self.beyond = (
                answer.obstacle, answer.lacking, answer.beyond,
            )  # fmt: skip
            self.note, self.ended = answer.note, answer.ended
        return None
