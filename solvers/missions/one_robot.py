"""One robot for all tasks of a mission: the same word, and one value of every parameter.

Structures are tried in the order of the objective.  For each, one task after another is tried,
beginning with those in which most structures were refuted so far; the first task that refutes a
structure ends it.  If every task has a motion, but with different parameters, the box of parameters
is cut between their values, and the parts are tried in the same way.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace

from compiler.missions.parameter_boxes import BoxTree, choices_halved
from compiler.objectives.least_values import Amount, amounts
from compiler.objectives.ordered_structures import Limit, structures_by
from compiler.robots.candidate import Candidate as Structure
from compiler.robots.normal_form import RobotFamily
from compiler.robots.robot_key import robot_key_in_task
from compiler.time_limits.time_limit import current_limit
from compiler.words.derivation import Derivation
from grammar_lang import ir
from solvers.conclusion import MOTION_SEARCHES
from solvers.lemma import Lemma
from solvers.missions.mission_result import BoxEvidence, CutRobot
from solvers.missions.shared_values import (
    Candidate,
    Group,
    agreed,
    cut_between,
    is_within,
    proved_at_once,
    widest_disagreement,
)
from solvers.missions.task_robots import NO_COVERING, Labels, TaskRobots
from solvers.missions.undecided_robots import Undecided
from solvers.search.least_search import searched_modules
from solvers.search.path_task import Design
from solvers.search.structures_left import StructuresLeft

MOST_LEAVES = 24
"""The most boxes tried for one structure."""
MANY_LEAVES = f"no common parameters were found in {MOST_LEAVES} boxes"
UNSUITED = "its parameters do not suit all tasks at once"


@dataclass(slots=True)
class OneRobotSearch:
    """The search in progress; ``found`` are the designs of the best robot, one for each task."""

    tasks: Sequence[TaskRobots]
    mission: ir.Mission
    found: tuple[Design, ...] = ()
    incumbent: tuple[Design, ...] = ()
    """Designs that were proved at once, in case the time is up before better ones."""
    stopped: str | None = None
    cut: dict[Labels, CutRobot] = field(default_factory=dict[Labels, CutRobot])
    undecided: dict[Labels, Undecided] = field(default_factory=dict[Labels, Undecided])
    """Structures that are neither found nor refuted, and why."""
    words: dict[Labels, tuple[str, ...]] = field(default_factory=dict[Labels, tuple[str, ...]])
    """All structures that were tried."""
    left: StructuresLeft = field(init=False)
    amounts: tuple[Amount, ...] = field(init=False)
    lemmas: list[Lemma] = field(default_factory=list[Lemma])
    _place: int = 0
    _best: Structure | None = None
    _seen: dict[str, Labels] = field(default_factory=dict[str, Labels])

    def __post_init__(self) -> None:
        first = self.tasks[0]
        asked = _bounded(self.tasks, self.mission)
        self.amounts = tuple(each for each in amounts(first.program, asked) if each.is_ordering)

    @property
    def task(self) -> ir.Task:
        """The first task, with the mission's objectives and the smallest bound on modules."""
        return _bounded(self.tasks, self.mission)

    def search(self) -> None:
        """Try structures until one does all tasks and no other one may have less."""
        first, tried = self.tasks[0], set[Labels]()
        for place in range(max(1, len(self.amounts))):
            self._place = place
            order = self._order if self.amounts else None
            self.left = StructuresLeft(
                first.program, self.task, first.context, first.family, self.lemmas, tried, order
            )
            while self.left.following is not None and not self._may_stop():
                structure = self.left.taken()
                self.left.go_on()
                self._examine(structure)
            if not self.found:
                return

    def _may_stop(self) -> bool:
        """Whether no remaining structure has less than the robot found, or a limit is reached."""
        following = self.left.following
        if self._best is not None and following is not None:
            if not self.amounts:
                return True
            amount, word = self.amounts[self._place], following.derivation.word
            if amount.of_robot(word, following.model) >= amount.of_word(self._best.derivation.word):
                return True
        if len(self.undecided) >= MOTION_SEARCHES:
            self.stopped = (
                f"the search ended at its limit of {MOTION_SEARCHES} robots that were neither "
                "found nor refuted"
            )
        return self.stopped is not None

    def _order(self, family: RobotFamily) -> Iterator[Structure]:
        """The structures within the limits so far, in the order of the current objective."""
        limits: list[Limit] = []
        if self._best is not None:
            for amount in self.amounts[: self._place]:
                least = amount.of_word(self._best.derivation.word)
                limits.append(Limit(amount, least, least))
        bound = searched_modules(family, self.task, self.amounts)
        return structures_by(self.amounts[self._place], family, bound, limits, None)

    # --- one structure --------------------------------------------------------------------------

    def _examine(self, structure: Structure) -> None:
        """Refute a structure in some task, find designs, or leave it undecided."""
        derivation = structure.derivation
        self.words[derivation.labels] = derivation.word
        for robots in sorted(self.tasks, key=lambda each: -each.success):
            if robots.model(derivation) is None:
                number = self.tasks.index(robots)
                self.undecided[derivation.labels] = Undecided(robots.fault(derivation), number)
                return
            if robots.refutes(derivation):
                self._learn(robots, derivation)
                return
        same = self._seen.setdefault(self._key(derivation), derivation.labels)
        if same != derivation.labels and same in self.undecided:
            self.undecided[derivation.labels] = self.undecided[same]
            return
        tree = BoxTree(self.tasks[0].box(derivation))
        cut = CutRobot(None, derivation.word, derivation.labels, tree)
        reason = self._boxes(structure, cut)
        if self._is_refuted(derivation):
            return
        if tree.parts is not None:
            self.cut[derivation.labels] = cut
        if reason is not None and not tree.is_refuted:
            self.undecided[derivation.labels] = reason

    def _key(self, derivation: Derivation) -> str:
        """A text that is equal for two structures only if they are the same robot in all tasks."""
        models = ((each.model(derivation), each.task) for each in self.tasks)
        return "||".join(
            robot_key_in_task(model, task) for model, task in models if model is not None
        )

    def _is_refuted(self, derivation: Derivation) -> bool:
        return any(robots.is_known(derivation) for robots in self.tasks)

    def _learn(self, robots: TaskRobots, derivation: Derivation) -> None:
        """Narrow the remaining family by what the refutation of a structure implies."""
        lemma = robots.teaches(derivation)
        if lemma is not None and self.left.following is not None:
            self.left.add(lemma, derivation.word)
        kept = [id(each) for each in self.left.lemmas]
        for each in self.tasks:
            each.lemmas[:] = [known for known in each.lemmas if id(known) in kept]

    def _boxes(self, structure: Structure, cut: CutRobot) -> Undecided | None:
        """Try the boxes of a structure; return why some remain open, or None if none does."""
        waiting, asked = [cut.tree], 0
        open_ones: Undecided | None = None
        known: list[Candidate] = []
        while waiting:
            if asked == MOST_LEAVES:
                return Undecided(MANY_LEAVES, apart=True)
            asked += 1
            box = waiting.pop(0)
            candidates = self._candidates(structure, box, cut, known)
            if candidates is None:
                continue
            if isinstance(candidates, Undecided):
                choices = choices_halved(box.box)
                if choices is None:
                    open_ones = open_ones or candidates
                else:
                    waiting += box.split(choices)
                continue
            known += candidates
            groups = self._groups(len(box.box))
            result = agreed(candidates, groups, {}, structure.number)
            if result is not None:
                self.found, self._best = result.designs, structure
                return None
            parts = _cut(candidates, groups, box, cut)
            if not parts:
                open_ones = open_ones or Undecided(UNSUITED, apart=True)
            waiting += parts
        return open_ones

    def _candidates(
        self, structure: Structure, box: BoxTree, cut: CutRobot, known: Sequence[Candidate]
    ) -> list[Candidate] | Undecided | None:
        """A motion for each task with parameters in a box; None if it is refuted; else why not.

        Motions in ``known`` are not searched for again.
        """
        found: dict[int, Candidate] = {}
        for each in known:
            if is_within(each.design, box.box):
                found[self.tasks.index(each.robots)] = replace(each, box=box.box)
        ranked = sorted(range(len(self.tasks)), key=lambda k: -self.tasks[k].success)
        due = [k for k in ranked if k not in found]
        for k in due:
            reason = self._screened(k, structure, box, cut)
            if reason is None or reason:
                return None if reason is None else Undecided(reason, k)
        if len(due) == len(self.tasks) > 1 and current_limit() and not self.found:
            self._prove_at_once(structure, box)
        for k in due:
            moving = self._moving(k, structure, box, cut)
            if not isinstance(moving, Candidate):
                return moving
            found[k] = moving
        return [found[k] for k in range(len(self.tasks))]

    def _prove_at_once(self, structure: Structure, box: BoxTree) -> None:
        """Look for first designs with parameters in a box, if there are none of any structure."""
        if not self.incumbent:
            robots = [(each, structure.derivation, box.box) for each in self.tasks]
            groups = self._groups(len(box.box))
            self.incumbent = proved_at_once(robots, groups, {}, structure.number) or ()

    def _screened(self, k: int, structure: Structure, box: BoxTree, cut: CutRobot) -> str | None:
        """None if a task refutes a box; else why no motion is sought, or an empty text."""
        robots, derivation = self.tasks[k], structure.derivation
        screening = robots.answer(derivation, box.box)
        if not screening.refutation.refuted:
            return screening.inadmissible or ""
        boxes = robots.covering(derivation, box.box)
        if boxes is None:
            return NO_COVERING
        box.refuted, cut.evidence[id(box)] = True, BoxEvidence(k, boxes)
        return None

    def _moving(
        self, k: int, structure: Structure, box: BoxTree, cut: CutRobot
    ) -> Candidate | Undecided | None:
        """A motion for a task with parameters in a box; None if it is refuted; else why not."""
        robots, derivation = self.tasks[k], structure.derivation
        sought = robots.motions(derivation, box.box, structure.number)
        design = sought.first()
        if design is not None:
            return Candidate(robots, derivation, box.box, design)
        late = robots.too_weak(derivation, box.box)
        if late is None:
            return sought.undecided(k)
        box.refuted, cut.evidence[id(box)] = True, BoxEvidence(k, late)
        if box is cut.tree:
            self._learn(robots, derivation)
        return None

    def _groups(self, count: int) -> list[Group]:
        """Groups of equal parameters: each of the ``count`` has one value in all tasks."""
        return [tuple((k, p) for k in range(len(self.tasks))) for p in range(count)]


def _bounded(tasks: Sequence[TaskRobots], mission: ir.Mission) -> ir.Task:
    """The first task, with a mission's objectives and the smallest bound on modules."""
    bounds = [each.task.modules for each in tasks if each.task.modules is not None]
    task = tasks[0].task
    return replace(task, minimize=mission.minimize, modules=min(bounds, default=None), origin=None)


def _cut(
    candidates: Sequence[Candidate], groups: Sequence[Group], box: BoxTree, cut: CutRobot
) -> tuple[BoxTree, ...]:
    """The parts of a box between whose values robots disagree; empty if it cannot be cut."""
    whole = [cut.tree.box] * len(candidates)
    widest = widest_disagreement(candidates, groups, whole)
    if widest is None:
        return ()
    group, low, high = widest
    where = cut_between(box.box, group[0][1], low, high)
    return () if where is None else box.split(where)
