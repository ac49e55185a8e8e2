"""Random tasks of many kinds that are feasible for certain: each comes with a motion that does it.

A family (``feasible_families.py``) draws a robot and poses to pass; the reference motion is that of
``rod_chains.py``, simulated under inputs that are held from sample to sample, and obstacles are put
beside it.  Inputs may be 1.2 to 2 times as large as the motion's, and it has more room than asked
for.  A draw without such a motion is drawn again.
"""

from __future__ import annotations

import random
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from math import floor, log10, pi, radians

import numpy as np

from tests.oracles.feasible_families import FAMILIES, Draw
from tests.oracles.feasible_maps import cart_on_a_map
from tests.oracles.feasible_text import BOUND, hull, plain
from tests.oracles.rod_chains import (
    FINE,
    Array,
    Block,
    RodChain,
    blocks_beside,
    cube_points,
    points_on,
    quintic,
    region_about,
    tracked,
)

MAPS = "noisy maps"
KINDS = (*FAMILIES, MAPS)
"""The names of all families."""
MARGIN = 0.01
"""The distance that bodies keep from obstacles, of arms of a metre or so (m)."""
ROOM = 0.03
"""How much more room the reference motion leaves, likewise."""
SPARE = 1.2
"""Inputs may be so many times as large as in the reference motion, at least."""
FASTEST = 6.0
"""rad/s or m/s: no reference motion is faster."""


@dataclass(frozen=True)
class Visit:
    """An arm's effector (both from 0) is in a region, by low and high corner, at a sample."""

    arm: int
    region: str
    low: Array
    high: Array
    sample: int


@dataclass(frozen=True)
class Reference:
    """An arm and its motion: states ``FINE`` times a step and at the end, inputs (steps, n)."""

    arm: RodChain
    states: Array
    inputs: Array
    half: Array

    @property
    def bars(self) -> tuple[Array, Array]:
        """The ends of the rods at all of these instants, (s, n, 3) each."""
        poses = self.states[:, : len(self.arm.axes)]
        starts, ends = zip(*(self.arm.bars(q) for q in poses), strict=True)
        return np.array(starts), np.array(ends)

    @property
    def tips(self) -> Array:
        """Where the effector is, (s, 3)."""
        return self.bars[1][:, -1]


@dataclass(frozen=True)
class FeasibleTask:
    """A specification and why it is feasible.

    ``files`` are what it consists of, ``task.srg`` among them.  ``bound`` is that of inputs (SI,
    one for all), ``margin`` the distance (m) that the ``body``, or else the effector, keeps from
    ``blocks``.
    """

    family: str
    seed: int
    files: Mapping[str, bytes]
    references: tuple[Reference, ...]
    visits: tuple[Visit, ...]
    blocks: tuple[Block, ...]
    body: bool
    margin: float
    bound: float
    step: float

    @property
    def text(self) -> str:
        """The specification."""
        return self.files["task.srg"].decode()


def feasible_task(family: str, seed: int) -> FeasibleTask:
    """The first draw of a seed that has a reference motion."""
    rng = random.Random(f"{family} {seed}")
    if family == MAPS:
        return _on_a_map(seed, rng)
    while (found := _made(family, seed, FAMILIES[family](rng), rng)) is None:
        pass
    return found


def _made(family: str, seed: int, draw: Draw, rng: random.Random) -> FeasibleTask | None:
    frame, scale = draw.frame, draw.frame.scale
    references = [_reference(draw, number) for number in range(len(draw.arms))]
    if any(each is None for each in references):
        return None
    known = tuple(each for each in references if each is not None)
    samples = [0, *np.cumsum(draw.steps).tolist()]
    visits = list[Visit]()
    for arm, reference in enumerate(known):
        named = zip(_names(len(samples), arm), samples, strict=True)
        # A second arm may start anywhere.
        for name, sample in list(named)[min(arm, 1) :]:
            spot, side = reference.tips[FINE * sample], scale * rng.uniform(*draw.sides)
            corners = region_about(rng, spot, side, 4 - floor(log10(scale)))
            visits.append(Visit(arm, name, *corners, sample))
    regions = [(visit.low, visit.high) for visit in visits]
    tips = known[0].tips
    points = [points_on(*each.bars) if draw.body else each.tips for each in known]
    flat = np.concatenate([each.reshape(-1, 3) for each in points])
    blocks = _obstacles(rng, draw, tips, flat, regions)
    if blocks is None:
        return None
    peak = max(float(np.abs(each.inputs).max()) for each in known)
    bound = _above(rng.uniform(SPARE, 2.0) * peak / (frame.gain or 1.0))
    text = _text(draw, visits, blocks, bound)
    return FeasibleTask(
        family, seed, {"task.srg": text.encode()}, known, tuple(visits), blocks, draw.body,
        MARGIN * scale, bound * (frame.gain or 1.0), draw.step,
    )  # fmt: skip


