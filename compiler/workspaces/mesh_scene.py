"""The objects of a mesh as convex polytopes in the workspace, each of which contains its object.

An object with few corners is represented by their hull.  For more corners, planes in fixed
directions of the file's axes touch and enclose the object, as for bodies.  A rotation that is not
rational is slightly off.  The piece is then enlarged about its middle until it contains every
corner wherever it may be; it keeps its numbers of facets and corners.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from math import isqrt, lcm

from compiler.workspaces.closed_frame import RationalFrame, rational_frame
from compiler.workspaces.enclosing_planes import FEW, enclosing_rows
from compiler.workspaces.hull import Point, Vertex, counter_clockwise, hull_rows, integer_row
from compiler.workspaces.map_header import MapFault
from compiler.workspaces.pieces import Pieces
from compiler.workspaces.polytope import Description, Polytope, rank
from grammar_lang.diagnostics.diagnostic import Code
from grammar_lang.diagnostics.wording import counted
from grammar_lang.ir import HalfSpace, Scene, SceneObject

FARTHEST = Fraction(1, 10**6)
"""The most metres by which pieces may grow; they would grow more if a frame is far away."""
_GRID = 2**64


def scene_pieces(scene: Scene) -> Pieces:
    """The pieces of a mesh, one for each object, in their order.

    Raises:
        MapFault: an object has no interior, or the frame is too far away to be rounded.
    """
    try:
        frame = rational_frame(scene.frame)
    except ArithmeticError:
        raise _too_far() from None
    found: list[Polytope] = []
    inflation, many = Fraction(0), 0
    for each in scene.objects:
        points = _points(each, scene.dimension)
        many += len(points) > FEW
        piece, grown = _placed(_local(points, scene.dimension), points, scene, frame)
        found.append(piece)
        inflation = max(inflation, grown)
    if inflation > FARTHEST:
        raise _too_far()
    return Pieces((), _origin(scene, many), inflation, polytopes=tuple(found))


def _too_far() -> MapFault:
    message = "the frame of this mesh is too far away, or its numbers are too large"
    return MapFault(message, "put it near the origin of the workspace", None, Code.BAD_VALUE)


def _origin(scene: Scene, many: int) -> str:
    triangles = counted(sum(len(each.faces) for each in scene.objects), "triangle")
    if not many:
        return triangles
    planes = 26 if scene.dimension == 3 else 16
    return f"{triangles} ({many:,} of more than {FEW} corners by {planes} planes)"


def _points(each: SceneObject, dimension: int) -> Sequence[Point]:
    """The distinct corners of an object; in the plane, those of the hull of its projection."""
    corners = {corner[:dimension] for corner in each.corners}
    if rank(_ray(corner) for corner in corners) <= dimension:
        where = "one plane" if dimension == 3 else "one line, seen along z"
        message = f"object {each.label} of this mesh has no interior: its corners lie in {where}"
        hint = "a flat piece has no interior: give it a thickness, or leave it out"
        raise MapFault(message, hint, None, Code.FLAT_POLYTOPE)
    return counter_clockwise(corners) if dimension == 2 else sorted(corners)


def _local(points: Sequence[Point], dimension: int) -> Polytope:
    """A polytope that contains an object, in the axes and the unit of the file."""
    if len(points) <= FEW:
        return Polytope(hull_rows(points))
    return Polytope(enclosing_rows(points, dimension)).irredundant()


# --- In the workspace -----------------------------------------------------------------------------


def _placed(
    local: Polytope, points: Sequence[Point], scene: Scene, frame: RationalFrame
) -> tuple[Polytope, Fraction]:
    """A piece in the workspace, and the most (m) by which it grew.

    A corner p is less than ``off`` from its exact place.  The ball of that radius about the middle
    c lies in ``c + s (K - c)`` for s = off / (least distance of c from a facet).  So K and all
    points nearer to it than ``off`` lie in ``c + (1 + s) (K - c)``.
    """
    size, scale = scene.dimension, scene.scale
    farthest = max(_dot(point, point) for point in points)
    off = frame.turned * scale * _root_above(farthest) + frame.moved
    corners = [_image(vertex.point(), scale, frame) for vertex in local.description.vertices]
    normals = [_turned(row.normal, frame)[:size] for row in local.rows]
    offsets = [
        scale * row.offset + _dot(normal, frame.shift[:size])
        for row, normal in zip(local.rows, normals, strict=True)
    ]
    middle = tuple(sum(column, Fraction(0)) / len(corners) for column in zip(*corners, strict=True))
    part = _part(off, middle, normals, offsets) if off else Fraction(0)
    grown = [
        tuple(x + part * (x - c) for x, c in zip(corner, middle, strict=True)) for corner in corners
    ]
    rows = tuple(
        _primitive(normal, offset + part * (offset - _dot(normal, middle)))
        for normal, offset in zip(normals, offsets, strict=True)
    )
    vertices = tuple(
        Vertex(_ray(corner), vertex.tight)
        for corner, vertex in zip(grown, local.description.vertices, strict=True)
    )
    reach = max(
        _dot(away, away)
        for away in (
            tuple(x - c for x, c in zip(corner, middle, strict=True)) for corner in corners
        )
    )
    moved = off + part * _root_above(reach) if off else Fraction(0)
    return Polytope(rows, Description(vertices, bounded=True)), moved


def _image(point: Point, scale: Fraction, frame: RationalFrame) -> Point:
    size = len(point)
    padded = (*(scale * x for x in point), *(Fraction(0),) * (3 - size))
    return frame.apply(padded)[:size]


def _turned(normal: Point, frame: RationalFrame) -> Point:
    return frame.direction((*normal, *(Fraction(0),) * (3 - len(normal))))


def _part(
    off: Fraction, middle: Point, normals: Sequence[Point], offsets: Sequence[Fraction]
) -> Fraction:
    """The fraction of itself by which a piece grows about its middle, rounded up."""
    nearest = min(
        (offset - _dot(normal, middle)) / _root_above(_dot(normal, normal))
        for normal, offset in zip(normals, offsets, strict=True)
    )
    part = off / nearest
    return Fraction(-(-part.numerator * _GRID // part.denominator), _GRID)


def _primitive(normal: Point, offset: Fraction) -> HalfSpace:
    *entries, last = integer_row(normal, offset)
    return HalfSpace(tuple(map(Fraction, entries)), Fraction(-last))


def _ray(point: Point) -> tuple[int, ...]:
    weight = lcm(*(x.denominator for x in point))
    return (*(x.numerator * (weight // x.denominator) for x in point), weight)


def _dot(one: Sequence[Fraction], other: Sequence[Fraction]) -> Fraction:
    return sum((a * b for a, b in zip(one, other, strict=True)), Fraction(0))


def _root_above(square: Fraction) -> Fraction:
    """A rational slightly larger than the root of a number."""
    p, q = square.numerator, square.denominator
    return Fraction(isqrt(p * q * _GRID * _GRID) + 1, q * _GRID)
