"""The check of ``impossible``: every structure up to the bound, each refuted by its evidence.

The structures are enumerated again.  A covering by boxes is replayed, and no solver is believed.
A script is made again from the spec, byte for byte; what is left to believe is the solver's
``unsat``, unless it is run again in a process of its own.  Where places are cut off from each
other, the cells are computed again, and no solver is believed.
"""

from __future__ import annotations

import subprocess
import sys
import sysconfig
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

from compiler.encodings.body_smt import body_script, body_scripts
from compiler.encodings.pose_questions import body_conditions, pose_questions
from compiler.encodings.reachability_smt import refutation_script
from compiler.robots.candidate import Candidate, candidates
from compiler.robots.normal_form import RobotFamily, family_of
from compiler.robots.robot import RobotModel
from compiler.robots.robot_key import robot_key_in_task
from compiler.words.structures import InfiniteAmbiguityError
from compiler.workspaces.abstraction import abstract
from grammar_lang import ir
from grammar_lang.files.file_tree import visible
from solvers.verdict import Answer, Fails, Holds, Reason, Unknown
from solvers.verifier.claims.certificate import ImpossibleClaim, SeparationClaim, StructureClaim
from solvers.verifier.claims.spec_copy import evidence_bytes
from solvers.verifier.proofs.scene import UNWATCHED, Watch
from solvers.verifier.refutations.box_check import why_not
from solvers.verifier.refutations.separation_check import misstated_separation
from solvers.verifier.report import Outcome, Refused

MOST_SHOWN = 80
"""Characters of a name in a message."""
AT_ONCE = 8
"""So many structures are checked in one go."""


class FalseClaim(Exception):
    """The claim is false, or its evidence is not what it says."""


@dataclass(frozen=True, slots=True)
class Impossibility:
    """How an impossibility is proved: ``by_boxes`` of all ``structures``, the rest by scripts.

    A separation is about all robots, and there are no structures.
    """

    structures: int
    by_boxes: int

    @property
    def complete(self) -> bool:
        """Whether no solver is left to believe."""
        return self.by_boxes == self.structures


def check_impossible(
    folder: Path,
    claim: ImpossibleClaim,
    program: ir.Program,
    task: ir.Task,
    trust: str | None,
    watch: Watch = UNWATCHED,
) -> Impossibility | str:
    """How a claim is proved, or the reason why it is refused.

    ``task`` is one of ``program``, both without maps.
    """
    if claim.separation is not None:
        return _separation(claim, claim.separation, program, task) or Impossibility(0, 0)
    family = family_of(program, task)
    try:
        bound = _bound(claim, family, task)
        proved = _structures(Evidence(folder, program, task, trust), claim, family, bound, watch)
    except (FalseClaim, InfiniteAmbiguityError) as error:
        return str(error)
    return Impossibility(len(proved), sum(proved))


def _separation(
    claim: ImpossibleClaim, separation: SeparationClaim, program: ir.Program, task: ir.Task
) -> str | None:
    """Why a separation does not prove the claim, or None."""
    if claim.structures or claim.modules is not None:
        return "the claim has a separation, which is about all robots, and structures or a bound"
    cells = abstract(program.workspaces[task.workspace])
    return misstated_separation(program, task, cells, separation)


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


def _structures(
    evidence: Evidence,
    claim: ImpossibleClaim,
    family: RobotFamily,
    bound: int,
    watch: Watch,
) -> list[bool]:
    """For each structure whether it is refuted by boxes."""
    listed = _Listed(evidence, claim, candidates(family, bound, evidence.task.origin))
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
    """A structure with evidence of its own."""

    number: int
    claimed: StructureClaim
    model: RobotModel


def _refuted(part: tuple[Evidence, list[_Question]]) -> list[bool]:
    """Whether boxes refute each of some structures; see ``Evidence.refutes``."""
    evidence, questions = part
    return [evidence.refutes(q.number, q.claimed, q.model) for q in questions]


