r"""Arms of rods under gravity with a task each, from a seed; a reference motion shows it feasible.

Planar arms have two to four links in a vertical plane, every fifth arm a turning base and two links
in space.  The lengths are free within a range, the efforts bounded by 1.3 to 2 times the largest
static torque of the reference motion.  That motion is a quintic in the joints, its inputs those of
inverse dynamics in the middle of each step plus feedback, held for the step; scipy integrates it
(DOP853).  A draw whose motion does not keep all that its task asks, with room, is drawn again.

A rod of mass m moves as m/6 at each end and 2 m/3 in the middle do (Routh, Dynamics of a System of
Rigid Bodies, part I, art. 44), so that

.. math:: M = \sum_p m_p J_p^T J_p, \qquad h = \sum_p m_p J_p^T (\dot J_p \dot q - g),
    \qquad M \ddot q + h = u.

No code of the project computes anything here.
"""

from __future__ import annotations

import random
from collections.abc import Sequence
from dataclasses import dataclass
from math import ceil, cos, degrees, floor, pi, radians, sin

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

Array = NDArray[np.float64]

GRAVITY = 9.81
"""m/s^2, downwards."""
PAYLOAD = 0.5
"""kg, at the effector."""
COLUMN = 0.5
"""m: the height of the first limb's joint in space."""
MARGIN = 0.01
"""m: the distance that bodies keep from obstacles."""
FINE = 8
"""Samples of a step at which a reference motion is checked."""
EFFORT_SHARE = 0.92
"""The part of the effort bound that a reference motion may use."""


@dataclass(frozen=True)
class RodArm:
    """A chain of joints about ``axes`` (``y`` or ``z``), each with a rod behind it along x.

    Attributes:
        axes: per joint.
        lengths: of the rods (m); 0 for a joint without one.
        density: of all rods (kg/m).
        height: of the first joint (m).
        down: the acceleration of gravity (m/s^2).
    """

    axes: str
    lengths: tuple[float, ...]
    density: float
    height: float
    down: tuple[float, float, float]

    def places(self, q: Array) -> tuple[Array, Array, Array]:
        """Of a pose: the axes and the joints, (n, 3) each, and the rods' ends, (n + 1, 3)."""
        turn, at = np.eye(3), np.array([0.0, 0.0, self.height])
        axes, ends = [], [at]
        for axis, length, angle in zip(self.axes, self.lengths, q, strict=True):
            axes.append(turn[:, 1 if axis == "y" else 2])
            turn = turn @ _rotation(axis, angle)
            at = at + length * turn[:, 0]
            ends.append(at)
        return np.array(axes), np.array(ends[:-1]), np.array(ends)

    def mechanics(self, q: Array, v: Array) -> tuple[Array, Array]:
        """M, (n, n), and h, (n,)."""
        count = len(q)
        axes, joints, ends = self.places(q)
        spins = np.cumsum(axes * v[:, None], axis=0)
        before = np.vstack([np.zeros(3), spins[:-1]])
        twists = np.cumsum(np.cross(before, axes * v[:, None]), axis=0)
        rods = ends[1:] - ends[:-1]
        gained = np.cross(twists, rods) + np.cross(spins, np.cross(spins, rods))
        moved = np.vstack([np.zeros(3), np.cumsum(gained, axis=0)])
        masses, points, drifts, links = [], [], [], []
        for i, length in enumerate(self.lengths):
            rod = self.density * length
            for share, along in ((1 / 6, 0.0), (2 / 3, 0.5), (1 / 6, 1.0)):
                masses.append(share * rod)
                points.append(joints[i] + along * rods[i])
                drifts.append(moved[i] + along * gained[i])
                links.append(i)
        masses.append(PAYLOAD)
        points.append(ends[-1])
        drifts.append(moved[-1])
        links.append(count - 1)
        arms = np.array(points)[:, None, :] - joints[None, :, :]
        carried = np.arange(count)[None, :] <= np.array(links)[:, None]
        jacobians = np.cross(axes[None, :, :], arms) * carried[:, :, None]
        weighed = jacobians * np.array(masses)[:, None, None]
        mass = np.einsum("pic,pjc->ij", weighed, jacobians)
        bias = np.einsum("pic,pc->i", weighed, np.array(drifts) - np.array(self.down))
        return mass, bias

    def slope(self, state: Array, u: Array) -> Array:
        """The derivative of (q, v) under inputs."""
        q, v = np.split(state, 2)
        mass, bias = self.mechanics(q, v)
        return np.concatenate([v, np.linalg.solve(mass, u - bias)])


