"""Modules from other formats, as readers pass them on to ``spec_text``, which writes the text.

A reader of a format makes a :class:`ModuleSet`.  All numbers are floats in SI units and radians;
vectors are tuples.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Literal, TypeAlias

import numpy as np
from numpy.typing import NDArray

from srgc.imports.source_warning import SourceWarning

Vector: TypeAlias = tuple[float, float, float]
Axis: TypeAlias = Literal["x", "y", "z", "-x", "-y", "-z"]
MotionKind: TypeAlias = Literal["revolute", "prismatic"]
Role: TypeAlias = Literal["base", "joint", "link", "effector"]

# --- Placements -----------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class Move:
    """A translation by a vector (m)."""

    by: Vector


@dataclass(frozen=True, slots=True)
class Turn:
    """A rotation about a coordinate axis by an angle (rad)."""

    axis: Literal["x", "y", "z"]
    angle: float


@dataclass(frozen=True, slots=True)
class Motion:
    """The motion of a degree of freedom, which moves all that follows it."""

    dof: str


Step: TypeAlias = Move | Turn | Motion
Steps: TypeAlias = tuple[Step, ...]


@dataclass(frozen=True, slots=True)
class Placement:
    """A named frame of the module, and steps from there."""

    base: str = "in"
    steps: Steps = ()


def acts(step: Step) -> bool:
    """Whether a step is not the identity."""
    match step:
        case Move():
            return any(step.by)
        case Turn():
            return step.angle != 0
        case Motion():
            return True


def joined(first: Steps, second: Steps) -> Steps:
    """Concatenate steps; two adjacent translations are merged into one."""
    before = tuple(step for step in first if acts(step))
    after = tuple(step for step in second if acts(step))
    if before and after and isinstance(before[-1], Move) and isinstance(after[0], Move):
        one, two = before[-1].by, after[0].by
        both = Move((one[0] + two[0], one[1] + two[1], one[2] + two[2]))
        return (*before[:-1], both, *after[1:])
    return (*before, *after)


def steps_of(matrix: NDArray[np.float64]) -> Steps:
    """The translation and rotations of a homogeneous matrix: ``move * rot z * rot y * rot x``.

    Raises:
        ValueError: the matrix (4, 4) is not a rigid displacement.
    """
    rotation = matrix[:3, :3]
    if not np.all(np.isfinite(matrix)) or np.abs(matrix[3] - (0, 0, 0, 1)).max() > 1e-9:
        raise ValueError("it is not a homogeneous matrix of finite numbers")
    if np.abs(rotation @ rotation.T - np.eye(3)).max() > 1e-6 or np.linalg.det(rotation) < 0:
        raise ValueError("its upper left part is not a rotation")
    x, y, z = (float(value) for value in matrix[:3, 3])
    return (Move((x, y, z)), *turns_of(rotation))


def turns_of(rotation: NDArray[np.float64]) -> Steps:
    """Rotations about z, y and x, in this order, whose product is a rotation matrix (3, 3).

    Of the two solutions this is the one with fewer rotations, otherwise the one with a pitch of at
    most 90 degrees.
    """
    pitch = math.atan2(-rotation[2, 0], math.hypot(rotation[0, 0], rotation[1, 0]))
    if abs(math.cos(pitch)) > 1e-9:
        roll = math.atan2(rotation[2, 1], rotation[2, 2])
        yaw = math.atan2(rotation[1, 0], rotation[0, 0])
    else:  # only the sum or difference of roll and yaw matters
        roll = 0.0
        yaw = math.atan2(-rotation[0, 1], rotation[1, 1])
    said = (yaw, pitch, roll)
    other = (_opposite(yaw), math.copysign(math.pi, pitch) - pitch, _opposite(roll))
    chosen = min((said, other), key=lambda angles: sum(abs(a) > 1e-9 for a in angles))
    yaw, pitch, roll = (math.pi if a < 1e-9 - math.pi else a for a in chosen)
    return (Turn("z", yaw), Turn("y", pitch), Turn("x", roll))


def _opposite(angle: float) -> float:
    return angle - math.copysign(math.pi, angle)


def matrix_of(steps: Steps) -> NDArray[np.float64]:
    """The homogeneous matrix (4, 4) of steps.

    Raises:
        ValueError: one of the steps is a motion.
    """
    found = np.eye(4)
    for step in steps:
        match step:
            case Move():
                found[:3, 3] += found[:3, :3] @ np.array(step.by)
            case Turn():
                found[:3, :3] = found[:3, :3] @ _rotation(step)
            case Motion():
                raise ValueError(f"the displacement of `{step.dof}` is not known")
    return found


def _rotation(turn: Turn) -> NDArray[np.float64]:
    cosine, sine = math.cos(turn.angle), math.sin(turn.angle)
    first, second = {"x": (1, 2), "y": (2, 0), "z": (0, 1)}[turn.axis]
    found = np.eye(3)
    found[first, first] = found[second, second] = cosine
    found[first, second], found[second, first] = -sine, sine
    return found


# --- Parts of modules -----------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class Drive:
    """Gear ratio (rad/rad or rad/m), rotor inertia (kg m^2), viscous and dry friction, or None."""

    gear: float | None = None
    rotor: float | None = None
    viscous: float | None = None
    coulomb: float | None = None


@dataclass(frozen=True, slots=True)
class Dof:
    """A degree of freedom; a limit is None if there is no bound, ``named`` is its joint.

    ``range`` is in rad or m, ``rate`` per s, ``accel`` per s^2, ``effort`` in N m or N.  A
    ``passive`` degree of freedom has no drive.
    """

    name: str
    kind: MotionKind
    axis: Axis
    range: tuple[float, float] | None = None
    rate: float | None = None
    accel: float | None = None
    effort: float | None = None
    drive: Drive = Drive()
    comment: str = ""
    passive: bool = False
    named: str = ""


@dataclass(frozen=True, slots=True)
class Port:
    """A port, where modules are joined; ``in`` is the module's own end."""

    name: str
    type: str
    gender: Literal["male", "female"] | None = None