def _reference(draw: Draw, number: int) -> Reference | None:
    """The motion of an arm, if it keeps within its ranges and above the floor."""
    arm, half = draw.arms[number], draw.half[number]
    wanted = _wanted(draw.poses[number], draw.steps, draw.step)
    slides = np.array([axis.isupper() for axis in arm.axes])
    room = np.where(slides, 0.03 * draw.frame.scale, radians(3))
    if max(float(np.abs(v).max()) for _, v, _ in wanted) > FASTEST:
        return None
    has_floor = arm.base[2] > 0
    if has_floor and min(arm.places(q)[2][:, 2].min() for q, _, _ in wanted) < 0.1:
        return None
    needed = max(float(np.abs(arm.inverse(*at)).max()) for at in wanted)
    followed = tracked(arm, wanted, draw.step, 2 * needed)
    if followed is None:
        return None
    found = Reference(arm, *followed, half)
    if (np.abs(found.states[:, : len(arm.axes)]) > half - room).any():
        return None
    return None if has_floor and min(each[..., 2].min() for each in found.bars) < 0.05 else found


def _wanted(
    poses: Sequence[Array], counts: Sequence[int], step: float
) -> list[tuple[Array, Array, Array]]:
    """From rest to rest between the poses, at the samples and in the middle of steps."""
    found = []
    for (first, last), steps in zip(pairwise(poses), counts, strict=True):
        found += [quintic(first, last, k / (2 * steps), steps * step) for k in range(2 * steps)]
    return [*found, quintic(poses[-1], poses[-1], 1.0, 1.0)]


def _names(count: int, arm: int) -> list[str]:
    """Of the regions of an arm, in order."""
    middle = [f"V{k}" for k in range(1, count - 1)]
    return ["Home", *middle, "Goal"] if arm == 0 else ["", *middle, "Other"]


def _above(value: float) -> float:
    """A little more, with three digits."""
    return round(value * 1.01, 2 - floor(log10(value)))


# --- obstacles ------------------------------------------------------------------------------------


def _obstacles(
    rng: random.Random,
    draw: Draw,
    tips: Array,
    points: Array,
    regions: Sequence[tuple[Array, Array]],
) -> tuple[Block, ...] | None:
    """Farther from ``points`` (.., 3) than asked for, and apart from the regions."""
    scale, room = draw.frame.scale, MARGIN + ROOM
    if draw.slot:
        return _slot(rng, tips, regions)
    unit = [(low / scale, high / scale) for low, high in regions]
    if draw.blocks > 3:
        return _many(rng, draw, points, unit, room)
    found = blocks_beside(
        rng, tips / scale, points / scale, room, unit, draw.blocks, draw.frame.space
    )
    return None if found is None else tuple(_scaled(block, scale) for block in found)


def _scaled(block: Block, scale: float) -> Block:
    (x, y, z), (a, b, c) = block.centre, block.half
    return Block((scale * x, scale * y, scale * z), (scale * a, scale * b, scale * c), block.angle)


def _many(
    rng: random.Random,
    draw: Draw,
    points: Array,
    regions: Sequence[tuple[Array, Array]],
    room: float,
) -> tuple[Block, ...]:
    """Small blocks all over the reach of the arm."""
    reach, cubes = sum(draw.arms[0].lengths), [cube_points(region) for region in regions]
    found = list[Block]()
    while len(found) < draw.blocks:
        a, b, c = (round(rng.uniform(0.02, 0.06), 3) for _ in range(3))
        x, y = (round(rng.uniform(-1.1, 1.1) * reach, 3) for _ in range(2))
        block = Block((x, y, 0.0), (a, b, c), round(rng.uniform(0, pi / 2), 3))
        near = block.distances(points).min() > room
        if near and all(block.distances(cube).min() > 0.01 for cube in cubes):
            found.append(block)
    return tuple(found)


def _slot(
    rng: random.Random, tips: Array, regions: Sequence[tuple[Array, Array]]
) -> tuple[Block, ...] | None:
    """Two walls on either side of the way, half way, with a gap of 4 to 6 cm between them."""
    middle = len(tips) // 2
    way = tips[middle + 1] - tips[middle - 1]
    along = way / np.linalg.norm(way)
    aside = np.array([-along[1], along[0], 0.0])
    angle = float(np.arctan2(along[1], along[0]))
    gap, width = rng.uniform(0.02, 0.03), rng.uniform(0.1, 0.3)
    found = []
    for side in (1, -1):
        x, y, _ = tips[middle] + side * (gap + width) * aside
        half = 0.01, round(width, 4), 1.0
        found.append(Block((round(x, 4), round(y, 4), 0.0), half, round(angle, 5)))
    cubes = [cube_points(region) for region in regions]
    clear = all(block.distances(tips).min() > 0.01 for block in found)
    apart = all(block.distances(cube).min() > 0.01 for block in found for cube in cubes)
    return tuple(found) if clear and apart else None


