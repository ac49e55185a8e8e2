"""Meshes that are not convex, by a seed: unions and differences of boxes, cylinders and balls.

``open_mesh`` leaves some triangles out, ``inverted`` turns all.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Vertices = NDArray[np.float64]
Triangles = NDArray[np.int64]


def random_mesh(seed: int) -> tuple[Vertices, Triangles]:
    """A closed mesh of one or several solids, of about 0.3 m."""
    from manifold3d import Manifold

    rng = np.random.default_rng(seed)
    solid = _primitive(rng)
    for _ in range(int(rng.integers(2, 6))):
        other = _primitive(rng)
        solid = solid + other if rng.random() < 0.6 else solid - other
    if solid.is_empty():
        solid = Manifold.cube((0.2, 0.1, 0.1))
    mesh = solid.to_mesh64()
    vertices = np.asarray(mesh.vert_properties, dtype=np.float64)[:, :3]
    return vertices, np.asarray(mesh.tri_verts, dtype=np.int64)


def open_mesh(seed: int) -> tuple[Vertices, Triangles]:
    """The same without a fifth of the triangles."""
    vertices, triangles = random_mesh(seed)
    rng = np.random.default_rng([seed, 1])
    return vertices, triangles[rng.random(len(triangles)) < 0.8]


def bumpy_ball(triangles: int, seed: int = 0) -> tuple[Vertices, Triangles]:
    """A ball with dents, of at least so many triangles, and not many more."""
    import trimesh

    steps = int(np.ceil(np.sqrt(triangles / 4))) + 1
    ball = trimesh.creation.uv_sphere(count=[steps, steps])
    directions = ball.vertices / np.linalg.norm(ball.vertices, axis=1)[:, None]
    rng = np.random.default_rng(seed)
    waves = rng.normal(scale=6.0, size=(4, 3))
    radius = 0.15 * (1 + 0.08 * np.sin(directions @ waves.T + rng.normal(size=4)).sum(axis=1))
    return directions * radius[:, None], np.asarray(ball.faces, dtype=np.int64)


def _primitive(rng: np.random.Generator):
    from manifold3d import Manifold

    sizes = rng.uniform(0.03, 0.25, size=3)
    kind = rng.integers(3)
    if kind == 0:
        solid = Manifold.cube(sizes.tolist(), center=True)
    elif kind == 1:
        solid = Manifold.cylinder(sizes[0] * 1.5, sizes[1] / 2, circular_segments=32, center=True)
    else:
        solid = Manifold.sphere(sizes[0] / 2, circular_segments=24)
    turned = solid.rotate(rng.uniform(0, 360, size=3).tolist())
    return turned.translate(rng.uniform(-0.08, 0.08, size=3).tolist())
