"""What a search for a mission comes to, and what that rests on."""

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
    """The covering that refutes the robots of a box in a task, given by its number."""

    task: int
    boxes: str


@dataclass(frozen=True, slots=True, eq=False)
class CutRobot:
    """A structure whose box of parameters was cut, and what refutes some of its leaves.

    ``task`` is the number of the one task that it is about; None: it is to do all of them.
    """

    task: int | None
    word: tuple[str, ...]
    labels: Labels
    tree: BoxTree
    evidence: dict[int, BoxEvidence] = field(default_factory=dict[int, BoxEvidence])
    """By the identity of a leaf."""

    def of(self, leaf: BoxTree) -> BoxEvidence | None:
        """What refutes a leaf."""
        return self.evidence.get(id(leaf))


@dataclass(frozen=True, slots=True)
class TaskEvidence:
    """What is refuted in a task, whatever its parameters are."""

    records: Sequence[StructureRecord]
    lemmas: Sequence[Lemma]
    separation: SeparationClaim | None = None


@dataclass(frozen=True, slots=True)
class ObjectiveValue:
    """What robots have of an objective; ``least``: none that does the mission has less."""

    objective: ir.Objective
    text: str
    value: Fraction
    least: Fraction
    unit: str = ""


@dataclass(frozen=True, slots=True)
class Existing:
    """The robot that there is before the first task."""

    word: tuple[str, ...]
    robot: Built


@dataclass(frozen=True, slots=True)
class MissionResult:
    """The verdict of a mission with what it rests on.

    ``designs`` are those of the tasks in their order, ``steps`` what is changed before each of
    them, of the first one only where there is a robot already.  ``modules`` is the bound within
    which robots were tried; ``by_default``: nobody asked for it.  ``undecided`` robots are neither
    found nor refuted; ``open_robots`` says which, and why.  ``ended`` is what ended the search
    without an answer, where something did.
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
