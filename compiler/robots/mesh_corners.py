"""The corners of a convex body that contains a mesh: a link with a hull collides as this body.

For a mesh of few vertices it is their hull. A mesh of more vertices is enclosed by its tangent
planes normal to fixed directions. The resulting polytope has few corners, and is larger than the
hull where the mesh is round.
"""

from __future__ import annotations

from fractions import Fraction
from functools import lru_cache
from typing import TypeAlias

from compiler.workspaces.enclosing_planes import FEW, enclosing_rows
from compiler.workspaces.polytope import Polytope
from grammar_lang.ir import Mesh

Point: TypeAlias = tuple[Fraction, ...]


@lru_cache(maxsize=64)
def mesh_corners(mesh: Mesh, scale: Fraction, dimension: int) -> tuple[Point, ...]:
    """The corners (c, 3) of a body that contains a mesh, in metres; in the plane of its shadow."""
    points = sorted({vertex[:dimension] for vertex in mesh.vertices})
    if len(points) > FEW:
        points = sorted(Polytope(enclosing_rows(points, dimension)).vertices)
    rest = (Fraction(0),) * (3 - dimension)
    return tuple((*(scale * x for x in point), *rest) for point in points)
