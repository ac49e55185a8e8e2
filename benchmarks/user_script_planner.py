"""What a robotics user would plan a robot's ways with: kinematics, obstacles, RRT-Connect.

Whatever can be done for many poses, branches or samples at once is, in numpy; OMPL's RRT-Connect
calls the same check of obstacles from C++, for an edge or a state at a time.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

Array: TypeAlias = NDArray[np.float64]
BRANCHES = 16
"""So many are tried at once."""
ROUNDS_OF_KINEMATICS = 25
SETTLING = 4
"""Steps at the end, where the target is reached at rest."""


@dataclass(frozen=True)
class Scene:
    """A task in arrays; lengths in metres, angles in radians.

    Attributes:
        axes: per joint x, y or z (0 to 2), ``slides``: whether it slides along it.
        arms: per arm its joints and where it begins, ``shortest``, ``longest``: its rods.
        low: of the joints, with ``high``.
        stages: regions to be in, in order: an arm, the low and the high corner.
        turn: of the obstacles, boxes, to their own axes (b, 3, 3), ``centre``, ``half`` (b, 3).
        near: of a map: distances from what is occupied, in centimetres squared, (x, y).
        space: whether there are three dimensions, and a floor.
        body: whether bodies keep the ``margin``, or the effectors alone.
        unit: what is a metre to a robot of a metre.
    """

    axes: tuple[int, ...]
    slides: tuple[bool, ...]
    arms: tuple[tuple[range, tuple[float, float, float]], ...]
    shortest: Array
    longest: Array
    low: Array
    high: Array
    stages: tuple[tuple[tuple[int, Array, Array], ...], ...]
    turn: Array
    centre: Array
    half: Array
    near: Array | None
    space: bool
    body: bool
    margin: float
    bound: float
    steps: int
    step: float
    rest: bool
    formula: bool
    unit: float

    @property
    def slack(self) -> float:
        """What plans keep from obstacles beyond what is asked for."""
        return 0.008 * self.unit

    @property
    def moving(self) -> int:
        """The steps of planned motions; in the others, they rest."""
        return self.steps - (SETTLING if self.rest else 0)

    # --- geometry ---------------------------------------------------------------------------------

    def places(self, q: Array, lengths: Array) -> tuple[Array, Array, Array]:
        """Axes, joints and rods' ends of K poses, (K, n, 3) each; lengths (n,) or (K, n)."""
        rods = np.broadcast_to(lengths, q.shape)[..., None]
        axes, joints, ends = (np.empty((*q.shape, 3)) for _ in range(3))
        cosine, sine = np.cos(q)[..., None], np.sin(q)[..., None]
        for own, base in self.arms:
            frame = [np.broadcast_to(unit, (len(q), 3)) for unit in np.eye(3)]
            at = np.broadcast_to(np.array(base), (len(q), 3))
            for j in own:
                i = self.axes[j]
                axes[:, j] = frame[i]
                if self.slides[j]:
                    at = at + q[:, j, None] * frame[i]
                else:
                    one, other = frame[(i + 1) % 3], frame[(i + 2) % 3]
                    c, s = cosine[:, j], sine[:, j]
                    frame[(i + 1) % 3] = c * one + s * other
                    frame[(i + 2) % 3] = c * other - s * one
                joints[:, j] = at
                at = at + rods[:, j] * frame[0]
                ends[:, j] = at
        return axes, joints, ends

    @property
    def last(self) -> list[int]:
        """The last joint of every arm."""
        return [own[-1] for own, _ in self.arms]

    def blocked(self, q: Array, lengths: Array, slack: float) -> NDArray[np.bool_]:
        """Whether bodies are nearer to obstacles than asked for and ``slack`` more."""
        _, joints, ends = self.places(q, lengths)
        tips = ends[:, self.last]
        found: NDArray[np.bool_] = np.zeros(len(q), dtype=bool)
        if self.space:
            found = np.asarray(tips[..., 2].min(axis=1) < slack)
        away = (self.margin if self.body else 0.0) + slack
        if self.near is not None:
            size = np.array(self.near.shape) - 1
            x, y = np.clip((tips[:, 0, :2] * 100).astype(int), 0, size).T
            found = found | (self.near[x, y] < (100 * away) ** 2)
        if not len(self.half):
            return found
        axes = 3 if self.space else 2
        half = self.half[:, :axes] + away
        first = joints if self.body else tips
        local = [self._local(at, axes) for at in ((first, ends) if self.body else (first,))]
        if not self.body:
            inside: NDArray[np.bool_] = np.all(np.abs(local[0]) < half, axis=-1)
            return found | inside.any(axis=(1, 2))
        way = local[1] - local[0]
        way = np.where(np.abs(way) < 1e-12, 1e-12, way)
        centre, spread = -local[0] / way, half / np.abs(way)
        enter = (centre - spread).max(axis=-1)
        leave = (centre + spread).min(axis=-1)
        hit: NDArray[np.bool_] = np.maximum(enter, 0.0) <= np.minimum(leave, 1.0)
        return found | hit.any(axis=(1, 2))

    def _local(self, points: Array, axes: int) -> Array:
        """Points (K, m, 3) in the axes of the boxes, (K, m, b, 2 or 3)."""
        away = points[:, :, None, :axes] - self.centre[:, :axes]
        found: Array = np.einsum("kmbi,bij->kmbj", away, self.turn[:, :axes, :axes])
        return found

    def clear(self, one: Array, other: Array, lengths: Array) -> Array:
        """The part of each straight way, of E, that is clear from its beginning on."""
        reach = np.array([
            1.0 if self.slides[j] else lengths[..., j : own[-1] + 1].sum(axis=-1).max()
            for own, _ in self.arms for j in own
        ])  # fmt: skip
        moved = float((np.abs(other - one) @ reach).max(initial=0.0))
        count = max(2, int(np.ceil(moved / (0.05 * self.unit))) + 1)
        parts = np.linspace(0.0, 1.0, count)
        q = one[:, None] + parts[:, None] * (other - one)[:, None]
        rods = lengths if lengths.ndim == 1 else np.repeat(lengths, count, axis=0)
        hit = self.blocked(q.reshape(-1, q.shape[-1]), rods, self.slack)
        free = ~hit.reshape(len(one), count)
        first = np.where(free.all(axis=1), count, np.argmin(free, axis=1))
        found: Array = np.maximum(first - 1, 0) / (count - 1)
        return found

    def reached(
        self, stage: Sequence[tuple[int, Array, Array]], lengths: Array, rng: np.random.Generator
    ) -> tuple[Array, NDArray[np.bool_]]:
        """Poses (K, n) by inverse kinematics, damped least squares, and which of them will do."""
        room = 0.02 * (self.high - self.low)
        low, high = self.low + room, self.high - room
        q = rng.uniform(low, high, lengths.shape)
        last = [self.last[arm] for arm, _, _ in stage]
        corners = np.array([[a, b] for _, a, b in stage])
        part = rng.uniform(0.35, 0.65, (len(q), len(stage), 3))
        goal = corners[:, 0] + part * (corners[:, 1] - corners[:, 0])
        shape = len(q), 3 * len(stage), q.shape[1]
        carried = np.array([
            [own[0] <= j <= own[-1] for j in range(q.shape[1])] for own, _ in
            (self.arms[arm] for arm, _, _ in stage)
        ])  # fmt: skip
        damping = (0.02 * self.unit) ** 2 * np.eye(shape[1])
        flat = np.array([1.0, 1.0, 1.0 if self.space else 0.0])
        axes, joints, ends = self.places(q, lengths)
        for _ in range(ROUNDS_OF_KINEMATICS):
            off = flat * (goal - ends[:, last])
            if np.abs(off).max() < 1e-4 * self.unit:
                break
            arms = ends[:, last, None] - joints[:, None]
            slope = np.where(
                np.array(self.slides)[:, None], axes[:, None], np.cross(axes[:, None], arms)
            )
            slope = (slope * carried[:, :, None]).transpose(0, 1, 3, 2).reshape(shape)
            back = slope.transpose(0, 2, 1)
            move = back @ np.linalg.solve(slope @ back + damping, off.reshape(*shape[:2], 1))
            q = np.clip(q + np.clip(move[..., 0], -0.5, 0.5), low, high)
            axes, joints, ends = self.places(q, lengths)
        size = 2 if not self.space else 3
        inner = 0.3 * (corners[:, 1] - corners[:, 0])
        middle = corners.mean(axis=1)
        good = (np.abs(ends[:, last] - middle) < inner)[..., :size].all(axis=(1, 2))
        return q, good & ~self.blocked(q, lengths, self.slack)


