"""One path: the motion along it and its proof; otherwise what to exclude, and why."""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np

from compiler.arrays import Array
from compiler.discretisation.numeric_robot import NumericRobot
from compiler.words.derivation import Derivation
from compiler.workspaces.abstraction import Abstraction
from grammar_lang import ir
from solvers.execution.workers import Begun
from solvers.planner import CounterExample, EffectorPath, Plan
from solvers.run_context import RunContext
from solvers.search.calm_motion import calmer
from solvers.search.cell_timing import settled, timed
from solvers.search.closed_loop import needs_feedback
from solvers.search.configuration_search import Configuration, search_configuration
from solvers.search.failed_proof import shorter_steps
from solvers.search.motion_proof import MotionProof
from solvers.search.path_cores import Explanation, PathCore, PathCores
from solvers.search.path_task import Design, PathTask, nearest_text
from solvers.search.round_task import RoundTask
from solvers.search.search_state import Blocked, Cause, Found, NearestMotion, PathAttempt
from solvers.trajectory.control_problem import ControlOutcome, Ending
from solvers.trajectory.counterexample import infeasible_prefix, infeasible_sample
from solvers.trajectory.path_following import PathProblem

GAIN = 1e-4
"""The least relative gain over a proved design for which a motion is proved."""
FREE_TEXT = (
    "; no motion was found even without cells and obstacles: the drives are too weak for it, or "
    "the time is too short"
)
EARLY_PROOFS = 3
"""The number of newly found motions that are tried to be proved, until one is."""


class Listener(Protocol):
    """Receives the results of a search before an attempt has ended."""

    def keep(self, design: Design) -> None:
        """Receive a proved design."""
        ...

    def see(self, motion: NearestMotion) -> None:
        """Receive a motion that may still become a design."""
        ...


@dataclass(frozen=True, slots=True)
class StructureTask:
    """A structure in a task for which designs are sought.

    ``number`` is its index among all structures.  ``name``, if given, replaces the number in
    journals.  ``robot`` is its key, which names it in counterexamples.
    """

    program: ir.Program
    task: ir.Task
    context: RunContext
    derivation: Derivation
    numeric: NumericRobot
    number: int
    robot: str
    listener: Listener
    name: str | None = None

    @property
    def label(self) -> str:
        """Its name in journals."""
        return str(self.number) if self.name is None else self.name


