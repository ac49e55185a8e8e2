"""The motion of a design as a ROS 2 message, ``trajectory_msgs/msg/JointTrajectory``, in YAML.

A point has no accelerations: those of held torques jump at the samples, and a message can have only
one there.  With positions and velocities controllers interpolate by cubic polynomials, as they
should where a motion is smooth between its samples.
"""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction
from itertools import pairwise
from typing import Any

import yaml

from srgc.exports.design_robot import origin, remarks
from srgc.exports.exported_motion import ExportedMotion
from srgc.exports.plain_line import plain_line
from srgc.faults import UsageFault

NANO = 10**9
MOST_SECONDS = 2**31
"""builtin_interfaces/msg/Duration has seconds of 32 bits with a sign."""


def joint_trajectory(motion: ExportedMotion, *, efforts: bool = True) -> str:
    """The message, behind lines of comment.

    Args:
        motion: what is written.
        efforts: whether the points have efforts; at the end, those of the last step.

    Raises:
        UsageFault: its times cannot be told apart in nanoseconds, or are too large.
    """
    times = [_nanoseconds(time) for time in motion.times]
    if any(after <= before for before, after in pairwise(times)):
        raise UsageFault("steps of less than a nanosecond are no JointTrajectory")
    if times[-1] >= MOST_SECONDS * NANO:
        raise UsageFault(f"a motion of {MOST_SECONDS} s and more is no JointTrajectory")
    message = {
        "header": {"stamp": {"sec": 0, "nanosec": 0}, "frame_id": ""},
        "joint_names": [joint.name for joint in motion.joints],
        "points": list(_points(motion, times, efforts=efforts)),
    }
    notes = (*origin(motion.design), *remarks(motion.design))
    head = "".join(f"# {plain_line(line)}\n" for line in notes)
    dumped = yaml.safe_dump(
        message, default_flow_style=None, sort_keys=False, width=10**9, allow_unicode=True
    )
    return head + str(dumped)


def _nanoseconds(time: Fraction) -> int:
    return round(time * NANO)


def _points(motion: ExportedMotion, times: list[int], *, efforts: bool) -> Iterator[dict[str, Any]]:
    for k, time in enumerate(times):
        yield {
            "positions": motion.position[k].tolist(),
            "velocities": motion.velocity[k].tolist(),
            "accelerations": [],
            "effort": motion.effort[k].tolist() if efforts else [],
            "time_from_start": {"sec": time // NANO, "nanosec": time % NANO},
        }
