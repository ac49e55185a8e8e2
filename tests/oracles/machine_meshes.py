"""A closed mesh like the housing of a milling machine: walls, an opening in front, a table."""

from __future__ import annotations

import random
import struct
from itertools import product
from pathlib import Path

import numpy as np

from compiler.arrays import Array

SEED = 30


def machine(seed: int = SEED) -> Array:
    """The triangles (n, 3, 3) in mm, counter-clockwise from outside.

    The origin is at the floor in the middle of the front; x leads into the machine.
    """
    rng = random.Random(seed)
    wall = rng.randrange(35, 46)
    deep, wide, high = rng.randrange(600, 681), rng.randrange(820, 901), rng.randrange(980, 1061)
    sill, lintel, table = rng.randrange(190, 211), rng.randrange(740, 781), rng.randrange(110, 131)
    xs = [0, wall, deep - wall, deep]
    half, open_half = wide // 2, rng.randrange(290, 321)
    ys = [-half, -half + wall, -open_half, open_half, half - wall, half]
    zs = [-60, 0, table, sill, lintel, high - wall, high]
    cells = np.ones((3, 5, 6), dtype=bool)
    cells[1, 1:4, 2:5] = False  # the room inside, above the table
    cells[0, 2, 3] = False  # the opening
    return boundary((xs, ys, zs), cells)


def boundary(grid: tuple[list[int], list[int], list[int]], cells: Array) -> Array:
    """Two triangles for each side of a cell that no other one touches.

    The sides of neighbours have the same corners, so that the surface is closed.
    """
    found = []
    for index in product(*(range(n) for n in cells.shape)):
        if not cells[index]:
            continue
        for axis, side in product(range(3), (0, 1)):
            near = list(index)
            near[axis] += 2 * side - 1
            inside = 0 <= near[axis] < cells.shape[axis]
            if inside and cells[tuple(near)]:
                continue
            found += _side(grid, index, axis, side)
    return np.array(found, dtype=float)


def _side(
    grid: tuple[list[int], list[int], list[int]], index: tuple[int, ...], axis: int, side: int
) -> list[list[list[int]]]:
    u, v = (axis + 1) % 3, (axis + 2) % 3
    corners = []
    for i, j in ((0, 0), (1, 0), (1, 1), (0, 1)):
        corner = [0, 0, 0]
        corner[axis] = grid[axis][index[axis] + side]
        corner[u] = grid[u][index[u] + i]
        corner[v] = grid[v][index[v] + j]
        corners.append(corner)
    if not side:
        corners.reverse()
    a, b, c, d = corners
    return [[a, b, c], [a, c, d]]


def stl_bytes(triangles: Array) -> bytes:
    """Binary STL."""
    head = b"a machine of tests/oracles/machine_meshes.py".ljust(80)
    found = [head, struct.pack("<I", len(triangles))]
    for corners in triangles:
        normal = np.cross(corners[1] - corners[0], corners[2] - corners[0])
        normal /= np.linalg.norm(normal)
        found.append(struct.pack("<12fH", *normal, *corners.ravel(), 0))
    return b"".join(found)


if __name__ == "__main__":
    Path("specs/imports/machine.stl").write_bytes(stl_bytes(machine()))