# --- ways between two poses -----------------------------------------------------------------------

Planner: TypeAlias = Callable[
    [Scene, Array, Array, Array, np.random.Generator, float], "list[Array] | None"
]
"""Of a scene, lengths, two poses: a way, within so many processor seconds."""


def rrt_connect(
    scene: Scene, lengths: Array, one: Array, other: Array, rng: np.random.Generator, limit: float
) -> list[Array] | None:
    """RRT-Connect: branches of a tree, and their ways to the other tree, are tried at once."""
    end = time.process_time() + limit
    nodes, parents = [one[None], other[None]], [[-1], [-1]]
    grown, step = 0, 0.35 * float(np.linalg.norm(scene.high - scene.low))
    while time.process_time() < end:
        goals = rng.uniform(scene.low, scene.high, (BRANCHES, len(one)))
        added = _grown(scene, lengths, nodes, parents, grown, goals, step)[0]
        if len(added):
            tips = nodes[grown][added]
            _, near, whole = _grown(scene, lengths, nodes, parents, 1 - grown, tips, np.inf)
            if whole.any():
                place = int(np.argmax(whole))
                halves = [
                    _branch(nodes[tree], parents[tree], int(index))
                    for tree, index in ((grown, added[place]), (1 - grown, near[place]))
                ]
                first, second = halves if grown == 0 else halves[::-1]
                return first[::-1] + second
        grown = 1 - grown
    return None