# --- the text -------------------------------------------------------------------------------------


def _text(draw: Draw, visits: Sequence[Visit], blocks: Sequence[Block], bound: float) -> str:
    frame, limit = draw.frame, plain(bound, max(0, 3 - floor(log10(bound))))
    places = "".join(
        f"  {'target' if v.region == 'Goal' and not draw.formula else 'region'} {v.region} "
        f"{frame.box(v.low, v.high)};\n"
        for v in visits
    )
    names = [f"O{i + 1}" for i in range(len(blocks))]
    hulls = "".join(
        f"  obstacle {name} {hull(frame, block)};\n"
        for name, block in zip(names, blocks, strict=True)
    )
    margin = frame.number(MARGIN * frame.scale)
    keeps = f"body margin {margin} m" if draw.body else "effector"
    first = " by effector 1" if len(draw.arms) > 1 else ""
    clauses = ["robot G; workspace W;", f"start in Home{first} at rest;"]
    if draw.formula:
        asked = "Goal"
        for visit in visits[-2:0:-1]:
            asked = f"{visit.region} and eventually ({asked})"
        clauses.append(f"satisfy eventually ({asked});")
    else:
        clauses.append(f"reach Goal{first}{' at rest' if draw.rest else ''};")
    if len(draw.arms) > 1:
        clauses.append("satisfy eventually Other by effector 2;")
    clauses += [f"avoid {', '.join(names)} with {keeps};"] if names else []
    if any(draw.arms[0].down):
        down = ", ".join(plain(x, 2) for x in draw.arms[0].down[: frame.dimension])
        clauses.append(f"gravity ({down}) m/s^2;")
    if not frame.gain:
        axes = "".join(arm.axes for arm in draw.arms)
        clauses += [f"effort <= {limit} N*m;"] if any(x.islower() for x in axes) else []
        clauses += [f"effort <= {limit} N;"] if any(x.isupper() for x in axes) else []
    clauses.append(f"horizon {sum(draw.steps)} steps of {draw.step} s;")
    robot = frame.robot(draw.arms, draw.half).replace(BOUND, limit)
    return (
        f"{robot}workspace W {{\n  {'space xyz' if frame.space else 'plane xy'};\n"
        f"  bounds {frame.box(*_bounds(draw, visits))};\n{places}{hulls}}}\n"
        "task T {\n" + "".join(f"  {clause}\n" for clause in clauses) + "}\n"
    )


def _bounds(draw: Draw, visits: Sequence[Visit]) -> tuple[Array, Array]:
    """A box about all that the arms can reach, down to the floor in space."""
    low, high = np.full(3, np.inf), np.full(3, -np.inf)
    for arm, half in zip(draw.arms, draw.half, strict=True):
        slid = [h if axis.isupper() else 0.0 for axis, h in zip(arm.axes, half, strict=True)]
        reach = 1.3 * (sum(arm.lengths) + max(slid))
        low, high = (
            np.minimum(low, arm.base - np.array(reach)),
            np.maximum(high, arm.base + np.array(reach)),
        )
    for visit in visits:
        low, high = np.minimum(low, visit.low), np.maximum(high, visit.high)
    if draw.frame.space:
        low[2] = min(0.0, *(float(visit.low[2]) for visit in visits))
    return low, high


# --- a cart on a map ------------------------------------------------------------------------------


def _on_a_map(seed: int, rng: random.Random) -> FeasibleTask:
    while (found := cart_on_a_map(rng)) is None:
        pass
    arm, way, step = found.arm, found.way, found.step
    wanted = _wanted(way, found.steps, step)
    followed = tracked(arm, wanted, step, np.inf)
    if followed is None:
        raise AssertionError(seed)
    reference = Reference(arm, *followed, found.half)
    bound = _above(rng.uniform(SPARE, 2.0) * float(np.abs(reference.inputs).max()))
    files = found.files(plain(bound, 3))
    samples = (0, sum(found.steps))
    visits = tuple(
        Visit(0, name, *corners, sample)
        for name, corners, sample in zip(("Home", "Goal"), found.regions, samples, strict=True)
    )
    return FeasibleTask(
        MAPS, seed, files, (reference,), visits, (), True, found.margin, bound, step
    )
