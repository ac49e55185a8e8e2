"""The kinematic refutation of one structure: sample poses first, then ask the solver, then boxes.

If the task constrains bodies, this is repeated with the whole body clear of the obstacles. Poses
found by inverse kinematics cheaply answer a question with "possible"; a script answered ``unsat``
proves that the structure cannot do the task with any parameters. If neither poses nor scripts
decide, a covering by boxes is tried, which also detects blocked ways between poses and weak drives.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from fractions import Fraction
from itertools import islice

import numpy as np

from compiler.discretisation.numeric_robot import NumericRobot
from compiler.encodings.body_smt import Poses, body_script, body_scripts
from compiler.encodings.pose_questions import (
    PoseQuestion,
    body_conditions,
    pose_questions,
    start_fault,
)
from compiler.encodings.reachability_smt import refutation_script
from compiler.robots.robot import RobotModel
from grammar_lang import ir
from solvers.backends.smt import RESOURCES, solve_script
from solvers.impossibility.box_refutation import (
    FOR_A_POSE,
    WITHOUT_PROOF,
    BoxRefutation,
    box_refutation,
    start_is_excluded,
    way_is_seen,
)
from solvers.impossibility.drive_search import (
    BEFORE_LONG_MOTIONS,
    BEFORE_MOTIONS,
    drive_refutation,
    drives_seem_able,
)
from solvers.impossibility.pose_search import PoseWitness, clear_poses, designs, find_poses
from solvers.run_context import RunContext
from solvers.verdict import Answer, Fails, Holds, Unknown
from solvers.verifier.refutations.solver_process import DisagreementError, agreed

REFUTED = 1.0
SECONDS = 60.0
"""A solver that the user named is ended after this time."""
FEW_DOFS = 2
"""With at most this many coordinates a covering is tried even if poses were found."""
DESIGNS = 6
"""The number of parameter vectors with which a way is looked for before a covering is tried."""
BOTH_POSES = 400_000
"""z3's resources for two poses of the body with common parameters, which are hard to find."""


@dataclass(frozen=True, slots=True)
class Refutation:
    """The result for a structure: a refuting ``script`` or ``boxes``, or the effector of poses.

    ``effector`` (from 0) is one that may start and reach, by the poses for the first question; None
    if none were found. ``unanswered``: why a solver that the user named has not answered a script.
    """

    reason: str
    script: str | None
    effector: int | None
    solver_calls: int
    boxes: str | None = None
    unanswered: str = ""

    @property
    def refuted(self) -> bool:
        """Whether a script was answered ``unsat``, or a covering was replayed."""
        return self.script is not None or self.boxes is not None


def refute_structure(
    model: RobotModel,
    numeric: NumericRobot,
    program: ir.Program,
    task: ir.Task,
    context: RunContext,
) -> Refutation:
    """Try to prove that a structure cannot move effectors from the start to where they must be."""
    asked = _Asked(model, numeric, program.workspaces[task.workspace], task, context)
    for question in pose_questions(asked.workspace, task):
        refuted = asked.poses(question) or asked.unposed() or asked.bodies(question)
        if refuted is not None:
            return replace(refuted, unanswered=asked.unanswered)
    effector = _recorded(task, asked.witnesses[0])
    found = asked.covered(asked.boxes() or asked.drives())
    if found is not None:
        return replace(found, unanswered=asked.unanswered)
    if not asked.calls:
        return Refutation("poses were found", None, effector, 0)
    reason = "neither poses nor a refutation were found"
    return Refutation(reason, None, effector, asked.calls, unanswered=asked.unanswered)