@dataclass(frozen=True, slots=True)
class PathSearch:
    """Paths of a structure for motions of one ``shape``; effector ``recorded`` (from 0) reaches.

    If motions go on for ever, the task that is searched (that of the shape) differs from the task
    that is proved (that of the structure).
    """

    structure: StructureTask
    shape: RoundTask
    recorded: int

    @property
    def place(self) -> PathTask:
        """The robot in the task that is searched."""
        given, context = self.structure, self.structure.context
        return PathTask(
            given.program, self.shape.task, given.numeric, self.shape.formula, context.seed,
            context.solver, self.shape.loop,
        )  # fmt: skip

    @property
    def cores(self) -> PathCores:
        """Explains paths that are not followed."""
        given = self.structure
        return PathCores(given.context, f"{given.label}|{self.recorded}")

    @property
    def proof(self) -> MotionProof:
        """Proves motions."""
        given = self.structure
        return MotionProof(
            given.program, given.task, given.derivation, given.context, self.see_unproved
        )

    def attempt(self, cells: Abstraction, plan: Plan, *, explaining: bool = True) -> PathAttempt:
        """A proved design for a plan; else the nearest motion and, if ``explaining``, a core.

        The first feasible motion is proved at once; later ones may be more robust.
        """
        path_problem, label = self.posed(cells, plan), self.label(cells, plan)
        early, context = _Early(self), self.structure.context
        found = search_configuration(path_problem, label, context, listener=early)
        first = early.design()
        if not found.outcome.feasible:
            why = self.cores.explained(path_problem, found, label) if explaining else None
            attempt = self.explained(path_problem, found, label, why)
        elif first is not None and not gains(found.outcome.robustness, first):
            attempt = PathAttempt(Found(first), first.robustness, found.samples)
        else:
            attempt = self.proved(path_problem, found, label)
        last = attempt.design
        if first is not None and (last is None or first.robustness > last.robustness):
            return PathAttempt(Found(first), first.robustness, attempt.samples)
        return attempt

    def improved(self, cells: Abstraction, plan: Plan, best: Design) -> PathAttempt:
        """A more robust design along another path than a proved design of the structure.

        The search uses the parameters of that design.
        """
        path_problem, label = self.posed(cells, plan), f"{self.label(cells, plan)}|improved"
        if best.controller is not None:
            path_problem = calmer(path_problem)
        theta: Array = best.configuration.outcome.trajectory.theta
        found = search_configuration(path_problem, label, self.structure.context, start=theta)
        outcome = found.outcome
        if not outcome.feasible or not gains(outcome.robustness, best):
            answer = Blocked(Cause.NO_MORE_ROBUST)
            return PathAttempt(answer, outcome.robustness, found.samples)
        return self.proved(path_problem, found, label)

    def standing(self, cells: Abstraction, cell: int, configuration: Configuration) -> PathAttempt:
        """A proved design of a robot that cannot move."""
        path_problem = self.place.path_problem(cells, self.recorded, self.recorded, (cell,))
        answer = self.proof.as_found(path_problem, configuration)
        if isinstance(answer, Found):
            self.structure.listener.keep(answer.design)
        return PathAttempt(answer, configuration.outcome.robustness)

    # --- the parts of an attempt ----------------------------------------------------------------

    def posed(self, cells: Abstraction, plan: Plan) -> PathProblem:
        """The path problem of a plan; the effector with the longest path leads."""
        leader = self.leader(plan)
        self.structure.context.reporter.path(tuple(cells.cells[cell].name for cell in leader.cells))
        others = tuple(path for path in plan.paths if path is not leader)
        found = self.place.path_problem(cells, self.recorded, leader.effector, leader.cells)
        found = timed(replace(found, others=others), leader.entries)
        return calmer(found) if needs_feedback(found) else found

    def leader(self, plan: Plan) -> EffectorPath:
        """The path of a plan that the search follows."""
        return max(plan.paths, key=lambda path: (len(path.cells), path.effector == self.recorded))

    def label(self, cells: Abstraction, plan: Plan) -> str:
        """The name of a plan in journals."""
        return f"{self.structure.label}|{self.recorded}|{len(cells.cuts)}|{plan}"

    def explained(
        self, path_problem: PathProblem, found: Configuration, label: str, why: Explanation
    ) -> PathAttempt:
        """The result for a path along which the search found no feasible motion."""
        if not isinstance(why, ControlOutcome):
            return self.not_followed(path_problem, found, why)
        at = settled(path_problem, why, found.entries, self.structure.context)
        if at is None:
            return self.not_followed(path_problem, found, None)
        motion = replace(
            found, outcome=at.outcome, entries=at.entries, cells=at.path_problem.cells,
            bound=at.path_problem.bound,
        )  # fmt: skip
        return self.proved(path_problem, motion, label)

    def not_followed(
        self, path_problem: PathProblem, found: Configuration, core: PathCore | None
    ) -> PathAttempt:
        """The attempt for a path without a feasible motion: what is deferred, and why.

        Without a core, all paths are deferred that contain the cells up to where the motion gets
        stuck.
        """
        outcome, cells = found.outcome, path_problem.cells
        sample = infeasible_sample(path_problem, outcome, found.entries)
        prefix = cells[: infeasible_prefix(sample, found.entries)]
        names = tuple(path_problem.abstraction.cells[cell].name for cell in prefix)
        text = "" if sample is None else nearest_text(path_problem, found, sample, names)
        blocked = blocked_by(outcome)
        if core is not None:
            prefix = tuple(cells[place] for place in core.places)
            if not prefix and blocked.cause is Cause.NOT_FOLLOWED:
                blocked = replace(blocked, text=FREE_TEXT)
        excluded = CounterExample(
            path_problem.effector, prefix, f"robustness {outcome.robustness:.4g}",
            self.structure.robot, ordered=core is None or core.ordered,
        )  # fmt: skip
        nearest = self.nearest(path_problem, found, sample, blocked.cause, text)
        return PathAttempt(blocked, outcome.robustness, found.samples, excluded, nearest)

    def proved(self, path_problem: PathProblem, found: Configuration, label: str) -> PathAttempt:
        """The attempt to prove a feasible configuration."""
        self.see(path_problem, found)
        tried = self.proof.attempt(path_problem, found, label)
        samples = found.samples + tried.samples
        if isinstance(tried.answer, Found):
            self.structure.listener.keep(tried.answer.design)
            return PathAttempt(tried.answer, tried.robustness, samples)
        nearest = self.nearest(path_problem, found, None, tried.answer.cause, tried.answer.text)
        return PathAttempt(tried.answer, tried.robustness, samples, nearest=nearest)

    def see(self, path_problem: PathProblem, found: Configuration) -> None:
        """Report a motion whose search or proof is still under way."""
        cause = Cause.UNDER_WAY
        self.structure.listener.see(self.nearest(path_problem, found, None, cause, ""))

    def see_unproved(
        self, path_problem: PathProblem, found: Configuration, blocked: Blocked
    ) -> None:
        """Report a motion that was not proved, while another one is about to be."""
        motion = self.nearest(path_problem, found, None, Cause.UNDER_WAY, blocked.text)
        remedy = ""
        if path_problem.feedback and self.shape.task.robust is not None:
            shorter = f"shorter steps ({shorter_steps(self.shape.task)})"
            remedy = f"a longer `--time-limit`, {shorter}, or smaller bounds in `robust`"
        self.structure.listener.see(replace(motion, remedy=remedy))

    def nearest(
        self,
        path_problem: PathProblem,
        found: Configuration,
        sample: int | None,
        cause: Cause,
        text: str,
    ) -> NearestMotion:
        """The motion of an attempt that was not proved."""
        outcome = found.outcome
        return NearestMotion(
            derivation=self.structure.derivation,
            model=path_problem.model,
            abstraction=path_problem.abstraction,
            cells=found.cells,
            effector=self.recorded,
            leader=path_problem.effector,
            trajectory=outcome.trajectory,
            robustness=outcome.robustness,
            feasible=outcome.feasible,
            sample=sample,
            cause=cause,
            text=text,
        )


