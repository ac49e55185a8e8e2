"""A cart on a map with walls and noise, and a way that a search on its pixels has found."""

from __future__ import annotations

import random
from collections import deque
from collections.abc import Mapping
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from tests.oracles.rod_chains import Array, RodChain

PIXEL = 0.05
"""m"""
WIDE, HIGH = 60, 40
"""Pixels."""
CLEAR = 4
"""Pixels that the way keeps from what is occupied, in rows and columns."""
MARGIN = 0.1
"""m; what the cart is asked to keep."""

Pixels = NDArray[np.bool_]


@dataclass(frozen=True)
class CartOnAMap:
    """``way`` are the turning points (m), ``steps`` those between them; row 0 of ``occupied`` is at
    the bottom."""

    arm: RodChain
    half: Array
    occupied: Pixels
    way: tuple[Array, ...]
    steps: tuple[int, ...]
    step: float
    regions: tuple[tuple[Array, Array], tuple[Array, Array]]
    margin: float = MARGIN

    def files(self, bound: str) -> Mapping[str, bytes]:
        """The specification, the map and its image."""
        grey = np.where(self.occupied[::-1], 0, 254).astype(np.uint8)
        image = f"P5\n{WIDE} {HIGH}\n255\n".encode() + grey.tobytes()
        header = (
            f"image: room.pgm\nresolution: {PIXEL}\norigin: [0.0, 0.0, 0.0]\nnegate: 0\n"
            "occupied_thresh: 0.65\nfree_thresh: 0.196\n"
        )
        boxes = [
            f"box [{low[0]:.3f}, {high[0]:.3f}] x [{low[1]:.3f}, {high[1]:.3f}] m"
            for low, high in self.regions
        ]
        text = (
            f"module Rail {{ role base; dof s: prismatic x in [0, {WIDE * PIXEL:g}] m; }}\n"
            f"module Cross {{ role joint; dof s: prismatic y in [0, {HIGH * PIXEL:g}] m; }}\n"
            "module Cart { role effector; }\n"
            "grammar Mobile { start R; r: R -> Rail Cross Cart; }\n"
            "semantics Mobile {\n"
            "  r { this.rail = world * move(x, Rail.s); this.tip = this.rail * move(y, Cross.s);\n"
            f"    point(frame: this.tip, mass: {self.arm.payload} kg);"
            " effector(frame: this.tip); }\n}\n"
            f"workspace Room {{ plane xy; bounds box [0, {WIDE * PIXEL:g}] x [0, "
            f'{HIGH * PIXEL:g}] m; obstacles from "room.yaml";\n'
            f"  region Home {boxes[0]};\n  target Goal {boxes[1]};\n}}\n"
            "task T {\n  robot Mobile; workspace Room; start in Home at rest; reach Goal;\n"
            f"  avoid room with body margin {MARGIN} m;\n  effort <= {bound} N;\n"
            f"  horizon {sum(self.steps)} steps of {self.step} s;\n}}\n"
        )
        return {"task.srg": text.encode(), "room.yaml": header.encode(), "room.pgm": image}


def cart_on_a_map(rng: random.Random) -> CartOnAMap | None:
    """Walls with a gap each and single pixels of noise; none where no way is left."""
    occupied = np.zeros((HIGH, WIDE), dtype=bool)
    for wall in range(rng.randint(1, 3)):
        x, gap = 15 + 14 * wall + rng.randint(0, 5), rng.randint(6, HIGH - 18)
        occupied[:, x : x + 2] = True
        occupied[gap : gap + rng.randint(10, 12), x : x + 2] = False
    for _ in range(rng.randint(5, 40)):
        occupied[rng.randrange(HIGH), rng.randrange(WIDE)] = True
    first = rng.randint(6, HIGH - 7), rng.randint(6, 8)
    last = rng.randint(6, HIGH - 7), rng.randint(WIDE - 9, WIDE - 7)
    wide = _grown(occupied, CLEAR)
    pixels = _way(wide, first, last)
    if pixels is None:
        return None
    turns = _straightened(wide, pixels)
    way = tuple(PIXEL * (np.array([column, row], dtype=float) + 0.5) for row, column in turns)
    lengths = [float(np.linalg.norm(b - a)) for a, b in pairwise(way)]
    steps = tuple(max(4, round(length / 0.06)) for length in lengths)
    arm = RodChain("XY", (0.0, 0.0), 1.0, payload=rng.choice((2.0, 4.0)))
    half, side = np.array([WIDE, HIGH]) * PIXEL, 0.075
    regions = tuple(
        (np.append(at - side, 0.0), np.append(at + side, 0.0)) for at in (way[0], way[-1])
    )
    return CartOnAMap(arm, half, occupied, way, steps, 0.2, regions)  # type: ignore[arg-type]


def _grown(occupied: Pixels, by: int) -> Pixels:
    """What is occupied, with all within so many rows and columns, and the edge of the map."""
    padded = np.pad(occupied, by, constant_values=True)
    found = np.zeros_like(occupied)
    for row in range(2 * by + 1):
        for column in range(2 * by + 1):
            found |= padded[row : row + HIGH, column : column + WIDE]
    return found


def _way(
    blocked: Pixels, first: tuple[int, int], last: tuple[int, int]
) -> list[tuple[int, int]] | None:
    """A shortest way of pixels, in rows and columns, by breadth first."""
    before: dict[tuple[int, int], tuple[int, int] | None] = {first: None}
    if blocked[first] or blocked[last]:
        return None
    queue = deque([first])
    while queue:
        at = queue.popleft()
        if at == last:
            found = [at]
            while (previous := before[found[-1]]) is not None:
                found.append(previous)
            return found[::-1]
        for row, column in ((0, 1), (1, 0), (0, -1), (-1, 0)):
            there = at[0] + row, at[1] + column
            if not blocked[there] and there not in before:
                before[there] = at
                queue.append(there)
    return None


def _straightened(blocked: Pixels, way: list[tuple[int, int]]) -> list[tuple[int, int]]:
    """Its ends and as few pixels between as straight lines need."""
    kept, at = [way[0]], 0
    while at < len(way) - 1:
        at = next(k for k in range(len(way) - 1, at, -1) if _free(blocked, kept[-1], way[k]))
        kept.append(way[at])
    return kept


def _free(blocked: Pixels, one: tuple[int, int], other: tuple[int, int]) -> bool:
    parts = np.linspace(0, 1, 200)[:, None]
    at = np.rint((1 - parts) * np.array(one) + parts * np.array(other)).astype(int)
    return not blocked[at[:, 0], at[:, 1]].any()
