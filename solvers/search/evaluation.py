"""Evaluate parameters: the best outcome over all seeds of a path problem, on any workers.

An evaluation is a pure function of the path problem and the parameters, so results do not depend on
who computes it.  Earlier evaluations are looked up in a journal, which stores outcomes as JSON
values without loss of precision.
"""

from __future__ import annotations

from base64 import b64decode, b64encode
from collections import deque
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, fields
from fractions import Fraction
from functools import lru_cache
from hashlib import sha256
from itertools import islice
from typing import TypeAlias

import numpy as np

from compiler.arrays import Array
from compiler.discretisation.numeric_robot import NumericRobot
from compiler.dynamics.equations_of_motion import robot_graph
from compiler.robots.robot import RobotModel
from solvers.execution.workers import InProcess, SharedPayload, Workers, keep, made_of, packed
from solvers.parameters.parameter_search import parameter_space
from solvers.run_context import Journal, Memory, Recorded
from solvers.search.calm_motion import chosen_by_spread
from solvers.trajectory.control_problem import (
    FULL,
    SURVEY,
    ControlOutcome,
    ControlProblem,
    Ending,
    IterationBudget,
)
from solvers.trajectory.path_following import PathProblem
from solvers.trajectory.path_timing import Entries
from solvers.trajectory.trajectory import Trajectory

RADIUS = 0.5
NEAR = 0.1
"""Units of length by which a seed may always leave the path."""
FARTHER = 2.0
"""Otherwise it may leave the path by this multiple of the distance of the best seed."""
ARRAY = "float64"
TRAJECTORY = "trajectory"


@dataclass(frozen=True, slots=True, eq=False)
class SolveRequest:
    """One control synthesis: the arguments of ``PathProblem.solve`` or ``PathProblem.released``.

    Without ``entries`` the path problem's own timing is used; with ``box``, a pair of bounds (p,),
    the parameters are unknowns too.
    """

    start: Trajectory
    entries: Entries | None = None
    box: tuple[Array, Array] | None = None
    budget: IterationBudget = FULL
    radius: float = RADIUS
    released: bool = False

    def outcome(self, path_problem: PathProblem) -> ControlOutcome:
        """Solve the path problem with these arguments; equal arguments give equal outcomes."""
        if self.released:
            entries = path_problem.waypoints()[1] if self.entries is None else self.entries
            return path_problem.released(self.start, entries, self.box, self.budget, self.radius)
        return path_problem.solve(self.start, self.entries, self.box, self.budget, self.radius)

    @property
    def digest(self) -> str:
        """A hash of these arguments, the same in every run."""
        plain = (self.entries, self.budget, self.radius, self.released, self.box is None)
        text = sha256(repr(plain).encode())
        for array in (self.start.x, self.start.u, self.start.theta, *(self.box or ())):
            text.update(repr(array.shape).encode() + array.astype("<f8").tobytes())
        return text.hexdigest()


ROBOTS = 4
"""The number of robots whose equations of motion a process caches."""


@dataclass(frozen=True, slots=True)
class Recipe:
    """A path problem as plain data, from which another process can rebuild it."""

    model: RobotModel
    settings: dict[str, object]

    def path_problem(self) -> PathProblem:
        """Build the path problem."""
        gravity = getattr(self.settings["task"], "gravity", ())
        numeric = _numeric(self.model, gravity)
        return PathProblem(numeric=numeric, **self.settings)  # type: ignore[arg-type]


@lru_cache(ROBOTS)
def _numeric(model: RobotModel, gravity: tuple[Fraction, ...]) -> NumericRobot:
    """The equations of motion of a robot, shared by its path problems."""
    return NumericRobot(robot_graph(model, gravity))


def recipe(path_problem: PathProblem) -> Recipe:
    """The plain data of a path problem."""
    settings = {f.name: getattr(path_problem, f.name) for f in fields(path_problem)}
    del settings["numeric"]
    return Recipe(path_problem.model, settings)


Outcomes: TypeAlias = tuple[ControlOutcome, ...]


def evaluate(
    path_problem: PathProblem, theta: Array, budget: IterationBudget = SURVEY
) -> ControlOutcome:
    """The best outcome over all seeds with free timing along the path; the first of equal ones.

    ``theta`` (p,) are the parameters, in SI units.

    Raises:
        ValueError: if there is no seed.
    """
    return best_of(attempts_at(path_problem, theta, budget))


def attempts_at(
    path_problem: PathProblem, theta: Array, budget: IterationBudget = SURVEY
) -> Outcomes:
    """The outcomes of all promising seeds for theta (p,), with free timing along the path."""
    return tuple(
        request.outcome(path_problem)
        for request in _requests(_hopeful(path_problem, theta), budget)
    )


def best_of(outcomes: Iterable[ControlOutcome]) -> ControlOutcome:
    """The most robust outcome, the first of equal ones."""
    return max(outcomes, key=lambda outcome: outcome.robustness)


