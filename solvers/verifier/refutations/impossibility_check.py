"""Check ``impossible``: every structure up to the bound has to be refuted by its evidence.

The structures are enumerated again. A covering by boxes is replayed, and no solver is trusted. A
script is generated again from the spec and compared byte for byte; only the solver's ``unsat`` has
to be trusted, unless a solver runs the script again in a process of its own. If places are
separated from each other, the cells are computed again, and no solver is trusted.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from compiler.objectives.cheaper_robots import CheaperRobots
from compiler.robots.candidate import Candidate, candidates, candidates_of
from compiler.robots.normal_form import RobotFamily, family_of
from compiler.robots.robot import RobotModel
from compiler.robots.robot_key import robot_key_in_task
from compiler.words.structures import InfiniteAmbiguityError
from compiler.workspaces.abstraction import abstract
from grammar_lang import ir
from solvers.verifier.claims.certificate import ImpossibleClaim, SeparationClaim
from solvers.verifier.claims.structure_claims import StructureClaim
from solvers.verifier.proofs.scene import UNWATCHED, Watch
from solvers.verifier.refutations.lemma_check import check_covered, checked_lemma
from solvers.verifier.refutations.separation_check import misstated_separation
from solvers.verifier.refutations.solver_process import SmtSolver
from solvers.verifier.refutations.structure_evidence import Evidence, FalseClaim

AT_ONCE = 8
"""How many structures are checked per work item."""


@dataclass(frozen=True, slots=True)
class Impossibility:
    """How an impossibility is proved: ``by_boxes`` of all ``structures``, the rest by scripts.

    A separation is about all robots: there are no structures then. ``lemmas`` counts the lemmas; a
    robot that stands for its variants in a lemma counts as a structure.
    """

    structures: int
    by_boxes: int
    lemmas: int = 0

    @property
    def complete(self) -> bool:
        """Whether no solver has to be trusted."""
        return self.by_boxes == self.structures


def check_impossible(
    folder: Path,
    claim: ImpossibleClaim,
    program: ir.Program,
    task: ir.Task,
    trust: tuple[SmtSolver, ...],
    watch: Watch = UNWATCHED,
) -> Impossibility | str:
    """How a claim is proved, or the reason why it is refused.

    ``task`` is a task of ``program``; both are without maps.
    """
    if claim.separation is not None:
        return _separation(claim, claim.separation, program, task) or Impossibility(0, 0)
    family = family_of(program, task)
    evidence = Evidence(folder, program, task, trust)
    try:
        lemmas = [
            checked_lemma(number, lemma, family, evidence)
            for number, lemma in enumerate(claim.lemmas, 1)
        ]
        due = _due(claim, family, task, [lemma.condition for lemma in lemmas])
        proved = refuted_structures(evidence, claim, due, watch)
    except (FalseClaim, InfiniteAmbiguityError) as error:
        return str(error)
    proved += [lemma.by_boxes for lemma in lemmas if lemma.by_boxes is not None]
    return Impossibility(len(proved), sum(proved), len(lemmas))


def _separation(
    claim: ImpossibleClaim, separation: SeparationClaim, program: ir.Program, task: ir.Task
) -> str | None:
    """Why a separation does not prove the claim, or None."""
    if claim.structures or claim.modules is not None:
        return "the claim has a separation, which is about all robots, and structures or a bound"
    cells = abstract(program.workspaces[task.workspace])
    return misstated_separation(program, task, cells, separation)


def _due(
    claim: ImpossibleClaim, family: RobotFamily, task: ir.Task, conditions: Sequence[ir.Accept]
) -> Iterator[Candidate]:
    """The structures that have to be refuted one by one, in order.

    Without lemmas these are all structures of the family, up to the bound. With lemmas they are the
    structures of the listed words that satisfy none of the lemmas' ``conditions``; it is checked
    that every word of the family is listed or satisfies such a condition.
    """
    if not claim.lemmas:
        return candidates(family, _bound(claim, family, task), task.origin)
    if claim.modules != task.modules:
        raise FalseClaim("the bound on modules is not the task's")
    words = tuple(dict.fromkeys(structure.word for structure in claim.structures))
    check_covered(family, task, conditions, words)
    left = family.with_condition(ir.NotAccept(ir.AnyOf(tuple(conditions))))
    return candidates_of(left, [w for w in words if left.language.accepts(w)], task.origin)


def _bound(claim: ImpossibleClaim, family: RobotFamily, task: ir.Task) -> int:
    """The number of modules up to which structures have to be refuted."""
    if claim.modules != task.modules:
        raise FalseClaim("the bound on modules is not the task's")
    if claim.modules is not None:
        if not family.language.is_finite(max_modules=claim.modules):
            raise FalseClaim("there are infinitely many words within the bound")
        return claim.modules
    if not family.language.is_finite():
        raise FalseClaim("the language is infinite and the task has no bound on modules")
    return len(family.language.count_words()) - 1


def refuted_structures(
    evidence: Evidence,
    claim: ImpossibleClaim,
    due: Iterator[Candidate],
    watch: Watch,
    cheaper: Callable[[Candidate], CheaperRobots | None] = lambda _: None,
) -> list[bool]:
    """For each structure of a claim, which has to list the ``due`` ones, whether boxes refute it.

    ``cheaper`` gives the parameters of a structure that its boxes have to cover; None: all of them.

    Raises:
        FalseClaim: the claim lists other structures, or one has no evidence that refutes it.
    """
    listed = _Listed(evidence, claim, due, cheaper)
    proved: list[bool] = []

    def add(by_boxes: bool) -> None:  # noqa: FBT001
        watch.tick()
        watch.part(len(proved), len(claim.structures))
        proved.append(by_boxes)

    def add_repeated() -> None:
        while (first := listed.earlier(len(proved))) is not None:
            add(proved[first])

    for part in watch.each(_refuted, listed.parts()):
        for by_boxes in part:
            add_repeated()
            add(by_boxes)
    add_repeated()
    if listed.fault is not None:
        raise listed.fault
    if len(proved) != len(claim.structures):
        raise FalseClaim("the claim lists structures that the family does not have")
    return proved


@dataclass(frozen=True, slots=True)
class _Question:
    """A structure with evidence of its own, to be checked."""

    number: int
    claimed: StructureClaim
    model: RobotModel
    cheaper: CheaperRobots | None


def _refuted(part: tuple[Evidence, list[_Question]]) -> list[bool]:
    """Whether boxes refute each of the given structures; see ``Evidence.refutes``."""
    evidence, questions = part
    return [
        evidence.refutes(
            f"structure {q.number}", q.claimed.evidence, q.claimed.boxes, q.model, q.cheaper
        )
        for q in questions
    ]


@dataclass(slots=True)
class _Listed:
    """The structures of a claim, compared in order with those of the family.

    A defect of the list is kept as ``fault`` until the evidence of all structures before it has
    been checked: so the message does not depend on how many structures are checked at once.
    """

    evidence: Evidence
    claim: ImpossibleClaim
    family: Iterator[Candidate]
    cheaper: Callable[[Candidate], CheaperRobots | None]
    first: list[int | None] = field(default_factory=list[int | None])
    """For each structure, the earlier one that is the same robot, if the claim names one."""
    keys: list[str] = field(default_factory=list[str])
    fault: FalseClaim | None = None

    def parts(self) -> Iterator[tuple[Evidence, list[_Question]]]:
        """The structures that have evidence of their own, in groups."""
        some: list[_Question] = []
        try:
            for candidate in self.family:
                question = self._question(candidate)
                if question is not None:
                    some.append(question)
                if len(some) == AT_ONCE:
                    yield self.evidence, some
                    some = []
        except FalseClaim as fault:
            self.fault = fault
        if some:
            yield self.evidence, some

    def earlier(self, number: int) -> int | None:
        """The earlier structure that is the same robot; None if this one has its own evidence."""
        return self.first[number] if number < len(self.first) else None

    def _question(self, candidate: Candidate) -> _Question | None:
        """The structure as a question; None if an earlier one that is the same robot answers it.

        Raises:
            FalseClaim: the claim lacks this structure, or lists another one in its place.
        """
        number, derivation = candidate.number, candidate.derivation
        if number >= len(self.claim.structures):
            raise FalseClaim(f"structure {number} is missing: {' '.join(derivation.word)}")
        claimed = self.claim.structures[number]
        if (claimed.word, claimed.derivation) != (derivation.word, derivation.labels):
            raise FalseClaim(f"structure {number} is not {' '.join(derivation.word)}")
        model = candidate.model
        if model is None:
            raise FalseClaim(f"structure {number} is not a robot: {candidate.fault}")
        self.keys.append(robot_key_in_task(model, self.evidence.task))
        first, cheaper = None, self.cheaper(candidate)
        if claimed.same_robot_as is not None:
            first = _same(number, self.claim, self.keys)
        if cheaper is not None and model.parameters:
            # The boxes of the earlier structure may leave out other parameters.
            first = None
        self.first.append(first)
        return _Question(number, claimed, model, cheaper) if first is None else None


def _same(number: int, claim: ImpossibleClaim, keys: list[str]) -> int:
    """The earlier structure that is the same robot and whose evidence is used."""
    claimed = claim.structures[number]
    first = claimed.same_robot_as
    if first is None or not 0 <= first < number or keys[first] != keys[number]:
        raise FalseClaim(f"structure {number} is not the same robot as structure {first}")
    earlier = claim.structures[first]
    if (claimed.evidence, claimed.boxes) != (earlier.evidence, earlier.boxes):
        raise FalseClaim(f"structure {number} does not name the evidence of structure {first}")
    return first
