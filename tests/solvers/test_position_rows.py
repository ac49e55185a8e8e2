"""Separating half-planes against exact distances between polygons."""

from __future__ import annotations

from itertools import pairwise, product

import cvxpy as cp
import numpy as np
import pytest
from scipy.spatial import ConvexHull

from compiler.arrays import Array
from compiler.discretisation.spanning_points import Points
from solvers.trajectory.convex_set import ConvexSet
from solvers.trajectory.linear_model import bends
from solvers.trajectory.position_plan import Dwell, PositionPlan, Separation
from solvers.trajectory.separating_planes import Obstacles, separating_planes
from tests.oracles.some_cases import some


def convex_set(points: Array) -> ConvexSet:
    hull = ConvexHull(points)
    rows = np.unique(np.round(hull.equations, 12), axis=0)
    return ConvexSet(rows[:, :-1], -rows[:, -1], points[hull.vertices])


def to_segment(p: Array, a: Array, b: Array) -> float:
    along = b - a
    size = float(along @ along)
    share = 0.0 if size == 0 else float(np.clip((p - a) @ along / size, 0, 1))
    return float(np.linalg.norm(p - a - share * along))


def edges(points: Array) -> list[tuple[Array, Array]]:
    """The segments between all pairs: among them every edge of the hull."""
    return [(a, b) for i, a in enumerate(points) for b in points[i:]]


def inside(p: Array, polygon: ConvexSet) -> bool:
    return bool(np.all(polygon.normals @ p <= polygon.offsets))


def cross(o: Array, a: Array, b: Array) -> float:
    return float((a[0] - o[0]) * (b[1] - o[1]) - (a[1] - o[1]) * (b[0] - o[0]))


def meet(a: Array, b: Array, c: Array, d: Array) -> bool:
    """Two segments in general position cross."""
    return cross(a, b, c) * cross(a, b, d) < 0 and cross(c, d, a) * cross(c, d, b) < 0


def distance(points: Array, polygon: ConvexSet) -> float:
    """Between the hull of a few points and a polygon: 0, or least over vertices and edges."""
    order = np.argsort(np.arctan2(*(polygon.vertices - polygon.vertices.mean(axis=0)).T))
    ring = polygon.vertices[order]
    sides = [*pairwise(ring), (ring[-1], ring[0])]
    ours = edges(points)
    if any(inside(p, polygon) for p in points) or any(meet(*s, *t) for s in ours for t in sides):
        return 0.0
    if len(points) > 2 and np.linalg.matrix_rank(points[1:] - points[0], tol=1e-9) == 2:
        own = convex_set(points)
        if any(inside(v, own) for v in ring):
            return 0.0
    gaps = [to_segment(p, *side) for p in points for side in sides]
    return min(gaps + [to_segment(v, *edge) for v in ring for edge in ours])


def polygon(rng: np.random.Generator, centre: Array, size: float) -> ConvexSet:
    return convex_set(centre + size * rng.uniform(-1, 1, (int(rng.integers(4, 9)), 2)))


@pytest.mark.parametrize("width", [1, 2, 4])
def test_planes_separate_exactly_what_is_apart(width: int) -> None:
    rng = np.random.default_rng(width)
    apart, hits = 0, 0
    for _ in range(150):
        obstacle = polygon(rng, np.zeros(2), 1.0)
        points = rng.uniform(-2, 2, 2) + rng.uniform(-1, 1, (width, 2))
        exact = distance(points, obstacle)
        normals, support = separating_planes(points[None], Obstacles((obstacle,)))
        np.testing.assert_allclose(np.linalg.norm(normals, axis=1), 1)
        assert np.max(obstacle.vertices @ normals[0]) == pytest.approx(support[0])
        gap = float(np.min(points @ normals[0]) - support[0])
        assert gap <= exact + 1e-9  # no plane shows more than the distance
        if exact > 1e-9:
            assert gap > 0
            apart += 1
        else:
            assert gap <= 1e-9
            hits += 1
    assert min(apart, hits) > 5