def _hopeful(path_problem: PathProblem, theta: Array) -> list[Trajectory]:
    problem = path_problem.problem(path_problem.waypoints()[1], released=True)
    return hopeful(problem, path_problem.seeds(theta))


def hopeful(problem: ControlProblem, seeds: Sequence[Trajectory]) -> list[Trajectory]:
    """The seeds that are worth trying, in order; at least one if there are any.

    A tracked seed leaves the path where the inverse kinematics finds no pose.  One that leaves it
    by far, while another hardly does, would only cost time.
    """
    gaps = [_excess(problem, seed) for seed in seeds]
    most = max(NEAR * problem.unit, FARTHER * min(gaps, default=0.0))
    return [seed for seed, gap in zip(seeds, gaps, strict=True) if gap <= most]


def _excess(problem: ControlProblem, seed: Trajectory) -> float:
    """The largest violation of the half-planes of a problem by a seed, in metres."""
    points = problem.numeric.points(seed.x[:, : problem.numeric.n], seed.theta)
    if not np.isfinite(points.value).all():
        return float("inf")
    return float(np.max(problem.rows(seed, points).excess(points), initial=0.0))


def _requests(seeds: Iterable[Trajectory], budget: IterationBudget) -> list[SolveRequest]:
    return [SolveRequest(seed, budget=budget, released=True) for seed in seeds]


_ThetaJob: TypeAlias = tuple[SharedPayload[Recipe], Array]
_SolveJob: TypeAlias = tuple[SharedPayload[Recipe], SolveRequest]


def _seeds(job: _ThetaJob) -> list[Trajectory]:
    """A job: the promising seeds at some parameters."""
    return _hopeful(made_of(job[0], Recipe.path_problem), job[1])


def _solved(job: _SolveJob) -> ControlOutcome:
    """A job: one control synthesis."""
    return job[1].outcome(made_of(job[0], Recipe.path_problem))


class Evaluator:
    """Evaluates parameters and solves for motions of one path problem; results are in order.

    In the journal, ``label`` stands for everything in the path problem that is not a plain number:
    structure, path and cells.  Recorded results are not computed again.
    """

    def __init__(
        self,
        path_problem: PathProblem,
        workers: Workers | None = None,
        journal: Journal | None = None,
        label: str = "",
    ) -> None:
        self.path_problem = path_problem
        self._workers = InProcess() if workers is None else workers
        self._journal = Memory() if journal is None else journal
        self._name = f"{label}|{_numbers(path_problem)}"
        self._packed: SharedPayload[Recipe] | None = None

    def batch(
        self, thetas: Sequence[Array], budget: IterationBudget = SURVEY
    ) -> Iterator[ControlOutcome]:
        """The best outcome over all seeds for each parameter vector (p,), one at a time.

        Raises:
            ValueError: if some of them have no seed.
        """
        return (best_of(outcomes) for outcomes in self.attempts(thetas, budget))

    def attempts(
        self, thetas: Sequence[Array], budget: IterationBudget = SURVEY
    ) -> Iterator[Outcomes]:
        """The outcomes of all promising seeds for each parameter vector (p,), one at a time."""
        keys = [f"{self._name}|{theta.tobytes().hex()}|{budget}" for theta in thetas]
        known = [self._recalled(key) for key in keys]
        missing = [theta for theta, found in zip(thetas, known, strict=True) if found is None]
        return self._merged(keys, known, self._evaluated(missing, budget))

    def solutions(self, requests: Sequence[SolveRequest]) -> Iterator[ControlOutcome]:
        """The outcomes of independent control syntheses, one at a time."""
        keys = [f"{self._name}|{request.digest}" for request in requests]
        known = [self._recalled(key) for key in keys]
        missing = [one for one, found in zip(requests, known, strict=True) if found is None]
        alone = ((outcome,) for outcome in self._outcomes(missing))
        return (outcome for (outcome,) in self._merged(keys, known, alone))

    def _merged(
        self, keys: list[str], known: list[Outcomes | None], missing: Iterator[Outcomes]
    ) -> Iterator[Outcomes]:
        """Known and missing outcomes in order; the missing ones are recorded as they arrive."""
        for key, recalled in zip(keys, known, strict=True):
            outcomes = recalled
            if outcomes is None:
                outcomes = next(missing)
                self._journal.record(key, [record_of(outcome) for outcome in outcomes])
            yield outcomes

    def _recalled(self, key: str) -> Outcomes | None:
        records = self._journal.recall(key)
        if not isinstance(records, list) or not records:
            return None
        outcomes = [outcome_of(record) for record in records]
        found = tuple(outcome for outcome in outcomes if outcome is not None)
        return found if len(found) == len(outcomes) else None

    def _evaluated(self, thetas: Sequence[Array], budget: IterationBudget) -> Iterator[Outcomes]:
        """Solve for all seeds of all parameters in parallel."""
        if isinstance(self._workers, InProcess):
            yield from (attempts_at(self.path_problem, theta, budget) for theta in thetas)
            return
        counts: deque[int] = deque()
        jobs = ((self._payload(), theta) for theta in thetas)

        def requests() -> Iterator[SolveRequest]:
            for seeds in self._workers.map(_seeds, jobs):
                counts.append(len(seeds))
                yield from _requests(seeds, budget)

        outcomes = self._outcomes(requests())
        ahead: list[ControlOutcome] = []
        for _ in thetas:
            if not counts:
                # Drawing the next outcome fills ``counts``.
                ahead += islice(outcomes, 1)
            missing = counts.popleft() - len(ahead)
            if missing < 0:
                yield ()
                continue
            yield (*ahead, *islice(outcomes, missing))
            ahead = []

    def _outcomes(self, requests: Iterable[SolveRequest]) -> Iterator[ControlOutcome]:
        if isinstance(self._workers, InProcess):
            return (request.outcome(self.path_problem) for request in requests)
        return self._workers.map(_solved, ((self._payload(), request) for request in requests))

    def _payload(self) -> SharedPayload[Recipe]:
        """The path problem packed for other processes; this process keeps the original."""
        if self._packed is None:
            self._packed = packed(recipe(self.path_problem))
            keep(self._packed, Recipe.path_problem, self.path_problem)
        return self._packed


