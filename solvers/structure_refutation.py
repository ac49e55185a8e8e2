"""The kinematic refutation of one structure: sample poses first, then ask the solver.

A pose pair found by inverse kinematics answers "reachable" for nothing; a script answered ``unsat``
proves that no parameters whatever let the structure do the task.
"""

from __future__ import annotations

from dataclasses import dataclass

from compiler.discretisation.float_reading import FloatReading
from compiler.encodings.reachability_smt import pose_question, refutation_script
from compiler.robots.robot import RobotModel
from grammar_lang import ir
from solvers.pose_search import find_poses
from solvers.progress import Conduct
from solvers.smt import solve_script
from solvers.verdict import Fails

REFUTED = 1.0


@dataclass(frozen=True, slots=True)
class Refutation:
    """The answer for a structure: a refuting ``script``, or the effector of witness poses."""

    reason: str
    script: str | None
    effector: int | None
    solver_calls: int

    @property
    def refuted(self) -> bool:
        """Whether there is a script that was answered ``unsat``."""
        return self.script is not None


def refute_structure(
    model: RobotModel, reading: FloatReading, program: ir.Program, task: ir.Task, conduct: Conduct
) -> Refutation:
    """Try to prove that a structure cannot bring an effector from the start to the target."""
    question = pose_question(program.workspaces[task.workspace], task)
    witness = find_poses(reading, question, conduct.seed)
    if witness is not None:
        return Refutation("poses were found", None, witness.effector, 0)
    script = refutation_script(model, question)
    key = f"smt|{script}"
    known = conduct.journal.recall(key)
    if known is None:
        known = REFUTED if isinstance(solve_script(script), Fails) else 0.0
        conduct.journal.record(key, known)
    if known == REFUTED:
        reason = "no poses in the start region and in the target for any parameters"
        return Refutation(reason, script, None, 1)
    return Refutation("neither poses nor a refutation were found", None, None, 1)
