"""The kinematic refutation of one structure: sample poses first, then ask the solver.

Where the task binds bodies, the same again with the whole body clear of the obstacles.  Poses
found by inverse kinematics answer a question "possible" for nothing; a script answered
``unsat`` proves that no parameters whatever let the structure do the task.
"""

from __future__ import annotations

from dataclasses import dataclass

from compiler.discretisation.float_reading import FloatReading
from compiler.encodings.body_demands import body_demands
from compiler.encodings.body_smt import Poses, body_script, body_scripts
from compiler.encodings.pose_questions import PoseQuestion, pose_questions
from compiler.encodings.reachability_smt import refutation_script
from compiler.robots.robot import RobotModel
from grammar_lang import ir
from solvers.backends.smt import RESOURCES, solve_script
from solvers.progress import Conduct
from solvers.refutation.clear_poses import clear_poses
from solvers.refutation.pose_search import PoseWitness, find_poses
from solvers.verifier.verdict import Fails

REFUTED = 1.0
BOTH_POSES = 400_000
"""z3's resources for two poses of the body with common parameters: those are hard to find."""


@dataclass(frozen=True, slots=True)
class Refutation:
    """The answer for a structure: a refuting ``script``, or the effector of witness poses.

    ``effector`` (from 0) is one that may start and reach, by the poses found for the first
    question; None where none were found.
    """

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
    """Try to prove that a structure cannot bring effectors from the start to where they must be."""
    calls, effectors = 0, list[int | None]()
    workspace = program.workspaces[task.workspace]
    demands = body_demands(workspace, task)
    for question in pose_questions(workspace, task):
        witness = find_poses(reading, question, conduct.seed)
        effectors.append(_recorded(task, witness))
        if witness is None:
            script = refutation_script(model, question)
            calls += 1
            if _refuted(script, conduct, RESOURCES):
                return Refutation(_reason(question), script, None, calls)
        if demands is None:
            continue
        known = clear_poses(reading, workspace, task, question, conduct.seed)
        for poses in body_scripts(question):
            body = None if poses in known else body_script(model, question, demands, poses)
            if body is None:
                continue
            calls += 1
            resources = RESOURCES if len(poses) == 1 else BOTH_POSES
            if _refuted(body, conduct, resources):
                return Refutation(_body_reason(question, poses), body, None, calls)
    if not calls:
        return Refutation("poses were found", None, effectors[0], 0)
    return Refutation("neither poses nor a refutation were found", None, effectors[0], calls)


def _refuted(script: str, conduct: Conduct, resources: int) -> bool:
    """Whether the solver answers ``unsat``; the journal is asked first."""
    key = f"smt|{script}"
    known = conduct.journal.recall(key)
    if known is None:
        known = REFUTED if isinstance(solve_script(script, resources=resources), Fails) else 0.0
        conduct.journal.record(key, known)
    return known == REFUTED


def _reason(question: PoseQuestion) -> str:
    if question.start is None:
        return f"no pose in {question.goal} for any parameters"
    return f"no poses in the start region and in {question.goal} for any parameters"


def _body_reason(question: PoseQuestion, poses: Poses) -> str:
    regions = {"start": "the start region", "target": question.goal}
    where = " and in ".join(regions[pose] for pose in poses)
    kind = "pose" if len(poses) == 1 else "poses"
    return f"no {kind} in {where} with the whole body clear, for any parameters"


def _recorded(task: ir.Task, witness: PoseWitness | None) -> int | None:
    """Of the poses of the first question: the effector that reaches, else the one that starts."""
    if witness is None:
        return None
    return witness.effector if task.reach is not None else witness.start_effector
