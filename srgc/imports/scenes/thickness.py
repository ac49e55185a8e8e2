"""Make shapes so thick that their numbers in a spec keep an extent."""

from __future__ import annotations

from srgc.imports.meshes.enclosing import THINNEST
from srgc.imports.scenes.scene import BallShape, BoxShape, RodShape, Shape

THIN = "made thicker: it is thinner than 0.01 mm, or than a ten-thousandth of its size"
"""A note on an object whose shape, or the piece about it, was made thicker."""


def thick_enough(shape: Shape) -> tuple[Shape, bool]:
    """A shape that holds this one with no edge or diameter below ``THINNEST``; whether it differs.

    Points and meshes stay as they are: the pieces about them are made thick enough.
    """
    found: Shape
    match shape:
        case BoxShape(size=(x, y, z)):
            found = BoxShape((max(x, THINNEST), max(y, THINNEST), max(z, THINNEST)))
        case BallShape(radius=radius):
            found = BallShape(max(radius, THINNEST / 2))
        case RodShape(kind=kind, radius=radius, length=length):
            found = RodShape(kind, max(radius, THINNEST / 2), max(length, THINNEST))
        case _:
            return shape, False
    return found, found != shape
