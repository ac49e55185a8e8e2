"""The robots that a mission's evidence refutes: structures, words of lemmas, parameter boxes."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from compiler.missions.parameter_boxes import BoxTree, Cut, whole_box, within_box
from compiler.robots.attributes import SemanticsError
from compiler.robots.candidate import Candidate, robot_in_task
from compiler.robots.normal_form import RobotFamily, family_of
from compiler.robots.robot import RobotModel
from compiler.tasks.obstacle_pieces import expanded
from compiler.words.derivation import BadDerivation, Derivation
from compiler.workspaces.abstraction import abstract
from grammar_lang import ir
from solvers.verifier.claims.certificate import ImpossibleClaim, exact
from solvers.verifier.claims.mission_claim import (
    BoxesClaim,
    LeafClaim,
    MissionClaim,
    TaskClaim,
    TreeClaim,
)
from solvers.verifier.proofs.scene import Watch
from solvers.verifier.refutations.impossibility_check import refuted_structures
from solvers.verifier.refutations.lemma_check import checked_lemma
from solvers.verifier.refutations.separation_check import misstated_separation
from solvers.verifier.refutations.solver_process import SmtSolver
from solvers.verifier.refutations.structure_evidence import Evidence, FalseClaim
from solvers.verifier.refutations.word_coverage import Reader, reader

Labels = tuple[str, ...]


@dataclass(slots=True)
class RefutedRobots:
    """What is refuted in one task; ``task`` is a task of ``program``, both without maps.

    ``by_boxes`` says of each piece of evidence whether it is a covering, which needs no solver.
    """

    program: ir.Program
    task: ir.Task
    evidence: Evidence
    family: RobotFamily
    structures: set[Labels] = field(default_factory=set[Labels])
    conditions: list[ir.Accept] = field(default_factory=list[ir.Accept])
    readers: list[Reader] = field(default_factory=list[Reader])
    trees: dict[Labels, BoxTree] = field(default_factory=dict[Labels, BoxTree])
    by_boxes: list[bool] = field(default_factory=list[bool])
    separated: bool = False

    def is_refuted(self, derivation: Derivation) -> bool:
        """Whether a structure is refuted for all its parameters."""
        return derivation.labels in self.structures or self.has_lemma(derivation.word)

    def has_lemma(self, word: Sequence[str]) -> bool:
        """Whether a lemma covers a word."""
        return any(_accepts(each, word) for each in self.readers)

    def model(self, derivation: Derivation) -> RobotModel | None:
        """The robot of a structure; None if the structure is not a robot."""
        try:
            return robot_in_task(self.family, self.task.origin, derivation)
        except SemanticsError:
            return None


def _accepts(each: Reader, word: Sequence[str]) -> bool:
    state = each.first
    for symbol in word:
        state = each.step(state, symbol)
    return each.accepts(state)


def refuted_robots(
    folder: Path,
    claim: MissionClaim,
    program: ir.Program,
    tasks: Sequence[str],
    trust: tuple[SmtSolver, ...],
    watch: Watch,
) -> list[RefutedRobots]:
    """What the evidence refutes in each task, in order; the boxes of one task count in that task.

    Raises:
        FalseClaim: a piece of evidence does not prove what it claims.
    """
    if [each.task for each in claim.tasks] != list(tasks):
        raise FalseClaim("the evidence is not that of the tasks of the mission")
    found = [_of_task(folder, claim, each, program, trust, watch) for each in claim.tasks]
    for boxes in claim.boxes:
        if boxes.task is not None:
            if not 0 <= boxes.task < len(found):
                raise FalseClaim(f"there is no task {boxes.task}")
            tree = tree_of(boxes, found)
            found[boxes.task].trees[boxes.derivation] = tree
    return found


def _of_task(
    folder: Path,
    claim: MissionClaim,
    own: TaskClaim,
    program: ir.Program,
    trust: tuple[SmtSolver, ...],
    watch: Watch,
) -> RefutedRobots:
    program, task = expanded(program, program.tasks[own.task])
    family, evidence = family_of(program, task), Evidence(folder, program, task, trust)
    found = RefutedRobots(program, task, evidence, family)
    if own.separation is not None:
        cells = abstract(program.workspaces[task.workspace])
        reason = misstated_separation(program, task, cells, own.separation)
        if reason is not None:
            raise FalseClaim(reason)
        found.separated = True
    for number, lemma in enumerate(own.lemmas, 1):
        checked = checked_lemma(number, lemma, family, evidence)
        found.conditions.append(checked.condition)
        found.readers.append(reader(checked.condition))
        if checked.by_boxes is not None:
            found.by_boxes.append(checked.by_boxes)
    impossible = ImpossibleClaim(
        own.task, claim.spec, claim.spec_sha256, None, own.structures, None, own.lemmas
    )
    due = _listed(own, family, task)
    found.by_boxes += refuted_structures(evidence, impossible, due, watch)
    found.structures |= {each.derivation for each in own.structures}
    return found


def _listed(own: TaskClaim, family: RobotFamily, task: ir.Task) -> Iterator[Candidate]:
    """The listed structures, rebuilt from the family."""
    for number, each in enumerate(own.structures):
        derivation = replayed(family, each.derivation)
        try:
            yield Candidate(number, derivation, robot_in_task(family, task.origin, derivation))
        except SemanticsError as error:
            yield Candidate(number, derivation, None, str(error))


def replayed(family: RobotFamily, labels: Labels) -> Derivation:
    """The derivation with these labels.

    Raises:
        FalseClaim: there is no such derivation.
    """
    try:
        return family.replay(labels)
    except BadDerivation as error:
        raise FalseClaim(f"`{' '.join(labels)}` is not a derivation: {error}") from None


# --- Boxes of parameters --------------------------------------------------------------------------


def tree_of(claim: BoxesClaim, tasks: Sequence[RefutedRobots]) -> BoxTree:
    """The boxes of a structure's parameters, with those marked that a covering refutes.

    Raises:
        FalseClaim: a covering does not refute its box, or the boxes are malformed.
    """
    first = tasks[claim.task or 0]
    derivation = replayed(first.family, claim.derivation)
    model = first.model(derivation)
    if derivation.word != claim.word or model is None:
        raise FalseClaim(f"`{' '.join(claim.word)}` is not a robot with that derivation")
    tree = BoxTree(whole_box(model))
    _check_tree(claim, claim.tree, tree, derivation, tasks)
    return tree


def _check_tree(
    claim: BoxesClaim,
    stated: TreeClaim,
    tree: BoxTree,
    derivation: Derivation,
    tasks: Sequence[RefutedRobots],
) -> None:
    if stated is None:
        return
    if isinstance(stated, LeafClaim):
        if not 0 <= stated.task < len(tasks) or claim.task not in (None, stated.task):
            raise FalseClaim(f"there is no task {stated.task} for these boxes")
        robots = tasks[stated.task]
        model = robots.model(derivation)
        if model is None or len(model.parameters) != len(tree.box):
            raise FalseClaim(f"`{' '.join(claim.word)}` has other parameters in another task")
        name = f"the robots of {' '.join(claim.word)} in a box"
        robots.by_boxes.append(
            robots.evidence.refutes(name, None, stated.boxes, within_box(model, tree.box))
        )
        tree.refuted = True
        return
    at = stated.at if isinstance(stated.at, int) else exact(stated.at)
    try:
        parts = tree.split(Cut(stated.parameter, at))
    except ValueError as error:
        raise FalseClaim(f"boxes of {' '.join(claim.word)}: {error}") from None
    for part, own in zip(parts, stated.parts, strict=True):
        _check_tree(claim, own, part, derivation, tasks)
