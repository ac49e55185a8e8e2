"""Whether an object of triangles is convex: closed, and as large as its convex hull.

Computed in floats: the answer is only used for a warning, and nothing is proved with it.  Corners
in files are rounded, so four of them are hardly ever exactly in a plane; small deviations count as
flat.
"""

from __future__ import annotations

from collections import Counter
from functools import lru_cache

from grammar_lang.ir import Scene, SceneObject

TOLERANCE = 1e-6
"""The tolerance for the surface of an object, relative to its size."""


@lru_cache(maxsize=8)
def hollow_objects(scene: Scene) -> int:
    """The number of objects of a mesh that are not convex; none of them may be flat."""
    return sum(not is_convex(each) for each in scene.objects)


def is_convex(found: SceneObject) -> bool:
    """Whether an object, whose corners are not all in one plane, bounds its own convex hull.

    If so, the pyramids from an inner point to its triangles fill the hull exactly.  They fill less
    if there is a hollow that the point sees, and more if one triangle hides another.
    """
    if not _is_closed(found):
        return False
    import numpy as np
    from scipy.spatial import ConvexHull, QhullError

    corners = np.array([[float(x) for x in corner] for corner in found.corners])
    corners -= corners.mean(axis=0)
    size = float(abs(corners).max())
    corners /= size
    try:
        hull = ConvexHull(corners)
    except QhullError:  # nearly flat: there is no volume to fill
        return True
    first, second, third = (corners[np.array(found.faces)[:, place]] for place in range(3))
    pyramids = np.einsum("ij,ij->i", first, np.cross(second, third)) / 6
    return bool(abs(abs(pyramids).sum() - hull.volume) <= TOLERANCE * hull.area)


def _is_closed(found: SceneObject) -> bool:
    """Whether every edge belongs to an even number of triangles."""
    edges = Counter(
        (min(ends), max(ends))
        for a, b, c in found.faces
        for ends in ((a, b), (b, c), (c, a))
        if ends[0] != ends[1]
    )
    return all(count % 2 == 0 for count in edges.values())
