"""Triangulate shapes; triangles are counter-clockwise from outside."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import product

import numpy as np
from numpy.typing import NDArray

from compiler.arrays import Array
from compiler.rigid_links.link_shape import Geometry

AROUND, ALONG = 32, 8
"""The number of corners around a round shape, and from its equator to a pole."""


@dataclass(frozen=True, slots=True, eq=False)
class Triangles:
    """A surface: ``corners`` (m, 3) in metres, and ``faces`` (f, 3) of their indices."""

    corners: Array
    faces: NDArray[np.int64]


def shape_triangles(shape: Geometry) -> Triangles:
    """The surface of a shape in its own frame; corners of round shapes lie on their surfaces."""
    size = shape.size
    match shape.kind:
        case "hull":
            return hull_triangles(np.array(size).reshape(-1, 3))
        case "box":
            signs = np.array([*product((-0.5, 0.5), repeat=3)])
            return hull_triangles(signs * np.array(size))
        case "sphere":
            return _turned(_arc(size[0], -1, 0.0) + _arc(size[0], 1, 0.0)[1:])
        case "capsule":
            radius, length = size
            return _turned(_arc(radius, -1, -length / 2) + _arc(radius, 1, length / 2))
        case "cylinder":
            radius, length = size
            ends = [(0.0, -length / 2), (radius, -length / 2)]
            return _turned([*ends, *((r, -z) for r, z in ends[::-1])])


def hull_triangles(points: Array) -> Triangles:
    """The surface of the convex hull of points (m, 3); it has no faces if the hull is flat."""
    from scipy.spatial import ConvexHull, QhullError

    try:
        hull = ConvexHull(points)
    except QhullError:
        return Triangles(points, np.zeros((0, 3), dtype=np.int64))
    kept = np.unique(hull.simplices)
    faces = np.searchsorted(kept, hull.simplices).astype(np.int64)
    corners = points[kept]
    one, two, three = (corners[faces[:, i]] for i in range(3))
    inward = np.einsum("ij,ij->i", np.cross(two - one, three - one), hull.equations[:, :3]) < 0
    faces[inward] = faces[inward][:, ::-1]
    return Triangles(corners, faces)


def _arc(radius: float, side: int, height: float) -> list[tuple[float, float]]:
    """A quarter circle about (0, height) as (r, z), ending (-1) or beginning (1) at the equator."""
    angles = np.linspace(0.0, np.pi / 2, ALONG + 1)
    found = [(radius * np.cos(a), height + side * radius * np.sin(a)) for a in angles]
    found[-1] = (0.0, height + side * radius)
    return [(float(r), float(z)) for r, z in found][::side]


def _turned(profile: list[tuple[float, float]]) -> Triangles:
    """The surface of revolution of a profile (r, z) about z, which runs upwards."""
    angles = 2 * np.pi * np.arange(AROUND) / AROUND
    circle = np.stack([np.cos(angles), np.sin(angles)], axis=1)
    inner = profile[1:-1]
    rings = [np.column_stack([r * circle, np.full(AROUND, z)]) for r, z in inner]
    poles = np.array([(0.0, 0.0, profile[0][1]), (0.0, 0.0, profile[-1][1])])
    low, high = AROUND * len(inner), AROUND * len(inner) + 1
    here, there = np.arange(AROUND), (np.arange(AROUND) + 1) % AROUND
    top = AROUND * (len(inner) - 1)
    faces = [np.column_stack([np.full(AROUND, low), there, here])]
    for ring in range(len(inner) - 1):
        a, b = AROUND * ring + here, AROUND * ring + there
        faces += [np.column_stack([a, b, b + AROUND]), np.column_stack([a, b + AROUND, a + AROUND])]
    faces.append(np.column_stack([np.full(AROUND, high), top + here, top + there]))
    return Triangles(np.concatenate([*rings, poles]), np.concatenate(faces).astype(np.int64))
