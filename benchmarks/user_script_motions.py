"""The rest of the script: ways are cut short and timed, motions simulated, until one will do."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from itertools import pairwise
from typing import Any, Protocol

import numpy as np
from user_script_planner import Array, Planner, Scene

DESIGNS, POSES = 8, 16
"""Of a round: lengths, and poses that inverse kinematics begin with for each of them."""
SIMULATED, PLANNED = 4, 3
"""Of a round: motions that are simulated, and pairs of poses that a way is planned for, at most."""
PLAN_SECONDS = 2.0
"""For a way, at first; twice as long each time that nothing is found in a round."""
USED = 0.97
"""Of the bound of efforts, by planned motions."""
FASTER = 2.0
"""Motions that need so many times the efforts are given to toppra."""
PARTS = 8
"""Of a step, in simulations, each by Runge and Kutta's method."""
AT_REST = 0.0009
"""rad/s or m/s; less than a task asks for."""


class Model(Protocol):
    """What the script is given: the compiled robot."""

    def torques(self, q: Array, v: Array, a: Array, lengths: Array) -> Array:
        """Of K states each, (K, n)."""
        ...

    def follow(self, first: Array, columns: Array, lengths: Array) -> tuple[Array, Array]:
        """States, ``PARTS`` a step and the last, and torques (N, n) of a simulated closed loop.

        ``columns`` are per step q and v wanted at its beginning, q, v, a in its middle, and two
        gains.
        """
        ...


@dataclass(frozen=True)
class Motion:
    """q, v and a at the samples and in the middle of steps, (2 N + 1, n) each."""

    q: Array
    v: Array
    a: Array


@dataclass(frozen=True)
class Chain:
    """Lengths and poses to pass."""

    lengths: Array
    nodes: Array


@dataclass
class Answer:
    """What the script ends with; seconds are processor time."""

    lengths: Array | None = None
    start: Array | None = None
    inputs: Array | None = None
    seconds: float = 0.0
    geometry: float = 0.0
    rounds: int = 0
    planned: int = 0
    by: str = ""


# --- from poses to motions ------------------------------------------------------------------------


def chains(scene: Scene, rng: np.random.Generator) -> list[Chain]:
    """Lengths with poses in all regions that are near each other, two of each design at most."""
    designs = rng.uniform(scene.shortest, scene.longest, (DESIGNS, len(scene.low)))
    lengths, poses, good = np.repeat(designs, POSES, axis=0), list[Array](), list[Any]()
    for stage in scene.stages[::-1]:
        q, fit = scene.reached(stage, lengths, rng)
        named = {arm for arm, _, _ in stage}
        for arm, (joints, _) in enumerate(scene.arms):
            if arm not in named and poses:
                q[:, joints] = poses[-1][:, joints]
        if poses and len(named) < len(scene.arms):
            fit = fit & good[-1] & ~scene.blocked(q, lengths, scene.slack)
        poses.append(q)
        good.append(fit)
    poses, good = poses[::-1], good[::-1]
    found = list[Chain]()
    for design in range(DESIGNS):
        own = slice(design * POSES, (design + 1) * POSES)
        sets = [q[own][fit[own]] for q, fit in zip(poses, good, strict=True)]
        if not all(map(len, sets)):
            continue
        found += [Chain(designs[design], nodes) for nodes in _nearest(sets)]
    return found


def _nearest(sets: list[Array]) -> Iterator[Array]:
    """Two rows of poses, one of each set, that take the least time."""
    cost, ways = np.zeros(len(sets[0])), list[Any]()
    for before, after in pairwise(sets):
        far = np.sqrt(np.linalg.norm(after[None] - before[:, None], axis=-1))
        total = cost[:, None] + far
        ways.append(np.argmin(total, axis=0))
        cost = total.min(axis=0)
    for end in np.argsort(cost)[:2]:
        at, picked = int(end), [sets[-1][end]]
        for before, way in zip(sets[-2::-1], ways[::-1], strict=True):
            at = int(way[at])
            picked.append(before[at])
        yield np.array(picked[::-1])


