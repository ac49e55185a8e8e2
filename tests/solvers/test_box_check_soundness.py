"""Every label of a covering against random poses, and whole coverings against flood fill."""

from __future__ import annotations

from collections import deque
from fractions import Fraction

import numpy as np
import pytest
import shapely

from compiler.expressions.evaluators.balls import working_precision
from compiler.unreachability.box_tree import ChoiceSide, Part, coordinate_boxes, coordinate_sides
from compiler.unreachability.covered_poses import CoveredPoses
from compiler.unreachability.motion_conditions import motion_conditions
from grammar_lang import ir
from solvers.verifier.refutations.box_check import why_not
from tests.oracles.arms import ArmBuilder
from tests.oracles.coverings import allowed, avoiding, covering, errand, height, spot, world
from tests.oracles.planar_bodies import random_polygon
from tests.oracles.planes import box
from tests.oracles.questions import random_robot
from tests.oracles.random_robots import random_robot as random_tree


def scene(seed):
    """A robot, a workspace with tilted obstacles in the plane, a task, of all sorts."""
    rng = np.random.default_rng(seed)
    while True:
        dimension = int(rng.choice([2, 2, 3]))
        if rng.random() < 0.5:
            model = random_robot(rng, dimension)
        else:
            model = random_tree(int(rng.integers(10**6)), dimension, int(rng.integers(1, 3)))
        if coordinate_sides(model) is not None and len(model.dofs) <= 3:
            break
    size = [(Fraction(-7, 2), Fraction(4))] * dimension
    regions = [random_region(rng, name, dimension) for name in ("S", "T", "O", "P")]
    workspace = world(*regions, bounds=size)
    subjects = [str(rng.choice(["body", "effector"])) for _ in range(2)]
    avoid = (*avoiding("O", subject=subjects[0]), *avoiding("P", subject=subjects[1]))
    reach = ir.Reach("T", None)
    return rng, model, workspace, errand(avoid=avoid, reach=reach, bounds_body=seed % 3 == 0)


def random_region(rng, name, dimension):
    centre = rng.uniform(-1.5, 1.5, dimension)
    if dimension == 2:
        rows = random_polygon(rng, centre, 1.3).rows
        return ir.Region(name, "region", ir.Inequalities(rows))
    sides = [(Fraction(round(10 * c - 8), 10), Fraction(round(10 * c + 8), 10)) for c in centre]
    return box(name, "region", *sides)


def random_tree_code(rng, count, leaves):
    """A tree of so many leaves that halves sides at random, evenly deep."""
    boxes = [(Part(),) * count]
    cuts = {}
    while len(boxes) < leaves and count:
        box_, side = boxes.pop(0), int(rng.integers(count))
        cuts[box_] = side
        boxes += [(*box_[:side], half, *box_[side + 1 :]) for half in box_[side].halves()]
    nodes, waiting = [], [(Part(),) * count]
    while waiting:
        box_ = waiting.pop()
        side = cuts.get(box_, -1)
        nodes.append(side)
        if side >= 0:
            halves = [(*box_[:side], half, *box_[side + 1 :]) for half in box_[side].halves()]
            waiting += halves[::-1]
    return tuple(nodes)


def random_parameters(rng, sides):
    parts = []
    for side in sides:
        part = Part()
        while part.halvings < 8 and rng.random() < 0.9:
            if isinstance(side, ChoiceSide) and np.diff(side.chosen(part))[0] < 2:
                break
            part = part.halves()[int(rng.integers(2))]
        parts.append(part)
    return tuple(parts)


def value(rng, side, part):
    if isinstance(side, ChoiceSide):
        chosen = side.values[slice(*side.chosen(part))]
        return float(chosen[int(rng.integers(len(chosen)))].mid())
    ends = side.enclosure(part)
    share = rng.choice([0.0, 1.0, rng.random(), rng.random(), rng.random()])
    return (1 - share) * float(ends.low) + share * float(ends.high)


def judge(seed, leaves):
    """The share of boxes that are blocked, after every label was held against poses."""
    rng, model, workspace, task = scene(seed)
    with working_precision(64):
        poses = CoveredPoses(motion_conditions(model, workspace, task))
        tree = random_tree_code(rng, len(model.dofs), leaves)
        parts = random_parameters(rng, poses.parameters)
        cover = poses.cover(poses.parameters_of(parts), tree)
        assert [*coordinate_boxes(tree, len(model.dofs))] == cover.boxes
        ((passage, *_),) = poses.demands.passages
        starts, goals = cover.starts(passage), cover.goals(passage, cover.free)
        for number, its in enumerate(cover.boxes):
            for _ in range(3):
                q = [value(rng, *pair) for pair in zip(poses.coordinates, its, strict=True)]
                theta = [value(rng, *pair) for pair in zip(poses.parameters, parts, strict=True)]
                q, theta = np.array(q), np.array(theta)
                if not cover.free[number]:
                    assert not allowed(model, workspace, task, q, theta)
                    continue
                tips = poses.tapes.near(q[None], theta)[0]
                if not starts[number]:
                    region = workspace.region("S")
                    assert height(region, tips[passage.starting]) > -1e-9
                if not goals[number]:
                    region = workspace.region("T")
                    assert height(region, tips[passage.reaching]) > -1e-9
    return float(np.mean(~cover.free)), float(np.mean(~starts | ~goals))