def test_a_facet_shows_the_whole_distance_where_it_is_the_nearest() -> None:
    box = convex_set(np.array(list(product([0.0, 1.0], [0.0, 1.0]))))
    swept = np.array(
        [[[0.2, 1.3], [0.7, 1.6]], [[1.4, 0.1], [1.6, 0.9]], [[0.5, -0.3], [0.5, -0.3]]]
    )
    normals, support = separating_planes(swept, Obstacles((box,)))
    gaps = np.min(np.einsum("kwd,kd->kw", swept, normals), axis=1) - support
    np.testing.assert_allclose(gaps, [0.3, 0.4, 0.3])
    np.testing.assert_allclose(normals, [[0, 1], [1, 0], [0, -1]], atol=1e-12)


def test_planes_in_space_come_from_the_facets() -> None:
    cube = convex_set(np.array(list(product([0.0, 1.0], repeat=3))))
    swept = np.array([[[0.5, 0.5, 1.25], [0.9, 0.1, 2.0]]])
    normals, support = separating_planes(swept, Obstacles((cube,)))
    np.testing.assert_allclose(normals[0], [0, 0, 1], atol=1e-12)
    assert support[0] == pytest.approx(1.0)


def space_distance(a: Array, b: Array) -> float:
    """Between two hulls by a quadratic program over convex combinations."""
    share_a, share_b = cp.Variable(len(a), nonneg=True), cp.Variable(len(b), nonneg=True)
    ones = [cp.sum(share_a) == 1, cp.sum(share_b) == 1]
    problem = cp.Problem(cp.Minimize(cp.sum_squares(share_a @ a - share_b @ b)), ones)
    return float(np.sqrt(max(0.0, problem.solve(solver=cp.CLARABEL))))


@pytest.mark.parametrize("width", some([2, 1, 4], 1))
def test_planes_in_space_separate_exactly_what_is_apart(width: int) -> None:
    rng = np.random.default_rng(20 + width)
    apart, hits = 0, 0
    for number in range(60):
        corners = np.array(list(product([0.0, 1.0], repeat=3)))
        obstacle = convex_set(corners if number % 2 else rng.uniform(0, 1, (7, 3)))
        points = rng.uniform(-0.2, 1.2, 3) + (width > 1) * rng.uniform(-1, 1, (width, 3))
        exact = space_distance(points, obstacle.vertices)
        normals, support = separating_planes(points[None], Obstacles((obstacle,)))
        gap = float(np.min(points @ normals[0]) - support[0])
        assert gap <= exact + 1e-4
        if exact > 1e-3:
            assert gap > 0
            apart += 1
        elif exact < 1e-5:
            assert gap <= 1e-3
            hits += 1
    assert min(apart, hits) > 2


def test_a_bar_past_an_edge_of_a_box_in_space() -> None:
    """No facet separates them: only the plane along both edges does."""
    cube = convex_set(np.array(list(product([0.0, 1.0], repeat=3))))
    bar = np.array([[[1.6, 0.5, 0.6], [0.6, 0.5, 1.6]]])
    normals, support = separating_planes(bar, Obstacles((cube,)))
    assert np.min(bar[0] @ normals[0]) - support[0] == pytest.approx(0.2 / np.sqrt(2))


OBSTACLE = convex_set(np.array([[1.7, 2.0], [3.0, 2.0], [3.0, 3.0], [1.7, 3.0]]))
GROUP = (0, 2)


def points_of(positions: Array) -> Points:
    return Points(positions, np.zeros((*positions.shape, 1)), np.zeros((*positions.shape, 0)))


def around(rng: np.random.Generator, steps: int) -> Array:
    """Positions (steps + 1, 3, 2) of three points walking about the obstacle."""
    angle = np.linspace(0, rng.uniform(2, 6), steps + 1) + rng.uniform(0, 6)
    radius = rng.uniform(1.3, 2.0)
    centre = np.array([2.35, 2.5]) + radius * np.stack([np.cos(angle), np.sin(angle)], axis=1)
    offsets = rng.uniform(-0.15, 0.15, (3, 2))
    return np.asarray(centre[:, None, :] + offsets[None])


@pytest.mark.parametrize("seed", range(8))
def test_every_row_excludes_the_obstacle(seed: int) -> None:
    rng = np.random.default_rng(seed)
    plan = PositionPlan(12, (), (Separation(GROUP, OBSTACLE, 0.02),), 0.01)
    rows = plan.rows(around(rng, 12))
    np.testing.assert_allclose(np.linalg.norm(rows.normal, axis=1), 1)
    at = rows.normal @ OBSTACLE.vertices.T
    # Every point of the obstacle violates every row, by the distance asked for at least.
    assert np.all(at.min(axis=1) - rows.offset >= 0.03 - 1e-12)
    assert set(rows.point.tolist()) == set(GROUP)
    assert sorted(set(rows.sample.tolist())) == list(range(13))
    # Two points, two ends per interval.
    assert len(rows.offset) == 12 * 4


