"""Brute force on the tasks of `random_tasks`: a million poses, flooded grids, random drives."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from compiler.arrays import Array
from tests.oracles.hand_arms import SimulatedArm
from tests.oracles.random_tasks import RandomTask, limits, placed, poses
from tests.oracles.spec_figures import Area, Figures

Mask = NDArray[np.bool_]


def inside(area: Area, points: Array) -> Mask:
    """Which points (n, 3) are in a closed set."""
    found: Mask = area.slack(points) >= 0
    return found


def crossing(area: Area, first: Array, last: Array) -> Mask:
    """Which segments (n, 3) meet the interior of a convex set: clipped by one facet after another.

    Cyrus and Beck, 1978.
    """
    d = area.normals.shape[1]
    low, high = np.zeros(len(first)), np.ones(len(first))
    for normal, offset in zip(area.normals, area.offsets, strict=True):
        a = first[:, :d] @ normal - offset
        b = last[:, :d] @ normal - offset
        step = np.where(a == b, 1.0, a - b)
        cut = a / step
        low = np.where(a > b, np.maximum(low, cut), low)
        high = np.where(a < b, np.minimum(high, cut), high)
        high = np.where((a == b) & (a >= 0), -1.0, high)
    found: Mask = high - low > 1e-9
    return found


@dataclass(frozen=True)
class Swept:
    """Which poses are allowed at every instant, and which of them may be the first, the last."""

    allowed: Mask
    first: Mask
    last: Mask


def swept(
    task: RandomTask, figures: Figures, word: Sequence[str], lengths: Array, q: Array
) -> Swept:
    """Poses of one word, with the margins of obstacles left out: more poses are allowed."""
    points = placed(task, word, lengths, q)
    tip = points[:, -1]
    allowed = inside(figures.bounds, tip)
    for name, subject, _ in figures.avoids:
        area = figures.areas[name]
        if subject == "effector":
            allowed &= ~crossing(area, tip, tip + 1e-12)
        else:
            for a, b in rods(word):
                allowed &= ~crossing(area, points[:, a], points[:, b])
    assert figures.reach is not None
    first = allowed & inside(figures.areas[figures.start], tip)
    return Swept(allowed, first, allowed & inside(figures.areas[figures.reach], tip))


def rods(word: Sequence[str]) -> list[tuple[int, int]]:
    """Which of the points of `placed` are the ends of bodies."""
    found, last = [], 0
    for symbol in word:
        if symbol == "P":
            found.append((last + 1, last + 2))
            last += 2
        elif symbol in ("L", "S", "K"):
            found.append((last, last + 1))
            last += 1
    return found


def counterexample(task: RandomTask, figures: Figures, count: int, seed: int) -> Array | None:
    """Lengths of a robot with allowed poses for start and target among random ones, or None.

    Several robots share the poses; of each some thousands are looked at.
    """
    rng = np.random.default_rng(seed)
    for word in task.words:
        free = len(task.free_lengths(word))
        robots = 1 if task.low == task.high else 50
        each = count // robots // len(task.words)
        for _ in range(robots):
            lengths = np.tile(rng.uniform(task.low, task.high, free), (each, 1))
            found = swept(task, figures, word, lengths, poses(task, word, rng, each))
            if found.first.any() and found.last.any():
                return lengths[0]
    return None


def flooded(
    task: RandomTask, figures: Figures, word: Sequence[str], lengths: Array, side: int
) -> bool:
    """Whether a flood of a grid of allowed poses leads from the start to the target."""
    axes = [np.linspace(*limits(task)[s], side) for s in word if s in limits(task)]
    grid = np.stack([part.ravel() for part in np.meshgrid(*axes, indexing="ij")], axis=1)
    found = swept(task, figures, word, np.tile(lengths, (len(grid), 1)), grid)
    shape = (side,) * len(axes)
    parts, _ = ndimage.label(found.allowed.reshape(shape))
    labels = parts.ravel()
    return bool(set(labels[found.first]) & set(labels[found.last]))


def drives_reach(
    task: RandomTask, figures: Figures, lengths: Array, seed: int, runs: int = 60
) -> bool:
    """Whether inputs at their bounds ever bring the tool to the target at the end.

    From random starts, each input with one random switch, if any; obstacles are left out.
    """
    rng = np.random.default_rng(seed)
    assert figures.reach is not None
    for word in task.words:
        free = task.free_lengths(word)
        arm = SimulatedArm(task.arm(word, dict(zip(free, lengths, strict=False))), figures.gravity)
        starts = poses(task, word, rng, 20_000)
        row = np.tile(lengths[: len(free)], (len(starts), 1))
        starts = starts[swept(task, figures, word, row, starts).first]
        within = limits(task)
        ranges = np.array([within[symbol] for symbol in word if symbol in within])
        for start in starts[:runs]:
            state = np.concatenate([start, np.zeros(len(start))])
            sign, switch = (
                rng.choice((-1.0, 1.0), len(start)),
                rng.integers(-3, figures.steps, len(start)),
            )
            if _arrives(arm, figures, state, task.effort * sign, switch, ranges):
                return True
    return False


def _arrives(
    arm: SimulatedArm, figures: Figures, state: Array, u: Array, switch: Array, ranges: Array
) -> bool:
    """Whether inputs that change their sign once lead to the target, joints within their ranges."""
    n = len(ranges)
    for step in range(figures.steps):
        for _ in range(20):
            state = _runge_kutta(
                arm, state, u * np.where(step < switch, -1.0, 1.0), float(figures.dt) / 20
            )
            if np.any((state[:n] < ranges[:, 0]) | (state[:n] > ranges[:, 1])):
                return False
    tips, _ = arm.points(state[None, :n])
    assert figures.reach is not None
    return bool(inside(figures.areas[figures.reach], tips[:, 0])[0])


def _runge_kutta(arm: SimulatedArm, state: Array, u: Array, h: float) -> Array:
    a = arm.slope(state, u)
    b = arm.slope(state + h / 2 * a, u)
    c = arm.slope(state + h / 2 * b, u)
    d = arm.slope(state + h * c, u)
    return state + h / 6 * (a + 2 * b + 2 * c + d)