def _rotation(axis: str, angle: float) -> Array:
    c, s = cos(angle), sin(angle)
    rows = [[c, 0, s], [0, 1, 0], [-s, 0, c]] if axis == "y" else [[c, -s, 0], [s, c, 0], [0, 0, 1]]
    return np.array(rows)


@dataclass(frozen=True)
class Block:
    """A box turned about z by ``angle``; in the plane the third half side counts nothing."""

    centre: tuple[float, float, float]
    half: tuple[float, float, float]
    angle: float

    def distances(self, points: Array) -> Array:
        """Of points (..., 3) from the block (m); 0 within."""
        local = (points - np.array(self.centre)) @ _rotation("z", self.angle)
        outside: Array = np.linalg.norm(
            np.maximum(np.abs(local) - np.array(self.half), 0.0), axis=-1
        )
        return outside

    def hull(self, dimension: int) -> str:
        """As the language has it."""
        turn = _rotation("z", self.angle)
        corners = [(-1, -1), (1, -1), (1, 1), (-1, 1)]
        levels = (-1, 1) if dimension == 3 else (0,)
        spots = [
            np.array(self.centre) + turn @ (np.array([a, b, c]) * np.array(self.half))
            for c in levels
            for a, b in corners
        ]
        listed = ", ".join(f"({', '.join(_number(x) for x in p[:dimension])})" for p in spots)
        return f"hull {listed} m"


@dataclass(frozen=True)
class GravityTask:
    """A task, and the reference motion that shows it feasible.

    Attributes:
        seed: that it was made from.
        text: the specification.
        arm: the robot of the reference.
        effort: the bound (N*m).
        static: the largest static torque of the reference (N*m).
        step: the time between two samples (s).
        states: (q, v) of the reference, ``FINE`` times a step and at the end.
        inputs: of the steps, (steps, n).
        home: the region of the start, as low and high corners, or none where a pose is given.
        goal: the target, likewise.
        ranges: of the joints, half (rad).
        blocks: the obstacles.
        body: whether the whole body avoids them.
    """

    seed: int
    text: str
    arm: RodArm
    effort: float
    static: float
    step: float
    states: Array
    inputs: Array
    home: tuple[Array, Array]
    goal: tuple[Array, Array]
    ranges: Array
    blocks: tuple[Block, ...]
    body: bool


def gravity_task(seed: int) -> GravityTask:
    """The first draw of a seed whose reference motion keeps its task."""
    rng = random.Random(seed)
    while (found := _drawn(seed, rng)) is None:
        pass
    return found


def _drawn(seed: int, rng: random.Random) -> GravityTask | None:
    space = seed % 5 == 0
    count = 2 if space else 2 + seed % 3
    low, high = round(rng.uniform(0.25, 0.35), 3), round(rng.uniform(0.6, 0.95), 3)
    limbs = tuple(round(rng.uniform(low + 0.02, high - 0.02), 3) for _ in range(count))
    if len(set(limbs)) < count or abs(limbs[0] - limbs[1]) < 0.03:
        return None
    density = round(rng.uniform(0.5, 2.0), 2)
    half = [160.0, *[140.0] * count] if space else [150.0] * count
    arm = RodArm(
        "z" + "y" * count if space else "z" * count,
        (0.0, *limbs) if space else limbs,
        density,
        COLUMN if space else 0.0,
        (0.0, 0.0, -GRAVITY) if space else (0.0, -GRAVITY, 0.0),
    )
    ranges = np.radians(half)
    first, last = (
        np.array([radians(round(rng.uniform(-0.9, 0.9) * h, 1)) for h in half]) for _ in range(2)
    )
    step, steps = rng.choice((0.05, 0.1)), rng.randint(20, 60)
    if np.linalg.norm(arm.places(first)[2][-1] - arm.places(last)[2][-1]) < 0.4:
        return None
    wanted = [_quintic(first, last, k / (2 * steps), step * steps) for k in range(2 * steps + 1)]
    static = max(float(np.abs(arm.mechanics(q, 0 * q)[1]).max()) for q, _, _ in wanted)
    effort = round(rng.uniform(1.3, 2.0) * static, 1)
    needed = max(float(np.abs(_inverse(arm, *at)).max()) for at in wanted)
    if needed > EFFORT_SHARE * effort:
        return None
    reach = 1.25 * sum(limbs)
    followed = _tracked(arm, wanted, step, EFFORT_SHARE * effort)
    if followed is None:
        return None
    states, inputs = followed
    ends = np.array([arm.places(q)[2] for q in states[:, : len(first)]])
    tips = ends[:, -1]
    near = np.abs(states[:, : len(first)]) > ranges - radians(3)
    if near.any() or (space and ends[:, 1:, 2].min() < 0.05):
        return None
    side = rng.uniform(0.2, 0.26) if space else rng.uniform(0.13, 0.19)
    home, goal = (_region(rng, spot, side) for spot in (tips[0], tips[-1]))
    body = rng.random() < 0.5
    blocks = _blocks(rng, ends, body, (home, goal), rng.choice((0, 1, 1, 2)), space)
    if blocks is None:
        return None
    pose = None if rng.random() < 0.7 else [round(degrees(angle), 1) for angle in first]
    text = _text(arm, (low, high), half, reach, (home, goal), pose, blocks, body, effort,
                 (steps, step))  # fmt: skip
    return GravityTask(seed, text, arm, effort, static, step, states, inputs, home, goal, ranges,
                       blocks, body)  # fmt: skip