@pytest.mark.parametrize("seed", range(8))
def test_chords_cannot_cut_corners(seed: int) -> None:
    """Any positions that satisfy the rows keep the hull of both samples away."""
    rng = np.random.default_rng(100 + seed)
    reference = around(rng, 12)
    plan = PositionPlan(12, (), (Separation(GROUP, OBSTACLE, 0.02),), 0.01)
    rows = plan.rows(reference)
    moved = reference + rng.uniform(-0.6, 0.6, reference.shape)
    for _ in range(200):  # project the positions on the violated half-planes
        excess = rows.excess(points_of(moved))
        worst = int(np.argmax(excess))
        if excess[worst] <= 0:
            break
        at = rows.sample[worst], rows.point[worst]
        moved[at] -= (excess[worst] + 1e-9) * rows.normal[worst]
    excess = rows.excess(points_of(moved))
    for i in range(12):
        here = np.isin(rows.sample, [i, i + 1])
        if np.all(excess[here] <= 0):
            swept = moved[i : i + 2, list(GROUP)].reshape(-1, 2)
            assert distance(swept, OBSTACLE) >= 0.03 - 1e-9
    assert np.max(excess) <= 1e-6


def test_a_chord_across_a_corner_violates_its_rows() -> None:
    """Both samples are clear of the obstacle by 0.1, the chord is not."""
    positions = np.array([[[1.6, 2.4]], [[2.1, 1.9]]])
    plan = PositionPlan(1, (), (Separation((0,), OBSTACLE, 0.0),), 0.0)
    assert not any(inside(p, OBSTACLE) for p in positions[:, 0])
    assert distance(positions[:, 0], OBSTACLE) == 0
    assert plan.rows(positions).excess(points_of(positions)).max() > 0


def test_dwells_are_the_shrunk_cells_at_their_samples() -> None:
    plan = PositionPlan(5, (Dwell(1, 2, 4, OBSTACLE),), (), 0.05)
    rows = plan.rows(np.zeros((6, 2, 2)))
    assert sorted(set(rows.sample.tolist())) == [2, 3, 4]
    assert set(rows.point.tolist()) == {1}
    assert len(rows.offset) == 3 * 4
    for corner in OBSTACLE.vertices:
        inward = corner + 0.05 * np.sign(np.array([2.35, 2.5]) - corner)
        positions = np.tile(inward, (6, 2, 1))
        assert rows.excess(points_of(positions)).max() == pytest.approx(0, abs=1e-12)
        positions[3, 1] = corner
        assert rows.excess(points_of(positions)).max() == pytest.approx(0.05)


def test_tightening_for_disturbed_motions_is_that_of_its_sample_and_point() -> None:
    spread = np.random.default_rng(4).uniform(0, 0.3, (6, 2))
    dwells = (
        Dwell(1, 2, 4, OBSTACLE),
        Dwell(0, 0, 1, OBSTACLE, spreads=np.array([1.0, 0.0, 0.0, 1.0])),
    )
    separations = (Separation((0, 1), OBSTACLE, 0.1),)
    here = np.random.default_rng(7).uniform(3, 5, (6, 2, 2))
    rows = PositionPlan(5, dwells, separations, 0.05, spread=spread).rows(here)
    plain = PositionPlan(5, dwells, separations, 0.05).rows(here)
    np.testing.assert_array_equal(rows.sample, plain.sample)
    np.testing.assert_array_equal(rows.point, plain.point)
    tightening = plain.offset - rows.offset
    whole = spread[rows.sample, rows.point]
    planned = slice(12, 20)  # four facets at two samples
    np.testing.assert_allclose(
        tightening[planned], whole[planned] * np.tile([1.0, 0.0, 0.0, 1.0], 2)
    )
    np.testing.assert_allclose(
        np.delete(tightening, np.arange(12, 20)), np.delete(whole, np.arange(12, 20))
    )


