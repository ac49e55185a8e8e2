"""The parts of a mesh that pieces are made for: split where hulls add much, joined elsewhere."""

from __future__ import annotations

import heapq
from typing import TYPE_CHECKING

import numpy as np

from srgc.imports.meshes.enclosing import THINNEST
from srgc.imports.meshes.joining import Joining
from srgc.imports.meshes.measures import union_of
from srgc.imports.meshes.mesh import Bools, Floats, Ints
from srgc.imports.meshes.regions import Region, ShellRegion, SolidRegion
from srgc.imports.meshes.solids import Anatomy

if TYPE_CHECKING:
    from collections.abc import Sequence

LOOK = 1.1
"""What pieces add is measured again when there are so many times as many."""
TINY = 10 * THINNEST
"""Parts below it (m) stay whole: pieces of their parts would be about as thick as they."""
ROUGH, JOINED = 0.6, 1.1
"""Shares of the detail: parts are split down to the first, and joined up to the second."""


def regions_of(
    parts: Anatomy, vertices: Floats, triangles: Ints, budget: float, most: int
) -> list[Region]:
    """Parts of solids and shells whose hulls add about the budget (m^3), and at most so many."""
    solids: list[Region] = [SolidRegion(each) for each in parts.solids]
    solids = _split_up(solids, ROUGH * budget, 2 * most + 8)
    shells: list[Region] = []
    for shell in parts.shells:
        outside = ~_inside_hulls(shell, solids)
        if outside.any():
            shells.append(ShellRegion(shell[outside]))
    shells = _split_up(shells, ROUGH * budget, 2 * most + 8)
    regions = [*solids, *shells]
    if not regions:  # all triangles are segments or points
        regions = [ShellRegion(vertices[triangles])]
    return Joining(regions).join(JOINED * budget, most)


def _split_up(regions: list[Region], budget: float, most: int) -> list[Region]:
    """Split the region that adds most until all add at most the budget (m^3)."""
    heap = [(-each.excess, i, each) for i, each in enumerate(regions)]
    heapq.heapify(heap)
    total, count, done = sum(each.excess for each in regions), len(regions), list[Region]()
    while heap and total > budget and len(heap) + len(done) < most:
        _, _, worst = heapq.heappop(heap)
        parts = _split(worst)
        if parts == [worst]:
            done.append(worst)
            continue
        total += sum(part.excess for part in parts) - worst.excess
        for part in parts:
            count += 1
            heapq.heappush(heap, (-part.excess, count, part))
    return [*done, *(each for _, _, each in sorted(heap, key=lambda each: each[1]))]


def _split(region: Region) -> list[Region]:
    """Regions instead of one; only itself where it cannot be split, or is tiny."""
    tiny = float(np.ptp(region.points, axis=0).max()) < TINY
    return [region] if tiny else region.split()


def _inside_hulls(sides: Floats, regions: Sequence[Region]) -> Bools:
    """Which triangles (m, 3, 3) lie in the hull of one of the regions, in doubles."""
    from scipy.spatial import ConvexHull, QhullError

    inside = np.zeros(len(sides), dtype=bool)
    for region in regions:
        try:
            planes = ConvexHull(region.points).equations
        except (QhullError, ValueError):
            continue
        lower, upper = region.points.min(axis=0), region.points.max(axis=0)
        near = np.flatnonzero(~inside & ((sides >= lower) & (sides <= upper)).all(axis=(1, 2)))
        heights = sides[near].reshape(-1, 3) @ planes[:, :3].T + planes[:, 3]
        inside[near] = (heights <= 0).all(axis=1).reshape(-1, 3).all(axis=1)
    return inside


def refined(regions: list[Region], budget: float, most: int) -> list[Region]:
    """Split regions whose pieces, with few corners, add most, until all add at most the budget.

    What pieces add one by one counts where they overlap as often as they do; so what they add
    together is measured now and then.
    """
    heap = [(each.volume - each.piece_volume, i, each) for i, each in enumerate(regions)]
    heapq.heapify(heap)
    count, done, next_look = len(heap), list[Region](), 0.0
    while heap:
        alive = [*done, *(each for _, _, each in heap)]
        if len(alive) >= next_look:
            next_look = LOOK * len(alive)
            if together(alive) <= budget:
                break
        _, _, worst = heapq.heappop(heap)
        parts = _split(worst)
        if parts == [worst] or len(heap) + len(done) + len(parts) > most:
            done.append(worst)
            if sum(each.piece_volume - each.volume for each in done) > budget:
                break  # splitting the others does not help
            continue
        for part in parts:
            count += 1
            heapq.heappush(heap, (part.volume - part.piece_volume, count, part))
    return [*done, *(each for _, _, each in sorted(heap, key=lambda each: each[1]))]


def together(regions: Sequence[Region]) -> float:
    """What the pieces of regions add together, or one by one where that is less (m^3)."""
    single = sum(each.piece_volume - each.volume for each in regions)
    union = union_of([each.enclosed.piece for each in regions])
    return min(single, float(union.volume()) - sum(each.volume for each in regions))
