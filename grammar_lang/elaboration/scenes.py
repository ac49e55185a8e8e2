"""The position of an obstacle file in the workspace: its unit, and the frame of a mesh."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import Literal

from grammar_lang import ir
from grammar_lang import syntax as s
from grammar_lang.diagnostics.diagnostic import Code, Sink
from grammar_lang.elaboration.closed import ClosedScope, list_unit, not_rational
from grammar_lang.elaboration.sorts import require_frame
from grammar_lang.elaboration.typecheck import Checker
from grammar_lang.ir.constants import is_closed
from grammar_lang.ir.expressions import too_large
from grammar_lang.syntax import tasks as t
from grammar_lang.units import LENGTH


def placed(
    item: t.ObstaclesFrom, size: Literal[2, 3], found: ir.ObstacleMap, sink: Sink
) -> ir.ObstacleMap | None:
    """The obstacles, positioned as the clause says; None if an error was reported.

    Args:
        item: the clause.
        size: the dimension of the workspace.
        found: the contents of its file.
        sink: collects the errors.
    """
    if found.scene is None:
        return found if _lies_itself(item, size, sink) else None
    before = len(sink.found)
    unit = list_unit(item.unit, LENGTH, sink).unit
    if item.unit is not None and unit is not None and unit.pi_power:
        not_rational(item.unit.span, sink)
    frame = ir.World() if item.frame is None else _frame(item.frame, size, sink)
    if Sink(sink.found[before:]).has_errors:
        return None
    scene = replace(found.scene, frame=frame, dimension=size)
    if unit is not None:
        scene = replace(scene, scale=unit.factor)
    return replace(found, scene=scene)


def _lies_itself(item: t.ObstaclesFrom, size: Literal[2, 3], sink: Sink) -> bool:
    """Whether a map or GeoJSON file is in the plane and without unit and frame; reported if not."""
    if size == 3:
        message = "a map of obstacles lies in the plane, this workspace in space"
        hint = "say `plane xy`, or write the obstacles as a mesh, boxes, polytopes or hulls"
        sink.error(Code.OUT_OF_PLANE, message, item.span, hint)
        return False
    extra = item.unit.span if item.unit is not None else None
    if item.frame is not None:
        extra = item.frame.span if extra is None else extra.to(item.frame.span)
    if extra is None:
        return True
    message = "a map states its own position, in metres; only meshes take a unit and a frame"
    sink.error(Code.BAD_VALUE, message, extra, "remove this, or change the map")
    return False


def _frame(expr: s.Expr, size: Literal[2, 3], sink: Sink) -> ir.Expr:
    """A closed frame, which in the plane must not leave it."""
    scope = ClosedScope()
    frame = require_frame(Checker(scope, sink).elaborate(expr), expr.span, sink)
    for use in scope.uses:
        if use.only != size:
            hint = "in the plane a mesh is turned about z and moved along x and y"
            sink.error(Code.OUT_OF_PLANE, use.message, use.span, hint)
    if too_large(frame):
        hint = "write fewer turns and moves"
        sink.error(Code.TOO_DEEP, "this expression is too large", expr.span, hint)
    elif not all(map(is_closed, _amounts(frame))):
        hint = "a constant is made of numbers, units and `pi`"
        sink.error(Code.NOT_CONSTANT, "this is not a constant", expr.span, hint)
    return frame


def _amounts(frame: ir.Expr) -> Iterator[ir.Expr]:
    """The angles and lengths in a frame."""
    for step in ir.factors(frame):
        match step:
            case ir.Rot(angle=amount) | ir.Move(distance=amount):
                yield amount
            case ir.Shift(vector=ir.Vector(x=x, y=y, z=z)):
                yield from (x, y, z)
            case _:
                pass
