"""The motion of joints of a URDF: held, or by degrees of freedom with limits."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from fractions import Fraction
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
from srgc.imports.names import in_quotes
from srgc.imports.urdf.joint_file import DriveBeside
from srgc.imports.urdf.robot_model import UrdfRobot
from srgc.imports.urdf.written_numbers import UNLIMITED

if TYPE_CHECKING:
    from yourdfpy.urdf import Joint

STRAIGHT = 1e-12
_AXES: tuple[Literal["x", "y", "z"], ...] = ("x", "y", "z")
_OPPOSITE: tuple[Axis, ...] = ("-x", "-y", "-z")


@dataclass(frozen=True, slots=True)
class JointMotion:
    """The degrees of freedom of a joint, and the steps from its frame to the frame of its link."""

    dofs: tuple[Dof, ...]
    steps: Steps


@dataclass(slots=True)
class JointMotions:
    """Reads joints.

    ``held`` maps joints to be fixed to their values (rad, m), ``beside`` joints to the parameters
    from the file next to the URDF.
    """

    robot: UrdfRobot
    held: Mapping[str, float]
    remarks: list[str]
    beside: Mapping[str, DriveBeside] = field(default_factory=dict[str, DriveBeside])
    unlimited: list[str] = field(default_factory=list)

    def of(self, name: str) -> JointMotion:
        """The motion of a joint.

        Raises:
            UsageFault: srgc has no joint of this kind, or with this axis or these limits.
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
        """Hold a joint that mimics others where it is when the joint they all follow is at rest."""
        name, leader = joint.name, joint.mimic.joint
        value = self._rest(name, ())
        unit = "m" if joint.type == "prismatic" else "rad"
        held = f"{value:g} {unit}"
        limit = joint.limit
        if limit is not None and joint.type != "continuous":
            low, high = float(limit.lower or 0.0), float(limit.upper or 0.0)
            if not low <= value <= high:
                held += f", outside of its range from {low:g} to {high:g}"
        self.remarks.append(
            f"joint `{visible(name)}` mimics `{visible(leader)}` and is held at {held}: "
            "joints in srgc move independently"
        )
        return JointMotion((), self._at(joint, value))

    def _rest(self, name: str, followers: tuple[str, ...]) -> float:
        """The value of a joint when all independent joints are at 0 or held (rad, m)."""
        joint = self.robot.joints[name]
        if name in self.held:
            return self.held[name]
        if joint.mimic is None or joint.type == "fixed":
            return _only_value(joint) or 0.0
        leader = joint.mimic.joint
        if leader not in self.robot.joints:
            near = nearest(leader, list(self.robot.joints))
            hint = None if near is None else f"did you mean `{near}`?"
            message = f"joint `{visible(name)}` mimics `{visible(leader)}`, which is not a joint"
            raise self.robot.fault("joint", name, message, hint)
        if leader in (*followers, name):
            message = f"joint `{visible(name)}` mimics `{visible(leader)}`, and so itself"
            raise self.robot.fault("joint", name, message, "one joint has to move by itself")
        leading = self._rest(leader, (*followers, name))
        return float(joint.mimic.multiplier) * leading + float(joint.mimic.offset)

    def _at(self, joint: Joint, value: float) -> Steps:
        """The steps of a joint held at a value."""
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

    # --- Moving joints ----------------------------------------------------------------------------

    def _axial(self, joint: Joint) -> JointMotion:
        kind: MotionKind = "prismatic" if joint.type == "prismatic" else "revolute"
        name = "s" if kind == "prismatic" else "q"
        axis = self._axis(joint)
        along = _coordinate(axis)
        limits = self._limits(joint)
        if (value := _only_value(joint)) is not None:
            self.remarks.append(
                f"joint `{visible(joint.name)}` has a range of one value and is held at {value:g}"
            )
            return JointMotion((), self._at(joint, value))
        if not in_quotes(joint.name):
            said = f"joint `{visible(joint.name)}` cannot have this name in exports"
            self.remarks.append(said)
        dof = Dof(name, kind, along or "z", *limits, drive=self._drive(joint), named=joint.name)
        if along is not None:
            return JointMotion((dof,), (Motion(name),))
        aligned = _aligning(axis)
        return JointMotion((dof,), (*aligned, Motion(name), *_inverse(aligned)))

    def _planar(self, joint: Joint) -> JointMotion:
        """Two translations perpendicular to the axis, then a rotation about it, as URDF defines."""
        parts = {"limit": joint.limit, "dynamics": joint.dynamics}
        left = " and ".join(f"<{tag}>" for tag, part in parts.items() if part is not None)
        self.remarks.append(
            f"joint `{visible(joint.name)}` is planar: two shifts and a turn, without limits"
            + (f"; {left} {'are' if ' ' in left else 'is'} left out" if left else "")
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
    ) -> tuple[tuple[float, float] | None, float | None, float | None, float | None]:
        """Range, rate, acceleration and effort; each None if it has no limit."""
        limit, beside = joint.limit, self.beside.get(joint.name)
        most = None if beside is None else beside.acceleration
        if limit is None:
            if joint.type in ("revolute", "prismatic"):
                message = f"joint `{visible(joint.name)}` lacks <limit lower=... upper=...>"
                hint = 'one without a range has type="continuous"'
                raise self.robot.fault("joint", joint.name, message, hint)
            return None, None, most, None
        found = None
        low, high = float(limit.lower or 0.0), float(limit.upper or 0.0)
        if joint.type == "continuous":
            if low != high:
                said = f"its range from {low:g} to {high:g} is left out"
                self.remarks.append(f"joint `{visible(joint.name)}` is continuous: {said}")
        else:
            if low > high:
                message = f"joint `{visible(joint.name)}` has a range from {low:g} down to {high:g}"
                raise self.robot.fault("joint", joint.name, message)
            found = None if min(-low, high) >= UNLIMITED else (low, high)
        return found, self._bound(joint, "velocity"), most, self._bound(joint, "effort")

    def _bound(self, joint: Joint, name: str) -> float | None:
        """The bound of a velocity or effort; None for 0 and for values that stand for no bound."""
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
        gear, beside = self.robot.gears.get(joint.name), self.beside.get(joint.name)
        rotor = None
        if beside is not None and beside.armature is not None:
            rotor = _rotor(beside.armature, gear or 1.0)
            if joint.type == "prismatic":
                gear = gear or 1.0  # the language requires a gear for prismatic joints
        return Drive(gear, rotor, viscous=said["damping"], coulomb=said["friction"])


