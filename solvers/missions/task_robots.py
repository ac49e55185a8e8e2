"""The robots of a family in one task of a mission: refuted, found or open.

A robot is examined in a box of its parameters, beginning with the whole box.  A refutation of the
whole box may yield a lemma about many other robots; a found robot has a design that the verifier's
own proof accepts.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import TypeAlias

from compiler.discretisation.numeric_robot import NumericRobot
from compiler.dynamics.equations_of_motion import robot_graph
from compiler.lemmas.variants import is_about_poses
from compiler.missions.parameter_boxes import Box, box_key, whole_box, within_box
from compiler.objectives.least_values import amounts
from compiler.robots.attributes import SemanticsError
from compiler.robots.candidate import Candidate, robot_in_task
from compiler.robots.normal_form import RobotFamily, family_of
from compiler.robots.robot import RobotModel
from compiler.robots.robot_key import robot_key_in_task
from compiler.tasks.obstacle_pieces import expanded
from compiler.tasks.specification import recorded_effector
from compiler.words.derivation import Derivation
from compiler.workspaces.abstraction import Abstraction, abstract
from grammar_lang import ir
from solvers.conclusion import StructureRecord
from solvers.impossibility.box_evidence import covered, out_of_reach_of_drives
from solvers.impossibility.box_refutation import WITH_PROOF, box_refutation
from solvers.impossibility.disconnection import disconnected, separation_text
from solvers.impossibility.distance_lemmas import distance_lemma
from solvers.impossibility.variant_lemmas import variant_lemma, weights_lemma
from solvers.lemma import Lemma
from solvers.missions.motions_sought import Listener, MotionsSought
from solvers.run_context import Journal, Memory, Recorded, RunContext
from solvers.search.design_values import design_values, limits_of
from solvers.search.objective_search import ObjectiveSearch
from solvers.search.path_search import PathSearch, StructureTask
from solvers.search.path_task import Design
from solvers.search.prefetch import Screening, screen, screening_of
from solvers.search.round_task import round_tasks
from solvers.search.shorter_motion import problem_along
from solvers.search.structure_search import StructureSearch
from solvers.trajectory.path_following import PathProblem
from solvers.verifier.claims.certificate import SeparationClaim

Labels: TypeAlias = tuple[str, ...]
NO_COVERING = "what a solver refutes has no covering by boxes"
"""Why a box of parameters is undecided although a solver refutes it."""


@dataclass(frozen=True, slots=True)
class Part:
    """A section of a journal, so that keys of different tasks, robots and boxes cannot clash."""

    journal: Journal
    name: str

    def recall(self, key: str) -> Recorded:
        """The result of a step finished earlier, or None."""
        return self.journal.recall(f"{self.name}|{key}")

    def record(self, key: str, value: Recorded) -> None:
        """Store the result of a finished step."""
        self.journal.record(f"{self.name}|{key}", value)


@dataclass(slots=True, eq=False)
class TaskRobots:
    """The robots of a family in one task; ``task`` belongs to ``program``, both without maps."""

    program: ir.Program
    task: ir.Task
    context: RunContext
    family: RobotFamily = field(init=False)
    cells: Abstraction = field(init=False)
    separation: SeparationClaim | None = field(init=False)
    records: dict[Labels, StructureRecord] = field(default_factory=dict[Labels, StructureRecord])
    """Structures refuted individually for all parameter values, in order of refutation."""
    lemmas: list[Lemma] = field(default_factory=list[Lemma])
    examined: set[Labels] = field(default_factory=set[Labels])
    screened: int = 0
    """The number of screenings, counting the boxes of a robot separately."""
    refuted: int = 0
    """The number of screenings that were refutations."""
    searched: int = 0
    """The number of searches for motions."""
    _asked: set[str] = field(default_factory=set[str])
    _keys: dict[str, Labels] = field(default_factory=dict[str, Labels])
    _models: dict[Labels, RobotModel | str] = field(default_factory=dict[Labels, RobotModel | str])

    def __post_init__(self) -> None:
        program, task = expanded(self.program, self.task)
        self.program, self.task = program, task
        self.cells = abstract(program.workspaces[task.workspace])
        self.family = family_of(program, task)
        self.separation = disconnected(program, task, self.cells)

    @property
    def separated(self) -> str:
        """Why no robot does the task; empty if its places are not separated from each other."""
        if self.separation is None:
            return ""
        return separation_text(self.program, self.task, self.separation)

    @property
    def success(self) -> float:
        """The share of refutations that succeeded, smoothed: one half if none was tried."""
        return (self.refuted + 1) / (self.screened + 2)

    @property
    def minimizes(self) -> bool:
        """Whether motions are worth improving: for objectives, or to take less time."""
        return self.task.at_most or bool(self.task.minimize)

    # --- robots ---------------------------------------------------------------------------------

    def model(self, derivation: Derivation) -> RobotModel | None:
        """The robot of a structure in the task, or None if it is not a robot."""
        known = self._models.get(derivation.labels)
        if known is None:
            try:
                known = robot_in_task(self.family, self.task.origin, derivation)
            except SemanticsError as error:
                known = str(error)
            self._models[derivation.labels] = known
        return None if isinstance(known, str) else known

    def fault(self, derivation: Derivation) -> str:
        """Why a structure is not a robot."""
        known = self._models.get(derivation.labels)
        return known if isinstance(known, str) else ""

    def box(self, derivation: Derivation) -> Box:
        """The box of all parameters of a structure; empty if it is not a robot."""
        model = self.model(derivation)
        return () if model is None else whole_box(model)

    # --- refutations ----------------------------------------------------------------------------

    def is_known(self, derivation: Derivation) -> bool:
        """Whether a structure is known to be refuted, on its own or by a lemma."""
        record = self.records.get(derivation.labels)
        if record is not None and record.verdict == "refuted":
            return True
        return any(lemma.is_about(derivation.word) for lemma in self.lemmas)

    def refutes(self, derivation: Derivation) -> bool:
        """Try to refute a structure for all parameter values; return whether it is refuted."""
        if self.is_known(derivation):
            return True
        model = self.model(derivation)
        if model is None:
            return False
        key = robot_key_in_task(model, self.task)
        first = self._keys.setdefault(key, derivation.labels)
        if first != derivation.labels:
            known = self.records.get(first)
            if known is not None and known.verdict == "refuted":
                self._refuted(derivation, replace(known, word=derivation.word), same=first)
                return True
            return False
        self.examined.add(derivation.labels)
        answer = self.answer(derivation, self.box(derivation)).refutation
        if not answer.refuted:
            return False
        record = StructureRecord(
            derivation.word, derivation.labels, "refuted", answer.reason, answer.script,
            boxes=answer.boxes,
        )  # fmt: skip
        self._refuted(derivation, record)
        return True

    def _refuted(
        self, derivation: Derivation, record: StructureRecord, same: Labels | None = None
    ) -> None:
        number = None if same is None else list(self.records).index(same)
        own = replace(record, derivation=derivation.labels, same_robot_as=number)
        self.records[derivation.labels] = own
        self.context.reporter.note(f"{self.task.name}: {' '.join(derivation.word)}: {own.reason}")

    def answer(self, derivation: Derivation, box: Box) -> Screening:
        """The screening of a structure with parameters in a box; the journal is consulted first.

        Raises:
            ValueError: the structure is not a robot.
        """
        model = self.model(derivation)
        if model is None:
            raise ValueError(f"{' '.join(derivation.word)} is no robot")
        self.context.check_time()
        journal = self.journal(derivation, box)
        new = journal.name not in self._asked
        self._asked.add(journal.name)
        self.screened += new
        found = screening_of(journal.recall("screened"))
        if found is None:
            narrow = within_box(model, box)
            numeric = NumericRobot(robot_graph(narrow, self.task.gravity))
            asked = replace(self.context, journal=Memory())
            found = screen(narrow, numeric, self.program, self.task, asked)
            journal.record("screened", found.record())
        self.refuted += new and found.refutation.refuted
        return found

    def covering(self, derivation: Derivation, box: Box) -> str | None:
        """A covering of a structure that is refuted in a box, or None if none is found."""
        found = self.answer(derivation, box).refutation.boxes
        if found is not None:
            return found
        journal, model = self.journal(derivation, box), self.model(derivation)
        known = journal.recall("boxes")
        if not isinstance(known, str) and model is not None:
            narrow = within_box(model, box)
            graph, workspace = robot_graph(narrow, self.task.gravity), self.workspace
            answer = box_refutation(narrow, graph, workspace, self.task, WITH_PROOF)
            known = "" if answer is None else answer.boxes
            journal.record("boxes", known)
        return known if isinstance(known, str) and known else None

    @property
    def workspace(self) -> ir.Workspace:
        """The workspace of the task."""
        return self.program.workspaces[self.task.workspace]

    def journal(self, derivation: Derivation, box: Box) -> Part:
        """The section of the journal about a structure in a box."""
        name = f"{self.task.name}|{' '.join(derivation.labels)}|{box_key(box)}"
        return Part(self.context.journal, name)

    def teaches(self, derivation: Derivation) -> Lemma | None:
        """A lemma from a refuted structure; None if there is none or an earlier one covers it."""
        record = self.records.get(derivation.labels)
        known = any(lemma.is_about(derivation.word) for lemma in self.lemmas)
        if record is None or known or not self.context.lemmas:
            return None
        by_poses = record.script is not None or (
            record.boxes is not None and is_about_poses(record.boxes)
        )
        lemma: Lemma | None = distance_lemma(self.family, self.task, derivation.word)
        if lemma is None:
            about = variant_lemma if by_poses else weights_lemma
            lemma = about(self.family, self.task, derivation)
        if lemma is not None:
            self.lemmas[:] = [each for each in self.lemmas if not lemma.covers(each)] + [lemma]
        return lemma

    # --- motions --------------------------------------------------------------------------------

    def motions(self, derivation: Derivation, box: Box, number: int) -> MotionsSought:
        """The search for motions of a structure with parameters in a box.

        Raises:
            ValueError: the structure is not a robot.
        """
        model = self.model(derivation)
        if model is None:
            raise ValueError(f"{' '.join(derivation.word)} is no robot")
        self.searched += 1
        narrow, listener = within_box(model, box), Listener()
        self.context.reporter.structure(number, derivation.word)
        given = self._given(derivation, box, narrow, number, listener)
        search = ObjectiveSearch if self.minimizes else StructureSearch
        states = search(given, self.cells).states(self.effectors(derivation, narrow, box))
        return MotionsSought(states, listener, self.best_of)

    def open_motions(self, derivation: Derivation, box: Box, number: int) -> MotionsSought | None:
        """The search for motions as of ``motions``; None if the robot is refuted or inadmissible.

        Raises:
            ValueError: the structure is not a robot.
        """
        screening = self.answer(derivation, box)
        if screening.refutation.refuted or screening.inadmissible is not None:
            return None
        return self.motions(derivation, box, number)

    def _given(
        self, derivation: Derivation, box: Box, model: RobotModel, number: int, listener: Listener
    ) -> StructureTask:
        """The search task for a structure whose robot has its parameters in a box."""
        return StructureTask(
            program=self.program,
            task=self.task,
            context=replace(self.context, journal=self.journal(derivation, box)),
            derivation=derivation,
            numeric=NumericRobot(robot_graph(model, self.task.gravity)),
            number=number,
            robot=robot_key_in_task(model, self.task),
            listener=listener,
        )

    def path_problem(self, design: Design, box: Box) -> PathProblem | None:
        """The problem of motions along the cells of a design, with parameters in a box.

        None if the task's formulas do not allow it.
        """
        model, steps = self.model(design.derivation), len(design.inputs)
        if model is None:
            return None
        narrow = within_box(model, box)
        given = self._given(design.derivation, box, narrow, 0, Listener())
        given = replace(given, task=self.task.lasting(steps))
        paths = PathSearch(given, round_tasks(given.task, design.effector)[0], design.effector)
        return problem_along(paths, design.abstraction, design, steps)

    def best_of(self, designs: Sequence[Design]) -> Design:
        """The best of some designs by the task's objectives; the most robust of equal ones."""
        asked = amounts(self.program, self.task)
        ranked = sorted(designs, key=lambda design: -design.robustness)
        values = [design_values(design, asked, self.task) for design in ranked]
        _, first = limits_of(values, asked)
        return ranked[first or 0]

    def effectors(self, derivation: Derivation, model: RobotModel, box: Box) -> list[int]:
        """The effectors that may start and reach, beginning with the one in the poses found."""
        bound = recorded_effector(self.task)
        if bound is not None:
            return [bound] if bound < len(model.effectors) else []
        found = screening_of(self.journal(derivation, box).recall("screened"))
        first = None if found is None else found.refutation.effector
        return sorted(range(len(model.effectors)), key=lambda e: (e != first, e))

    def too_weak(self, derivation: Derivation, box: Box) -> str | None:
        """A covering that shows the drives of a robot without a motion to be too weak, or None."""
        model = self.model(derivation)
        if model is None:
            return None
        context = replace(self.context, journal=self.journal(derivation, box))
        candidate = Candidate(0, derivation, within_box(model, box))
        late = out_of_reach_of_drives(candidate, self.program, self.task, context)
        if late is None:
            return None
        if box == self.box(derivation):
            record = StructureRecord(
                derivation.word, derivation.labels, "refuted", late.reason, boxes=late.boxes
            )
            self._refuted(derivation, record)
        return late.boxes

    # --- evidence -------------------------------------------------------------------------------

    def evidence(self) -> list[StructureRecord]:
        """The refutations; coverings are added to solvers' answers if they are found."""
        part = Part(self.context.journal, f"{self.task.name}|covered")
        context = replace(self.context, journal=part)
        found, late = covered(list(self.records.values()), self.family, self.task, context)
        if late is not None:
            raise late
        return found