def _numbers(path_problem: PathProblem) -> str:
    """The settings of a path problem that are numbers or names, or arrays and tuples of these."""
    settings = ((field.name, getattr(path_problem, field.name)) for field in fields(path_problem))
    return ",".join(f"{name}={text}" for name, value in settings if (text := _number(value)))


def _number(value: object) -> str:
    """A number, a name, an array or a tuple of numbers as text; empty for anything else."""
    match value:
        case np.ndarray():
            return f"{value.shape}{value.astype('<f8').tobytes().hex()}"
        case bool() | int() | float() | str() | None:
            return repr(value)
        case tuple() if all(isinstance(item, int | float) for item in value):
            return repr(value)
        case _:
            return ""


# --- the journal ---------------------------------------------------------------------------------


def record_of(outcome: ControlOutcome) -> dict[str, Recorded]:
    """An outcome as a JSON value."""
    return {field.name: _recorded(getattr(outcome, field.name)) for field in fields(outcome)}


def outcome_of(record: Recorded) -> ControlOutcome | None:
    """The outcome in a record, or None if the record is not of this version."""
    try:
        if not isinstance(record, dict):
            return None
        known = {name: _value(value) for name, value in record.items()}
        known["ending"] = Ending(str(known["ending"]))
        outcome = ControlOutcome(**known)  # type: ignore[arg-type]
    except (TypeError, ValueError, KeyError):
        return None
    found: object = outcome.trajectory  # a corrupt record may hold any type
    if not isinstance(found, Trajectory):
        return None
    return outcome


def _recorded(value: object) -> Recorded:
    if isinstance(value, Trajectory):
        arrays = (value.x, value.u, value.theta)
        return {TRAJECTORY: [_recorded(array) for array in arrays]}
    if isinstance(value, np.ndarray):
        return {ARRAY: b64encode(value.astype("<f8").tobytes()).decode(), "shape": [*value.shape]}
    if isinstance(value, np.generic):
        return _recorded(value.item())
    if value is None or isinstance(value, bool | int | float | str):
        return value
    raise TypeError(f"{type(value).__name__} cannot be recorded")


def _value(value: Recorded) -> object:
    if isinstance(value, list):
        raise TypeError("an outcome has no lists")
    if not isinstance(value, dict):
        return value
    if TRAJECTORY in value:
        parts = value[TRAJECTORY]
        if not isinstance(parts, list):
            raise TypeError("a trajectory has three arrays")
        return Trajectory(*(_array(part) for part in parts))
    return _array(value)


def _array(value: Recorded) -> Array:
    match value:
        case {"float64": str(text), "shape": list(shape)}:
            numbers = np.frombuffer(b64decode(text, validate=True), dtype="<f8")
            return numbers.reshape([int(str(size)) for size in shape]).astype(np.float64)
        case _:
            raise TypeError("an array has numbers and a shape")


def free_parameters(path_problem: PathProblem, about: Trajectory) -> tuple[Array, Array] | None:
    """Bounds (p,) on the parameters as unknowns near a motion; None if none may vary.

    Parameters chosen by the spread of disturbed motions stay fixed, because the convex programs do
    not model these.
    """
    if chosen_by_spread(path_problem):
        return None
    ranges = parameter_space(path_problem.model).free_box(about.theta)
    if path_problem.box is None or ranges is None:
        return ranges
    low, high = path_problem.box
    return np.maximum(ranges[0], low), np.minimum(ranges[1], high)