def test_planes_of_a_reference_that_is_astray_are_chosen_at_its_anchors() -> None:
    """The dwell is left of the obstacle; the reference has strayed to its right."""
    cell = convex_set(np.array([[0.0, 2.0], [1.5, 2.0], [1.5, 3.0], [0.0, 3.0]]))
    astray = np.tile([3.5, 2.5], (4, 1, 1))
    anchors = np.tile([1.0, 2.5], (4, 1))
    separation = Separation((0,), OBSTACLE, 0.0)
    plan = PositionPlan(3, (Dwell(0, 0, 3, cell),), (separation,), 0.0, 0, anchors)
    rows = plan.rows(astray)
    assert rows.excess(points_of(anchors[:, None])).max() <= 0
    plain = PositionPlan(3, (Dwell(0, 0, 3, cell),), (separation,), 0.0)
    assert plain.rows(astray).excess(points_of(anchors[:, None])).max() > 0
    # A reference within its dwell is believed.
    here = np.tile([1.4, 2.9], (4, 1, 1))
    np.testing.assert_array_equal(plan.rows(here).normal, plain.rows(here).normal)


def test_an_empty_plan_has_no_rows() -> None:
    rows = PositionPlan(3, (), (), 0.0).rows(np.zeros((4, 1, 3)))
    assert len(rows.offset) == 0
    assert rows.normal.shape == (0, 3)


@pytest.mark.parametrize(
    ("first", "last", "samples"),
    [
        (0, None, [(0, 1), (1, 2), (2, 3)]),
        (1, 3, [(1, 2), (2, 3)]),
        (1, 1, [(1, 1)]),
        (3, 3, [(3, 3)]),
        (0, 0, [(0, 0)]),
    ],
)
def test_a_separation_binds_the_steps_between_its_samples(
    first: int, last: int | None, samples: list[tuple[int, int]]
) -> None:
    """A single sample is bound alone: at the samples beside it the point may be in the set."""
    separation = Separation((0,), OBSTACLE, 0.1, first, last)
    rows = PositionPlan(3, (), (separation,), 0.0).rows(np.full((4, 1, 2), 9.0))
    assert rows.sample.reshape(-1, 2).tolist() == [list(pair) for pair in samples]


def test_far_separations_are_left_out_where_there_are_many() -> None:
    """Of twenty boxes in a row, those that are near a point that moves along half of them."""
    boxes = [
        convex_set(np.array([(2 * i + x, y) for x in (0.0, 1.0) for y in (1.0, 2.0)]))
        for i in range(20)
    ]
    x = np.linspace(0, 20, 11)
    positions = np.stack([x, np.zeros(11)], axis=1)[:, None, :]
    plan = PositionPlan(10, (), tuple(Separation((0,), b, 0.0) for b in boxes), 0.0)
    rows = plan.rows(positions)
    every = PositionPlan(10, (), plan.separations[:8], 0.0).rows(positions)
    assert len(every.offset) == 8 * 10 * 2
    kept = {int(step) for step in rows.sample}
    assert kept == set(range(11))
    assert len(rows.offset) < 20 * 10 * 2 * 0.6
    # Nothing nearer than what counts as near is lost: the half-plane of the nearest box is there.
    assert rows.excess(Points(positions, np.zeros(0), np.zeros(0))).max() == pytest.approx(-1.0)


def test_rows_of_separations_of_many_kinds_are_those_of_each_in_order() -> None:
    """Sets with three, four and five corners, one, two and three points, near and far."""
    rng = np.random.default_rng(11)
    angles = [np.sort(rng.uniform(0, 2 * np.pi / n, n) + 2 * np.pi * np.arange(n) / n)
              for n in (4, 3, 5, 4, 3)]  # fmt: skip
    centres = rng.uniform(1, 4, (5, 2))
    centres[3] = 40.0, -30.0
    sets = [
        convex_set(centre + 0.5 * np.stack([np.cos(angle), np.sin(angle)], axis=1))
        for centre, angle in zip(centres, angles, strict=True)
    ]
    groups = ((0, 2), (1,), (0, 1, 2), (0, 2), (2, 1))
    pairs = zip(groups, sets, strict=True)
    wanted = tuple(Separation(g, s, 0.01 * i, i % 3) for i, (g, s) in enumerate(pairs))
    positions = around(rng, 9)
    found = PositionPlan(9, (), wanted, 0.01).rows(positions)
    alone = [PositionPlan(9, (), (each,), 0.01).rows(positions) for each in wanted]
    for name in ("sample", "point", "normal", "offset"):
        parts = np.concatenate([getattr(rows, name) for rows in alone])
        np.testing.assert_array_equal(getattr(found, name), parts)
    # Rows of the far set are those of its facets, and valid.
    far = alone[3].normal
    assert all(np.abs(sets[3].normals + row).sum(axis=1).min() < 1e-12 for row in far)
    assert np.all((far @ sets[3].vertices.T).min(axis=1) >= alone[3].offset)


