"""Arms of rods under gravity with a task each, from a seed; a reference motion shows it feasible.

Planar arms have two to four links in a vertical plane, every fifth arm a turning base and two links
in space.  The lengths are free within a range, the efforts bounded by 1.3 to 2 times the largest
static torque of the reference motion (``rod_chains.py``).  A draw whose motion does not keep all
that its task asks, with room, is drawn again.
"""

from __future__ import annotations

import random
from collections.abc import Sequence
from dataclasses import dataclass
from math import degrees, radians

import numpy as np

from tests.oracles.rod_chains import (
    GRAVITY,
    Array,
    Block,
    RodChain,
    blocks_beside,
    box,
    points_on,
    quintic,
    region_about,
    tracked,
)

PAYLOAD = 0.5
"""kg, at the effector."""
COLUMN = 0.5
"""m: the height of the first limb's joint in space."""
MARGIN = 0.01
"""m: the distance that bodies keep from obstacles."""
EFFORT_SHARE = 0.92
"""The part of the effort bound that a reference motion may use."""


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
    arm: RodChain
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
    arm = RodChain(
        "z" + "y" * count if space else "z" * count,
        (0.0, *limbs) if space else limbs,
        density,
        (0.0, 0.0, COLUMN if space else 0.0),
        (0.0, 0.0, -GRAVITY) if space else (0.0, -GRAVITY, 0.0),
        PAYLOAD,
    )
    ranges = np.radians(half)
    first, last = (
        np.array([radians(round(rng.uniform(-0.9, 0.9) * h, 1)) for h in half]) for _ in range(2)
    )
    step, steps = rng.choice((0.05, 0.1)), rng.randint(20, 60)
    if np.linalg.norm(arm.places(first)[2][-1] - arm.places(last)[2][-1]) < 0.4:
        return None
    wanted = [quintic(first, last, k / (2 * steps), step * steps) for k in range(2 * steps + 1)]
    static = max(float(np.abs(arm.mechanics(q, 0 * q)[1]).max()) for q, _, _ in wanted)
    effort = round(rng.uniform(1.3, 2.0) * static, 1)
    needed = max(float(np.abs(arm.inverse(*at)).max()) for at in wanted)
    if needed > EFFORT_SHARE * effort:
        return None
    reach = 1.25 * sum(limbs)
    followed = tracked(arm, wanted, step, EFFORT_SHARE * effort)
    if followed is None:
        return None
    states, inputs = followed
    ends = np.array([arm.places(q)[2] for q in states[:, : len(first)]])
    tips = ends[:, -1]
    near = np.abs(states[:, : len(first)]) > ranges - radians(3)
    if near.any() or (space and ends[:, 1:, 2].min() < 0.05):
        return None
    side = rng.uniform(0.2, 0.26) if space else rng.uniform(0.13, 0.19)
    home, goal = (region_about(rng, spot, side) for spot in (tips[0], tips[-1]))
    body = rng.random() < 0.5
    points = points_on(ends[:, :-1], ends[:, 1:]) if body else tips
    room, obstacles = (MARGIN + 0.03) if body else 0.05, rng.choice((0, 1, 1, 2))
    blocks = blocks_beside(rng, tips, points, room, (home, goal), obstacles, space)
    if blocks is None:
        return None
    pose = None if rng.random() < 0.7 else [round(degrees(angle), 1) for angle in first]
    text = _text(arm, (low, high), half, reach, (home, goal), pose, blocks, body, effort,
                 (steps, step))  # fmt: skip
    return GravityTask(seed, text, arm, effort, static, step, states, inputs, home, goal, ranges,
                       blocks, body)  # fmt: skip


def _text(
    arm: RodChain,
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
    space = arm.base[2] > 0
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
        f"  bounds {box(np.array([-reach, -reach, 0.0]), corner, size)};\n"
        f"  region Home {box(*regions[0], size)};\n"
        f"  target Goal {box(*regions[1], size)};\n"
        f"{obstacles}"
        "}\n"
        "task T {\n"
        f"  robot Arm; workspace Place;\n  start {start};\n  reach Goal;\n{avoid}"
        f"  effort <= {effort} N*m;\n  horizon {horizon[0]} steps of {horizon[1]} s;\n"
        f"  gravity ({down}) m/s^2;\n  modules <= {count + 2 + space};\n"
        "}\n"
    )
