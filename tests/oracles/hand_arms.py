"""Arms put together by hand, as MuJoCo computes them: no code of the project.

A part of an arm is put at the current place, which joints, turns and moves change.  MuJoCo gives
the acceleration and the places of points for a state; scipy integrates.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from itertools import pairwise

import mujoco
import numpy as np
from scipy.spatial.transform import Rotation

from compiler.arrays import Array

Torque = Callable[[float, float, Array, float], float]
"""The torque on a joint from its coordinate, its rate, the states of its drive and its input."""
Slope = Callable[[float, float, Array, float], list[float]]
TINY = 1e-13
"""A moment of inertia (kg m^2) that MuJoCo asks of every body and that no test can see."""


@dataclass(frozen=True)
class Drive:
    """How an input acts on a joint; ``states`` are those of the drive at the start."""

    torque: Torque = lambda _q, _v, _s, u: u
    slope: Slope = lambda _q, _v, _s, _u: []
    states: tuple[float, ...] = ()


@dataclass(frozen=True)
class HandJoint:
    """A joint: its place in the word, its kind, and its limits as exact or nearby numbers."""

    symbol: int
    kind: str
    range: tuple[float, float] | None
    rate: tuple[float, float] | None
    drive: Drive


@dataclass
class _Body:
    """A rigid body: mass, first moment and second moment about its origin."""

    parent: int
    pose: tuple[Array, Array]
    joint: tuple[int, Array] | None
    mass: float = 0.0
    moment: Array = field(default_factory=lambda: np.zeros(3))
    inertia: Array = field(default_factory=lambda: np.zeros((3, 3)))
    sites: list[tuple[str, Array]] = field(default_factory=list)


def _steiner(mass: float, at: Array) -> Array:
    """The moments of inertia of a point mass about the origin."""
    found: Array = mass * (at @ at * np.eye(3) - np.outer(at, at))
    return found


class HandArm:
    """Built outwards; ``place`` is the body and the pose on it where the next part goes."""

    def __init__(self) -> None:
        self._bodies = [_Body(-1, (np.eye(3), np.zeros(3)), None)]
        self.joints: list[HandJoint] = []
        self.effectors: list[str] = []
        self.rods: list[tuple[str, str]] = []
        """Per body the names of its ends; twice the same for a point or a solid."""
        self.place: tuple[int, Array, Array] = (0, np.eye(3), np.zeros(3))
        self._names = 0

    def turn(self, axis: int, angle: float) -> HandArm:
        body, turn, origin = self.place
        vector = angle * np.eye(3)[axis]
        self.place = (body, turn @ Rotation.from_rotvec(vector).as_matrix(), origin)
        return self

    def move(self, x: float = 0, y: float = 0, z: float = 0) -> HandArm:
        body, turn, origin = self.place
        self.place = (body, turn, origin + turn @ np.array([x, y, z], dtype=float))
        return self

    def joint(
        self,
        symbol: int,
        axis: int,
        kind: str = "hinge",
        limits: tuple[float, float] | None = None,
        rate: tuple[float, float] | None = None,
        drive: Drive | None = None,
    ) -> HandArm:
        body, turn, origin = self.place
        self._bodies.append(_Body(body, (turn, origin), (len(self.joints), np.eye(3)[axis])))
        self.joints.append(HandJoint(symbol, kind, limits, rate, drive or Drive()))
        self.place = (len(self._bodies) - 1, np.eye(3), np.zeros(3))
        return self

    def rod(self, axis: int, length: float, density: float, start: float = 0.0) -> HandArm:
        """A thin rod from ``start`` along an axis; in the plane alone, where just z counts."""
        mass, along = density * abs(length), np.eye(3)[axis]
        ends = [start * along, (start + length) * along]
        self._mass(mass, (ends[0] + ends[1]) / 2, np.eye(3) * mass * length**2 / 12)
        self.rods.append((self._site(ends[0]), self._site(ends[1])))
        return self

    def point(self, mass: float) -> HandArm:
        return self.solid(mass, (0, 0, 0), np.zeros(3))

    def solid(self, mass: float, com: Sequence[float], moments: Sequence[float]) -> HandArm:
        """A body with moments of inertia about axes through its centre of mass."""
        self._mass(mass, np.array(com, dtype=float), np.diag(np.array(moments, dtype=float)))
        name = self._site(np.array(com, dtype=float))
        self.rods.append((name, name))
        return self

    def effector(self) -> HandArm:
        self.effectors.append(self._site(np.zeros(3)))
        return self

    def _mass(self, mass: float, com: Array, inertia: Array) -> None:
        number, turn, origin = self.place
        body, at = self._bodies[number], origin + turn @ com
        body.mass += mass
        body.moment = body.moment + mass * at
        body.inertia = body.inertia + turn @ inertia @ turn.T + _steiner(mass, at)

    def _site(self, at: Array) -> str:
        number, turn, origin = self.place
        self._names += 1
        name = f"p{self._names}"
        self._bodies[number].sites.append((name, origin + turn @ at))
        return name

    def mjcf(self, gravity: Sequence[float]) -> str:
        pull = " ".join(repr(float(g)) for g in [*gravity, 0, 0, 0][:3])
        return (
            f'<mujoco><option gravity="{pull}"><flag contact="disable"/></option>'
            f'<compiler angle="radian" inertiafromgeom="false"/>'
            f"<worldbody>{self._inner(0)}</worldbody></mujoco>"
        )

    def _inner(self, number: int) -> str:
        body = self._bodies[number]
        parts = [f'<site name="{name}" pos="{_text(at)}"/>' for name, at in body.sites]
        if body.joint is not None:
            index, axis = body.joint
            kind = self.joints[index].kind
            parts.append(f'<joint name="j{index}" type="{kind}" axis="{_text(axis)}"/>')
            mass = max(body.mass, TINY)
            com = body.moment / mass
            about = body.inertia - _steiner(body.mass, com) + TINY * np.eye(3)
            six = _text(about[i, j] for i, j in ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)))
            at = _text(com)
            parts.append(f'<inertial pos="{at}" mass="{float(mass)!r}" fullinertia="{six}"/>')
        for child, other in enumerate(self._bodies):
            if other.parent == number:
                turn, origin = other.pose
                x, y, z, w = Rotation.from_matrix(turn).as_quat()
                head = f'<body pos="{_text(origin)}" quat="{_text((w, x, y, z))}">'
                parts.append(f"{head}{self._inner(child)}</body>")
        return "".join(parts)


def _text(values: object) -> str:
    return " ".join(repr(float(value)) for value in values)  # type: ignore[attr-defined]


class SimulatedArm:
    """The mechanics of an arm; joints in the order of their symbols in the word."""

    def __init__(self, arm: HandArm, gravity: Sequence[float]) -> None:
        self.model = mujoco.MjModel.from_xml_string(arm.mjcf(gravity))
        self.data = mujoco.MjData(self.model)
        order = sorted(range(len(arm.joints)), key=lambda i: arm.joints[i].symbol)
        self.joints = [arm.joints[i] for i in order]
        self._at = np.array([self.model.joint(f"j{i}").qposadr[0] for i in order], dtype=int)
        # A site's number is the order of the bodies in MuJoCo's file, not that of their making.
        self._effectors = [self.model.site(name).id for name in arm.effectors]
        self._rods = [[self.model.site(name).id for name in ends] for ends in arm.rods]
        sizes = [len(joint.drive.states) for joint in self.joints]
        ends = np.cumsum([0, *sizes])
        self._own = [slice(int(a), int(b)) for a, b in pairwise(ends)]

    @property
    def own_states(self) -> list[float]:
        """The states of the drives at the start."""
        return [value for joint in self.joints for value in joint.drive.states]

    def slope(self, state: Array, u: Array) -> Array:
        """The derivative of (q, v, s)."""
        n = len(self.joints)
        q, v, own = state[:n], state[n : 2 * n], state[2 * n :]
        pulls, inner = [], list[float]()
        for joint, part, x, rate, pull in zip(self.joints, self._own, q, v, u, strict=True):
            pulls.append(joint.drive.torque(x, rate, own[part], pull))
            inner += joint.drive.slope(x, rate, own[part], pull)
        self.data.qpos[self._at] = q
        self.data.qvel[self._at] = v
        self.data.qfrc_applied[self._at] = pulls
        mujoco.mj_forward(self.model, self.data)
        return np.concatenate([v, self.data.qacc[self._at], inner])

    def points(self, coordinates: Array) -> tuple[Array, Array]:
        """Effectors (samples, effectors, 3) and ends of bodies (samples, bodies, 2, 3)."""
        tips, ends = [], []
        for q in coordinates:
            self.data.qpos[self._at] = q
            mujoco.mj_kinematics(self.model, self.data)
            sites = self.data.site_xpos
            tips.append(sites[self._effectors])
            ends.append([sites[pair] for pair in self._rods])
        return np.array(tips), np.array(ends)