def _quintic(first: Array, last: Array, part: float, duration: float) -> tuple[Array, Array, Array]:
    """q, v and a of the motion from rest to rest, at a part of its duration (s)."""
    way = last - first
    return (
        first + way * (10 * part**3 - 15 * part**4 + 6 * part**5),
        way * (30 * part**2 - 60 * part**3 + 30 * part**4) / duration,
        way * (60 * part - 180 * part**2 + 120 * part**3) / duration**2,
    )


def _inverse(arm: RodArm, q: Array, v: Array, a: Array) -> Array:
    """The inputs of a motion."""
    mass, bias = arm.mechanics(q, v)
    inputs: Array = mass @ a + bias
    return inputs


def _tracked(
    arm: RodArm, wanted: Sequence[tuple[Array, Array, Array]], step: float, most: float
) -> tuple[Array, Array] | None:
    """The simulated motion along one that is given at the samples and in the middle of steps.

    None where an input is above ``most`` (N*m).
    """
    stiffness, damping = (0.3 / step) ** 2, 2 * 0.3 / step
    state = np.concatenate([wanted[0][0], 0 * wanted[0][0]])
    states, inputs = [state], []
    grid = np.linspace(0.0, step, FINE + 1)
    for k in range(0, len(wanted) - 1, 2):
        (q, v, _), (middle, rate, change) = wanted[k], wanted[k + 1]
        off, late = q - state[: len(q)], v - state[len(q) :]
        u = _inverse(arm, middle, rate, change + stiffness * off + damping * late)
        if np.abs(u).max() > most:
            return None
        answer = solve_ivp(
            lambda _t, x, u=u: arm.slope(x, u), (0.0, step), state,
            method="DOP853", rtol=1e-9, atol=1e-10, t_eval=grid,
        )  # fmt: skip
        states += list(answer.y.T[1:])
        inputs.append(u)
        state = states[-1]
    return np.array(states), np.array(inputs)


def _region(rng: random.Random, spot: Array, side: float) -> tuple[Array, Array]:
    """A cube about a point, which is off its middle by a quarter of a side at most."""
    low = np.array([floor(1e4 * (x - side * rng.uniform(0.25, 0.75))) / 1e4 for x in spot])
    return low, np.array([ceil(1e4 * x) / 1e4 for x in low + side])


