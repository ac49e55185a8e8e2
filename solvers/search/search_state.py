"""The state of the search of a structure: attempts at paths, each found or blocked.

A state is immutable: every attempt makes a new one.  Everything that a result reports about a
structure (its counts, counterexamples, nearest motion) is derived from its attempts.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from enum import Enum
from typing import TypeAlias

import numpy as np

from compiler.robots.robot import RobotModel
from compiler.words.derivation import Derivation
from compiler.workspaces.abstraction import Abstraction
from solvers.planner import CounterExample
from solvers.search.configuration_search import PathSamples, Sample
from solvers.search.path_task import Design
from solvers.trajectory.trajectory import Trajectory
from solvers.verifier.proofs.checked_condition import CheckedCondition


class Cause(Enum):
    """The reason why there is no design along a path."""

    NOT_FINITE = "the equations of motion have no finite value"
    UNSOLVED = "a convex program was not solved"
    NOT_FOLLOWED = "no motion was found along the path"
    NO_MORE_ROBUST = "the motion is not more robust than a proved one"
    NO_CLEARANCE = "no motion leaves the clearance that a proof takes"
    NOISE = "errors of measurements alone are more than a motion bears"
    UNSTABLE = "the inputs alone do not cause the motion"
    DIVERGES = "the motion with feedback diverges"
    NO_SET = "no set of states was found that every round returns into"
    NO_DECIMALS = "the parameters have no decimals within their bounds"
    BROKEN = "a simulation of the motion breaks a condition"
    BETWEEN_SAMPLES = "a formula fails between the samples"
    ENDED = "the enclosure of the motion ended"
    UNPROVED = "a condition was not proved"
    UNDER_WAY = "its search or its proof had not ended"


@dataclass(frozen=True, slots=True)
class Blocked:
    """Why there is no design; ``text`` explains it in words appended to a reason, if useful.

    ``lacking`` is the share by which the margin for disturbed motions must grow.  ``beyond`` is the
    share by which motions leave the set of their loop.  ``limits`` are what the
    range and the rate of each joint lack, in SI; empty if they lack nothing.
    ``condition`` is the first one that was not proved.
    """

    cause: Cause
    text: str = ""
    lacking: float = 0.0
    beyond: float = 0.0
    limits: tuple[tuple[float, float], ...] = ()
    condition: CheckedCondition | None = None


@dataclass(frozen=True, slots=True)
class Found:
    """A proved design."""

    design: Design


Answer: TypeAlias = Found | Blocked


@dataclass(frozen=True, slots=True, eq=False)
class NearestMotion:
    """The most robust motion of an attempt that ended without a proof.

    ``sample`` is the first sample that it cannot reach; None if it reaches all, or if this is not
    known.  ``effector`` (from 0) reaches, and ``leader`` follows the cells of the path.  A motion
    that is ``feasible`` at its samples was found but not proved.  ``cause`` says why, and ``text``
    what it lacks.  ``remedy`` is what to try first, in words, if more than the cause is known.
    """

    derivation: Derivation
    model: RobotModel
    abstraction: Abstraction
    cells: tuple[int, ...]
    effector: int
    leader: int
    trajectory: Trajectory
    robustness: float
    feasible: bool
    sample: int | None
    cause: Cause
    text: str
    remedy: str = ""

    @property
    def stuck(self) -> int | None:
        """The first sample that it cannot reach; None also if only the end conditions fail."""
        return None if self.sample is None or self.sample > len(self.trajectory.u) else self.sample

    @property
    def rank(self) -> tuple[bool, float]:
        """A sort key; greater is nearer."""
        return self.feasible, self.robustness


@dataclass(frozen=True, slots=True)
class CounterExampleRecord:
    """A counterexample: paths with these cells, in this order if ``ordered``, were deferred.

    ``structure`` and ``path`` identify the samples with which it was found.  ``effector`` (from 0)
    could not follow its path of ``length`` cells.  ``deferred`` counts the deferred paths with at
    most two more cells, as far as they were counted.  ``sample`` is the first sample that the most
    robust motion cannot reach, None if there is none or it is not known.  ``robustness`` is that of
    this motion.
    """

    structure: int
    path: int
    effector: int
    cells: tuple[str, ...]
    ordered: bool
    length: int
    deferred: int
    sample: int | None
    robustness: float


@dataclass(frozen=True, slots=True, eq=False)
class PathAttempt:
    """The result for a path: a proved design, or what blocked it and what to defer.

    ``excluded`` is a counterexample, by which ``deferred`` paths are deferred.

    Raises:
        ValueError: if a path is excluded although a motion along it was found.
    """

    answer: Answer
    robustness: float = -np.inf
    samples: tuple[Sample, ...] = ()
    excluded: CounterExample | None = None
    nearest: NearestMotion | None = None
    deferred: int = 0

    def __post_init__(self) -> None:
        if self.excluded is not None and (self.nearest is None or self.nearest.feasible):
            raise ValueError("a path is excluded only where no motion along it was found")

    @property
    def design(self) -> Design | None:
        """The proved design, if there is one."""
        return self.answer.design if isinstance(self.answer, Found) else None


@dataclass(frozen=True, slots=True, eq=False)
class StructureState:
    """All attempts at a structure so far; ``reason`` says why no more are made, once over."""

    attempts: tuple[PathAttempt, ...] = ()
    reason: str | None = None

    @property
    def is_over(self) -> bool:
        """Whether nothing is left to try."""
        return self.reason is not None

    @property
    def design(self) -> Design | None:
        """The most robust proved design."""
        designs = [each.design for each in self.attempts if each.design is not None]
        return max(designs, key=lambda design: design.robustness, default=None)

    @property
    def best(self) -> float:
        """The best robustness of all attempts."""
        return max((each.robustness for each in self.attempts), default=-np.inf)

    @property
    def nearest(self) -> NearestMotion | None:
        """The motion nearest to a design, the first of equal ones."""
        known = [each.nearest for each in self.attempts if each.nearest is not None]
        return max(known, key=lambda motion: motion.rank, default=None)

    @property
    def obstacle(self) -> str:
        """The text of the last blocked attempt that has one, else that of the nearest motion."""
        answers = (each.answer for each in reversed(self.attempts))
        texts = (answer.text for answer in answers if isinstance(answer, Blocked) and answer.text)
        nearest = self.nearest
        return next(texts, "" if nearest is None else nearest.text)

    @property
    def cause(self) -> Cause | None:
        """The cause that belongs to the obstacle; None if nothing was attempted."""
        blocked = [a.answer for a in reversed(self.attempts) if isinstance(a.answer, Blocked)]
        spoken = next((answer.cause for answer in blocked if answer.text), None)
        if spoken is not None or self.nearest is not None:
            return spoken or (None if self.nearest is None else self.nearest.cause)
        return blocked[0].cause if blocked else None

    @property
    def tried(self) -> str:
        """The number of paths tried and the best robustness, in words."""
        count = len(self.attempts)
        if not count:
            return "no path tried"
        paths = "1 path" if count == 1 else f"{count} paths"
        return f"{paths} tried, best robustness {self.best:.4g}"

    @property
    def evaluated(self) -> tuple[PathAttempt, ...]:
        """The attempts in which parameters were evaluated."""
        return tuple(each for each in self.attempts if each.samples)

    def samples(self, structure: int, names: Sequence[str]) -> tuple[PathSamples, ...]:
        """The samples by path; ``names`` are the parameters."""
        return tuple(
            PathSamples(structure, path, tuple(names), each.samples)
            for path, each in enumerate(self.evaluated)
        )

    @property
    def is_deferred(self) -> bool:
        """Whether no motion is expected along any path."""
        return any(each.excluded is not None and not each.excluded.cells for each in self.attempts)

    def counterexamples(self, structure: int) -> tuple[CounterExampleRecord, ...]:
        """The counterexamples, in the order in which they were found."""
        found = list[CounterExampleRecord]()
        for path, each in enumerate(self.evaluated):
            if each.excluded is not None and each.nearest is not None:
                at = each.nearest
                cells = at.abstraction.cells
                names = tuple(cells[cell].name for cell in each.excluded.cells)
                found.append(
                    CounterExampleRecord(
                        structure, path, at.leader, names, each.excluded.ordered, len(at.cells),
                        each.deferred, at.stuck, at.robustness,
                    )
                )  # fmt: skip
        return tuple(found)
