"""The visual and collision geometry of a robot. Dynamics do not depend on it."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import product

import numpy as np
from flint import arb

from compiler.expressions.evaluators.balls import ball
from compiler.rigid_links.ball_pose import WORLD_POSE, Pose, column, nearest, unit
from compiler.rigid_links.mass_moments import body_moments
from compiler.robots.robot import Body, Collider, PointBody, RodBody, Shape, SolidBody
from grammar_lang import ir

SLENDERNESS = 50
"""The ratio of length to radius with which a rod without a radius is drawn."""
STEEL = 7850
"""The density in kg/m^3 of the ball that represents a point mass in drawings."""
THINNEST = Fraction(1, 1000)
"""The least thickness of a drawn box, in metres."""


@dataclass(frozen=True, slots=True)
class Geometry:
    """A set centred on ``pose``.

    ``size`` is in metres: for a cylinder or capsule the radius and the length (along z, without the
    end caps of a capsule), for a sphere the radius, for a box the three sides, for a hull the
    coordinates of its corners in ``pose``, three each.
    """

    kind: ir.ShapeKind
    pose: Pose
    size: tuple[float, ...]


def body_shape(body: Body, scalars: Sequence[arb], frame: Pose) -> list[Geometry]:
    """The visual shape of a body whose frame has this pose; empty if it has no extent.

    A solid is drawn as a box with about the same inertia.
    """
    shape = _shape(body, scalars, frame)
    return [shape] if all(size > 0 for size in shape.size) else []


def _shape(body: Body, scalars: Sequence[arb], frame: Pose) -> Geometry:
    match body:
        case RodBody(_, axis, sign, length, _, radius):
            extent = scalars[length]
            thickness = extent / SLENDERNESS if radius is None else scalars[radius]
            middle = frame.moved(unit(axis, sign) * (extent / 2))
            return Geometry("cylinder", _upright(middle, axis), _sizes(thickness, extent))
        case PointBody(_, mass):
            volume = scalars[mass] * 3 / (4 * arb.pi() * STEEL)
            return Geometry("sphere", frame, _sizes(volume.root(3)))
        case SolidBody(_, mass, com, _):
            centre = frame.moved(column([scalars[i] for i in com]))
            if not scalars[mass] > 0:
                return Geometry("box", centre, (0.0, 0.0, 0.0))
            central = body_moments(body, scalars, WORLD_POSE).central
            sides = [12 * central[i, i] / scalars[mass] for i in range(3)]
            return Geometry("box", centre, _sizes(*(_root(side) for side in sides)))


def shape_geometry(
    each: Collider, scalars: Sequence[arb], frame: Pose, flat: Fraction
) -> Geometry | None:
    """The collision geometry of a body or shape with this frame pose; None if it has no extent.

    Boxes of the plane, and flat hulls, are ``flat`` metres thick.
    """
    if isinstance(each, RodBody):
        if each.radius is None:
            return None
        kind: ir.ShapeKind = "capsule"
        sizes: tuple[arb, ...] = scalars[each.length], scalars[each.radius]
    elif isinstance(each, Shape):
        kind, sizes = each.kind, tuple(scalars[size] for size in each.sizes)
    else:
        return None
    if isinstance(each, Shape) and each.corners:
        return Geometry(kind, frame, _sizes(*_spread(each, scalars, flat)))
    if kind == "sphere":
        return Geometry(kind, frame, _sizes(*sizes))
    if kind == "box":
        return Geometry(kind, frame, _sizes(*sizes, *[ball(flat)] * (3 - len(sizes))))
    length, radius = sizes
    middle = frame.moved(unit(each.axis, each.sign) * (length / 2))
    return Geometry(kind, _upright(middle, each.axis), _sizes(radius, length))


def _spread(each: Shape, scalars: Sequence[arb], flat: Fraction) -> Iterator[arb]:
    """The coordinates of the corners of a hull, one after another."""
    corners = [tuple(scalars[i] for i in corner) for corner in each.corners]
    if all(z.is_zero() for _, _, z in corners):
        corners = [(x, y, side * ball(flat) / 2) for side in (-1, 1) for x, y, _ in corners]
    places = np.array([[float(x) for x in corner] for corner in corners])
    if np.linalg.matrix_rank(places - places[0]) < 3:
        # Other flat hulls get the corners of a small cube about each corner.
        sides = list(product((-1, 1), repeat=3))
        thick = ball(flat) / 2
        corners = [tuple(x + s * thick for x, s in zip(corner, side, strict=True))
                   for corner in corners for side in sides]  # fmt: skip
    for corner in corners:
        yield from corner


def _upright(pose: Pose, axis: int) -> Pose:
    """The pose turned so that its z axis lies along the former axis 0, 1 or 2."""
    if axis == 2:
        return pose
    quarter = arb.pi() / 2
    return pose.turned(1, quarter) if axis == 0 else pose.turned(0, -quarter)


def _root(value: arb) -> arb:
    return value.sqrt() if value > ball(THINNEST) ** 2 else ball(THINNEST)


def _sizes(*values: arb) -> tuple[float, ...]:
    return tuple(nearest(value) for value in values)