def _blocks(
    rng: random.Random,
    ends: Array,
    body: bool,
    regions: Sequence[tuple[Array, Array]],
    count: int,
    space: bool,
) -> tuple[Block, ...] | None:
    """So many blocks near the way of the effector; none where ten trials find no place for one."""
    alongs = np.linspace(0.0, 1.0, 61)[:, None]
    rods = ends[:, :-1, None] + alongs * (ends[:, 1:, None] - ends[:, :-1, None])
    points, room = (rods, MARGIN + 0.03) if body else (ends[:, -1], 0.05)
    grid = np.linspace(0.0, 1.0, 7)
    found = list[Block]()
    for _ in range(count):
        for _ in range(10):
            spot = ends[round(rng.uniform(0.3, 0.7) * (len(ends) - 1)), -1]
            angle, away = rng.uniform(0, 2 * pi), rng.uniform(0.12, 0.4)
            rise = rng.uniform(-0.2, 0.2) if space else 0.0
            centre = spot + np.array([away * cos(angle), away * sin(angle), rise])
            half = [rng.uniform(0.04, 0.14) for _ in range(3)]
            block = Block(
                (round(centre[0], 3), round(centre[1], 3), round(centre[2], 3)),
                (round(half[0], 3), round(half[1], 3), round(half[2], 3)),
                round(rng.uniform(0.1, pi / 2 - 0.1), 3),
            )
            cubes = [
                np.stack(np.meshgrid(*(a + grid * (b - a) for a, b in zip(*at, strict=True))), -1)
                for at in regions
            ]
            if block.distances(points).min() > room and all(
                block.distances(cube).min() > 0.01 for cube in cubes
            ):
                found.append(block)
                break
        else:
            return None
    return tuple(found)


def _number(value: float) -> str:
    return repr(round(float(value), 4))


def _box(low: Array, high: Array, dimension: int) -> str:
    sides = [f"[{_number(a)}, {_number(b)}]" for a, b in zip(low, high, strict=True)]
    return f"box {' x '.join(sides[:dimension])} m"


def _text(
    arm: RodArm,
    lengths: tuple[float, float],
    half: Sequence[float],
    reach: float,
    regions: Sequence[tuple[Array, Array]],
    pose: Sequence[float] | None,
    blocks: Sequence[Block],
    body: bool,
    effort: float,
    horizon: tuple[int, float],
) -> str:
    """The specification."""
    space = arm.height > 0
    size, count = (3 if space else 2), len(arm.lengths) - space
    turn = f"module Turn {{ role joint; dof q: revolute z in [-{half[0]:g}, {half[0]:g}] deg; }}\n"
    based = "world * move(z, 0.5 m) * rot(z, Turn.q)" if space else "world"
    corner = np.array([reach, reach, COLUMN + reach])
    names = [f"O{i + 1}" for i in range(len(blocks))]
    obstacles = "".join(
        f"  obstacle {name} {block.hull(size)};\n"
        for name, block in zip(names, blocks, strict=True)
    )
    keeps = f"body margin {MARGIN} m" if body else "effector"
    avoid = f"  avoid {', '.join(names)} with {keeps};\n" if names else ""
    start = "in Home" if pose is None else f"at ({', '.join(f'{x} deg' for x in pose)})"
    down = ", ".join(f"{x:g}" for x in arm.down[:size])
    return (
        "module Base { role base; }\n"
        f"{turn if space else ''}"
        f"module Limb {{ role link; dof q: revolute {arm.axes[-1]} in [-{half[-1]:g}, "
        f"{half[-1]:g}] deg; param length in [{lengths[0]}, {lengths[1]}] m; }}\n"
        "module Hand { role effector; }\n"
        "grammar Arm { start Robot; hand: Robot -> Limbs Hand; limb: Limbs -> Limbs Limb;\n"
        f"  base: Limbs -> Base{' Turn' if space else ''}; accept count(Limb) == {count}; }}\n"
        "semantics Arm {\n"
        f"  base {{ this.tip = {based}; }}\n"
        f"  hand {{ point(frame: Limbs.tip, mass: {PAYLOAD} kg); effector(frame: Limbs.tip); }}\n"
        f"  limb {{ this.tip = Limbs.tip * rot({arm.axes[-1]}, Limb.q) * move(x, Limb.length);\n"
        f"    rod(frame: this.tip, axis: -x, length: Limb.length, "
        f"density: {arm.density} kg/m); }}\n"
        "}\n"
        "workspace Place {\n"
        f"  {'space xyz' if space else 'plane xy'};\n"
        f"  bounds {_box(np.array([-reach, -reach, 0.0]), corner, size)};\n"
        f"  region Home {_box(*regions[0], size)};\n"
        f"  target Goal {_box(*regions[1], size)};\n"
        f"{obstacles}"
        "}\n"
        "task T {\n"
        f"  robot Arm; workspace Place;\n  start {start};\n  reach Goal;\n{avoid}"
        f"  effort <= {effort} N*m;\n  horizon {horizon[0]} steps of {horizon[1]} s;\n"
        f"  gravity ({down}) m/s^2;\n  modules <= {count + 2 + space};\n"
        "}\n"
    )