def test_no_pose_contradicts_the_label_of_its_box():
    found = [judge(seed, 40) for seed in (1, 5, 6, 9)]
    assert sum(0.1 < blocked < 1 for blocked, _ in found) >= 2
    assert any(blocked == 1 for blocked, _ in found)
    assert sum(elsewhere > 0.3 for _, elsewhere in found) >= 3


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(10, 40))
def test_no_pose_contradicts_the_label_of_its_box_at_length(seed):
    judge(seed, 250)


# --- flood fill ----------------------------------------------------------------------------------

LENGTHS = (1.0, 0.7)
CELLS = 72
"""Samples of each angle, on the whole circle or between its limits."""


def two_links(limits):
    arm = ArmBuilder().revolute(limits=limits).link(1)
    return arm.revolute(limits=(-150, 150)).link("0.7").effector().model()


def flood_finds_a_way(workspace, names, limits):
    """Whether grid poses clear by more than a step moves the arm lead from S to T.

    Between neighbours every point of the arm moves by at most half a step from either, so such a
    way is one of the arm.
    """
    first = np.linspace(-np.pi, np.pi, CELLS) if limits is None else np.radians(
        np.linspace(*limits, CELLS))  # fmt: skip
    second = np.radians(np.linspace(-150, 150, CELLS))
    step = (first[1] - first[0]) * sum(LENGTHS), (second[1] - second[0]) * LENGTHS[1]
    a, b = np.meshgrid(first, second, indexing="ij")
    elbow = np.stack([np.cos(a), np.sin(a)], axis=-1) * LENGTHS[0]
    tip = elbow + np.stack([np.cos(a + b), np.sin(a + b)], axis=-1) * LENGTHS[1]
    arms = shapely.linestrings(np.stack([np.zeros_like(elbow), elbow, tip], axis=-2))
    gaps = [shapely.distance(arms, polygon(workspace.region(name))) for name in names]
    free = np.min(gaps, axis=0) > max(step) / 2
    tips = shapely.points(tip)
    inside = {name: shapely.covers(polygon(workspace.region(name)), tips) for name in ("S", "T")}
    queue = deque(zip(*np.nonzero(free & inside["S"]), strict=True))
    seen = np.zeros_like(free)
    for i, j in queue:
        seen[i, j] = True
    while queue:
        i, j = queue.popleft()
        for beside, m in ((i + 1, j), (i - 1, j), (i, j + 1), (i, j - 1)):
            k = beside % CELLS if limits is None else beside
            if 0 <= k < CELLS and 0 <= m < CELLS and free[k, m] and not seen[k, m]:
                seen[k, m] = True
                queue.append((k, m))
    return bool(np.any(seen & inside["T"]))


def polygon(region):
    from compiler.workspaces.polytope import polytope_of

    corners = polytope_of(region.shape, 2).vertices
    return shapely.Polygon([[float(x) for x in corner] for corner in corners])


def crowded(seed):
    rng = np.random.default_rng(seed)
    places = []
    for name in "ST":
        angle, radius = rng.uniform(-3, 3), rng.uniform(0.9, 1.6)
        x, y = (Fraction(round(100 * radius * f(angle)), 100) for f in (np.cos, np.sin))
        places.append(spot(name, x, y, "0.12"))
    blocks = []
    while len(blocks) < 3:
        angle, radius = rng.uniform(-3, 3), rng.uniform(0.5, 1.5)
        rows = random_polygon(rng, (radius * np.cos(angle), radius * np.sin(angle)), 0.4).rows
        block = ir.Region(f"O{len(blocks)}", "obstacle", ir.Inequalities(rows))
        if polygon(block).distance(shapely.Point(0, 0)) > 0.15:
            blocks.append(block)
    limits = None if rng.random() < 0.5 else (-170, 170)
    return world(*places, *blocks), [block.name for block in blocks], limits


def hold_against_flood_fill(seeds, letters):
    """How many are proved impossible, and how many have a way."""
    proved = ways = 0
    for seed in seeds:
        workspace, names, limits = crowded(seed)
        task = errand(avoid=avoiding(*names))
        reason = why_not(covering("", letters), two_links(limits), workspace, task)
        way = flood_finds_a_way(workspace, names, limits)
        assert not (way and reason is None), seed
        proved, ways = proved + (reason is None), ways + way
    return proved, ways


def test_what_is_proved_impossible_has_no_way_by_flood_fill():
    proved, ways = hold_against_flood_fill(range(8), "aaaaabbbbb")
    assert proved >= 2
    assert ways >= 2


@pytest.mark.slow
def test_what_is_proved_impossible_has_no_way_by_flood_fill_at_length():
    proved, ways = hold_against_flood_fill(range(8, 36), "aaaaaabbbbbb")
    assert proved >= 3
    assert ways >= 8
