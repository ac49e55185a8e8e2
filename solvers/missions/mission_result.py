"""The result of the search for a mission, with its evidence."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from typing import TypeAlias

from compiler.missions.parameter_boxes import BoxTree
from compiler.missions.robot_changes import Built, Changes
from grammar_lang import ir
from solvers.conclusion import StructureRecord
from solvers.lemma import Lemma
from solvers.missions.undecided_robots import Ended, UndecidedRobots
from solvers.search.path_task import Design
from solvers.verdict import Verdict
from solvers.verifier.claims.certificate import SeparationClaim

Labels: TypeAlias = tuple[str, ...]


@dataclass(frozen=True, slots=True)
class BoxEvidence:
    """The covering that refutes the robots of a box in a task, given by its index."""

    task: int
    boxes: str


@dataclass(frozen=True, slots=True, eq=False)
class CutRobot:
    """A structure whose box of parameters was cut, and the refutations of some of the leaves.

    ``task`` is the index of the task that it is about; None if it is to do all of them.
    """

    task: int | None
    word: tuple[str, ...]
    labels: Labels
    tree: BoxTree
    evidence: dict[int, BoxEvidence] = field(default_factory=dict[int, BoxEvidence])
    """Maps the id of a leaf to its refutation."""

    def of(self, leaf: BoxTree) -> BoxEvidence | None:
        """The refutation of a leaf, or None."""
        return self.evidence.get(id(leaf))


@dataclass(frozen=True, slots=True)
class TaskEvidence:
    """The structures refuted in a task for all values of their parameters."""

    records: Sequence[StructureRecord]
    lemmas: Sequence[Lemma]
    separation: SeparationClaim | None = None


@dataclass(frozen=True, slots=True)
class ObjectiveValue:
    """The value of an objective; no robot that does the mission has less than ``least``."""

    objective: ir.Objective
    text: str
    value: Fraction
    least: Fraction
    unit: str = ""


@dataclass(frozen=True, slots=True)
class Existing:
    """The robot that exists before the first task."""

    word: tuple[str, ...]
    robot: Built


@dataclass(frozen=True, slots=True)
class MissionResult:
    """The verdict on a mission with its evidence.

    ``designs`` are those of the tasks in order, ``steps`` the changes before each task; the first
    is None unless a robot exists already.  ``modules`` is the bound up to which robots were tried;
    ``by_default`` says that it is a default.  ``undecided`` robots are neither found nor refuted;
    ``open_robots`` says which, and why.  ``ended`` says what ended the search without an answer, if
    anything did.
    """

    mission: ir.Mission
    verdict: Verdict
    reason: str | None
    designs: tuple[Design, ...] = ()
    steps: tuple[Changes | None, ...] = ()
    cost: Fraction | None = None
    least: Fraction | None = None
    values: tuple[ObjectiveValue, ...] = ()
    evidence: tuple[TaskEvidence, ...] = ()
    cut: tuple[CutRobot, ...] = ()
    existing: Existing | None = None
    modules: int | None = None
    by_default: bool = False
    undecided: int = 0
    open_robots: tuple[UndecidedRobots, ...] = ()
    ended: Ended | None = None
    counts: dict[str, int] = field(default_factory=dict[str, int])
    unfinished: bool = False