def parabolas(rng: np.random.Generator, steps: int) -> tuple[Array, Array]:
    """Positions (steps + 1, 3, 2) of points with constant accelerations in steps, and their rates.

    A step takes one second; the rates (steps + 1, 3, 2) are continuous.
    """
    x, v = [around(rng, 1)[0]], [rng.uniform(-0.3, 0.3, (3, 2))]
    for _ in range(steps):
        a = rng.uniform(-1.0, 1.0, (3, 2)) * rng.choice([0.05, 0.6])
        x.append(x[-1] + v[-1] + a / 2)
        v.append(v[-1] + a)
    return np.array(x), np.array(v)


def bent(rates: Array) -> Array:
    """The bends of such motions, whose coordinates are their positions themselves."""
    k, m, d = rates.shape
    by_q = np.broadcast_to(np.eye(m * d).reshape(m, d, m * d), (k, m, d, m * d))
    points = Points(np.zeros((k, m, d)), by_q, np.zeros((k, m, d, 0)))
    return bends(points, rates.reshape(k, m * d), 1.0)


def test_bends_are_what_curves_are_off_their_chords_half_way() -> None:
    x, v = parabolas(np.random.default_rng(3), 6)
    middle = x[:-1] + v[:-1] / 2 + (v[1:] - v[:-1]) / 8
    np.testing.assert_allclose(bent(v), middle - (x[:-1] + x[1:]) / 2, atol=1e-12)


def test_curves_that_keep_their_rows_are_clear_between_samples() -> None:
    """Looked at 11 times a step, against exact distances; chords alone would not do."""
    rng, plan = (
        np.random.default_rng(7),
        PositionPlan(1, (), (Separation(GROUP, OBSTACLE, 0.02),), 0.0),
    )
    kept, caught = 0, 0
    for _ in range(3000):
        x, v = parabolas(rng, 1)
        a = rng.uniform(-6.0, 6.0, (3, 2))
        v[0] = -rng.uniform(0.3, 0.7) * a  # there and back again
        v[1] = v[0] + a
        x[1] = x[0] + v[0] + a / 2
        whole = plan.rows(x, bent(v)).excess(points_of(x)).max()
        chords = plan.rows(x).excess(points_of(x)).max()
        if chords > 0 or whole < -0.2:
            continue
        times = np.linspace(0, 1, 11)[:, None, None]
        curve = x[0] + times * v[0] + times**2 / 2 * (v[1] - v[0])
        least = min(distance(each[list(GROUP)], OBSTACLE) for each in curve)
        if whole <= 0:
            kept += 1
            assert least >= 0.02 - 1e-9
        else:
            caught += least < 0.02
    assert kept > 100
    assert caught > 10


def test_curves_that_keep_their_rows_stay_in_a_dwell_between_its_samples() -> None:
    """Not so beyond its first and last sample, nor through facets of which only samples speak."""
    rng = np.random.default_rng(8)
    region = ConvexSet(np.array([[1.0, 0.0], [0.0, 1.0]]), np.array([2.6, 2.6]), OBSTACLE.vertices)
    plan = PositionPlan(4, (Dwell(1, 1, 3, region, spreads=np.array([1.0, 0.0])),), (), 0.0)
    kept, beyond = 0, 0
    for _ in range(4000):
        x, v = parabolas(rng, 4)
        if plan.rows(x, bent(v)).excess(points_of(x)).max() > 0:
            continue
        kept += 1
        times = np.linspace(0, 1, 21)[:, None, None]
        curves = [x[i] + times * v[i] + times**2 / 2 * (v[i + 1] - v[i]) for i in range(4)]
        first, second = (np.array([c[:, 1, axis].max() for c in curves]) for axis in (0, 1))
        assert first[1:3].max() <= 2.6 + 1e-9
        beyond += first[0] > 2.6 or first[3] > 2.6 or second[1:3].max() > 2.6
    assert kept > 50
    assert beyond > 10