@dataclass(frozen=True, slots=True)
class Frame:
    """A named frame."""

    name: str
    place: Placement


@dataclass(frozen=True, slots=True)
class Body:
    """A rigid body: mass (kg), centre (m), inertia about it (xx, yy, zz, xy, xz, yz) in kg m^2."""

    place: Placement
    mass: float
    com: Vector
    inertia: tuple[float, float, float, float, float, float]
    comment: str = ""


@dataclass(frozen=True, slots=True)
class Shape:
    """Collision geometry, or a mesh for pictures.

    ``size`` is (radius,) of a sphere, the edges of a box, (radius, length) of a cylinder or
    capsule, which extends along the z axis from the origin of its frame, and (unit of the file in
    m,) of a ``hull`` or ``visual``.  A ``visual`` is a mesh for pictures only.
    """

    kind: Literal["sphere", "box", "cylinder", "capsule", "hull", "visual"]
    place: Placement
    size: tuple[float, ...]
    file: str = ""
    comment: str = ""


@dataclass(frozen=True, slots=True)
class Module:
    """A module to be written as text; ``comments`` are the lines above it, ``named`` its part."""

    name: str
    role: Role
    ports: Sequence[Port]
    frames: Sequence[Frame] = ()
    dofs: Sequence[Dof] = ()
    bodies: Sequence[Body] = ()
    shapes: Sequence[Shape] = ()
    effectors: Sequence[Placement] = ()
    comments: Sequence[str] = ()
    named: str = ""


@dataclass(frozen=True, slots=True)
class Family:
    """A grammar from ports; ``accept`` is a condition as text, empty if there is none."""

    name: str
    start: str
    carried: Sequence[str]
    accept: str = ""
    comments: Sequence[str] = ()


@dataclass(slots=True)
class ModuleSet:
    """The result of a reader.

    ``remarks`` say what could not be carried over, one a line; ``warnings`` say the same for things
    that have a place in the file.
    """

    comments: list[str] = field(default_factory=list)
    modules: list[Module] = field(default_factory=list)
    families: list[Family] = field(default_factory=list)
    remarks: list[str] = field(default_factory=list)
    warnings: Sequence[SourceWarning] = ()