class _Early:
    """Receives the outcomes of a search and proves the first feasible ones.

    Proofs may run in parallel with the search, one after the other, until one gives a design.
    Which one does so does not depend on how long they take.
    """

    def __init__(self, search: PathSearch) -> None:
        self._search = search
        self._left = EARLY_PROOFS
        self._best = -np.inf
        self._waiting: deque[tuple[PathProblem, ControlOutcome]] = deque()
        self._begun: Begun[Design | None] | None = None
        self._design: Design | None = None

    def see(self, path_problem: PathProblem, outcome: ControlOutcome) -> None:
        """Report an outcome that is more robust than all before."""
        if outcome.robustness > self._best:
            self._best = outcome.robustness
            cells, entries = path_problem.cells, path_problem.waypoints()[1]
            self._search.see(path_problem, Configuration(outcome, entries, cells))

    def prove(self, path_problem: PathProblem, outcome: ControlOutcome) -> None:
        """Report an outcome and queue it for proof."""
        self.see(path_problem, outcome)
        if self._left and outcome.feasible:
            self._waiting.append((path_problem, outcome))
        self._advance(wait=False)

    def design(self) -> Design | None:
        """Wait for the proofs; return the design that one of them gave, or None."""
        self._advance(wait=True)
        return self._design

    def _advance(self, *, wait: bool) -> None:
        """Begin queued proofs one after the other, and collect their results."""
        proof = self._search.proof
        while True:
            while self._begun is None and self._waiting and self._left:
                path_problem, outcome = self._waiting.popleft()
                prepared = proof.prepared(path_problem, outcome)
                if prepared is not None:
                    self._left -= 1
                    self._begun = proof.begin_early(prepared, outcome)
            if self._begun is None or not (wait or self._begun.done):
                return
            self._design, self._begun = self._begun.result(), None
            if self._design is not None:
                self._left = 0
                self._search.structure.listener.keep(self._design)


def gains(robustness: float, proved: Design) -> bool:
    """Whether a motion is worth proving, given a proved design."""
    return robustness > proved.robustness * (1 + GAIN)


def blocked_by(outcome: ControlOutcome) -> Blocked:
    """Why an outcome is infeasible."""
    match outcome.ending:
        case Ending.NOT_FINITE:
            text = "; the equations of motion have no finite value where the search begins"
            return Blocked(Cause.NOT_FINITE, text)
        case Ending.UNSOLVED:
            return Blocked(Cause.UNSOLVED, f"; {outcome.ending.value}: {outcome.detail}")
        case _:
            return Blocked(Cause.NOT_FOLLOWED)
