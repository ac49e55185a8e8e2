"""The total length of a robot: how much of it there is between its joints."""

from __future__ import annotations

import math

from compiler.arrays import Array
from compiler.expressions.evaluators.floats import scalar_floats
from compiler.robots.robot import WORLD, Joint, Offset, RobotModel


def total_length(model: RobotModel, theta: Array) -> float:
    r"""The sum of the lengths of a robot's rigid displacements at ``theta``, in metres.

    .. math:: \sum_{f \in F} \lVert t_f(\theta) \rVert_2

    Source: own definition.  F are the frames that a ``move`` by a vector t leads to and that lie
    on the way from the world to a joint or to an effector, each once however many ways share it.
    So a bracket ``move(x, a) * move(y, b)`` has length a + b, where ``model`` is the robot as it
    was built, before neighbouring displacements are merged.  Not counted are the travel of
    prismatic joints, which is no part of the design, and frames that only bodies are placed in:
    the way to the middle of a link is part of the link.

    Args:
        model: the robot.
        theta: its parameters, shape (p,), SI.
    """
    values = scalar_floats(model.scalars, theta)
    joints = (i for i, frame in enumerate(model.frames) if isinstance(frame.step, Joint))
    counted: set[int] = set()
    for end in (*joints, *model.effectors):
        frame = end
        while frame != WORLD and frame not in counted:
            counted.add(frame)
            frame = model.frames[frame].parent
    steps = [model.frames[frame].step for frame in sorted(counted)]
    return math.fsum(
        math.hypot(*(values[scalar] for scalar in step.vector))
        for step in steps
        if isinstance(step, Offset)
    )
