"""Refutations of all structures of a family in its task with fewer resources, step by step.

A larger step leaves fewer resources: less effort, or less time.  Refutations by poses hold at every
step.  For the other structures, the least step is sought at which their drives are shown to be too
weak.  The result is a proof only after the verifier has checked it again.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import NoReturn, Protocol

from compiler.discretisation.numeric_robot import NumericRobot
from compiler.dynamics.equations_of_motion import robot_graph
from compiler.lemmas.variants import is_about_poses
from compiler.lemmas.weighted import weighted_robot
from compiler.robots.candidate import Candidate, robot_in_task
from compiler.robots.normal_form import RobotFamily, family_of
from compiler.robots.robot import RobotModel
from compiler.robots.robot_key import robot_key_in_task
from compiler.words.derivation import Derivation
from compiler.words.structures import InfiniteAmbiguityError
from grammar_lang import ir
from solvers.conclusion import (
    DEFAULT_MODULES,
    StructureRecord,
    StructureVerdict,
    robot_limit,
    with_lemmas,
)
from solvers.impossibility.box_refutation import WITH_PROOF, box_refutation
from solvers.impossibility.drive_search import DriveEffort, drive_refutation
from solvers.impossibility.structure_refutation import refute_structure
from solvers.impossibility.variant_lemmas import weights_lemma
from solvers.lemma import Lemma, VariantLemma, WeightsLemma
from solvers.run_context import RunContext, Silent
from solvers.search.structures_left import StructuresLeft
from solvers.verifier.refutations.box_check import why_not

FINE = 1_000
"""The least step of a structure is sought to a relative accuracy of 1 / ``FINE``."""
MOST_STRUCTURES = 200
"""The largest number of structures refuted one by one for a bound."""


class Narrowing(Protocol):
    """A way to reduce the resources of a task step by step."""

    @property
    def most(self) -> int:
        """The largest step."""
        ...

    @property
    def name(self) -> str:
        """The name of this kind of narrowing in journals."""
        ...

    @property
    def none(self) -> str:
        """The message that no step leaves too little; the caller appends whose drives."""
        ...

    @property
    def reason(self) -> str:
        """Why structures are refuted at a step."""
        ...

    def at(self, program: ir.Program, task: ir.Task, step: int) -> tuple[ir.Program, ir.Task]:
        """The program and its task at a step; unchanged at step 0."""
        ...


@dataclass(frozen=True, slots=True)
class NarrowedFamily:
    """Evidence that no robot of at most ``modules`` modules does the task at ``step``.

    ``modules`` is None if the evidence is about the whole family.  ``records`` are the structures
    that no lemma covers, each with a covering, and the base structures of the ``lemmas``.
    """

    step: int
    modules: int | None
    records: tuple[StructureRecord, ...]
    lemmas: tuple[Lemma, ...]


class NoBoundError(Exception):
    """No bound was found; the message says why."""


@dataclass(frozen=True, slots=True)
class Tried:
    """The results of the search of a family so far: its structures and its lemmas."""

    records: Sequence[StructureRecord]
    lemmas: Sequence[Lemma]


def narrowed_family(
    family: RobotFamily,
    task: ir.Task,
    context: RunContext,
    tried: Tried,
    narrowing: Narrowing,
    first: int,
    effort: DriveEffort,
) -> NarrowedFamily:
    """The least step found at which no structure of a family does its task.

    Args:
        family: the whole family of the task, without maps.
        task: the task, without maps; without a bound on modules and with an infinite language, the
            evidence is about ``DEFAULT_MODULES``.
        context: how to search; its journal avoids repeating questions.
        tried: what is known of the family.
        narrowing: how resources are reduced.
        first: the first step to try.
        effort: how hard to try to show that drives are too weak.

    Raises:
        NoBoundError: if no bound was found.
    """
    modules = task.modules if robot_limit(family, task) is None else DEFAULT_MODULES
    silent = replace(context, reporter=Silent())
    asked = replace(task, modules=modules)
    search = _Search(family, asked, silent, tried, effort, narrowing, first)
    try:
        search.refute_all()
    except InfiniteAmbiguityError as error:
        raise NoBoundError(str(error)) from None
    return search.result(modules)


@dataclass(slots=True)
class _Evidence:
    """A covering, and the step from which it holds; 0 if it rests on poses alone."""

    boxes: str
    step: int


@dataclass(slots=True)
class _Search:
    """The search in progress; all structures so far are refuted at ``step``."""

    family: RobotFamily
    task: ir.Task
    context: RunContext
    tried: Tried
    effort: DriveEffort
    narrowing: Narrowing
    step: int = 0
    lemmas: list[Lemma] = field(default_factory=list[Lemma])
    found: list[tuple[Derivation, _Evidence, int | None]] = field(
        default_factory=list[tuple[Derivation, _Evidence, int | None]]
    )
    """Structures in order, each with the index of the first one that is the same robot."""
    narrow: dict[int, tuple[RobotFamily, ir.Task]] = field(
        default_factory=dict[int, tuple[RobotFamily, ir.Task]]
    )

    def refute_all(self) -> None:
        """Refute every structure that no lemma covers, raising the step as required."""
        self._known_lemmas()
        program = self.family.program
        left = StructuresLeft(program, self.task, self.context, self.family, self.lemmas)
        seen: dict[str, int] = {}
        while left.following is not None:
            self.context.check_time()
            if len(left.tried) == MOST_STRUCTURES:
                raise NoBoundError(f"the family has more than {MOST_STRUCTURES} structures")
            candidate = left.taken()
            model = _model(candidate)
            first = seen.setdefault(robot_key_in_task(model, self.task), len(self.found))
            if first < len(self.found):
                self.found.append((candidate.derivation, self.found[first][1], first))
                left.go_on()
                continue
            evidence = self._refuted(candidate, model)
            self.found.append((candidate.derivation, evidence, None))
            left.go_on()
            self._learn(left, candidate, evidence)

    def _learn(self, left: StructuresLeft, candidate: Candidate, evidence: _Evidence) -> None:
        if evidence.step == 0:
            left.learn(candidate, by_poses=True)
        elif left.following is not None and self.context.lemmas:
            narrow, due = self._narrowed(self.step)
            lemma = weights_lemma(narrow, due, candidate.derivation, self.effort)
            if lemma is not None:
                left.add(lemma, candidate.derivation.word)

    def _known_lemmas(self) -> None:
        """Keep the lemmas of the search that do not depend on drives, if coverings prove them."""
        known = {record.derivation: record for record in self.tried.records}
        for lemma in self.tried.lemmas:
            if isinstance(lemma, WeightsLemma):
                continue
            if isinstance(lemma, VariantLemma):
                derivation = self.family.replay(lemma.labels)
                model = robot_in_task(self.family, self.task.origin, derivation)
                boxes = self._by_poses(known[lemma.labels], model)
                if boxes is None:
                    continue
                self.found.append((derivation, _Evidence(boxes, 0), None))
            self.lemmas.append(lemma)

    # --- one structure --------------------------------------------------------------------------

    def _refuted(self, candidate: Candidate, model: RobotModel) -> _Evidence:
        """The evidence about a structure, at the least step found."""
        derivation = candidate.derivation
        known = {record.derivation: record for record in self.tried.records}
        record = known.get(derivation.labels)
        if record is not None and record.verdict == "refuted":
            boxes = self._by_poses(record, model)
            if boxes is not None:
                return _Evidence(boxes, 0)
        boxes = self._by_drives(derivation, self.step)
        if boxes is not None:
            return _Evidence(boxes, self.step)
        if record is None:
            boxes = self._by_poses(self._screened(derivation, model), model)
            if boxes is not None:
                return _Evidence(boxes, 0)
        return self._risen(derivation)

    def _risen(self, derivation: Derivation) -> _Evidence:
        """The evidence at the least step found, which becomes the step of the search."""
        low, high = self.step, self.narrowing.most
        boxes = self._by_drives(derivation, high)
        if boxes is None:
            word = " ".join(derivation.word)
            raise NoBoundError(f"{self.narrowing.none} for the drives of {word}")
        while high - low > max(1, low // FINE):
            middle = (low + high) // 2
            better = self._by_drives(derivation, middle)
            if better is None:
                low = middle
            else:
                high, boxes = middle, better
        self.step = high
        return _Evidence(boxes, high)

    def _by_drives(self, derivation: Derivation, step: int) -> str | None:
        """A covering that shows the drives to be too weak at a step; None if none is found."""
        key = (
            f"{self.narrowing.name}|{' '.join(derivation.labels)}|{step}|{max(self.effort.leaves)}"
        )
        known = self.context.journal.recall(key)
        if not isinstance(known, str):
            self.context.check_time()
            narrow, due = self._narrowed(step)
            model = robot_in_task(narrow, due.origin, derivation)
            workspace, graph = self._workspace, robot_graph(model, due.gravity)
            answer = drive_refutation(model, graph, workspace, due, self.effort)
            known = "" if answer is None else answer.boxes
            self.context.journal.record(key, known)
        return known or None

    def _by_poses(self, record: StructureRecord, model: RobotModel) -> str | None:
        """A covering of a refuted structure by poses alone; None if none is found."""
        if record.boxes is not None and is_about_poses(record.boxes):
            return record.boxes
        if record.script is None:
            return None
        key = f"{self.narrowing.name}|{' '.join(record.derivation)}"
        known = self.context.journal.recall(key)
        if not isinstance(known, str):
            graph = robot_graph(model, self.task.gravity)
            answer = box_refutation(model, graph, self._workspace, self.task, WITH_PROOF)
            known = "" if answer is None else answer.boxes
            self.context.journal.record(key, known)
        return known or None

    def _screened(self, derivation: Derivation, model: RobotModel) -> StructureRecord:
        """The record of a structure that the search has not tried, after trying to refute it."""
        numeric = NumericRobot(robot_graph(model, self.task.gravity))
        program = self.family.program
        answer = refute_structure(model, numeric, program, self.task, self.context)
        verdict: StructureVerdict = "refuted" if answer.refuted else "unresolved"
        return StructureRecord(
            derivation.word, derivation.labels, verdict, answer.reason, answer.script,
            boxes=answer.boxes,
        )  # fmt: skip

    # --- the task with fewer resources ----------------------------------------------------------

    @property
    def _workspace(self) -> ir.Workspace:
        return self.family.program.workspaces[self.task.workspace]

    def _narrowed(self, step: int) -> tuple[RobotFamily, ir.Task]:
        """The family and its task at a step."""
        if step not in self.narrow:
            program, task = self.narrowing.at(self.family.program, self.task, step)
            self.narrow[step] = family_of(program, task), task
        return self.narrow[step]

    # --- all structures at one step -------------------------------------------------------------

    def result(self, modules: int | None) -> NarrowedFamily:
        """The evidence at the step at which all structures are refuted.

        Raises:
            NoBoundError: if evidence found at a smaller step does not hold at this one.
        """
        records = [self._record(*found) for found in self.found]
        lemmas = [self._held(lemma) for lemma in self.lemmas]
        return NarrowedFamily(self.step, modules, with_lemmas(records, lemmas), tuple(lemmas))

    def _record(
        self, derivation: Derivation, evidence: _Evidence, first: int | None
    ) -> StructureRecord:
        """The record of a structure, with a covering that holds at the final step."""
        if 0 < evidence.step < self.step:
            narrow, due = self._narrowed(self.step)
            model = robot_in_task(narrow, due.origin, derivation)
            if why_not(evidence.boxes, model, self._workspace, due) is not None:
                evidence.boxes = self._by_drives(derivation, self.step) or _lost(derivation)
            evidence.step = self.step
        return StructureRecord(
            derivation.word, derivation.labels, "refuted", self.narrowing.reason,
            same_robot_as=first, boxes=evidence.boxes,
        )  # fmt: skip

    def _held(self, lemma: Lemma) -> Lemma:
        """The lemma, after checking that its covering holds at the final step."""
        if not isinstance(lemma, WeightsLemma):
            return lemma
        narrow, due = self._narrowed(self.step)
        base = narrow.replay(lemma.labels)
        model = weighted_robot(narrow, due, base, lemma.most)
        if model is None or why_not(lemma.boxes, model, self._workspace, due) is not None:
            _lost(base)
        return lemma


def _model(candidate: Candidate) -> RobotModel:
    """The robot of a structure; NoBoundError if it has none and so cannot be refuted."""
    if candidate.model is None:
        word = " ".join(candidate.derivation.word)
        raise NoBoundError(f"{word} is not a robot: {candidate.fault}")
    return candidate.model


def _lost(derivation: Derivation) -> NoReturn:
    word = " ".join(derivation.word)
    raise NoBoundError(f"what refutes {word} with more to do with does not with less")
