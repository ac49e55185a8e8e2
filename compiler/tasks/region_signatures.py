"""Which sets of regions a point of the workspace can be in: the cells of an arrangement, by name.

A *signature* is a set of closed regions such that some point of the bounds is in these and in no
others. The result is exact for sets with interior, as long as there are few; sets that cannot be
excluded are kept, so an absent signature is certainly impossible.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import reduce

from compiler.workspaces.partition import remainder
from compiler.workspaces.polytope import Polytope

COVERING_LIMIT = 8
"""If more regions than this cut a cell, it is not checked whether they cover it together."""


def region_signatures(
    bounds: Polytope, regions: Sequence[Polytope], limit: int
) -> tuple[int, ...] | None:
    """The signatures as bit sets (bit i: the i-th region), in increasing order.

    Args:
        bounds: a bounded polytope with interior.
        regions: closed convex sets, which may be unbounded.
        limit: the greatest number of signatures.

    Returns:
        The signatures, a superset of those that occur; None if there are more than ``limit``.
    """
    inside = [bounds.intersection(region) for region in regions]
    cells: list[tuple[Polytope, int]] = [(bounds, 0)]
    for number, region in enumerate(inside):
        if region.is_empty:
            continue
        following = [(cell, bits) for cell, bits in cells if not regions[number].contains(cell)]
        for cell, bits in cells:
            common = cell.intersection(region)
            if not common.is_empty:
                following.append((common, bits | 1 << number))
        if len(following) > limit:
            return None
        cells = following
    return tuple(sorted(bits for cell, bits in cells if not _covered(cell, bits, inside)))


def _covered(cell: Polytope, bits: int, inside: Sequence[Polytope]) -> bool:
    """Whether the regions without a bit cover a cell."""
    others = [
        region
        for number, region in enumerate(inside)
        if not bits >> number & 1 and not region.is_empty
    ]
    if any(other.contains(cell) for other in others):
        return True
    cutting = [other.irredundant() for other in others if other.has_interior and other.meets(cell)]
    if not cell.has_interior or len(cutting) > COVERING_LIMIT:
        return False
    return not remainder(cell.irredundant(), cutting)


# --- Which signatures a motion can have one after the other ---------------------------------------


def adjacency(signatures: Sequence[int]) -> list[int]:
    """For each signature those that can touch it, as bit sets.

    Two do not if one has a region that is disjoint from a region of the other; two regions without
    a signature that has both are disjoint.
    """
    meeting: dict[int, int] = {}
    for bits in signatures:
        for number in _bits(bits):
            meeting[number] = meeting.get(number, 0) | bits
    common = [reduce(int.__and__, (meeting[k] for k in _bits(bits)), -1) for bits in signatures]
    return [
        sum(1 << k for k, other in enumerate(signatures) if other & meeting_all == other)
        for meeting_all in common
    ]


def components(mask: int, near: Sequence[int]) -> list[int]:
    """The signatures of a bit set, in parts that do not touch each other."""
    parts: list[int] = []
    while mask:
        part, new = 0, mask & -mask
        while new:
            part |= new
            new = reduce(int.__or__, (near[k] for k in _bits(new)), 0) & mask & ~part
        parts.append(part)
        mask &= ~part
    return parts


def _bits(number: int) -> Iterator[int]:
    """The places of the ones of a number, from the lowest."""
    while number:
        lowest = number & -number
        yield lowest.bit_length() - 1
        number ^= lowest
