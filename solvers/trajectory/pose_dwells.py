"""Poses of an effector as dwells of the axes of its frame, for a search.

An axis e within an angle of a direction t is one with t . e at least its cosine, as both have the
length one.  A whole frame is within an angle where the sum of three such products is large enough;
here each of them is asked to be a third of that.
"""

from __future__ import annotations

from collections.abc import Iterator
from math import cos, pi, sin

import numpy as np

from compiler.discretisation.numeric_robot import NumericRobot
from compiler.tasks.pose_target import FLOATS, pose_target
from grammar_lang import ir
from solvers.trajectory.convex_set import ConvexSet
from solvers.trajectory.position_plan import Dwell


def pose_dwells(
    numeric: NumericRobot, pose: ir.Pose, unit: float, effector: int, samples: tuple[int, int]
) -> Iterator[Dwell]:
    """What keeps an effector (from 0) in a pose, from a first sample to a last one.

    Near its bound a row counts angles as lengths, a ``unit`` in metres for a rad, so that margins
    suit it.  The directions themselves are the places that inverse kinematics brings the axes to.
    """
    target = pose_target(pose, numeric.d, FLOATS)
    level = cos(target.within)
    if len(target.axes) > 1:
        level = (1 + 2 * level) / 3
    scale = unit / sin(min(target.within, pi / 2))
    points = numeric.spanning.axes[effector]
    for axis, direction in zip(target.axes, target.directions, strict=True):
        towards = np.array(direction)[None]
        region = ConvexSet(-scale * towards, np.array([-scale * level]), towards)
        point = len(numeric.graph.model.effectors) + points[axis]
        yield Dwell(point, *samples, region, spreads=np.array([scale]))
