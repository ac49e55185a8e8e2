"""Triangulate polygons in the plane."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from srgc.imports.meshes.mesh import Floats, Ints
from srgc.imports.scenes.scene import Fault


def triangulated(points: Sequence[Sequence[float]], fault: Fault) -> tuple[Floats, Ints]:
    """The corners (n, 2) of a simple polygon, and a triangulation of it (m, 3).

    Raises:
        SourceFault: the polygon has fewer than three corners, or no area.
    """
    from manifold3d import triangulate

    ring = [tuple(point) for point in points]
    if len(ring) > 1 and ring[0] == ring[-1]:
        ring.pop()
    corners = np.array(ring, dtype=np.float64).reshape(-1, 2)
    following = np.roll(corners, -1, axis=0)
    area = float((corners[:, 0] * following[:, 1] - corners[:, 1] * following[:, 0]).sum()) / 2
    if len(corners) < 3 or area == 0:
        raise fault("its polyline encloses nothing")
    if area < 0:
        corners = corners[::-1].copy()
    triangles = np.asarray(triangulate([corners]), dtype=np.int64)
    return corners, triangles