def shortened(scene: Scene, chain: Chain) -> Array:
    """The shortest way over its points and points between; all short cuts are tried at once."""
    nodes = chain.nodes
    for _ in range(3):
        middle = (nodes[1:] + nodes[:-1]) / 2
        points = np.insert(nodes, np.arange(1, len(nodes)), middle, axis=0)
        if len(points) > 40:
            points = nodes
        one, other = np.triu_indices(len(points), 1)
        free = scene.clear(points[one], points[other], chain.lengths) == 1.0
        free |= other == one + 1
        far = np.where(free, np.linalg.norm(points[other] - points[one], axis=1) + 1e-3, np.inf)
        table = np.full((len(points), len(points)), np.inf)
        table[one, other] = far
        cost, before = np.zeros(len(points)), np.zeros(len(points), dtype=int)
        for at in range(1, len(points)):
            total = cost[:at] + table[:at, at]
            before[at] = int(np.argmin(total))
            cost[at] = total[before[at]]
        kept = [len(points) - 1]
        while kept[-1]:
            kept.append(int(before[kept[-1]]))
        nodes = points[kept[::-1]]
    return nodes


def quintics(scene: Scene, model: Model, chain: Chain) -> tuple[Motion, float]:
    """From stop to stop, and the part of the bound that it takes.

    The time is divided so that all parts take about the same.
    """
    far = np.abs(np.diff(chain.nodes, axis=0)).max(axis=1)
    weights = np.sqrt(np.maximum(far, 0.05 * far.max() + 1e-9))
    found = list[tuple[float, Motion]]()
    for _ in range(3 if len(far) > 1 else 1):
        counts = _shares(weights, scene.moving)
        motion = _stopping(scene, chain.nodes, counts)
        asked = np.abs(model.torques(motion.q, motion.v, motion.a, chain.lengths)).max(axis=1)
        starts = 2 * np.concatenate([[0], np.cumsum(counts)[:-1]])
        peaks = np.maximum.reduceat(asked, starts) / scene.bound
        found.append((float(peaks.max()), motion))
        weights = counts * np.sqrt(np.maximum(peaks, 0.2 * peaks.max()))
    need, motion = min(found, key=lambda each: each[0])
    return motion, need


def _shares(weights: Array, total: int) -> Any:
    """Whole numbers, 1 at least, with a sum, in proportion to weights as far as may be."""
    exact = weights / weights.sum() * total
    counts = np.maximum(np.floor(exact).astype(int), 1)
    while counts.sum() < total:
        counts[np.argmax(exact - counts)] += 1
    while counts.sum() > total and counts.max() > 1:
        counts[np.argmax(counts)] -= 1
    return counts


def _stopping(scene: Scene, nodes: Array, counts: Any) -> Motion:
    instant = np.arange(2 * scene.steps + 1) / 2
    bounds = np.concatenate([[0], np.cumsum(counts)])
    part = np.clip(np.searchsorted(bounds, instant, side="right") - 1, 0, len(counts) - 1)
    t = np.clip((instant - bounds[part]) / counts[part], 0.0, 1.0)
    p, v, a = _law(t[:, None])
    way, time_of = np.diff(nodes, axis=0)[part], (counts[part] * scene.step)[:, None]
    return Motion(nodes[part] + p * way, v * way / time_of, a * way / time_of**2)


def _law(t: Array) -> tuple[Array, Array, Array]:
    """The quintic from 0 to 1 and its derivatives."""
    return (
        10 * t**3 - 15 * t**4 + 6 * t**5,
        30 * t**2 - 60 * t**3 + 30 * t**4,
        60 * t - 180 * t**2 + 120 * t**3,
    )


def _spline(nodes: Array) -> Any:
    from scipy.interpolate import CubicSpline

    far = np.linalg.norm(np.diff(nodes, axis=0), axis=1)
    return CubicSpline(np.concatenate([[0.0], np.cumsum(far)]), nodes)


