"""The evidence in a result folder that one robot cannot do a task: a covering or a script."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from compiler.encodings.body_smt import body_script, body_scripts
from compiler.encodings.pose_questions import body_conditions, pose_questions
from compiler.encodings.reachability_smt import refutation_script
from compiler.objectives.cheaper_robots import CheaperRobots
from compiler.robots.robot import RobotModel
from grammar_lang import ir
from grammar_lang.files.file_tree import visible
from solvers.verdict import Fails, Holds
from solvers.verifier.claims.spec_copy import evidence_bytes
from solvers.verifier.refutations.box_check import why_not
from solvers.verifier.refutations.solver_process import SmtSolver, agreed
from solvers.verifier.report import Outcome, Refused

MOST_SHOWN = 80
"""The most characters of a file name that a message quotes."""


class FalseClaim(Exception):
    """The claim is false, or its evidence does not prove it."""


@dataclass(frozen=True, slots=True)
class Evidence:
    """The evidence in a folder; ``program`` and ``task`` are without maps."""

    folder: Path
    program: ir.Program
    task: ir.Task
    trust: tuple[SmtSolver, ...]

    @property
    def workspace(self) -> ir.Workspace:
        """The workspace of the task."""
        return self.program.workspaces[self.task.workspace]

    def refutes(
        self,
        robot: str,
        script: str | None,
        boxes: str | None,
        model: RobotModel,
        cheaper: CheaperRobots | None = None,
    ) -> bool:
        """Check that boxes, or else a script, refute a robot; return whether boxes do.

        A script is run only if there are no boxes and there are solvers to trust.

        Args:
            robot: the name of the robot in messages.
            script: the name of a file, or None.
            boxes: the name of a file, or None.
            model: the robot.
            cheaper: the parameters that boxes have to cover; None: all of them.

        Raises:
            FalseClaim: there is no evidence, or it does not refute the robot.
        """
        if script is None and boxes is None:
            raise FalseClaim(f"{robot} has no evidence")
        if boxes is not None:
            self._covered(robot, boxes, model, cheaper)
        if script is not None:
            content = self._script(robot, script, model)
            if boxes is None and self.trust:
                self._unsatisfiable(robot, script, content)
        return boxes is not None

    def content(self, name: str) -> bytes:
        """The bytes of a file of evidence.

        Raises:
            FalseClaim: the file cannot be read.
        """
        try:
            return evidence_bytes(self.folder, name)
        except FileNotFoundError:
            raise FalseClaim(f"the evidence {_shown(name)} is missing") from None
        except OSError as error:
            raise FalseClaim(f"the evidence {_shown(name)}: {error.strerror}") from None

    def _covered(
        self, robot: str, name: str, model: RobotModel, cheaper: CheaperRobots | None
    ) -> None:
        """Check that the boxes prove that the robot cannot do the task."""
        try:
            covering = self.content(name).decode("ascii")
        except UnicodeDecodeError:
            raise FalseClaim(f"{name} is not ASCII") from None
        reason = why_not(covering, model, self.workspace, self.task, cheaper)
        if reason is not None:
            raise FalseClaim(f"{name} does not refute {robot}: {reason}")

    def _script(self, robot: str, name: str, model: RobotModel) -> str:
        """The script in a file, which has to be one for this robot and task."""
        content = self.content(name)
        for script in refutation_scripts(model, self.workspace, self.task):
            if script.encode() == content:
                return script
        raise FalseClaim(f"{name} is not the script of {robot}")

    def _unsatisfiable(self, robot: str, name: str, script: str) -> None:
        """Check that all trusted solvers refute the script."""
        match agreed(script, name, self.trust):
            case Fails():
                return
            case Holds():
                who = trusted_text(self.trust)
                raise FalseClaim(f"{who} does not refute {robot}: its script has a model")
            case unanswered:
                raise Refused(
                    f"the script of {robot} is not decided: "
                    f"{unanswered.detail or unanswered.reason.value}",
                    Outcome.UNDECIDED,
                )


def trusted_text(solvers: Sequence[SmtSolver]) -> str:
    """The names of the trusted solvers."""
    return " and ".join(solver.name for solver in solvers)


def _shown(name: str) -> str:
    """A file name for a message, shortened and made printable: a certificate may name anything."""
    return visible(name[:MOST_SHOWN]) or "``"


# --- The scripts that refute a robot for a task: first without its body, then with it -------------


def refutation_scripts(model: RobotModel, workspace: ir.Workspace, task: ir.Task) -> Iterator[str]:
    """The scripts in a fixed order, generated lazily; the robot is refuted if any is ``unsat``."""
    demands = body_conditions(workspace, task)
    for question in pose_questions(workspace, task):
        yield refutation_script(model, question)
        if demands is None:
            continue
        for poses in body_scripts(question):
            script = body_script(model, question, demands, poses)
            if script is not None:
                yield script