@dataclass(slots=True)
class _Listed:
    """The structures of a claim, held against those of the family, in their order.

    What is wrong with the list is a ``fault``, which counts once the evidence of all structures
    before it has been checked: the same is said, however many of these are checked at once.
    """

    evidence: Evidence
    claim: ImpossibleClaim
    family: Iterator[Candidate]
    first: list[int | None] = field(default_factory=list[int | None])
    """For each structure the earlier one that is the same robot."""
    keys: list[str] = field(default_factory=list[str])
    fault: FalseClaim | None = None

    def parts(self) -> Iterator[tuple[Evidence, list[_Question]]]:
        """The structures that have evidence of their own, some at a time."""
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
        """The structure before one that is the same robot; None if it has evidence of its own."""
        return self.first[number] if number < len(self.first) else None

    def _question(self, candidate: Candidate) -> _Question | None:
        """What has to be checked of a structure; None where that was done.

        Raises:
            FalseClaim: the claim does not have it, or has another one in its place.
        """
        number, derivation = candidate.number, candidate.derivation
        if number >= len(self.claim.structures):
            raise FalseClaim(f"structure {number} is missing: {' '.join(derivation.word)}")
        claimed = self.claim.structures[number]
        if (claimed.word, claimed.derivation) != (derivation.word, derivation.labels):
            raise FalseClaim(f"structure {number} is not {' '.join(derivation.word)}")
        model = candidate.model
        if model is None:
            raise FalseClaim(f"structure {number} is no robot: {candidate.fault}")
        self.keys.append(robot_key_in_task(model, self.evidence.task))
        if claimed.same_robot_as is not None:
            self.first.append(_same(number, self.claim, self.keys))
            return None
        self.first.append(None)
        return _Question(number, claimed, model)


def _same(number: int, claim: ImpossibleClaim, keys: list[str]) -> int:
    """The earlier structure that is the same robot, whose evidence counts."""
    claimed = claim.structures[number]
    first = claimed.same_robot_as
    if first is None or not 0 <= first < number or keys[first] != keys[number]:
        raise FalseClaim(f"structure {number} is not the same robot as structure {first}")
    earlier = claim.structures[first]
    if (claimed.evidence, claimed.boxes) != (earlier.evidence, earlier.boxes):
        raise FalseClaim(f"structure {number} does not name the evidence of structure {first}")
    return first


@dataclass(frozen=True, slots=True)
class Evidence:
    """The evidence in a folder; ``program`` and ``task`` are without maps."""

    folder: Path
    program: ir.Program
    task: ir.Task
    trust: str | None

    @property
    def workspace(self) -> ir.Workspace:
        """The workspace of the task."""
        return self.program.workspaces[self.task.workspace]

    def refutes(self, number: int, claimed: StructureClaim, model: RobotModel) -> bool:
        """Whether boxes refute a structure; else its script does, if a solver is to be believed.

        Raises:
            FalseClaim: there is no evidence, or it is not what it says.
        """
        if claimed.evidence is None and claimed.boxes is None:
            raise FalseClaim(f"structure {number} has no evidence")
        if claimed.boxes is not None:
            self._covered(number, claimed.boxes, model)
        if claimed.evidence is not None:
            script = self._script(number, claimed.evidence, model)
            if claimed.boxes is None and self.trust == "z3":
                self._unsatisfiable(number, script)
        return claimed.boxes is not None

    def _covered(self, number: int, name: str, model: RobotModel) -> None:
        """The boxes prove that the robot does not do the task."""
        try:
            covering = self._content(name).decode("ascii")
        except UnicodeDecodeError:
            raise FalseClaim(f"{name} is not ASCII") from None
        reason = why_not(covering, model, self.workspace, self.task)
        if reason is not None:
            raise FalseClaim(f"{name} does not refute structure {number}: {reason}")

    def _script(self, number: int, name: str, model: RobotModel) -> str:
        """The script is one of this structure and task."""
        content = self._content(name)
        for script in refutation_scripts(model, self.workspace, self.task):
            if script.encode() == content:
                return script
        raise FalseClaim(f"{name} is not the script of structure {number}")

    def _unsatisfiable(self, number: int, script: str) -> None:
        match run_z3_subprocess(script):
            case Fails():
                return
            case Holds():
                raise FalseClaim(f"z3 does not refute structure {number}: its script has a model")
            case unanswered:
                raise Refused(
                    f"z3 does not decide the script of structure {number}: "
                    f"{unanswered.detail or unanswered.reason.value}",
                    Outcome.UNDECIDED,
                )

    def _content(self, name: str) -> bytes:
        try:
            return evidence_bytes(self.folder, name)
        except FileNotFoundError:
            raise FalseClaim(f"the evidence {_shown(name)} is missing") from None
        except OSError as error:
            raise FalseClaim(f"the evidence {_shown(name)}: {error.strerror}") from None