def smooth(scene: Scene, model: Model, chain: Chain) -> tuple[Motion, float]:
    """Along a spline without a stop, by one quintic, and the part of the bound that it takes."""
    path, duration = _spline(chain.nodes), scene.moving * scene.step
    t = np.clip(np.arange(2 * scene.steps + 1) / 2 / scene.moving, 0.0, 1.0)[:, None]
    s, rate, change = (path.x[-1] * each for each in _law(t))
    first, second = (path(s[:, 0], k) for k in (1, 2))
    v = first * rate / duration
    a = (second * rate**2 + first * change) / duration**2
    motion = Motion(path(s[:, 0]), v, a)
    asked = np.abs(model.torques(motion.q, motion.v, motion.a, chain.lengths)).max()
    return motion, float(asked) / scene.bound


def quickest(scene: Scene, model: Model, chain: Chain) -> Motion | None:
    """Toppra's quickest motion along the spline, slowed down to the time there is."""
    try:
        import toppra
        from toppra import algorithm, constraint
    except ImportError:
        return None
    toppra.setup_logging("CRITICAL")
    rods, limit = chain.lengths, 0.93 * scene.bound

    class Torques(constraint.JointTorqueConstraint):  # type: ignore[misc]
        def compute_constraint_params(self, path: Any, grid: Array) -> tuple[Any, ...]:
            """As in toppra, but for all points of the grid at once."""
            p, d, dd = path(grid), path(grid, 1), path(grid, 2)
            c = model.torques(p, 0 * p, 0 * p, rods)
            a, b = (model.torques(p, v, w, rods) - c for v, w in ((0 * p, d), (d, dd)))
            size = p.shape[1]
            rows = np.concatenate([np.eye(size), -np.eye(size)])
            return a, b, c, rows, np.full(2 * size, limit), None, None

    path, count = _spline(chain.nodes), len(scene.low)
    bounds = np.array([[-limit, limit]] * count)
    wrapped = toppra.SplineInterpolator(path.x, chain.nodes)
    try:
        solver = algorithm.TOPPRA(
            [Torques(model.torques, bounds, np.zeros(count))], wrapped,
            gridpoints=np.linspace(0, path.x[-1], 101), solver_wrapper="seidel",
            parametrizer="ParametrizeConstAccel",
        )  # fmt: skip
        found = solver.compute_trajectory(0, 0)
    except (ValueError, FloatingPointError, ZeroDivisionError):
        return None
    duration = scene.moving * scene.step
    if found is None or found.duration > duration:
        return None
    slower = found.duration / duration
    t = np.clip(np.arange(2 * scene.steps + 1) / 2 / scene.moving, 0.0, 1.0) * found.duration
    held = (t < found.duration)[:, None]
    return Motion(found(t), held * slower * found(t, 1), held * slower**2 * found(t, 2))


# --- the simulated motion -------------------------------------------------------------------------


def simulated(scene: Scene, model: Model, lengths: Array, motion: Motion) -> Array | None:
    """The inputs (N, n), by computed torque with feedback, if the motion they make will do."""
    count, n = scene.steps, len(scene.low)
    gains = np.tile([(0.3 / scene.step) ** 2, 2 * 0.3 / scene.step], (count, 1))
    if scene.rest:
        # What is left is gone in two steps, but for what is small of second order.
        gains[scene.moving :] = 1 / scene.step**2, 1.5 / scene.step
    columns = np.concatenate(
        [motion.q[:-1:2], motion.v[:-1:2], motion.q[1::2], motion.v[1::2], motion.a[1::2], gains],
        axis=1,
    )
    first = np.concatenate([motion.q[0], 0 * motion.q[0]])
    states, inputs = model.follow(first, columns, lengths)
    q, v = states[:, :n], states[:, n:]
    if not np.isfinite(states).all() or (scene.rest and np.abs(v[-1]).max() > AT_REST):
        return None
    if not _passes(scene, scene.places(q[::PARTS], lengths)[2][:, scene.last]):
        return None
    within = (scene.low < q) & (q < scene.high)
    if not within.all() or scene.blocked(q, lengths, 0.002 * scene.unit).any():
        return None
    return inputs


