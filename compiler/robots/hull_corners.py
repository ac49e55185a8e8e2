"""The corners of a link's hull, exactly, relative to its middle.

In a robot's graph a hull is given by its middle and the directions of the axes of its frame. Its
corners are sums of these with constant weights.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from typing import TypeAlias

from compiler.expressions.scalars import Constant, ScalarNode
from compiler.robots.robot import Shape

Place: TypeAlias = tuple[Fraction, Fraction, Fraction]
"""A point in the frame of a hull, in metres."""


def hull_middle(shape: Shape, scalars: Sequence[ScalarNode]) -> Place:
    """The middle of the hull's bounding box along the axes of its frame.

    ``scalars`` are the scalars of the robot.

    Raises:
        ValueError: a corner is not a number.
    """
    x, y, z = ((min(axis) + max(axis)) / 2 for axis in zip(*_corners(shape, scalars), strict=True))
    return x, y, z


def corners_from_middle(shape: Shape, scalars: Sequence[ScalarNode]) -> tuple[Place, ...]:
    """The vectors from the middle of a hull to each of its corners, along the axes of its frame.

    Raises:
        ValueError: a corner is not a number.
    """
    a, b, c = hull_middle(shape, scalars)
    return tuple((x - a, y - b, z - c) for x, y, z in _corners(shape, scalars))


def _corners(shape: Shape, scalars: Sequence[ScalarNode]) -> list[Place]:
    return [
        (_number(scalars[x]), _number(scalars[y]), _number(scalars[z])) for x, y, z in shape.corners
    ]


def _number(scalar: ScalarNode) -> Fraction:
    if not isinstance(scalar, Constant):
        raise ValueError("a corner of a hull is not a number")  # noqa: TRY004
    return scalar.value
