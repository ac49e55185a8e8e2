"""From a feasible motion to a proved design: widen margins and add feedback until a proof succeeds.

Margins start at the minimum and grow only if a proof lacked room.  An open loop is tried first, if
the inputs alone produce the motion.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import TypeAlias

import numpy as np

from compiler.words.derivation import Derivation
from grammar_lang import ir
from solvers.execution.workers import Begun, Job, Result
from solvers.run_context import RunContext
from solvers.search.calm_motion import calmer, feedback_before_digits, outgrows
from solvers.search.certified_design import certified_design
from solvers.search.closed_loop import feedback_choices, unbearable_noise
from solvers.search.configuration_search import (
    Configuration,
    Sample,
    calmed,
    resolved,
    searched_further,
    within_limits,
)
from solvers.search.constraint_tightening import ConstraintTightening, no_margin_text
from solvers.search.evaluation import Recipe, recipe
from solvers.search.failed_proof import failure_text, shorter_steps
from solvers.search.path_task import Design
from solvers.search.search_state import Answer, Blocked, Cause, Found
from solvers.trajectory.control_problem import FULL, SURVEY, ControlOutcome, IterationBudget
from solvers.trajectory.fine_motion import inset, refined, unstable
from solvers.trajectory.path_following import PathProblem
from solvers.trajectory.trajectory import Trajectory
from solvers.verifier.proofs.scene import Watch

EARLY_MARGINS = 2
"""The number of margins tried for a newly found motion."""
FailureListener: TypeAlias = Callable[[PathProblem, Configuration, Blocked], None]
"""Receives each motion that was not proved, and what blocked it."""
UNSTABLE_TEXT = "; the motion is unstable: its inputs alone do not cause it"


@dataclass(frozen=True, slots=True)
class ProofAttempt:
    """The answer about a configuration, its robustness, and the samples evaluated on the way."""

    answer: Answer
    robustness: float
    samples: tuple[Sample, ...] = ()


@dataclass(frozen=True, slots=True)
class MotionProof:
    """Proves motions of a robot; ``task`` is the task as stated, even if motions go on for ever.

    The ``listener`` is called whenever a motion is not proved.
    """

    program: ir.Program
    task: ir.Task
    derivation: Derivation
    context: RunContext
    listener: FailureListener | None = None

    @property
    def watch(self) -> Watch:
        """The callbacks of proofs."""
        return Watch(self.context.check_time, begin=self._beside)

    def _beside(self, function: Callable[[Job], Result], job: Job) -> Callable[[], Result]:
        return self.context.workers.begin(function, job).result

    def as_found(self, path_problem: PathProblem, found: Configuration) -> Answer:
        """The answer about a configuration as it stands."""
        return certified_design(
            self.program, self.task, self.derivation, path_problem, found,
            self.watch, last=True,
        )  # fmt: skip

    def prepared(self, path_problem: PathProblem, outcome: ControlOutcome) -> PathProblem | None:
        """The problem for which a newly found motion may be proved at once, or None.

        It is None if the motion needs feedback and the task asks for an open loop.  It is also None
        if the motion needs feedback, its rates had no price and no disturbance is named: a calm
        motion is then searched for at once.
        """
        finer = refined(path_problem, outcome.trajectory)
        opened = False in feedback_choices(path_problem, outcome)
        feedback = not opened or unstable(finer, outcome.trajectory)
        feedback = feedback or outgrows(finer, outcome.trajectory)
        if feedback and self.task.control == "open loop":
            return None
        if feedback and not path_problem.rates:
            if self.task.robust is None:
                return None
            path_problem = calmer(path_problem)
        return replace(path_problem, bound=False, feedback=feedback, refines=feedback)

    def begin_early(self, prepared: PathProblem, outcome: ControlOutcome) -> Begun[Design | None]:
        """Begin to prove such a motion with few margins; the result is its design or None."""
        return self.context.workers.begin(_early, EarlyProof(self, prepared, outcome))

    def attempt(self, path_problem: PathProblem, found: Configuration, label: str) -> ProofAttempt:
        """A proved design from a feasible configuration, or from more evaluations of parameters."""
        attempt = self.open_or_closed(path_problem, found, label)
        if isinstance(attempt.answer, Found) or attempt.answer.cause is Cause.NOISE:
            return attempt
        closer = searched_further(path_problem, label, self.context)
        if closer is None:
            return attempt
        samples = attempt.samples + closer.samples
        if closer.outcome.feasible:
            again = self.open_or_closed(path_problem, closer, label)
            return replace(again, samples=samples + again.samples)
        return replace(attempt, samples=samples)

    def open_or_closed(
        self, path_problem: PathProblem, found: Configuration, label: str
    ) -> ProofAttempt:
        """A proved design from a feasible configuration; open loop first, if that is possible."""
        attempt = ProofAttempt(Blocked(Cause.UNPROVED), found.outcome.robustness)
        choices, samples = feedback_choices(path_problem, found.outcome), tuple[Sample, ...]()
        left: tuple[PathProblem, Configuration] | None = None
        for feedback in (False, True):
            if feedback not in choices and not (feedback and self.wants_feedback(attempt.answer)):
                continue
            if feedback and not found.calmed:
                slower = calmed(path_problem, label, self.context)
                samples += slower.samples
                found = slower if slower.outcome.feasible else found
            given = calmer(path_problem) if found.calm else path_problem
            along = given.along(found.cells, found.entries)
            closed = replace(along, feedback=feedback, refines=feedback, bound=found.bound)
            attempt = self.with_margins(closed, found)
            if isinstance(attempt.answer, Found):
                break
            if not feedback and self.wants_feedback(attempt.answer):
                left = closed, found
        if left is not None and is_rough(left[0]) and not isinstance(attempt.answer, Found):
            attempt = self.with_margins(*left, thoroughly=True)
        return replace(attempt, samples=samples)

    def wants_feedback(self, answer: Answer) -> bool:
        """Whether an open-loop motion failed in a way that feedback may repair."""
        lost = isinstance(answer, Blocked) and answer.cause in (Cause.UNSTABLE, Cause.ENDED)
        return lost and not self.task.control

    def with_margins(
        self,
        path_problem: PathProblem,
        found: Configuration,
        most: int | None = None,
        budget: IterationBudget = FULL,
        *,
        thoroughly: bool = False,
    ) -> ProofAttempt:
        """A proved design with as much tightening as it needs, in at most ``most`` trials.

        ``budget`` is for the motion under each tightening.  With many joints, an open loop is
        proved in double precision only, unless ``thoroughly``.
        """
        rough = is_rough(path_problem) and not thoroughly
        tightening: ConstraintTightening | None = ConstraintTightening(path_problem.margin)
        blocked, tried = Blocked(Cause.UNPROVED), 0
        while tightening is not None and tried != most:
            tried += 1
            wider = tightened(path_problem, found.outcome.trajectory, tightening)
            given = path_problem.spread, path_problem.margin, path_problem.substeps
            if (wider.spread, wider.margin, wider.substeps) != given:
                path_problem = wider
                found = resolved(path_problem, found, budget)
            path_problem = replace(path_problem, slack=tightening.slack)
            path_problem, found = within_limits(path_problem, found, budget)
            if not found.outcome.feasible:
                blocked = without_motion(path_problem, found, blocked)
                break
            if lost(path_problem, found.outcome.trajectory, rough=rough):
                blocked = Blocked(Cause.UNSTABLE, blocked.text + UNSTABLE_TEXT)
                break
            answer = certified_design(
                self.program, self.task, self.derivation, path_problem, found,
                self.watch, last=tightening.is_last, roughly=rough,
            )  # fmt: skip
            if isinstance(answer, Found):
                return ProofAttempt(answer, found.outcome.robustness)
            blocked = answer
            if blocked.cause in (Cause.ENDED, Cause.NO_DECIMALS):
                break  # wider margins do not help
            limited = bool(blocked.limits) and path_problem.spread is not None
            if limited:
                path_problem = inset(path_problem, np.array(blocked.limits)[:, :, None])
            tightening = tightening.wider(
                blocked.lacking, path_problem.spread, blocked.beyond, limited=limited
            )
            self.tell(
                path_problem, found, blocked, goes_on=tightening is not None and tried != most
            )
        return ProofAttempt(blocked, found.outcome.robustness)

    def tell(
        self, path_problem: PathProblem, found: Configuration, blocked: Blocked, *, goes_on: bool
    ) -> None:
        """Report a failed proof; ``goes_on`` says that a wider margin is tried next."""
        note, task, condition = self.context.reporter.note, path_problem.task, blocked.condition
        note(failure_text(blocked, goes_on=goes_on))
        disturbed = path_problem.feedback and task.robust is not None
        if disturbed and condition and self.context.failures.often(condition.name):
            note(f"it fails again and again; shorter steps may help: {shorter_steps(task)}")
        if self.listener is not None:
            self.listener(path_problem, found, blocked)


def is_rough(path_problem: PathProblem) -> bool:
    """Whether the open loop of a robot is proved only roughly because feedback is tried next."""
    return not path_problem.feedback and feedback_before_digits(path_problem)


def lost(path_problem: PathProblem, trajectory: Trajectory, *, rough: bool) -> bool:
    """Whether an open-loop proof is not worth trying."""
    if path_problem.feedback:
        return False
    return unstable(path_problem, trajectory) or (rough and outgrows(path_problem, trajectory))


@dataclass(frozen=True, slots=True)
class EarlyProof:
    """A motion to be proved at once; in another process its ``proof`` reports to nobody."""

    proof: MotionProof
    prepared: PathProblem
    outcome: ControlOutcome

    def __reduce__(self) -> tuple[object, ...]:
        """Pickle as plain data."""
        proof = self.proof
        asked = proof.program, proof.task, proof.derivation
        return _early_proof, (*asked, recipe(self.prepared), self.outcome)


def _early_proof(
    program: ir.Program,
    task: ir.Task,
    derivation: Derivation,
    made: Recipe,
    outcome: ControlOutcome,
) -> EarlyProof:
    proof = MotionProof(program, task, derivation, RunContext())
    return EarlyProof(proof, made.path_problem(), outcome)


def _early(asked: EarlyProof) -> Design | None:
    """A job: the design of a motion, or None if it is not proved with few margins."""
    prepared = asked.prepared
    found = Configuration(asked.outcome, prepared.waypoints()[1], prepared.cells, bound=False)
    proof = asked.proof
    answer = proof.with_margins(prepared, found, EARLY_MARGINS, SURVEY).answer
    if is_rough(prepared) and prepared.rates and proof.wants_feedback(answer):
        closed = replace(prepared, feedback=True, refines=True)
        answer = proof.with_margins(closed, found, EARLY_MARGINS, SURVEY).answer
    return answer.design if isinstance(answer, Found) else None


def tightened(
    path_problem: PathProblem, trajectory: Trajectory, tightening: ConstraintTightening
) -> PathProblem:
    """The same task, tightened as much as a motion requires."""
    wider = refined(path_problem.with_margin(tightening.margin), trajectory)
    wider = replace(wider, slack=tightening.slack, narrowing=tightening.narrowing)
    robust = path_problem.task.robust is not None
    return wider.spreading(trajectory, tightening.spreads) if robust else wider


def without_motion(path_problem: PathProblem, found: Configuration, before: Blocked) -> Blocked:
    """Why no motion was found under tightening; ``before`` is the result of the last proof."""
    if path_problem.spread is None:
        return Blocked(Cause.NO_CLEARANCE, before.text)
    noise = unbearable_noise(path_problem, found.outcome.trajectory)
    text = noise or no_margin_text(path_problem.spread)
    return Blocked(Cause.NO_CLEARANCE if noise is None else Cause.NOISE, f"{before.text}; {text}")
