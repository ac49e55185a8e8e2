"""Poses, the orientation of an effector's frame: ``aligned`` and ``oriented``."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from math import pi
from typing import Literal

from grammar_lang import ir
from grammar_lang import syntax as s
from grammar_lang.diagnostics.diagnostic import Code, Sink
from grammar_lang.elaboration.closed import ClosedScope, Constants, coordinates, list_unit
from grammar_lang.elaboration.sorts import Sort, wrong_sort
from grammar_lang.elaboration.typecheck import Checker
from grammar_lang.ir.constants import is_closed, to_float
from grammar_lang.syntax import formulas as f
from grammar_lang.units import ONE

HALF_TURN = pi * (1 - 1e-9)


def lower_poses(
    poses: Sequence[f.Pose], dimension: Literal[2, 3], sink: Sink
) -> tuple[ir.Pose, ...]:
    """The poses for a workspace of that dimension; wrong ones are reported and left out."""
    reader = _Reader(dimension, sink)
    found = (reader.pose(pose) for pose in poses)
    return tuple(pose for pose in found if pose is not None)


class _Reader:
    def __init__(self, dimension: Literal[2, 3], sink: Sink) -> None:
        self.dimension = dimension
        self.sink = sink
        self.constants = Constants(sink)

    def pose(self, pose: f.Pose) -> ir.Pose | None:
        """The meaning of a pose; None if an error was reported."""
        match pose:
            case f.Aligned():
                return self._aligned(pose)
            case f.Oriented():
                return self._oriented(pose)

    def _aligned(self, pose: f.Aligned) -> ir.Pose | None:
        within = self._angle(pose.within)
        axis: ir.Axis = pose.axis  # type: ignore[assignment]
        if self.dimension == 2 and axis in ("z", "-z"):
            message = f"the axis {axis} is perpendicular to the plane"
            self.sink.error(Code.OUT_OF_PLANE, message, pose.span, "write x, y, -x or -y")
            return None
        unit = list_unit(pose.unit, ONE, self.sink)
        direction = coordinates(
            self.constants, pose.direction, unit, ONE, self.dimension, pose.span
        )
        if direction is not None and not any(direction):
            message = "a direction is not zero"
            down = "(0, -1)" if self.dimension == 2 else "(0, 0, -1)"
            hint = f"write the direction that the axis is to point along, as `{down}`"
            self.sink.error(Code.BAD_VALUE, message, pose.span, hint)
            return None
        if within is None or direction is None:
            return None
        return ir.Aligned(axis, direction, within, pose.span)

    def _oriented(self, pose: f.Oriented) -> ir.Pose | None:
        within, before = self._angle(pose.within), len(self.sink.found)
        scope = ClosedScope()
        value = Checker(scope, self.sink).elaborate(pose.frame)
        if value.sort is not Sort.FRAME:
            wrong_sort(value, "a frame", pose.frame.span, self.sink)
            return None
        for use in scope.uses:
            if use.only != self.dimension:
                hint = "in the plane rotations are about z only"
                self.sink.error(Code.OUT_OF_PLANE, use.message, use.span, hint)
        turns = tuple(_turns(value.expr))
        if any(turn is None for turn in turns):
            message = "a pose consists of rotations, without moves"
            hint = "write a product of `rot(axis, angle)`; the region says where it is"
            self.sink.error(Code.BAD_VALUE, message, pose.frame.span, hint)
        elif not all(turn is None or is_closed(turn[1]) for turn in turns):
            hint = "a constant is made of numbers, units and `pi`"
            self.sink.error(Code.NOT_CONSTANT, "this is not a constant", pose.frame.span, hint)
        if within is None or Sink(self.sink.found[before:]).has_errors:
            return None
        return ir.Oriented(tuple(turn for turn in turns if turn is not None), within, pose.span)

    def _angle(self, expr: s.Expr) -> ir.Expr | None:
        """An angle above zero and below a half turn; None if an error was reported."""
        value = self.constants.scalar(expr, ONE, angle=True)
        if value is None:
            return None
        if not 0 < to_float(value) < HALF_TURN:
            message = "the angle is not between zero and a half turn"
            hint = "write the allowed deviation, such as `5 deg`"
            self.sink.error(Code.BAD_VALUE, message, expr.span, hint)
            return None
        return value


def _turns(frame: ir.Expr) -> Iterator[tuple[ir.Axis, ir.Expr] | None]:
    """The rotations of a frame from the world outwards; None for each other step."""
    match frame:
        case ir.Compose(left=left, right=right):
            yield from _turns(left)
            yield from _turns(right)
        case ir.Rot(axis=axis, angle=angle):
            yield axis, angle
        case ir.World():
            pass
        case _:
            yield None