def _shown(name: str) -> str:
    """A name of a file as a message has it: a certificate may name anything."""
    return visible(name[:MOST_SHOWN]) or "``"


# --- z3 on the text of an SMT-LIB 2 script in a process of its own --------------------------------
#
# For the verifier, which loads no solver: importing this module does not import z3.


# As much again as the searchers spend, so that what they decided is decided here too.
RESOURCES = 2_000_000

# Without the executable, the Python package does the same; -P keeps the working directory out of
# the module path.
_PROGRAM = """\
import sys, z3
solver = z3.SolverFor("QF_NRA")
solver.set("rlimit", int(sys.argv[1]))
solver.from_string(sys.stdin.read())
print(solver.check())
"""


def z3_command(resources: int = RESOURCES) -> list[str]:
    """The command that reads a script on standard input: z3 as installed beside this Python."""
    name = "z3.exe" if sys.platform == "win32" else "z3"
    for folder in (Path(sys.executable).parent, Path(sysconfig.get_path("scripts"))):
        if (folder / name).is_file():
            return [str(folder / name), "-smt2", "-in", f"rlimit={resources}"]
    return [sys.executable, "-P", "-c", _PROGRAM, str(resources)]


def run_z3_subprocess(
    script: str, *, resources: int = RESOURCES, command: list[str] | None = None
) -> Answer[None, None]:
    """Decide a QF_NRA script elsewhere: ``Holds`` is sat, ``Fails`` is unsat.

    An answer is exactly one word; any other output, an error among them, is ``Unknown``.

    Raises:
        ValueError: ``resources`` is not positive.
    """
    if resources < 1:
        raise ValueError("a budget is at least one unit")
    try:
        finished = subprocess.run(  # noqa: S603 (the command is our own)
            z3_command(resources) if command is None else command,
            input=script,
            capture_output=True,
            text=True,
            encoding="utf-8",
            check=False,
        )
    except OSError as error:
        return Unknown(Reason.INCOMPLETE, f"z3 does not start: {error}")
    match finished.returncode, finished.stdout.strip():
        case 0, "unsat":
            return Fails(None)
        case 0, "sat":
            return Holds(None)
        case 0, "unknown":
            return Unknown(Reason.RESOURCE_LIMIT, f"within {resources} z3 resource units")
        case code, output:
            message = " ".join((output or finished.stderr).split())[:200]
            return Unknown(Reason.INCOMPLETE, f"z3 ended with status {code}: {message}")


# --- Every script that refutes a robot for a task: without its body first, then with it -----------


def refutation_scripts(model: RobotModel, workspace: ir.Workspace, task: ir.Task) -> Iterator[str]:
    """The scripts in a fixed order, made one by one; any of them that is ``unsat`` refutes."""
    demands = body_conditions(workspace, task)
    for question in pose_questions(workspace, task):
        yield refutation_script(model, question)
        if demands is None:
            continue
        for poses in body_scripts(question):
            script = body_script(model, question, demands, poses)
            if script is not None:
                yield script