def _grown(
    scene: Scene, lengths: Array, nodes: list[Array], parents: list[list[int]], tree: int,
    goals: Array, step: float,
) -> tuple[NDArray[np.int64], NDArray[np.int64], NDArray[np.bool_]]:  # fmt: skip
    """Branches towards goals as far as they are clear: new nodes, the nearest old ones, arrivals.

    The old node is the one that a goal is reached from.
    """
    known = nodes[tree]
    near = np.argmin(((goals[:, None] - known) ** 2).sum(axis=-1), axis=1)
    way = goals - known[near]
    far = np.linalg.norm(way, axis=1, keepdims=True)
    ends = known[near] + way * np.minimum(1.0, step / np.maximum(far, 1e-12))
    part = scene.clear(known[near], ends, lengths)
    kept = np.flatnonzero(part * np.minimum(far[:, 0], step) > 0.02 * min(step, 3.0))
    nodes[tree] = np.concatenate(
        [known, known[near[kept]] + part[kept, None] * (ends - known[near])[kept]]
    )
    parents[tree] += near[kept].tolist()
    return len(known) + np.arange(len(kept)), near, (part == 1.0) & (far[:, 0] <= step)


def _branch(nodes: Array, parents: list[int], at: int) -> list[Array]:
    """From a node to the root."""
    found = []
    while at >= 0:
        found.append(nodes[at])
        at = parents[at]
    return found


def ompl_connect(*, edges: bool = True) -> Planner:
    """OMPL's RRT-Connect with a checker in Python: of whole edges at once, or of states."""
    from ompl import base, geometric, util

    util.setLogLevel(util.LOG_NONE)

    class Edges(base.MotionValidator):  # type: ignore[misc]
        def __init__(self, about: Any, count: int, free: Callable[[Array, Array], bool]) -> None:
            super().__init__(about)
            self.count, self.free = count, free

        def checkMotion(self, one: Any, other: Any, *_: Any) -> bool:  # noqa: N802
            a, b = ([at[i] for i in range(self.count)] for at in (one, other))
            return self.free(np.array([a]), np.array([b]))

    def plan(
        scene: Scene, lengths: Array, one: Array, other: Array, rng: np.random.Generator,
        limit: float,
    ) -> list[Array] | None:  # fmt: skip
        del rng
        end, count = time.process_time() + limit, len(one)
        space, bounds = base.RealVectorStateSpace(count), base.RealVectorBounds(count)
        for i in range(count):
            bounds.setLow(i, float(scene.low[i]))
            bounds.setHigh(i, float(scene.high[i]))
        space.setBounds(bounds)
        about = base.SpaceInformation(space)

        def valid(at: Any) -> bool:
            q = np.array([[at[i] for i in range(count)]])
            return not scene.blocked(q, lengths, scene.slack)[0]

        about.setStateValidityChecker(valid)
        if edges:
            about.setMotionValidator(
                Edges(about, count, lambda a, b: bool(scene.clear(a, b, lengths)[0] == 1.0))
            )
        else:
            # Two poses so far apart move a body by 5 cm at most.
            reach = max(1.0 if all(scene.slides) else 0.0, float(lengths.sum()))
            about.setStateValidityCheckingResolution(
                0.05 * scene.unit / (reach * space.getMaximumExtent())
            )
        about.setup()
        ends = [about.allocState() for _ in range(2)]
        for state, values in zip(ends, (one, other), strict=True):
            for i in range(count):
                state[i] = float(values[i])
        problem = base.ProblemDefinition(about)
        problem.setStartAndGoalStates(*ends)
        planner = geometric.RRTConnect(about)
        planner.setProblemDefinition(problem)
        planner.setup()
        late = base.PlannerTerminationCondition(lambda: time.process_time() > end)
        if not planner.solve(late) or not problem.hasExactSolution():
            return None
        states = problem.getSolutionPath().getStates()
        return [np.array([state[i] for i in range(count)]) for state in states]

    return plan
