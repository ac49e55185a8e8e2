"""Screenings of structures, begun ahead of need by idle workers.

They are in the order of the structures, so nothing depends on how far ahead the workers are.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable, Iterator
from dataclasses import asdict, dataclass, replace

import numpy as np

from compiler.discretisation.numeric_robot import NumericRobot
from compiler.dynamics.equations_of_motion import robot_graph
from compiler.mass_matrix.mass_matrix_check import mass_matrix_check
from compiler.robots.candidate import Candidate
from compiler.robots.robot import RobotModel
from compiler.robots.robot_key import robot_key_in_task
from grammar_lang import ir
from solvers.execution.workers import InProcess, SharedPayload, made_of, packed
from solvers.impossibility.structure_refutation import Refutation, refute_structure
from solvers.parameters.parameter_search import parameter_space
from solvers.run_context import Memory, Recorded, RunContext
from solvers.verifier.refutations.solver_process import SmtSolver

MOST_DRAWN = 64
"""The most structures drawn ahead; many of them may be robots seen before."""
MOST_ASKED = 256
"""The SMT answers that a process caches, because robots may share a question."""

_ASKED = Memory()


@dataclass(frozen=True, slots=True)
class _Question:
    """The part of the question that is the same for all robots."""

    program: ir.Program
    task: ir.Task
    seed: int
    smt: tuple[SmtSolver, ...]

    def itself(self) -> _Question:
        """The question itself."""
        return self


@dataclass(frozen=True, slots=True)
class _Job:
    question: SharedPayload[_Question]
    number: int
    model: RobotModel


def _examined(job: _Job) -> tuple[int, Screening]:
    """A job: the number of a structure and its screening."""
    question = made_of(job.question, _Question.itself)
    numeric = NumericRobot(robot_graph(job.model, question.task.gravity))
    if len(_ASKED.values) > MOST_ASKED:
        _ASKED.values.clear()
    context = RunContext(question.seed, journal=_ASKED, smt=question.smt)
    return job.number, screen(job.model, numeric, question.program, question.task, context)


class Prefetch:
    """The structures in order, and their screenings.

    ``screening`` and ``numeric`` are for the structure that was returned last.
    """

    def __init__(
        self,
        candidates: Iterable[Candidate],
        program: ir.Program,
        task: ir.Task,
        context: RunContext,
    ) -> None:
        self._candidates = iter(candidates)
        self._question = _Question(program, task, context.seed, context.smt)
        self._context = context
        self._asked = replace(context, journal=Memory())
        self._alone = isinstance(context.workers, InProcess)
        self._drawn: deque[Candidate] = deque()
        self._due: deque[Candidate] = deque()
        self._expected: set[int] = set()
        self._seen: set[str] = set()
        self._fault: Exception | None = None
        self._payload: SharedPayload[_Question] | None = None
        self._results: Iterator[tuple[int, Screening]] | None = None
        self._numeric: tuple[int, NumericRobot] | None = None

    def __iter__(self) -> Iterator[Candidate]:
        """All structures, once."""
        while True:
            candidate = self._drawn.popleft() if self._drawn else self._draw()
            if candidate is not None:
                yield candidate
            elif self._fault is not None:
                raise self._fault
            else:
                return

    def numeric(self, candidate: Candidate) -> NumericRobot:
        """The equations of motion of the robot of a structure.

        Raises:
            ValueError: if it has no robot.
        """
        if self._numeric is None or self._numeric[0] != candidate.number:
            graph = robot_graph(_robot(candidate), self._question.task.gravity)
            self._numeric = candidate.number, NumericRobot(graph)
        return self._numeric[1]

    def screening(self, candidate: Candidate) -> Screening:
        """The screening of the robot of a structure; the journal is consulted first.

        Raises:
            ValueError: if it has no robot.
        """
        key = _key(candidate)
        found = screening_of(self._context.journal.recall(key))
        if found is None:
            found = self._own(candidate) if self._alone else self._result(candidate)
            self._context.journal.record(key, found.record())
        return found

    def _own(self, candidate: Candidate) -> Screening:
        question, numeric = self._question, self.numeric(candidate)
        model = _robot(candidate)
        return screen(model, numeric, question.program, question.task, self._asked)

    def _result(self, candidate: Candidate) -> Screening:
        """The result of the workers; results of other structures are discarded on the way."""
        if candidate.number not in self._expected:
            return self._own(candidate)
        while True:
            if self._results is None:
                self._results = self._context.workers.map(_examined, self._jobs())
            for number, screening in self._results:
                self._expected.discard(number)
                if number == candidate.number:
                    return screening
            self._results = None

    # --- drawing --------------------------------------------------------------------------------

    def _jobs(self) -> Iterator[_Job]:
        """A job for each robot not seen before, drawing further structures ahead."""
        if self._payload is None:
            self._payload = packed(self._question)
        while True:
            while self._due:
                candidate = self._due.popleft()
                yield _Job(self._payload, candidate.number, _robot(candidate))
            drawn = self._draw() if len(self._drawn) < MOST_DRAWN else None
            if drawn is None:
                return
            self._drawn.append(drawn)

    def _draw(self) -> Candidate | None:
        """The next structure; None after the last one, or if drawing it raised an exception."""
        if self._fault is not None:
            return None
        try:
            candidate = next(self._candidates, None)
        except Exception as fault:
            self._fault = fault
            return None
        if candidate is not None and not self._alone and self._is_new(candidate):
            self._due.append(candidate)
            self._expected.add(candidate.number)
        return candidate

    def _is_new(self, candidate: Candidate) -> bool:
        """Whether a structure has a robot that was not seen before and has to be screened."""
        if candidate.model is None:
            return False
        key = robot_key_in_task(candidate.model, self._question.task)
        if key in self._seen:
            return False
        self._seen.add(key)
        return screening_of(self._context.journal.recall(_key(candidate))) is None


def _key(candidate: Candidate) -> str:
    return f"screened|{candidate.number}"


def _robot(candidate: Candidate) -> RobotModel:
    if candidate.model is None:
        raise ValueError(f"structure {candidate.number} has no robot")
    return candidate.model


# --------------------------------------------------------------------------------------------------
# Screening, before any motion is searched: a robot is refuted, inadmissible, or open.
#
# A robot whose mass matrix is nowhere regular cannot be driven: it is *inadmissible*.  Samples
# raise the suspicion, a proof confirms it.  If M is singular only at single poses or parameters
# (at length zero, say), the robot is searched like any other: the certificate proves that M is
# regular along the motion.


SAMPLES = 4
SINGULAR = 1e-12
BOXES = 256


@dataclass(frozen=True, slots=True)
class Screening:
    """The result of the refutation, and why the robot cannot be driven, or None."""

    refutation: Refutation
    inadmissible: str | None

    def record(self) -> Recorded:
        """The screening as a JSON value."""
        return [asdict(self.refutation), self.inadmissible]


def screening_of(record: Recorded) -> Screening | None:
    """The screening in a record, or None if the record is not of this version."""
    match record:
        case [dict(refutation), None | str() as blocked]:
            try:
                return Screening(Refutation(**refutation), blocked)  # type: ignore[arg-type]
            except TypeError:
                return None
        case _:
            return None


def screen(
    model: RobotModel,
    numeric: NumericRobot,
    program: ir.Program,
    task: ir.Task,
    context: RunContext,
) -> Screening:
    """Screen a robot; a refuted one is not examined further."""
    refutation = refute_structure(model, numeric, program, task, context)
    blocked = None if refutation.refuted else inadmissible(model, numeric)
    return Screening(refutation, blocked)


def inadmissible(model: RobotModel, numeric: NumericRobot) -> str | None:
    """Why a robot cannot be driven, or None."""
    if not model.dofs or not _singular_at_all_samples(model, numeric):
        return None
    found = mass_matrix_check(model, budget=BOXES)
    return None if found.status == "proved" else f"the mass matrix is {found.text}"


def _singular_at_all_samples(model: RobotModel, numeric: NumericRobot) -> bool:
    """Whether M is singular, indefinite or not finite at every one of a few random points."""
    rng = np.random.default_rng(0)
    space = parameter_space(model)
    for _ in range(SAMPLES):
        theta = rng.uniform(space.lower, space.upper)
        mass = numeric.mass_matrix(rng.uniform(-1, 1, size=(SAMPLES, len(model.dofs))), theta)
        finite = mass[np.isfinite(mass).all(axis=(1, 2))]
        eigenvalues = np.linalg.eigvalsh(finite)
        if np.any(eigenvalues[:, 0] > SINGULAR * eigenvalues[:, -1]):
            return False
    return True
