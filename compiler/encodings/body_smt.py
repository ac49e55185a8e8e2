"""The refutation of a robot by poses of its whole body, an SMT-LIB 2 script, in the plane.

Statement: for some parameters in range there are poses, one with an effector in the start region
and one with an effector in the target, with every effector within the bounds and every rod, point
and com clear of the obstacles that the task keeps bodies out of.  The unknowns are the vectors
from joint to joint (``planar_poses.py``).  A script asks about one of the two poses, or about both
with the same parameters.  ``unsat`` proves that the structure cannot do the task; every relaxation
only enlarges the set of solutions.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TypeAlias

from compiler.encodings.body_conditions import BodyConditions
from compiler.encodings.planar_poses import PlanarPose
from compiler.encodings.pose_questions import PoseQuestion, effector_choices
from compiler.encodings.reachability_smt import PRECISION, Pose
from compiler.encodings.real_terms import Formula, Quantity, RealScript, all_of, any_of
from compiler.encodings.region_terms import inside, point_clear, segment_clear
from compiler.encodings.scalar_terms import ScalarTerms
from compiler.expressions.evaluators.balls import working_precision
from compiler.robots.robot import Offset, RobotModel, RodBody, SolidBody
from grammar_lang import ir

Poses: TypeAlias = tuple[Pose, ...]

HEADER = """\
Is there a robot of this structure with {wanted}, every
effector within the bounds and the whole body clear of the obstacles?  unsat: there is none, so no
robot of this structure does the task.  Limits of revolute joints, the dynamics, margins and radii
are left out, touching is allowed, and irrational numbers lie in rational intervals: all this can
only add solutions.  SI units."""

START = "a pose that brings an effector into the start region"
TARGET = "a pose that brings {who} into {target}"


def body_scripts(question: PoseQuestion) -> tuple[Poses, ...]:
    """The poses that scripts about a question are about, each script's together."""
    if question.start is None:
        return (("target",),)
    return ("target",), ("start",), ("start", "target")


def body_script(
    model: RobotModel, question: PoseQuestion, demands: BodyConditions, poses: Poses
) -> str | None:
    """The script of a robot and a task: SMT-LIB 2, QF_NRA, the same bytes for the same input.

    None where no effector is a candidate: the script without the body refutes that.
    """
    pairs = effector_choices(model, question)
    if not pairs:
        return None
    script = RealScript()
    who = "an effector" if len(poses) == 1 else question.who
    wanted = {"start": START, "target": TARGET.format(who=who, target=question.goal)}
    script.comment(HEADER.format(wanted=" and\n".join(wanted[pose] for pose in poses)))
    script.lines.append("(set-logic QF_NRA)")
    with working_precision(PRECISION):
        _Encoding(model, question, demands, script).write(poses, pairs)
    script.lines.append("(check-sat)")
    return "\n".join(script.lines) + "\n"


@dataclass(slots=True)
class _Encoding:
    model: RobotModel
    question: PoseQuestion
    demands: BodyConditions
    script: RealScript

    def write(self, poses: Poses, pairs: Sequence[tuple[int, int]]) -> None:
        """Everything between the logic and the check."""
        scalars = ScalarTerms(self.model, self.script)
        scalars.define(_lengths(self.model))
        bodies: dict[Pose, PlanarPose] = {}
        for pose in poses:
            self.script.comment(f"The {pose} pose: effectors within the bounds, the body clear.")
            bodies[pose] = PlanarPose(self.model, scalars, pose)
            self._clear(bodies[pose])
        self.script.comment("The effectors in their regions.")
        alternatives = dict.fromkeys(
            all_of([part for pose in poses for part in self._reached(bodies[pose], pose, pair)])
            for pair in pairs
        )
        self.script.assertion(any_of(list(alternatives)))

    def _reached(self, body: PlanarPose, pose: Pose, pair: tuple[int, int]) -> list[Formula]:
        """The effector of a choice is where it has to be at a pose."""
        region = self.question.target if pose == "target" else self.question.start or ()
        position = body.position(body.effectors[pair[pose == "target"]])
        return [inside(row, position) for row in region]

    def _clear(self, body: PlanarPose) -> None:
        """What holds at every instant."""
        script, demands = self.script, self.demands
        found: list[Formula] = []
        for place in body.effectors:
            position = body.position(place)
            found += [inside(row, position) for row in self.question.bounds]
            found += [point_clear(polygon, position) for polygon in demands.effectors]
        for place in body.points:
            position = body.position(place)
            found += self._within(position)
            found += [point_clear(polygon, position) for polygon in demands.bodies]
        for rod in body.rods:
            ends = [body.position(end) for end in rod.ends]
            found += [formula for end in ends for formula in self._within(end)]
            if demands.bodies:
                line = body.line(rod)
                found += [segment_clear(polygon, ends, line) for polygon in demands.bodies]
        script.assertion(*dict.fromkeys(found))

    def _within(self, position: Sequence[Quantity]) -> list[Formula]:
        """Bodies keep the bounds where the task says so."""
        bounds: tuple[ir.HalfSpace, ...] = self.question.bounds
        return [inside(row, position) for row in bounds] if self.demands.bounds_body else []


def _lengths(model: RobotModel) -> set[int]:
    """The scalars that the places of a robot in the plane are made of, but for angles."""
    found = set[int]()
    for node in model.frames:
        if isinstance(node.step, Offset):
            found.update(node.step.vector[:2])
    for body in model.bodies:
        if isinstance(body, RodBody):
            found.add(body.length)
        elif isinstance(body, SolidBody):
            found.update(body.com[:2])
    return found
