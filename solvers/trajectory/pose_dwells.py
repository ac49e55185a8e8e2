"""Poses of an effector in a search: conditions on its axes, and dwells for these conditions.

A unit axis e is within an angle of a unit direction t if t . e is at least the cosine of the angle.
A whole frame is within an angle if the sum of three such products is large enough; dwells require
each of them to be at least a third of that.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from math import cos, pi, sin

import numpy as np
from numpy.typing import NDArray

from compiler.arrays import Array
from compiler.discretisation.numeric_robot import NumericRobot
from compiler.tasks.pose_target import FLOATS, PoseTarget, pose_target
from grammar_lang import ir
from solvers.trajectory.convex_set import ConvexSet
from solvers.trajectory.position_plan import Dwell


def pose_dwells(
    numeric: NumericRobot,
    pose: ir.Pose,
    unit: float,
    effector: int,
    samples: tuple[int, int],
    *,
    away: bool = False,
) -> Iterator[Dwell]:
    """Dwells that keep an effector (from 0) in a pose between two samples, or out of it (``away``).

    Near its bound a row measures angles as lengths, one ``unit`` in metres per rad, so that margins
    fit.  The directions themselves are the targets to which inverse kinematics brings the axes.
    """
    target = pose_target(pose, numeric.d, FLOATS)
    level = target.along(cos(target.within)) / len(target.axes)
    scale = unit / sin(min(target.within, pi / 2))
    for point, towards in _directed(numeric, target, effector):
        sign = 1.0 if away else -1.0
        rows, offsets = sign * scale * towards[None], np.array([sign * scale * level])
        region = ConvexSet(rows, offsets, -sign * towards[None])
        yield Dwell(point, *samples, region, spreads=np.array([scale]))


def in_poses(
    numeric: NumericRobot, poses: Sequence[ir.Pose], effector: int, points: Array
) -> NDArray[np.bool_]:
    """Whether an effector (from 0) is in all poses, (K,), for points of the robot (K, m, d)."""
    found = np.ones(len(points), dtype=bool)
    for pose in poses:
        target = pose_target(pose, numeric.d, FLOATS)
        directed = _directed(numeric, target, effector)
        along = sum((points[:, point] @ towards for point, towards in directed), np.zeros(1))
        found &= along >= target.along(cos(target.within))
    return found


def _directed(
    numeric: NumericRobot, target: PoseTarget[float], effector: int
) -> Iterator[tuple[int, Array]]:
    """The points that represent the axes of an effector's frame, and their target directions."""
    first, axes = len(numeric.graph.model.effectors), numeric.spanning.axes[effector]
    for axis, direction in zip(target.axes, target.directions, strict=True):
        yield first + axes[axis], np.array(direction)
