"""What a hull of a mesh collides as: it holds every vertex, and little else."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest

from compiler.robots.mesh_corners import mesh_corners
from compiler.workspaces.hull import hull_rows
from grammar_lang.ir import Mesh

MILLI = Fraction(1, 1000)


def mesh(points: np.ndarray, name: str) -> Mesh:
    exact = {tuple(Fraction(float(x)) for x in point) for point in points}
    return Mesh(name, name, tuple(sorted(exact)))


def test_few_vertices_are_the_corners() -> None:
    points = np.random.default_rng(1).normal(size=(20, 3))
    found = mesh_corners(mesh(points, "few"), MILLI, 3)
    expected = np.array(sorted(map(tuple, points))) / 1000
    np.testing.assert_allclose(np.array(found, float), expected, rtol=1e-15)


@pytest.mark.parametrize("dimension", [2, 3])
@pytest.mark.parametrize("seed", range(4))
def test_of_many_vertices_none_is_outside(dimension: int, seed: int) -> None:
    rng = np.random.default_rng(seed)
    points = rng.normal(size=(300, 3)) @ rng.normal(size=(3, 3)) + rng.normal(size=3)
    given = mesh(points, f"many {seed}")
    corners = mesh_corners(given, Fraction(1, 3), dimension)
    assert len(corners) <= 48
    assert all(corner[dimension:] == (0,) * (3 - dimension) for corner in corners)
    rows = hull_rows([corner[:dimension] for corner in corners])
    for vertex in given.vertices:
        for row in rows:
            along = sum(a * x / 3 for a, x in zip(row.normal, vertex, strict=False))
            assert along <= row.offset
    for axis in range(dimension):
        ends = [corner[axis] for corner in corners]
        assert float(max(ends)) == pytest.approx(points[:, axis].max() / 3, rel=1e-12)
        assert float(min(ends)) == pytest.approx(points[:, axis].min() / 3, rel=1e-12)


def test_a_ball_is_an_eighth_larger_at_most() -> None:
    points = np.random.default_rng(2).normal(size=(4000, 3))
    points /= np.linalg.norm(points, axis=1)[:, None]
    corners = np.array(mesh_corners(mesh(points, "ball"), Fraction(1), 3), float)
    assert np.linalg.norm(corners, axis=1).max() < 1.13
