"""What families of feasible tasks draw: robots, poses to pass, obstacles; no motion yet."""

from __future__ import annotations

import random
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from tests.oracles.feasible_text import Frame
from tests.oracles.rod_chains import GRAVITY, Array, RodChain


@dataclass(frozen=True)
class Draw:
    """A robot of one or two arms and what it does.

    Attributes:
        frame: how it is written.
        arms: its arms, with half the ranges of their joints (``half``).
        half: see there.
        poses: per arm the poses it passes, as many of each.
        steps: between two of these.
        step: the time between two samples (s).
        blocks: how many obstacles.
        body: whether bodies avoid them.
        sides: of the regions (m, of an arm of a metre or so).
        rest: whether the target is reached at rest.
        formula: whether all poses are to be passed, in order.
        slot: whether the obstacles are a slot.
    """

    frame: Frame
    arms: tuple[RodChain, ...]
    half: tuple[Array, ...]
    poses: tuple[tuple[Array, ...], ...]
    steps: tuple[int, ...]
    step: float
    blocks: int = 1
    body: bool = True
    sides: tuple[float, float] = (0.14, 0.2)
    rest: bool = False
    formula: bool = False
    slot: bool = False


def _lengths(rng: random.Random, count: int, scale: float = 1.0) -> tuple[float, ...]:
    """Different lengths of rods, about half a metre."""
    while True:
        found = tuple(round(rng.uniform(0.3, 0.8), 3) for _ in range(count))
        if all(abs(a - b) > 0.02 for a, b in pairwise(found)):
            return tuple(round(scale * each, 6) for each in found)


def _poses(rng: random.Random, half: Array, count: int, arm: RodChain) -> tuple[Array, ...]:
    """Poses whose tips are apart, by a third of the reach, and above the floor."""
    reach = sum(arm.lengths) or 2 * float(half.min())
    while True:
        found = [np.array([rng.uniform(-0.8, 0.8) * h for h in half]) for _ in range(count)]
        ends = [arm.places(q)[2] for q in found]
        if arm.base[2] and min(each[:, 2].min() for each in ends) < 0.15:
            continue
        if all(np.linalg.norm(a[-1] - b[-1]) > reach / 3 for a, b in pairwise(ends)):
            return tuple(found)


@dataclass(frozen=True)
class _Planar:
    """A planar arm of so many links."""

    count: int
    body: bool
    gravity: bool = False
    scale: float = 1.0
    visits: int = 2
    gain: float = 0.0
    damping: float = 0.0

    def arm(self, rng: random.Random, x: float = 0.0) -> RodChain:
        down = (0.0, -GRAVITY, 0.0) if self.gravity else (0.0, 0.0, 0.0)
        payload = round(rng.choice((0.2, 0.5, 1.0)) * self.scale, 6)
        lengths = _lengths(rng, self.count, self.scale)
        density = round(rng.uniform(0.5, 2), 2)
        return RodChain(
            "z" * self.count, lengths, density, (x, 0.0, 0.0), down, payload, damping=self.damping
        )

    def drawn(
        self,
        rng: random.Random,
        blocks: int = 1,
        sides: tuple[float, float] = (0.14, 0.2),
        *,
        rest: bool = False,
        formula: bool = False,
        slot: bool = False,
    ) -> Draw:
        arm = self.arm(rng)
        half = np.radians([rng.choice((130.0, 150.0, 170.0))] * self.count)
        steps = tuple(rng.randint(15, 40) for _ in range(self.visits - 1))
        frame = Frame(space=False, scale=self.scale, gain=self.gain)
        return Draw(
            frame, (arm,), (half,), (_poses(rng, half, self.visits, arm),), steps,
            rng.choice((0.05, 0.1)), blocks, self.body, sides, rest, formula, slot,
        )  # fmt: skip


def _links(count: int, *, body: bool) -> Callable[[random.Random], Draw]:
    def drawn(rng: random.Random) -> Draw:
        return _Planar(count, body).drawn(rng, rng.randint(1, 3), rest=rng.random() < 0.3)

    return drawn


def _gravity(rng: random.Random) -> Draw:
    made = _Planar(rng.choice((2, 2, 3)), rng.random() < 0.5, gravity=True)
    return made.drawn(rng, rng.randint(0, 2))


