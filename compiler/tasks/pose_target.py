"""The demands of a pose on the axes of an effector's frame, in floats or in balls.

The cosine of the angle between an axis e and a direction t, both of length one, is t . e. The
rotation from axes t1, t2, t3 to e1, e2, e3 has an angle of cosine (t1 . e1 + t2 . e2 + t3 . e3 - 1)
/ 2, as the trace of its matrix is 1 + 2 cos; in the plane one axis determines the angle.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Generic, TypeVar

from flint import arb

from compiler.expressions.evaluators.balls import ball, closed_ball
from grammar_lang import ir
from grammar_lang.ir.constants import to_float

Number = TypeVar("Number", float, arb)


@dataclass(frozen=True, slots=True)
class Arithmetic(Generic[Number]):
    """The operations that make numbers."""

    rational: Callable[[Fraction], Number]
    closed: Callable[[ir.Expr], Number]
    cosine: Callable[[Number], Number]
    sine: Callable[[Number], Number]
    root: Callable[[Number], Number]


FLOATS: Arithmetic[float] = Arithmetic(float, to_float, math.cos, math.sin, math.sqrt)
BALLS: Arithmetic[arb] = Arithmetic(ball, closed_ball, arb.cos, arb.sin, arb.sqrt)


@dataclass(frozen=True, slots=True)
class PoseTarget(Generic[Number]):
    """The directions, each (d,), towards which some ``axes`` (from 0) of a frame must point.

    The angle between them is at most ``within``, in rad.
    """

    axes: tuple[int, ...]
    directions: tuple[tuple[Number, ...], ...]
    within: Number

    def cosine(self, along: Number) -> Number:
        """The cosine of the angle, from the sum of the products t . e."""
        return along if len(self.axes) == 1 else (along - 1) / 2

    def along(self, cosine: Number) -> Number:
        """The sum of the products t . e, from the cosine of the angle."""
        return cosine if len(self.axes) == 1 else 1 + 2 * cosine


def pose_target(pose: ir.Pose, dimension: int, numbers: Arithmetic[Number]) -> PoseTarget[Number]:
    """The target of a pose, with directions (d,), in the plane (2) or in space (3)."""
    within = numbers.closed(pose.within)
    if isinstance(pose, ir.Aligned):
        # The direction has any length, and the square of its length may not fit a double.
        largest = max(map(abs, pose.direction))
        direction = [a / largest for a in pose.direction]
        size = numbers.root(numbers.rational(sum((a * a for a in direction), Fraction(0))))
        sign = -1 if pose.axis.startswith("-") else 1
        along = tuple(numbers.rational(sign * a) / size for a in direction)
        return PoseTarget(("xyz".index(pose.axis[-1]),), (along,), within)
    columns = _columns(pose.turns, numbers)
    axes = (0,) if dimension == 2 else (0, 1, 2)
    return PoseTarget(axes, tuple(tuple(columns[i][:dimension]) for i in axes), within)


def _columns(
    turns: Sequence[tuple[ir.Axis, ir.Expr]], numbers: Arithmetic[Number]
) -> list[list[Number]]:
    """The axes of a frame, (3, 3), after successive rotations about its own axes."""
    axes = [[numbers.rational(Fraction(int(i == j))) for j in range(3)] for i in range(3)]
    for axis, expr in turns:
        angle = numbers.closed(expr)
        cos, sin = numbers.cosine(angle), numbers.sine(angle)
        if axis.startswith("-"):
            sin = -sin
        about = "xyz".index(axis[-1])
        i, j = (about + 1) % 3, (about + 2) % 3
        one, two = axes[i], axes[j]
        axes[i] = [cos * a + sin * b for a, b in zip(one, two, strict=True)]
        axes[j] = [cos * b - sin * a for a, b in zip(one, two, strict=True)]
    return axes
