"""Growing coverings against the reading of their trees, and distances against a plain search."""

from __future__ import annotations

from collections import deque
from fractions import Fraction
from itertools import pairwise, product

import numpy as np
import pytest

from compiler.unreachability.box_tree import Part, Parts, coordinate_boxes
from solvers.impossibility.coordinate_cover import MOST_HALVINGS, UNREACHED, CoordinateCover, Side

CIRCLES = [(False, False), (True, False), (True, True)]
FRACTION = 2.0**-MOST_HALVINGS


def grown(seed: int, circles: tuple[bool, ...], halvings: int = 60) -> CoordinateCover:
    """A covering of random boxes, some of which are not kept."""
    rng = np.random.default_rng(seed)
    side = Side(np.array([-1.0, 0.0]), np.array([3.0, 1.0]), np.array(circles))
    cover = CoordinateCover(side)
    for _ in range(halvings):
        where = rng.choice(len(cover.node), size=min(2, len(cover.node)), replace=False)
        cover.halve(where, rng.integers(0, 2, len(where)))
        if rng.uniform() < 0.1 and len(cover.node) > 8:
            cover.keep(rng.uniform(size=len(cover.node)) > 0.15)
    return cover


def ends(part: Part) -> tuple[Fraction, Fraction]:
    size = Fraction(1, 2**part.halvings)
    return part.number * size, (part.number + 1) * size


def touch(one: Parts, other: Parts, circles: tuple[bool, ...]) -> bool:
    """Whether closed boxes share a point, by trying a turn more and less."""
    for a, b, circle in zip(one, other, circles, strict=True):
        (low, high), (first, last) = ends(a), ends(b)
        turns = (-1, 0, 1) if circle else (0,)
        if not any(low <= last + k and first + k <= high for k in turns):
            return False
    return True


def kept_parts(cover: CoordinateCover) -> list[Parts]:
    """The kept leaves, found among the boxes of the tree by their places."""
    boxes = {
        tuple(float(ends(part)[0]) for part in box) + tuple(part.halvings for part in box): box
        for box in coordinate_boxes(cover.tree(), 2)
    }
    assert len(boxes) == cover.leaves
    return [
        boxes[tuple(float(a) * FRACTION for a in first) + tuple(int(d) for d in depth)]
        for first, depth in zip(cover.first, cover.depth, strict=True)
    ]


@pytest.mark.parametrize("seed", range(3))
def test_leaves_are_boxes_of_the_tree(seed: int) -> None:
    cover = grown(seed, (True, False))
    low, high = cover.boxes()
    for i, box in enumerate(kept_parts(cover)):
        expected = [[float(end) for end in ends(part)] for part in box]
        assert (low[i, 0], high[i, 0]) == pytest.approx([4 * e - 1 for e in expected[0]])
        assert (low[i, 1], high[i, 1]) == pytest.approx(expected[1])


@pytest.mark.parametrize(("seed", "circles"), list(product(range(3), CIRCLES)))
def test_distances_and_ways(seed: int, circles: tuple[bool, bool]) -> None:
    cover = grown(seed, circles)
    parts, rng = kept_parts(cover), np.random.default_rng(seed)
    count = len(parts)
    within = rng.uniform(size=count) > 0.3
    sources, goals = np.arange(count) < 3, np.arange(count) >= count - 3
    expected = np.full(count, UNREACHED)
    queue = deque(int(i) for i in np.flatnonzero(sources & within))
    expected[list(queue)] = 0
    while queue:
        i = queue.popleft()
        for j in range(count):
            if within[j] and expected[j] == UNREACHED and touch(parts[i], parts[j], circles):
                expected[j] = expected[i] + 1
                queue.append(j)
    found = cover.distances(sources, within)
    assert found.tolist() == expected.tolist()
    way = cover.way(found, goals)
    reached = expected[goals & (expected != UNREACHED)]
    assert len(way) == (min(reached) + 1 if len(reached) else 0)
    for i, j in pairwise(way):
        assert within[i]
        assert touch(parts[i], parts[j], circles)