def _rotor(armature: float, gear: float) -> float:
    """The inertia of a rotor that acts as ``armature`` at the joint, as the shortest decimal."""
    ratio = Fraction(repr(gear)) ** 2
    for digits in range(1, 17):
        text = f"{armature / gear**2:.{digits}g}"
        if float(ratio * Fraction(text)) == armature:
            return float(text)
    return armature / gear**2


def _only_value(joint: Joint) -> float | None:
    """The value of a joint whose range has a single value (rad, m); otherwise None."""
    limit = joint.limit
    if limit is None or joint.type not in ("revolute", "prismatic"):
        return None
    low, high = float(limit.lower or 0.0), float(limit.upper or 0.0)
    return low if low == high else None


def held_values(robot: UrdfRobot, texts: Iterable[str]) -> dict[str, float]:
    """Parse the joints to be held, each ``JOINT`` or ``JOINT=VALUE`` (rad, m).

    Raises:
        UsageFault: there is no such joint, or the value is not a number.
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
        kind = robot.joints[name].type
        if found[name] and kind in ("fixed", "floating", "planar"):
            message = f"joint `{visible(name)}` is {kind}, and one number does not say where it is"
            raise UsageFault(f"--fix {text}: {message}; --fix {name} holds it where its origin is")
    return found


# --- Axes -----------------------------------------------------------------------------------------


def _coordinate(axis: np.ndarray) -> Axis | None:
    """The coordinate axis that a unit vector lies along, or None."""
    number = int(np.argmax(np.abs(axis)))
    rest = np.delete(axis, number)
    if np.abs(rest).max() > STRAIGHT:
        return None
    letter = _AXES[number]
    return letter if axis[number] > 0 else _OPPOSITE[number]


def _aligning(axis: np.ndarray) -> Steps:
    """Rotations after which z points along a unit vector."""
    if _coordinate(axis) == "z":
        return ()
    yaw = math.atan2(axis[1], axis[0])
    pitch = math.atan2(math.hypot(axis[0], axis[1]), axis[2])
    return tuple(turn for turn in (Turn("z", yaw), Turn("y", pitch)) if turn.angle)


def _inverse(turns: Steps) -> Steps:
    return tuple(Turn(turn.axis, -turn.angle) for turn in reversed(turns) if isinstance(turn, Turn))
