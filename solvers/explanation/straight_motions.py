"""What straight motions between poses say about changes of drives, of limits and of the time.

They are a cheap sign, not a proof: obstacles are left out, and other motions may need less or more.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from math import inf, isnan

import numpy as np

from compiler.discretisation.numeric_robot import NumericRobot
from compiler.dynamics.equations_of_motion import robot_graph
from compiler.encodings.pose_questions import pose_questions
from compiler.robots.candidate import robot_in_task
from compiler.robots.normal_form import family_of
from compiler.robots.robot import RobotModel
from compiler.robots.state_and_input import robot_inputs
from compiler.words.derivation import Derivation
from solvers.explanation.posed_task import PosedTask
from solvers.explanation.scale import Scale
from solvers.impossibility.drive_search import Strains, straight_strains
from solvers.impossibility.pose_search import PoseWitness, find_poses


@dataclass(frozen=True, slots=True)
class StraightMotions:
    """Straight motions between poses of one robot that a task requires, one for each question."""

    posed: PosedTask
    derivation: Derivation
    numeric: NumericRobot
    witnesses: tuple[PoseWitness | None, ...]

    @property
    def model(self) -> RobotModel:
        """The robot in the task as it is."""
        return self.numeric.graph.model

    def most(self, posed: PosedTask) -> float:
        """The largest part of a bound that they take in a task with other bounds or more time.

        Infinite if it is not known.
        """
        changed = posed.expanded()
        family = family_of(changed.program, changed.task)
        model = robot_in_task(family, changed.task.origin, self.derivation)
        found = [
            inf if strains is None or isnan(strains.most) else strains.most
            for strains in self._strains(model, changed)
        ]
        return max(found, default=inf)

    def least(self, scale: Scale) -> Fraction | None:
        """The least value of a scale with which they keep all bounds.

        None if they do so without the change, or not even with the largest one.
        """

        def kept(index: int) -> bool:
            return self.most(scale.at(scale.values[index]).posed) <= 1

        low, high = 0, len(scale.values) - 1
        if not scale.values or self.most(self.posed) <= 1 or not kept(high):
            return None
        while low < high:
            middle = (low + high) // 2
            low, high = (low, middle) if kept(middle) else (middle + 1, high)
        return scale.values[low]

    def loads(self) -> dict[tuple[str, str], float]:
        """The largest parts of its bounds that they take of each joint.

        By the kind of its line in a task and its name, as ``Module.dof``.
        """
        found = dict[tuple[str, str], float]()
        driven, dofs = robot_inputs(self.model), self.model.dofs
        places = [each.dof for each in driven]
        for strains in self._strains(self.model, self.posed.expanded()):
            if strains is None:
                continue
            parts = [
                ("joint_effort", places, strains.inputs),
                ("joint_rate", range(len(dofs)), strains.rates),
                ("joint_accel", range(len(dofs)), strains.accelerations),
            ]
            for kind, joints, values in parts:
                for joint, value in zip(joints, values, strict=True):
                    if joint is not None:
                        key = kind, dofs[joint].called
                        found[key] = max(found.get(key, 0.0), float(np.nan_to_num(value)))
        return found

    def _strains(self, model: RobotModel, posed: PosedTask) -> list[Strains | None]:
        questions = pose_questions(posed.workspace, posed.task)
        return [
            None
            if witness is None
            else straight_strains(self.numeric, model, posed.task, witness, question.by)
            for witness, question in zip(self.witnesses, questions, strict=True)
        ]


def straight_motions(posed: PosedTask, derivation: Derivation, seed: int) -> StraightMotions:
    """The straight motions of one robot between poses that are found with a seed."""
    whole = posed.expanded()
    model = robot_in_task(family_of(whole.program, whole.task), whole.task.origin, derivation)
    numeric = NumericRobot(robot_graph(model, whole.task.gravity))
    questions = pose_questions(whole.workspace, whole.task)
    witnesses = tuple(find_poses(numeric, question, seed) for question in questions)
    return StraightMotions(posed, derivation, numeric, witnesses)


def by_promise(
    changes: Sequence[Scale], motions: StraightMotions | None
) -> list[tuple[Scale, Fraction | None]]:
    """The scales in the order in which to try them, each with the value to begin with, or None.

    First those with which straight motions keep all bounds, the least factor first. For the others,
    the bounds of which they take most come first, and the horizon last.
    """
    loads = {} if motions is None else motions.loads()
    least = [None if motions is None else motions.least(scale) for scale in changes]

    def order(item: tuple[Scale, Fraction | None]) -> tuple[bool, float, float]:
        (scale, value), line = item, item[0].line
        if value is not None:
            return False, float(value / scale.values[0]), 0
        name = ".".join(map(str, line.key))
        load = inf if line.kind == "effort" else loads.get((line.kind, name), 0.0)
        return True, line.kind == "horizon", -load

    return sorted(zip(changes, least, strict=True), key=order)
