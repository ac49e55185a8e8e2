"""Where the bodies of a planar robot are, by products of frames, and their distances by GEOS."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from math import acos, atan2, cos, hypot, sin

import numpy as np
import shapely

from compiler.arrays import Array
from compiler.robots.robot import RobotModel, RodBody, SolidBody
from compiler.workspaces.polytope import Polytope, polytope_of
from tests.oracles.arms import frames_of, scalar_values
from tests.oracles.planes import hull

Points = list[tuple[float, float]]


def bodies_of(model: RobotModel, q: Array, theta: Array) -> list[Points]:
    """Per body its ends (a rod) or its one point."""
    values, poses, found = scalar_values(model, theta), frames_of(model, q, theta), []
    for body in model.bodies:
        turn, origin = poses[body.frame]
        ends = [origin]
        if isinstance(body, RodBody):
            ends.append(origin + turn[:, body.axis] * body.sign * values[body.length])
        if isinstance(body, SolidBody):
            ends = [origin + turn @ np.array([values[i] for i in body.com])]
        found.append([(float(p[0]), float(p[1])) for p in ends])
    return found


def depth(bodies: Sequence[Points], corners: Sequence[Sequence[Fraction | float]]) -> float:
    """The least distance from a polygon where positive, else minus how deep a body is inside.

    The depth is the greatest distance to the boundary over points of the bodies, to a millimetre.
    """
    polygon = shapely.Polygon([[float(x) for x in corner] for corner in corners]).convex_hull
    shapes = [shapely.LineString([*points, points[-1]]) for points in bodies]
    gap = min(shape.distance(polygon) for shape in shapes)
    if gap > 0:
        return gap
    inside = [shape.intersection(polygon) for shape in shapes]
    dense = [shapely.segmentize(part, 1e-3) for part in inside if not part.is_empty]
    points = [shapely.Point(p) for part in dense for p in shapely.get_coordinates(part)]
    return -max(point.distance(polygon.exterior) for point in points)


def random_polygon(rng: np.random.Generator, centre: Sequence[float], size: float) -> Polytope:
    """A tilted convex polygon with corners on a grid of a hundredth, three or more."""
    while True:
        count = int(rng.integers(3, 7))
        angles, radii = rng.uniform(0, 2 * np.pi, count), rng.uniform(0.4, 1, count) * size
        corners = np.stack([np.cos(angles), np.sin(angles)], axis=1) * radii[:, None] + centre
        exact = [[Fraction(round(100 * x), 100) for x in corner] for corner in corners]
        found = polytope_of(hull("O", "obstacle", *exact).shape, 2)
        if found.has_interior:
            return found


def two_link_poses(a: float, b: float, x: float, y: float) -> list[tuple[float, float]]:
    """Both poses of two links that bring the tip to a point (law of cosines)."""
    distance = hypot(x, y)
    if not abs(a - b) < distance < a + b:
        return []
    elbow = acos((distance**2 - a**2 - b**2) / (2 * a * b))
    return [(atan2(y, x) - atan2(b * sin(e), a + b * cos(e)), e) for e in (elbow, -elbow)]
