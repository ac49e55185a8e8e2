r"""Chains of joints and rods: their motion under inputs, by points of mass; obstacles beside them.

A rod of mass m moves as m/6 at each end and 2 m/3 in the middle do (Routh, Dynamics of a System of
Rigid Bodies, part I, art. 44), so that

.. math:: M = \sum_p m_p J_p^T J_p, \qquad h = \sum_p m_p J_p^T (\dot J_p \dot q - g),
    \qquad M \ddot q + h = u.

A reference motion is made of quintics in the joints, its inputs are those of inverse dynamics in
the middle of each step plus feedback, held for the step; scipy integrates it (DOP853).  No code of
the project computes anything here.
"""

from __future__ import annotations

import random
from collections.abc import Sequence
from dataclasses import dataclass, field
from math import ceil, cos, floor, pi, sin

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

Array = NDArray[np.float64]

GRAVITY = 9.81
"""m/s^2, downwards."""
FINE = 8
"""Samples of a step at which a reference motion is checked."""
TURNS = {"x": 0, "y": 1, "z": 2}
SLIDES = {"X": 0, "Y": 1, "Z": 2}


@dataclass(frozen=True)
class RodChain:
    """A chain of joints, each with a rod behind it along x.

    Attributes:
        axes: per joint, the axis that it turns about (``x``, ``y``, ``z``) or slides along (in
            capitals).
        lengths: of the rods (m); 0 for a joint without one.
        density: of all rods (kg/m).
        base: where the first joint is (m).
        down: the acceleration of gravity (m/s^2).
        payload: at the effector (kg).
        carriage: behind each slide (kg).
        damping: what resists the rate of each joint, (n,) (N m s/rad, N s/m); default nothing.
    """

    axes: str
    lengths: tuple[float, ...]
    density: float
    base: tuple[float, float, float] = (0.0, 0.0, 0.0)
    down: tuple[float, float, float] = (0.0, 0.0, 0.0)
    payload: float = 0.5
    carriage: float = 0.0
    damping: Array | float = field(default=0.0)

    def places(self, q: Array) -> tuple[Array, Array, Array]:
        """Of a pose: the axes and the joints, (n, 3) each, and the rods' ends, (n + 1, 3).

        The joint of a slide is where its carriage is.
        """
        turn, at = np.eye(3), np.array(self.base)
        axes, joints, ends = [], [], [at]
        for axis, length, value in zip(self.axes, self.lengths, q, strict=True):
            if axis in SLIDES:
                axes.append(turn[:, SLIDES[axis]])
                at = at + value * axes[-1]
            else:
                axes.append(turn[:, TURNS[axis]])
                turn = turn @ _rotation(axis, value)
            joints.append(at)
            at = at + length * turn[:, 0]
            ends.append(at)
        return np.array(axes), np.array(joints), np.array(ends)

    def bars(self, q: Array) -> tuple[Array, Array]:
        """The two ends of every rod of a pose, (n, 3) each."""
        _, joints, ends = self.places(q)
        return joints, ends[1:]

    def mechanics(self, q: Array, v: Array) -> tuple[Array, Array]:
        """M, (n, n), and h, (n,)."""
        count = len(q)
        axes, joints, ends = self.places(q)
        slides = np.array([axis in SLIDES for axis in self.axes])
        spun = np.where(slides[:, None], 0.0, axes * v[:, None])
        spins = np.cumsum(spun, axis=0)
        before = np.vstack([np.zeros(3), spins[:-1]])
        twists = np.cumsum(np.cross(before, spun), axis=0)
        rods = ends[1:] - joints
        gained = np.cross(twists, rods) + np.cross(spins, np.cross(spins, rods))
        # A slide moves what is behind it along an axis that turns.
        shifts = joints - ends[:-1]
        slid = np.cross(twists, shifts) + np.cross(spins, np.cross(spins, shifts))
        slid += np.where(slides[:, None], 2 * np.cross(spins, axes * v[:, None]), 0.0)
        moved = np.vstack([np.zeros(3), np.cumsum(slid + gained, axis=0)])
        masses, points, drifts, links = [], [], [], []
        for i, length in enumerate(self.lengths):
            rod = self.density * length
            for share, along in ((1 / 6, 0.0), (2 / 3, 0.5), (1 / 6, 1.0)):
                masses.append(share * rod)
                points.append(joints[i] + along * rods[i])
                drifts.append(moved[i] + slid[i] + along * gained[i])
                links.append(i)
            if slides[i]:
                masses.append(self.carriage)
                points.append(joints[i])
                drifts.append(moved[i] + slid[i])
                links.append(i)
        masses.append(self.payload)
        points.append(ends[-1])
        drifts.append(moved[-1])
        links.append(count - 1)
        arms = np.array(points)[:, None, :] - joints[None, :, :]
        carried = np.arange(count)[None, :] <= np.array(links)[:, None]
        jacobians = np.where(slides[None, :, None], axes[None, :, :], np.cross(axes[None], arms))
        jacobians = jacobians * carried[:, :, None]
        weighed = jacobians * np.array(masses)[:, None, None]
        mass = np.einsum("pic,pjc->ij", weighed, jacobians)
        bias = np.einsum("pic,pc->i", weighed, np.array(drifts) - np.array(self.down))
        return mass, bias + self.damping * v

    def slope(self, state: Array, u: Array) -> Array:
        """The derivative of (q, v) under inputs."""
        q, v = np.split(state, 2)
        mass, bias = self.mechanics(q, v)
        return np.concatenate([v, np.linalg.solve(mass, u - bias)])

    def inverse(self, q: Array, v: Array, a: Array) -> Array:
        """The inputs of a motion."""
        mass, bias = self.mechanics(q, v)
        inputs: Array = mass @ a + bias
        return inputs


