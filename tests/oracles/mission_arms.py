"""Planar arms on one or two joints, and which tasks they do, by closed formulas with margins.

An arm of links on one joint reaches the points at one distance from its base, that of the sum of
its lengths; on two joints those within a ring.  A region is a box, which is connected: the arm gets
there if the nearest point of the region is not too far, and the farthest not too near.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from math import cos, hypot, pi, sin

import numpy as np

from tests.oracles.mission_robots import Robot

CLEAR = 0.02
"""Metres by which an arm does or does not reach a region."""
SPARE = 3.0
"""A drive is so many times as strong as is needed, or so many times too weak."""
AROUND = np.linspace(-pi, pi, 2881)
Point = tuple[float, float]


class Unclear(Exception):
    """An arm is too close to the border of what it can do."""


@dataclass(frozen=True)
class Box:
    """Sides parallel to the axes, in hundredths of a metre."""

    x: int
    y: int
    half: int

    @property
    def text(self) -> str:
        """As it is written."""
        low, high = (
            (self.x - self.half, self.y - self.half),
            (self.x + self.half, self.y + self.half),
        )
        sides = (f"[{_m(a)}, {_m(b)}]" for a, b in zip(low, high, strict=True))
        return f"box {' x '.join(sides)} m"

    def distances(self, centre: Point) -> tuple[float, float]:
        """Of the nearest and the farthest point from another one."""
        along = abs(self.x / 100 - centre[0]), abs(self.y / 100 - centre[1])
        half = self.half / 100
        near = hypot(*(max(0.0, a - half) for a in along))
        return near, hypot(*(a + half for a in along))

    def angles(self, centre: Point, radius: float) -> np.ndarray:
        """The directions in which a point at a distance is inside."""
        x, y = centre[0] + radius * np.cos(AROUND), centre[1] + radius * np.sin(AROUND)
        half = self.half / 100
        inside = (abs(x - self.x / 100) < half) & (abs(y - self.y / 100) < half)
        return AROUND[inside]

    def apart(self, start: Point, end: Point) -> float:
        """The distance of a line segment, by points on it; below zero how deep it goes inside."""
        part = np.linspace(0.0, 1.0, 201)
        x = abs(start[0] + part * (end[0] - start[0]) - self.x / 100) - self.half / 100
        y = abs(start[1] + part * (end[1] - start[1]) - self.y / 100) - self.half / 100
        outside = np.hypot(np.maximum(x, 0), np.maximum(y, 0))
        return float(np.where(outside > 0, outside, np.maximum(x, y)).min())


@dataclass(frozen=True)
class Post:
    """An obstacle, which no part of the arm may touch."""

    box: Box


@dataclass(frozen=True)
class Task:
    """From one region to another one; ``effort`` in N m, ``payload`` in kg, ``time`` in seconds."""

    name: str
    hall: int
    home: Box
    shelf: Box
    effort: int = 50
    payload: Fraction = Fraction(0)
    steps: int = 10
    step: Fraction = Fraction(3, 10)
    modules: int | None = None
    post: Post | None = None

    @property
    def regions(self) -> tuple[Box, Box]:
        """Where it starts and ends."""
        return self.home, self.shelf

    @property
    def time(self) -> float:
        """How long it takes."""
        return float(self.steps * self.step)


def _m(hundredths: int) -> str:
    return f"{hundredths / 100:.2f}"


def ring(lengths: Sequence[float], joints: Sequence[int]) -> tuple[float, float]:
    """Between which distances an arm reaches; ``joints`` are the numbers of links on each."""
    rigid, begin = list[float](), 0
    for count in joints:
        rigid.append(sum(lengths[begin : begin + count]))
        begin += count
    far = sum(rigid)
    return max(0.0, 2 * max(rigid) - far), far


def clearly(gap: float) -> bool:
    """Whether a gap is one."""
    if abs(gap) < CLEAR:
        raise Unclear
    return gap > 0


def reaches(task: Task, base: Point, near: float, far: float) -> bool:
    """Whether an arm gets into both regions."""
    gaps = list[float]()
    for box in task.regions:
        nearest, farthest = box.distances(base)
        gaps += [far - nearest, farthest - near]
    return all(clearly(gap) for gap in gaps)


def is_strong(task: Task, base: Point, radius: float, inertia: float) -> bool:
    """Whether the effort turns an arm on one joint far enough, which stands still at first."""
    starts, ends = (box.angles(base, radius) for box in task.regions)
    gaps = abs(np.subtract.outer(starts, ends))
    angle = float(np.minimum(gaps, 2 * pi - gaps).min())
    needed = 2 * inertia * angle / task.time**2
    if needed / SPARE < task.effort < needed * SPARE:
        raise Unclear
    return task.effort > needed


def is_free(task: Task, base: Point, radius: float) -> bool:
    """Whether an arm on one joint, straight as it is, keeps off the post.

    Where it can stand in both regions at all, nothing may be in its shorter way from one to the
    other, or it would not be clear whether another way is found.
    """
    if task.post is None:
        return True
    stands = list[bool]()
    spans = [box.angles(base, radius) for box in task.regions]
    for span in spans:
        depths = [_depth(task.post, base, radius, angle) for angle in span[::4]]
        stands.append(_all_or_none(depths))
    if not all(stands):
        return False
    first, last = float(spans[0].mean()), float(spans[1].mean())
    turn = (last - first + pi) % (2 * pi) - pi
    on_the_way = np.linspace(first, first + turn, 60)
    if min(_depth(task.post, base, radius, angle) for angle in on_the_way) < CLEAR:
        raise Unclear
    return True


def _depth(post: Post, base: Point, radius: float, angle: float) -> float:
    return post.box.apart(base, (base[0] + radius * cos(angle), base[1] + radius * sin(angle)))


def _all_or_none(depths: Sequence[float]) -> bool:
    """Whether all keep off, where none of them does else."""
    if all(depth > CLEAR for depth in depths):
        return True
    if all(depth < -CLEAR for depth in depths):
        return False
    raise Unclear


@dataclass(frozen=True)
class Arm:
    """The links on each joint of an arm: their lengths in metres, and masses in kg."""

    base: Point
    joints: tuple[int, ...]
    lengths: tuple[float, ...]
    masses: tuple[float, ...]

    def does(self, task: Task) -> bool:
        """Whether it does a task.

        Raises:
            Unclear: that is not clear.
        """
        near, far = ring(self.lengths, self.joints)
        if not reaches(task, self.base, near, far):
            return False
        if len(self.joints) > 1:
            return True
        ends = np.cumsum(self.lengths)
        inertia = float(np.dot(self.masses, ends**2)) + float(task.payload) * far**2
        return is_free(task, self.base, far) and is_strong(task, self.base, far, inertia)


def values(robot: Robot) -> tuple[Fraction, ...]:
    """The lengths of a robot that are chosen."""
    return tuple(value for _, value in robot if value is not None)
