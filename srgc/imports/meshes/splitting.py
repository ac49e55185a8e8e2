"""Choose the parts of a mesh for pieces: split where hulls add much, join elsewhere."""

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
"""The added volume is measured again when the number of pieces has grown by this factor."""
TINY = 10 * THINNEST
"""Smaller parts (m) stay whole: pieces of their parts would be about as thick as they are."""
ROUGH, JOINED = 0.6, 1.1
"""Shares of the detail down to which parts are split, and up to which they are joined."""


def regions_of(
    parts: Anatomy, vertices: Floats, triangles: Ints, budget: float, most: int
) -> list[Region]:
    """At most ``most`` parts of solids and shells whose hulls add about the budget (m^3).

    Vertices have the shape (n, 3), triangles (m, 3).
    """
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
    """Split the region that adds most until in all they add at most the budget (m^3)."""
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
    """The regions that replace one; only itself if it is tiny or cannot be split."""
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
    """Split the regions whose pieces, with few corners, add most, until the budget is kept.

    The sum over single pieces counts overlaps several times, so the volume that all add together is
    measured from time to time.
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
    """The volume that the pieces of regions add together, or singly if that is less (m^3)."""
    single = sum(each.piece_volume - each.volume for each in regions)
    union = union_of([each.enclosed.piece for each in regions])
    return min(single, float(union.volume()) - sum(each.volume for each in regions))
