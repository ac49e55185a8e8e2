"""Modules as other formats describe them, before they are text: what all readers hand on.

All numbers are floats in SI units and radians; vectors are tuples.  A reader of a format makes a
:class:`ModuleSet`; ``spec_text`` writes it.
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

# --- Where things are -----------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class Move:
    """A shift by a vector (m)."""

    by: Vector


@dataclass(frozen=True, slots=True)
class Turn:
    """A turn about an axis by an angle (rad)."""

    axis: Literal["x", "y", "z"]
    angle: float


@dataclass(frozen=True, slots=True)
class Motion:
    """A degree of freedom of the module, where it moves what comes after it."""

    dof: str


Step: TypeAlias = Move | Turn | Motion
Steps: TypeAlias = tuple[Step, ...]


@dataclass(frozen=True, slots=True)
class Placement:
    """A frame of the module, by its name, and steps from there."""

    base: str = "in"
    steps: Steps = ()


def acts(step: Step) -> bool:
    """Whether a step does anything."""
    match step:
        case Move():
            return any(step.by)
        case Turn():
            return step.angle != 0
        case Motion():
            return True


def joined(first: Steps, second: Steps) -> Steps:
    """Steps one after the other; two shifts with nothing between them are one."""
    before = tuple(step for step in first if acts(step))
    after = tuple(step for step in second if acts(step))
    if before and after and isinstance(before[-1], Move) and isinstance(after[0], Move):
        one, two = before[-1].by, after[0].by
        both = Move((one[0] + two[0], one[1] + two[1], one[2] + two[2]))
        return (*before[:-1], both, *after[1:])
    return (*before, *after)


def steps_of(matrix: NDArray[np.float64]) -> Steps:
    """The shift and the turns of a homogeneous matrix (4, 4): ``move * rot z * rot y * rot x``.

    Raises:
        ValueError: the matrix is no rigid displacement.
    """
    rotation = matrix[:3, :3]
    if not np.all(np.isfinite(matrix)) or np.abs(matrix[3] - (0, 0, 0, 1)).max() > 1e-9:
        raise ValueError("it is not a homogeneous matrix of finite numbers")
    if np.abs(rotation @ rotation.T - np.eye(3)).max() > 1e-6 or np.linalg.det(rotation) < 0:
        raise ValueError("its upper left part is not a rotation")
    x, y, z = (float(value) for value in matrix[:3, 3])
    return (Move((x, y, z)), *turns_of(rotation))


def turns_of(rotation: NDArray[np.float64]) -> Steps:
    """Turns about z, y and x, in this order, whose product is a rotation (3, 3).

    Of the two ways to say it the one with fewer turns, else with a pitch of at most 90 degrees.
    """
    pitch = math.atan2(-rotation[2, 0], math.hypot(rotation[0, 0], rotation[1, 0]))
    if abs(math.cos(pitch)) > 1e-9:
        roll = math.atan2(rotation[2, 1], rotation[2, 2])
        yaw = math.atan2(rotation[1, 0], rotation[0, 0])
    else:  # only the difference or the sum of the two counts
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
    """The homogeneous matrix (4, 4) of steps without a motion."""
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


# --- What modules have ----------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class Drive:
    """Gear (rad per rad, or per m), rotor (kg m^2), viscous and dry friction; None: not said."""

    gear: float | None = None
    rotor: float | None = None
    viscous: float | None = None
    coulomb: float | None = None


@dataclass(frozen=True, slots=True)
class Dof:
    """A degree of freedom; None where nothing bounds it.

    ``range`` in rad or m, ``rate`` per s, ``accel`` per s^2, ``effort`` in N m or N.  Nothing
    drives a ``passive`` one.
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


@dataclass(frozen=True, slots=True)
class Port:
    """Where modules meet; ``in`` is the module's own end."""

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
    """A rigid body: mass (kg), centre (m) and inertia about it, (xx, yy, zz, xy, xz, yz) kg m^2."""

    place: Placement
    mass: float
    com: Vector
    inertia: tuple[float, float, float, float, float, float]
    comment: str = ""


@dataclass(frozen=True, slots=True)
class Shape:
    """Collision geometry.

    ``size``: of a sphere (radius,), of a box its edges, of a cylinder or capsule (radius, length)
    about the z axis of its frame, where it begins; of a hull (unit of its file in m,).  A
    ``visual`` is a mesh for pictures alone, with the unit of its file.
    """

    kind: Literal["sphere", "box", "cylinder", "capsule", "hull", "visual"]
    place: Placement
    size: tuple[float, ...]
    file: str = ""
    comment: str = ""


@dataclass(frozen=True, slots=True)
class Module:
    """A module as text is to say it; ``comments`` are lines above it."""

    name: str
    role: Role
    ports: Sequence[Port]
    frames: Sequence[Frame] = ()
    dofs: Sequence[Dof] = ()
    bodies: Sequence[Body] = ()
    shapes: Sequence[Shape] = ()
    effectors: Sequence[Placement] = ()
    comments: Sequence[str] = ()


@dataclass(frozen=True, slots=True)
class Family:
    """A grammar from ports; ``accept`` is a condition as text, empty where there is none."""

    name: str
    start: str
    carried: Sequence[str]
    accept: str = ""
    comments: Sequence[str] = ()


@dataclass(slots=True)
class ModuleSet:
    """What a reader has read.

    ``remarks`` say what could not be carried over, one a line, and ``warnings`` what of it has a
    place in the file.
    """

    comments: list[str] = field(default_factory=list)
    modules: list[Module] = field(default_factory=list)
    families: list[Family] = field(default_factory=list)
    remarks: list[str] = field(default_factory=list)
    warnings: Sequence[SourceWarning] = ()
