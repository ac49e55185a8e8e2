"""What a joint of a URDF does: it is held, or it moves by degrees of freedom with limits."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Literal

import numpy as np

from grammar_lang.diagnostics.wording import nearest
from grammar_lang.files.file_tree import visible
from srgc.faults import UsageFault
from srgc.imports.module_set import (
    Axis,
    Dof,
    Drive,
    Motion,
    MotionKind,
    Move,
    Steps,
    Turn,
)
from srgc.imports.urdf.robot_model import UNLIMITED, UrdfRobot

if TYPE_CHECKING:
    from yourdfpy.urdf import Joint

STRAIGHT = 1e-12
_AXES: tuple[Literal["x", "y", "z"], ...] = ("x", "y", "z")
_OPPOSITE: tuple[Axis, ...] = ("-x", "-y", "-z")


@dataclass(frozen=True, slots=True)
class JointMotion:
    """The degrees of freedom of a joint, and the steps from its frame to that of its link."""

    dofs: tuple[Dof, ...]
    steps: Steps


@dataclass(slots=True)
class JointMotions:
    """Reads joints; ``held`` are values (rad, m) of joints that are to be fixed."""

    robot: UrdfRobot
    held: Mapping[str, float]
    remarks: list[str]
    unlimited: list[str] = field(default_factory=list)

    def of(self, name: str) -> JointMotion:
        """What a joint does.

        Raises:
            UsageFault: its axis, its limits or its kind are of no joint that srgc has.
        """
        joint = self.robot.joints[name]
        if name in self.held:
            return JointMotion((), self._at(joint, self.held[name]))
        if joint.mimic is not None and joint.type != "fixed":
            return self._mimicking(joint)
        match joint.type:
            case "fixed":
                return JointMotion((), ())
            case "floating":
                message = f"joint `{visible(name)}` is floating, and robots stand on a base"
                raise self.robot.fault("joint", name, message, f"`--fix {name}` holds it at 0")
            case "planar":
                return self._planar(joint)
            case _:
                return self._axial(joint)

    def _mimicking(self, joint: Joint) -> JointMotion:
        """A joint that follows another one is held where that one is at 0."""
        name, leader = joint.name, joint.mimic.joint
        if leader not in self.robot.joints:
            near = nearest(leader, list(self.robot.joints))
            hint = None if near is None else f"did you mean `{near}`?"
            message = f"joint `{visible(name)}` mimics `{visible(leader)}`, which is not a joint"
            raise self.robot.fault("joint", name, message, hint)
        leading = self.held.get(leader, 0.0)
        value = float(joint.mimic.multiplier) * leading + float(joint.mimic.offset)
        unit = "m" if joint.type == "prismatic" else "rad"
        held = f"{value:g} {unit}"
        limit = joint.limit
        if limit is not None and joint.type != "continuous":
            low, high = float(limit.lower or 0.0), float(limit.upper or 0.0)
            if not low <= value <= high:
                held += f", outside of its range from {low:g} to {high:g}"
        self.remarks.append(
            f"joint `{visible(name)}` mimics `{visible(leader)}` and is held at {held}: "
            "joints of srgc move by themselves"
        )
        return JointMotion((), self._at(joint, value))

    def _at(self, joint: Joint, value: float) -> Steps:
        """The steps of a joint that is held at a value."""
        axis = self._axis(joint) if joint.type not in ("fixed", "floating", "planar") else None
        if axis is None:
            return ()
        if joint.type == "prismatic":
            x, y, z = (float(part) * value for part in axis)
            return (Move((x, y, z)),)
        named = _coordinate(axis)
        if named is not None:
            number = int(np.argmax(np.abs(axis)))
            return (Turn(_AXES[number], float(np.sign(axis[number])) * value),)
        aligned = _aligning(axis)
        return (*aligned, Turn("z", value), *_inverse(aligned))

    def _axis(self, joint: Joint) -> np.ndarray:
        axis = np.asarray(joint.axis, dtype=float)
        length = float(np.linalg.norm(axis))
        if not length > 1e-9:
            message = f"joint `{visible(joint.name)}` has the axis 0"
            raise self.robot.fault("joint", joint.name, message)
        return axis / length

    # --- Joints that move -------------------------------------------------------------------------

    def _axial(self, joint: Joint) -> JointMotion:
        kind: MotionKind = "prismatic" if joint.type == "prismatic" else "revolute"
        name = "s" if kind == "prismatic" else "q"
        axis = self._axis(joint)
        along = _coordinate(axis)
        limits = self._limits(joint)
        if limits[0] is not None and limits[0][0] == limits[0][1]:
            value = limits[0][0]
            self.remarks.append(
                f"joint `{visible(joint.name)}` has a range of one value and is held at {value:g}"
            )
            return JointMotion((), self._at(joint, value))
        dof = Dof(name, kind, along or "z", *limits, drive=self._drive(joint))
        if along is not None:
            return JointMotion((dof,), (Motion(name),))
        aligned = _aligning(axis)
        return JointMotion((dof,), (*aligned, Motion(name), *_inverse(aligned)))

    def _planar(self, joint: Joint) -> JointMotion:
        """Two shifts across the axis, then a turn about it, as the format says."""
        self.remarks.append(
            f"joint `{visible(joint.name)}` is planar: two shifts and a turn, without limits"
        )
        dofs = (
            Dof("sx", "prismatic", "x"),
            Dof("sy", "prismatic", "y"),
            Dof("q", "revolute", "z"),
        )
        aligned = _aligning(self._axis(joint))
        motions = (Motion("sx"), Motion("sy"), Motion("q"))
        return JointMotion(dofs, (*aligned, *motions, *_inverse(aligned)))

    def _limits(
        self, joint: Joint
    ) -> tuple[tuple[float, float] | None, float | None, None, float | None]:
        """Range, rate, no acceleration, and effort; None where there is no limit."""
        limit = joint.limit
        if limit is None:
            if joint.type in ("revolute", "prismatic"):
                message = f"joint `{visible(joint.name)}` lacks <limit lower=... upper=...>"
                hint = 'one without a range has type="continuous"'
                raise self.robot.fault("joint", joint.name, message, hint)
            return None, None, None, None
        found = None
        if joint.type != "continuous":
            low, high = float(limit.lower or 0.0), float(limit.upper or 0.0)
            if low > high:
                message = f"joint `{visible(joint.name)}` has a range from {low:g} down to {high:g}"
                raise self.robot.fault("joint", joint.name, message)
            found = None if min(-low, high) >= UNLIMITED else (low, high)
        return found, self._bound(joint, "velocity"), None, self._bound(joint, "effort")

    def _bound(self, joint: Joint, name: str) -> float | None:
        """A bound above 0 and below what stands for none."""
        value = getattr(joint.limit, name)
        if value is None or value >= UNLIMITED:
            return None
        if value < 0:
            message = f"joint `{visible(joint.name)}` has the {name} {value:g}, below 0"
            raise self.robot.fault("joint", joint.name, message)
        if value == 0:
            self.unlimited.append(f"{name} of `{visible(joint.name)}`")
            return None
        return float(value)

    def _drive(self, joint: Joint) -> Drive:
        dynamics = joint.dynamics
        said: dict[str, float | None] = {"damping": None, "friction": None}
        for name in said:
            value = float(getattr(dynamics, name) or 0.0) if dynamics is not None else 0.0
            if value < 0:
                message = f"joint `{visible(joint.name)}` has the {name} {value:g}, below 0"
                raise self.robot.fault("joint", joint.name, message)
            said[name] = value or None
        gear = self.robot.gears.get(joint.name) if joint.type != "prismatic" else None
        return Drive(gear=gear, viscous=said["damping"], coulomb=said["friction"])


def held_values(robot: UrdfRobot, texts: Iterable[str]) -> dict[str, float]:
    """The joints that are to be held, each ``JOINT`` or ``JOINT=VALUE`` (rad, m).

    Raises:
        UsageFault: there is no such joint, or the value is no number.
    """
    found = dict[str, float]()
    for text in texts:
        name, _, value = text.rpartition("=") if "=" in text else (text, "", "0")
        if name not in robot.joints:
            near = nearest(name, list(robot.joints))
            hint = "" if near is None else f"; did you mean `{near}`?"
            raise UsageFault(f"--fix {text}: there is no joint `{name}`{hint}")
        try:
            found[name] = float(value)
        except ValueError:
            raise UsageFault(f"--fix {text}: `{value}` is not a number") from None
        if not math.isfinite(found[name]):
            raise UsageFault(f"--fix {text}: `{value}` is not finite")
    return found


# --- Axes -----------------------------------------------------------------------------------------


def _coordinate(axis: np.ndarray) -> Axis | None:
    """The axis of the frame that a unit vector is, if it is one."""
    number = int(np.argmax(np.abs(axis)))
    rest = np.delete(axis, number)
    if np.abs(rest).max() > STRAIGHT:
        return None
    letter = _AXES[number]
    return letter if axis[number] > 0 else _OPPOSITE[number]


def _aligning(axis: np.ndarray) -> Steps:
    """Turns after which z points along a unit vector."""
    if _coordinate(axis) == "z":
        return ()
    yaw = math.atan2(axis[1], axis[0])
    pitch = math.atan2(math.hypot(axis[0], axis[1]), axis[2])
    return tuple(turn for turn in (Turn("z", yaw), Turn("y", pitch)) if turn.angle)


def _inverse(turns: Steps) -> Steps:
    return tuple(Turn(turn.axis, -turn.angle) for turn in reversed(turns) if isinstance(turn, Turn))