def _passes(scene: Scene, tips: Array) -> bool:
    """Whether all regions are visited in order, the last at the end."""
    size, at, late = 3 if scene.space else 2, 0, np.zeros(1, dtype=int)
    for stage in scene.stages[1:]:
        inside = [
            (np.abs(tips[:, arm] - (low + high) / 2) < 0.49 * (high - low))[:, :size].all(axis=1)
            for arm, low, high in stage
        ]
        late = at + np.flatnonzero(np.all(inside, axis=0)[at:])
        if not len(late):
            return False
        at = int(late[0])
    return scene.formula or int(late[-1]) == len(tips) - 1


# --- rounds ---------------------------------------------------------------------------------------


def solve(scene: Scene, model: Model, planner: Planner, seed: int, limit: float) -> Answer:
    """Rounds until a motion will do, for so many processor seconds."""
    begun, rng, answer = time.process_time(), np.random.default_rng(seed), Answer()
    allowed = PLAN_SECONDS

    def taken(chain: Chain, motion: Motion, by: str) -> bool:
        inputs = simulated(scene, model, chain.lengths, motion)
        if inputs is not None:
            answer.lengths, answer.start, answer.inputs = chain.lengths, motion.q[0], inputs
            answer.by = by
        return inputs is not None

    def left() -> float:
        return begun + limit - time.process_time()

    while answer.inputs is None and left() > 0:
        answer.rounds += 1
        found = chains(scene, rng)
        timed = sorted(((quintics(scene, model, each), each) for each in found), key=_need)
        clear = _clear(scene, [each for _, each in timed])
        straight = [one for one, free in zip(timed, clear, strict=True) if free.all()]
        ready = [one for one in straight if one[0][1] < USED][:SIMULATED]
        if any(taken(chain, motion, "straight") for (motion, _), chain in ready):
            break
        other = [(need, chain, free) for ((_, need), chain), free in zip(timed, clear, strict=True)]
        for need, chain, free in other[:PLANNED]:
            if left() < 0 or (free.all() and need < USED):
                continue
            whole = chain if free.all() else _around(
                scene, planner, chain, free, rng, min(allowed, left()), answer
            )  # fmt: skip
            if whole is not None and _timed(scene, model, whole, taken):
                break
        allowed *= 1.2
    answer.seconds = time.process_time() - begun
    return answer


def _need(one: tuple[tuple[Motion, float], Chain]) -> float:
    return one[0][1]


def _clear(scene: Scene, found: list[Chain]) -> list[Any]:
    """Per chain, which of its ways are clear."""
    if not found:
        return []
    one = np.concatenate([each.nodes[:-1] for each in found])
    other = np.concatenate([each.nodes[1:] for each in found])
    rods = np.concatenate([np.tile(each.lengths, (len(each.nodes) - 1, 1)) for each in found])
    free = scene.clear(one, other, rods) == 1.0
    return np.split(free, np.cumsum([len(each.nodes) - 1 for each in found])[:-1])


def _around(
    scene: Scene, planner: Planner, chain: Chain, free: Any, rng: np.random.Generator,
    limit: float, answer: Answer,
) -> Chain | None:  # fmt: skip
    """With ways planned where the straight ones are not clear."""
    begun, nodes = time.process_time(), [chain.nodes[:1]]
    for (one, other), straight in zip(pairwise(chain.nodes), free, strict=True):
        way = np.array([one, other])
        if not straight:
            answer.planned += 1
            found = planner(scene, chain.lengths, one, other, rng, limit)
            if found is None:
                answer.geometry += time.process_time() - begun
                return None
            way = shortened(scene, Chain(chain.lengths, np.array(found)))
        nodes.append(way[1:])
    answer.geometry += time.process_time() - begun
    return Chain(chain.lengths, np.concatenate(nodes))


def _timed(
    scene: Scene, model: Model, chain: Chain, taken: Callable[[Chain, Motion, str], bool]
) -> bool:
    """Whether a way will do with stops, in one go, or as quick as can be."""
    motion, need = quintics(scene, model, chain)
    if need < USED and taken(chain, motion, "stops"):
        return True
    least = need
    if len(chain.nodes) > 2:
        motion, need = smooth(scene, model, chain)
        if need < USED and taken(chain, motion, "spline"):
            return True
        least = min(least, need)
    fast = quickest(scene, model, chain) if least < FASTER else None
    return fast is not None and taken(chain, fast, "toppra")
