from __future__ import annotations

import random
from fractions import Fraction

import networkx as nx
import numpy as np
import pytest

from compiler.unreachability.box_tree import Part
from compiler.unreachability.covered_poses import TouchingBoxes


def random_boxes(choose, sides):
    """The leaves of a random tree."""
    boxes = [(Part(),) * sides]
    for _ in range(choose.randrange(1, 30)):
        box = boxes.pop(choose.randrange(len(boxes)))
        side = choose.randrange(sides)
        boxes += [(*box[:side], half, *box[side + 1 :]) for half in box[side].halves()]
    choose.shuffle(boxes)
    return boxes


def ends(part):
    width = Fraction(1, 2**part.halvings)
    return part.number * width, (part.number + 1) * width


def touch(a, b, circles):
    """Whether two boxes have a common point, where the ends of a circle are one."""
    for one, other, circle in zip(a, b, circles, strict=True):
        (low, high), (first, last) = ends(one), ends(other)
        shifts = (-1, 0, 1) if circle else (0,)
        if not any(low + k <= last and first <= high + k for k in shifts):
            return False
    return True


@pytest.mark.parametrize("seed", range(40))
def test_what_chains_of_touching_boxes_lead_to(seed):
    choose = random.Random(seed)
    sides = choose.randrange(1, 4)
    circles = [choose.random() < 0.5 for _ in range(sides)]
    boxes = random_boxes(choose, sides)
    free = np.array([choose.random() < 0.6 for _ in boxes])
    seeds = np.array([choose.random() < 0.1 for _ in boxes])
    graph = nx.Graph()
    graph.add_nodes_from(np.flatnonzero(free))
    graph.add_edges_from(
        (i, j) for i in graph for j in graph if i < j and touch(boxes[i], boxes[j], circles)
    )
    expected = {
        j for i in np.flatnonzero(seeds & free) for j in nx.node_connected_component(graph, i)
    }
    reached = TouchingBoxes(boxes, circles).reachable(seeds, free)
    assert set(np.flatnonzero(reached)) == expected


def test_corners_touch_and_circles_close():
    half, other = Part().halves()
    boxes = [(half, half), (other, other)]
    seeds, free = np.array([True, False]), np.array([True, True])
    assert TouchingBoxes(boxes, [False, False]).reachable(seeds, free).all()
    quarters = [part for h in (half, other) for part in h.halves()]
    ring = [(part,) for part in quarters]
    ends_only = np.array([True, False, False, True])
    first = np.array([True, False, False, False])
    assert TouchingBoxes(ring, [True]).reachable(first, ends_only)[3]
    assert not TouchingBoxes(ring, [False]).reachable(first, ends_only)[3]


def test_no_side_is_one_box_and_the_deepest_halves_are_exact():
    one = TouchingBoxes([()], [])
    assert one.reachable(np.array([True]), np.array([True])).all()
    deep = Part(2**60 - 1, 60)
    boxes = [(deep,), (Part(2**60 - 2, 60),), (Part(2**60 - 3, 60),)]
    found = TouchingBoxes(boxes, [False])
    seeds = np.array([True, False, False])
    assert not found.reachable(seeds, np.array([True, False, True]))[2]
    assert found.reachable(seeds, np.array([True, True, True])).all()
