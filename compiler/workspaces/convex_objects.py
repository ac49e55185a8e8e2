"""Whether an object of triangles is convex: closed, and as large as its convex hull.

In floats: the answer is a warning's, nothing is proved with it.  Corners of files are rounded, so
that no plane holds four of them exactly; what is off by as little as that counts as flat.
"""

from __future__ import annotations

from collections import Counter
from functools import lru_cache

from grammar_lang.ir import Scene, SceneObject

TOLERANCE = 1e-6
"""Of the size of an object, by so much its surface may be off."""


@lru_cache(maxsize=8)
def hollow_objects(scene: Scene) -> int:
    """How many objects of a mesh are not convex; the corners of none lie in one plane."""
    return sum(not is_convex(each) for each in scene.objects)


def is_convex(found: SceneObject) -> bool:
    """Whether an object, the corners of which lie in no plane, bounds its own convex hull.

    The pyramids from a point within to its triangles fill the hull exactly then; they fill less
    where it has a hollow that they see, and more where one hides another.
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
    except QhullError:  # as good as flat: what is filled is nothing
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