def _space(axes: str) -> Callable[[random.Random], Draw]:
    def drawn(rng: random.Random) -> Draw:
        rods = _lengths(rng, len(axes) - 1)
        if len(axes) > 4:
            rods = tuple(round(each / 2, 3) for each in rods)
        arm = RodChain(
            axes, (0.0, *rods), round(rng.uniform(0.5, 2), 2), (0.0, 0.0, 0.8),
            (0.0, 0.0, -GRAVITY), rng.choice((0.2, 0.5, 1.0)),
        )  # fmt: skip
        half = np.radians([160.0, *[130.0] * (len(axes) - 1)])
        return Draw(
            Frame(space=True), (arm,), (half,), (_poses(rng, half, 2, arm),),
            (rng.randint(20, 40),), rng.choice((0.05, 0.1)), rng.randint(1, 3), sides=(0.2, 0.26),
            rest=rng.random() < 0.3,
        )  # fmt: skip

    return drawn


def _gantry(rng: random.Random) -> Draw:
    space = rng.random() < 0.5
    axes = "XYZ" if space else "XY"
    arm = RodChain(
        axes, (0.0,) * len(axes), 1.0, (0.0, 0.0, 1.0 if space else 0.0),
        (0.0, 0.0, -GRAVITY if space else 0.0), rng.choice((0.5, 2.0)),
        round(rng.uniform(0.5, 3.0), 2),
    )  # fmt: skip
    half = np.array([1.0, 0.8, 0.5][: len(axes)])
    return Draw(
        Frame(space=space), (arm,), (half,), (_poses(rng, half, 2, arm),), (rng.randint(20, 40),),
        rng.choice((0.05, 0.1)), rng.randint(1, 3), rng.random() < 0.5,
    )  # fmt: skip


def _visits(rng: random.Random) -> Draw:
    made = _Planar(rng.choice((2, 2, 3)), rng.random() < 0.5, visits=rng.randint(3, 5))
    return made.drawn(rng, rng.randint(0, 2), formula=True)


def _narrow(rng: random.Random) -> Draw:
    made = _Planar(rng.choice((2, 3)), body=False)
    if rng.random() < 0.5:
        return made.drawn(rng, 1, (0.01, 0.015))
    return made.drawn(rng, slot=True)


def _two_arms(rng: random.Random) -> Draw:
    made = _Planar(2, rng.random() < 0.5)
    arms = tuple(made.arm(rng, x) for x in (-0.7, 0.7))
    half = np.radians([150.0, 150.0])
    poses = tuple(_poses(rng, half, 2, arm) for arm in arms)
    return Draw(
        Frame(space=False), arms, (half, half), poses, (rng.randint(20, 40),),
        rng.choice((0.05, 0.1)), rng.randint(0, 2), made.body,
    )  # fmt: skip


def _motors(rng: random.Random) -> Draw:
    gain, friction = round(rng.uniform(0.05, 0.5), 3), round(rng.uniform(0.01, 0.3), 3)
    made = _Planar(
        rng.choice((2, 3)), rng.random() < 0.5, rng.random() < 0.3, gain=gain, damping=friction
    )
    return made.drawn(rng)


def _sizes(rng: random.Random) -> Draw:
    made = _Planar(rng.choice((2, 3)), rng.random() < 0.5, scale=rng.choice((0.02, 100.0)))
    return made.drawn(rng)


def _crowded(rng: random.Random) -> Draw:
    return _Planar(rng.choice((2, 3)), rng.random() < 0.7).drawn(rng, rng.randint(20, 60))


FAMILIES: Mapping[str, Callable[[random.Random], Draw]] = {
    "two links": _links(2, body=False),
    "two links with body": _links(2, body=True),
    "three links": _links(3, body=False),
    "three links with body": _links(3, body=True),
    "four links": _links(4, body=False),
    "four links with body": _links(4, body=True),
    "gravity": _gravity,
    "three joints in space": _space("zyy"),
    "four joints in space": _space("zyyz"),
    "six joints in space": _space("zyyzyz"),
    "gantries": _gantry,
    "visits": _visits,
    "slots and small targets": _narrow,
    "two arms": _two_arms,
    "motors": _motors,
    "2 cm and 100 m": _sizes,
    "20 to 60 obstacles": _crowded,
}