def _rotation(axis: str, angle: float) -> Array:
    c, s = cos(angle), sin(angle)
    rows = {
        "x": [[1, 0, 0], [0, c, -s], [0, s, c]],
        "y": [[c, 0, s], [0, 1, 0], [-s, 0, c]],
        "z": [[c, -s, 0], [s, c, 0], [0, 0, 1]],
    }
    return np.array(rows[axis])


# --- reference motions ----------------------------------------------------------------------------


def quintic(first: Array, last: Array, part: float, duration: float) -> tuple[Array, Array, Array]:
    """q, v and a of the motion from rest to rest, at a part of its duration (s)."""
    way = last - first
    return (
        first + way * (10 * part**3 - 15 * part**4 + 6 * part**5),
        way * (30 * part**2 - 60 * part**3 + 30 * part**4) / duration,
        way * (60 * part - 180 * part**2 + 120 * part**3) / duration**2,
    )


def tracked(
    arm: RodChain, wanted: Sequence[tuple[Array, Array, Array]], step: float, most: float
) -> tuple[Array, Array] | None:
    """The simulated motion along one that is given at the samples and in the middle of steps.

    States (q, v), ``FINE`` times a step and at the end, and inputs (steps, n); None where an input
    is above ``most`` (N*m).
    """
    stiffness, damping = (0.3 / step) ** 2, 2 * 0.3 / step
    state = np.concatenate([wanted[0][0], 0 * wanted[0][0]])
    states, inputs = [state], []
    grid = np.linspace(0.0, step, FINE + 1)
    for k in range(0, len(wanted) - 1, 2):
        (q, v, _), (middle, rate, change) = wanted[k], wanted[k + 1]
        off, late = q - state[: len(q)], v - state[len(q) :]
        u = arm.inverse(middle, rate, change + stiffness * off + damping * late)
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


# --- obstacles and regions ------------------------------------------------------------------------


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

    def corners(self, dimension: int) -> list[Array]:
        """Its corners (m)."""
        turn = _rotation("z", self.angle)
        corners = [(-1, -1), (1, -1), (1, 1), (-1, 1)]
        levels = (-1, 1) if dimension == 3 else (0,)
        return [
            np.array(self.centre) + turn @ (np.array([a, b, c]) * np.array(self.half))
            for c in levels
            for a, b in corners
        ]

    def hull(self, dimension: int) -> str:
        """As the language has it."""
        spots = self.corners(dimension)
        listed = ", ".join(f"({', '.join(number(x) for x in p[:dimension])})" for p in spots)
        return f"hull {listed} m"


def region_about(
    rng: random.Random, spot: Array, side: float, digits: int = 4
) -> tuple[Array, Array]:
    """A cube about a point, which is off its middle by a quarter of a side at most."""
    unit = 10.0**digits
    low = np.array([floor(unit * (x - side * rng.uniform(0.25, 0.75))) / unit for x in spot])
    return low, np.array([ceil(unit * x) / unit for x in low + side])


def points_on(starts: Array, ends: Array, count: int = 61) -> Array:
    """Points along rods with ends (..., 3), (..., count, 3)."""
    alongs = np.linspace(0.0, 1.0, count)[:, None]
    found: Array = starts[..., None, :] + alongs * (ends - starts)[..., None, :]
    return found


def cube_points(region: tuple[Array, Array]) -> Array:
    """A grid of 7 points a side in a region, (7, 7, 7, 3)."""
    grid = np.linspace(0.0, 1.0, 7)
    sides = [a + grid * (b - a) for a, b in zip(*region, strict=True)]
    return np.stack(np.meshgrid(*sides), -1)


def blocks_beside(
    rng: random.Random,
    tips: Array,
    points: Array,
    room: float,
    regions: Sequence[tuple[Array, Array]],
    count: int,
    space: bool,
) -> tuple[Block, ...] | None:
    """So many blocks near the way of the effector; none where ten trials find no place for one.

    They are farther than ``room`` (m) from all ``points``, and 1 cm from the regions.
    """
    cubes = [cube_points(region) for region in regions]
    found = list[Block]()
    for _ in range(count):
        for _ in range(10):
            spot = tips[round(rng.uniform(0.3, 0.7) * (len(tips) - 1))]
            angle, away = rng.uniform(0, 2 * pi), rng.uniform(0.12, 0.4)
            rise = rng.uniform(-0.2, 0.2) if space else 0.0
            centre = spot + np.array([away * cos(angle), away * sin(angle), rise])
            half = [rng.uniform(0.04, 0.14) for _ in range(3)]
            block = Block(
                (round(centre[0], 3), round(centre[1], 3), round(centre[2], 3)),
                (round(half[0], 3), round(half[1], 3), round(half[2], 3)),
                round(rng.uniform(0.1, pi / 2 - 0.1), 3),
            )
            if block.distances(points).min() > room and all(
                block.distances(cube).min() > 0.01 for cube in cubes
            ):
                found.append(block)
                break
        else:
            return None
    return tuple(found)


def number(value: float) -> str:
    """With four digits."""
    return repr(round(float(value), 4))


def box(low: Array, high: Array, dimension: int) -> str:
    """As the language has it."""
    sides = [f"[{number(a)}, {number(b)}]" for a, b in zip(low, high, strict=True)]
    return f"box {' x '.join(sides[:dimension])} m"
