"""Pieces against the polarity of the compiler, trimesh and algebra."""

from __future__ import annotations

from fractions import Fraction
from itertools import product

import numpy as np
import pytest
import trimesh
from scipy.spatial import ConvexHull

from compiler.workspaces.hull import hull_rows
from srgc.imports.meshes.containment import uncovered
from srgc.imports.meshes.convex_piece import MOST_CORNERS, convex_piece
from srgc.imports.meshes.enclosing import enclosing, holds


@pytest.mark.parametrize("seed", range(10))
def test_planes_and_corners_are_those_of_polarity(seed):
    rng = np.random.default_rng(seed)
    spread = [3, 40, 10**6, 10**8][seed % 4]  # few values: many points in one plane
    points = [tuple(row) for row in rng.integers(-spread, spread, size=(14, 3)).tolist()]
    piece = convex_piece(points, 3)
    rows = hull_rows([tuple(map(Fraction, p)) for p in points])
    assert {(tuple(map(Fraction, p[:3])), Fraction(p[3])) for p in piece.planes} == {
        (row.normal, row.offset) for row in rows
    }
    hull = ConvexHull(np.array(points, dtype=float))
    assert set(piece.corners) == {points[i] for i in hull.vertices}


@pytest.mark.parametrize("seed", range(6))
def test_the_surface_is_closed_and_looks_outwards(seed):
    rng = np.random.default_rng(seed)
    points = rng.integers(-4 - seed, 5 + seed, size=(16, 3))
    piece = convex_piece(map(tuple, points.tolist()), 0)
    mesh = trimesh.Trimesh(piece.points(), piece.outward(), process=False)
    assert mesh.is_watertight
    assert mesh.is_winding_consistent
    assert mesh.volume == pytest.approx(ConvexHull(points).volume)


@pytest.mark.parametrize(
    "points",
    [
        [(0, 0, 0), (1, 0, 0), (0, 1, 0)],
        [(0, 0, 0), (1, 1, 1), (2, 2, 2), (5, 5, 5)],
        [(x, y, x + y) for x in range(3) for y in range(3)],
    ],
)
def test_what_is_flat_is_no_piece(points):
    assert convex_piece(points, 2) is None


def test_decimals_are_short_and_exact():
    piece = convex_piece([(0, 0, 0), (-1500, 0, 0), (0, 20, 0), (0, 0, 1234567)], 3)
    assert set(piece.decimals()) == {
        ("0", "0", "0"), ("-1.5", "0", "0"), ("0", "0.02", "0"), ("0", "0", "1234.567"),
    }  # fmt: skip


def test_a_box_is_told():
    corners = list(product((0, 3), (-2, 5), (1, 2)))
    assert convex_piece(corners, 1).box() == ((0, -2, 1), (3, 5, 2))
    assert convex_piece([*corners, (1, 1, 9)], 1).box() is None


def sphere(count, seed=0):
    points = np.random.default_rng(seed).normal(size=(count, 3))
    return points / np.linalg.norm(points, axis=1)[:, None]


def cylinder(sides):
    angles = 2 * np.pi * np.arange(sides) / sides
    ring = np.column_stack([0.05 * np.cos(angles), 0.05 * np.sin(angles)])
    return np.concatenate([np.column_stack([ring, np.full(sides, z)]) for z in (0.0, 0.3)])


@pytest.mark.parametrize(
    ("points", "most"),
    [
        # A ball about 32 corners cannot be below 1.06; a prism of 16 sides is 1.013 of a round one.
        (sphere(300), 1.20),
        (cylinder(48), 1.02),
        (np.random.default_rng(3).uniform(-1, 1, size=(200, 3)), 1.25),
        (np.array(list(product((0.0, 0.1), (0.0, 0.2), (0.0, 0.003)))), 1.001),
    ],
)
def test_an_enclosing_piece_is_tight_and_holds_all(points, most):
    found = enclosing(points)
    assert not found.thickened
    assert len(found.piece.corners) <= MOST_CORNERS
    assert holds(found.piece, points)
    assert uncovered(points, np.arange(len(points) // 3 * 3).reshape(-1, 3), [found.piece]) == ()
    volume = ConvexHull(found.piece.points()).volume
    assert ConvexHull(points).volume <= volume <= most * ConvexHull(points).volume


@pytest.mark.parametrize(
    "points",
    [
        [[0.1, 0.2, 0.3]],
        [[0.1, 0.2, 0.3], [1.1, 0.4, -0.3]],
        [[0, 0, 0], [1, 0, 0.5], [0, 1, 0.25], [1, 1, 0.75]],
        [[0, 0, 0], [1e-9, 0, 0], [0, 1e-9, 0]],
    ],
)
def test_flat_sets_are_made_thick_enough_and_no_more(points):
    points = np.array(points, dtype=float)
    found = enclosing(points)
    assert found.thickened
    assert holds(found.piece, points)
    size = max(np.ptp(points, axis=0).max(), 0.0)
    least = max(1e-5, 1e-4 * size)
    corners = found.piece.points()
    normal = np.linalg.svd(corners - corners.mean(axis=0))[2][2]
    assert 0.9 * least <= np.ptp(corners @ normal) <= 3 * least


def test_a_double_below_a_decimal_is_rounded_to_it():
    points = np.array(list(product((0.0, 0.3), (1.0, 1.5), (0.0, 2.0))))  # 0.3 is below 3/10
    assert enclosing(points).piece.box() is not None
    lower, upper = enclosing(points).piece.box()
    scale = 10 ** enclosing(points).piece.digits
    assert [Fraction(x, scale) for x in (*lower, *upper)] == [
        0, 1, 0, Fraction(3, 10), Fraction(3, 2), 2,
    ]  # fmt: skip
