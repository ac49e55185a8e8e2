"""Surfaces of shapes: closed, outward, within the shapes and as large as these to a percent."""

from __future__ import annotations

from math import pi

import numpy as np
import pytest

from compiler.rigid_links.ball_pose import WORLD_POSE
from compiler.rigid_links.link_shape import Geometry
from grammar_lang import ir
from srgc.exports.scenes.triangles import Triangles, hull_triangles, shape_triangles

R, L = 0.3, 0.8
WEDGE = (0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.1, 0.1, 0.1)
"""A tetrahedron, and a point in it."""
CASES: dict[ir.ShapeKind, tuple[tuple[float, ...], float]] = {
    "sphere": ((R,), 4 / 3 * pi * R**3),
    "cylinder": ((R, L), pi * R**2 * L),
    "capsule": ((R, L), pi * R**2 * L + 4 / 3 * pi * R**3),
    "box": ((0.5, 0.6, 0.7), 0.21),
    "hull": (WEDGE, 1 / 6),
}


def volume(surface: Triangles) -> float:
    """By the divergence theorem: negative where triangles face inward."""
    a, b, c = (surface.corners[surface.faces[:, i]] for i in range(3))
    return float(np.einsum("ij,ij->i", a, np.cross(b, c)).sum() / 6)


def distance(kind: str, size: tuple[float, ...], points: np.ndarray) -> np.ndarray:
    """How far outside of a round shape points are; on it, 0."""
    r, z = np.hypot(points[:, 0], points[:, 1]), np.abs(points[:, 2])
    match kind:
        case "sphere":
            return np.linalg.norm(points, axis=1) - size[0]
        case "cylinder":
            return np.maximum(r - size[0], z - size[1] / 2)
        case _:
            return np.hypot(r, np.maximum(z - size[1] / 2, 0)) - size[0]


@pytest.mark.parametrize("kind", CASES)
def test_surfaces(kind: ir.ShapeKind) -> None:
    size, expected = CASES[kind]
    surface = shape_triangles(Geometry(kind, WORLD_POSE, size))
    edges = np.concatenate([surface.faces[:, [i, (i + 1) % 3]] for i in range(3)])
    directed = {(int(a), int(b)) for a, b in edges}
    assert len(directed) == len(edges)
    assert {(b, a) for a, b in directed} == directed
    assert set(np.unique(surface.faces)) == set(range(len(surface.corners)))
    assert len(surface.corners) - len(edges) // 2 + len(surface.faces) == 2
    assert 0.97 * expected < volume(surface) <= expected * (1 + 1e-12)
    if kind in ("sphere", "cylinder", "capsule"):
        assert np.abs(distance(kind, size, surface.corners)).max() < 1e-12


def test_a_flat_hull_has_no_surface() -> None:
    flat = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0]])
    assert len(hull_triangles(flat).faces) == 0