@dataclass(slots=True)
class _Asked:
    """The questions asked about a robot: the poses found for each of them, and its deadline (s)."""

    model: RobotModel
    numeric: NumericRobot
    workspace: ir.Workspace
    task: ir.Task
    context: RunContext
    witnesses: list[PoseWitness | None] = field(default_factory=list[PoseWitness | None])
    deadlines: list[Fraction | None] = field(default_factory=list[Fraction | None])
    calls: int = 0
    unanswered: str = ""

    def poses(self, question: PoseQuestion) -> Refutation | None:
        """Poses of the effectors alone: found, refuted, or neither."""
        witness = find_poses(self.numeric, question, self.context.seed)
        self.witnesses.append(witness)
        self.deadlines.append(question.by)
        if witness is not None:
            return None
        script = refutation_script(self.model, question)
        self.calls += 1
        if not self.refutes(script, RESOURCES):
            return None
        return Refutation(_reason(self.model, question), script, None, self.calls)

    def unposed(self) -> Refutation | None:
        """A small covering, if no poses were found for the last question.

        It often decides at once what solvers are asked for long in questions about bodies.
        """
        if self.witnesses[-1] is not None or body_conditions(self.workspace, self.task) is None:
            return None
        robot = self.model, self.numeric.graph, self.workspace, self.task
        return self.covered(box_refutation(*robot, FOR_A_POSE))

    def covered(self, found: BoxRefutation | None) -> Refutation | None:
        """The refutation by a covering."""
        if found is None:
            return None
        return Refutation(found.reason, None, None, self.calls, found.boxes)

    def bodies(self, question: PoseQuestion) -> Refutation | None:
        """Poses of the whole body: found, refuted, or neither."""
        demands = body_conditions(self.workspace, self.task)
        if demands is None:
            return None
        seed = self.context.seed
        known = clear_poses(self.numeric, self.workspace, self.task, question, seed)
        for poses in body_scripts(question):
            body = None if poses in known else body_script(self.model, question, demands, poses)
            if body is None:
                continue
            self.calls += 1
            resources = RESOURCES if len(poses) == 1 else BOTH_POSES
            if self.refutes(body, resources):
                return Refutation(_body_reason(question, poses), body, None, self.calls)
        return None

    def refutes(self, script: str, resources: int) -> bool:
        """Whether the solver, or each of several, answers ``unsat``; the journal is read first."""
        key = f"smt|{script}"
        known = self.context.journal.recall(key)
        if known is None:
            answer = self.answer(script, resources)
            known = REFUTED if isinstance(answer, Fails) else 0.0
            if isinstance(answer, Unknown) and self.context.smt:
                self.unanswered = known = answer.detail
            self.context.journal.record(key, known)
        elif isinstance(known, str):
            self.unanswered = known
        return known == REFUTED

    def answer(self, script: str, resources: int) -> Answer[None, None]:
        """The answer of z3 as a library, or of the solvers that the user named."""
        if not self.context.smt:
            return solve_script(script, resources=resources)
        name = "a refutation script"
        answer = agreed(script, name, self.context.smt, seconds=SECONDS)
        if isinstance(answer, Fails):
            # A robot is not excluded on one program's word if another contradicts it.
            library = solve_script(script, resources=resources)
            if isinstance(library, Holds):
                said = {solver.name: "unsat" for solver in self.context.smt}
                raise DisagreementError(name, script, {**said, "z3 as a library": "sat"})
        return answer

    def boxes(self) -> BoxRefutation | None:
        """A covering, if there is a prospect of one."""
        robot = self.model, self.numeric.graph, self.workspace, self.task
        if start_is_excluded(*robot):
            return box_refutation(*robot, FOR_A_POSE)
        few = len(self.model.dofs) <= FEW_DOFS
        if not few and not self.calls:
            return None
        rng = np.random.default_rng(self.context.seed)
        drawn = list(islice(designs(self.numeric, rng), DESIGNS))
        if way_is_seen(*robot, self.witnesses, drawn):
            return None
        return box_refutation(*robot, WITHOUT_PROOF)

    def drives(self) -> BoxRefutation | None:
        """A covering that shows that the drives are far too weak, if there is a prospect of one."""
        if drives_seem_able(self.numeric, self.task, self.witnesses, self.deadlines):
            return None
        robot = self.model, self.numeric.graph, self.workspace, self.task
        few = len(self.model.dofs) <= FEW_DOFS
        return drive_refutation(*robot, BEFORE_MOTIONS if few else BEFORE_LONG_MOTIONS)


def _reason(model: RobotModel, question: PoseQuestion) -> str:
    fault = start_fault(model, question)
    if fault:
        return fault
    if question.start is None:
        return f"no pose in {question.goal} for any parameters"
    return f"no poses in the start region and in {question.goal} for any parameters"


def _body_reason(question: PoseQuestion, poses: Poses) -> str:
    regions = {"start": "the start region", "target": question.goal}
    where = " and in ".join(regions[pose] for pose in poses)
    kind = "pose" if len(poses) == 1 else "poses"
    return f"no {kind} in {where} with the whole body clear, for any parameters"


def _recorded(task: ir.Task, witness: PoseWitness | None) -> int | None:
    """The effector that reaches in the poses of the first question, else the one that starts."""
    if witness is None:
        return None
    return witness.effector if task.reach is not None else witness.start_effector
