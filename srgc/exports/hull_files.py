"""Write the collision hulls of a robot's links as STL files next to its URDF."""

from __future__ import annotations

import struct

import numpy as np

from srgc.exports.exported_robot import ExportedRobot

UNSAID = "URDF needs a file for each hull; name a file with -o, and they stand beside it"
_HEADER, _TRIANGLE = struct.Struct("<80sI"), struct.Struct("<12fH")


def hull_files(robot: ExportedRobot) -> dict[tuple[float, ...], bytes]:
    """Map the corners (x, y, z, x, …) of each distinct hull to its STL file, in order of links.

    Lengths are in metres, in single precision, as in binary STL.  Flat hulls are omitted.
    """
    shapes = (g for link in robot.tree.links for g in (*link.looks, *link.collisions))
    corners = dict.fromkeys(shape.size for shape in shapes if shape.kind == "hull")
    found = {size: _triangles(size) for size in corners}
    return {size: content for size, content in found.items() if content is not None}


def _triangles(size: tuple[float, ...]) -> bytes | None:
    """The boundary of a hull, with triangles counter-clockwise from outside; None if it is flat."""
    # SciPy is only loaded for robots with hulls.
    from scipy.spatial import ConvexHull, QhullError

    points = np.array(size).reshape(-1, 3)
    try:
        hull = ConvexHull(points)
    except QhullError:
        return None
    parts = [_HEADER.pack(b"", len(hull.simplices))]
    for corners, plane in zip(hull.simplices, hull.equations, strict=True):
        one, two, three = points[corners]
        normal = plane[:3]
        if np.cross(two - one, three - one) @ normal < 0:
            two, three = three, two
        parts.append(_TRIANGLE.pack(*normal, *one, *two, *three, 0))
    return b"".join(parts)
