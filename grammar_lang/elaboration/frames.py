"""Frames: ``rot(axis, angle)``, ``move(axis, distance)`` and ``move((x, y, z))``.

A degree of freedom is the whole argument of one of them, about or along its declared axis.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Literal, TypeAlias

from grammar_lang import ir
from grammar_lang import syntax as s
from grammar_lang.diagnostics.diagnostic import Code, Sink
from grammar_lang.elaboration.sorts import (
    UNKNOWN,
    DimensionUse,
    Scope,
    Sort,
    Typed,
    require_scalar,
    require_vector,
    warn_implausible,
    warn_implausible_vector,
    warn_turn,
)
from grammar_lang.source import Span
from grammar_lang.syntax.expressions import readings
from grammar_lang.units import LENGTH, ONE

Elaborate: TypeAlias = Callable[[s.Expr], Typed]

_NEGATED: dict[str, ir.Axis] = {"x": "-x", "y": "-y", "z": "-z"}
_KIND: dict[str, ir.DofKind] = {"rot": "revolute", "move": "prismatic"}
_PLACE: dict[ir.DofKind, str] = {"revolute": "rot", "prismatic": "move"}


def axis_of(expr: s.Expr) -> ir.Axis | None:
    """The axis that an expression names, such as ``x`` or ``-z``; None if it names none."""
    match expr:
        case s.AxisName(axis=axis):
            return axis
        case s.Negate(operand=s.AxisName(axis=axis)):
            return _NEGATED[axis]
        case _:
            return None


def require_axis(expr: s.Expr, sink: Sink) -> ir.Axis:
    """The axis that an expression names; reported if it names none."""
    axis = axis_of(expr)
    if axis is None:
        sink.error(
            Code.SORT_MISMATCH, "expected an axis", expr.span, "an axis is x, y, z, -x, -y or -z"
        )
        return "x"
    return axis


def _check_dof(
    function: Literal["rot", "move"],
    axis: ir.Axis,
    dof: ir.Dof,
    at: s.Member | s.Name,
    sink: Sink,
) -> None:
    name = dof.name if isinstance(at, s.Name) else f"{at.owner.text}.{dof.name}"
    called = f"`{name}`"
    notes = [(dof.span, "declared here")]
    if dof.kind != _KIND[function]:
        place = _PLACE[dof.kind]
        message = f"{called} is {dof.kind}, it cannot stand in a `{function}`"
        hint = f"write `{place}({dof.axis}, {name})`"
        sink.error(Code.BAD_DOF_USE, message, at.span, hint, notes)
    elif dof.axis != axis:
        message = f"{called} has the axis {dof.axis}, not {axis}"
        hint = f"write `{function}({dof.axis}, {name})`"
        sink.error(Code.BAD_DOF_USE, message, at.span, hint, notes)


def report_reuse(called: str, places: Sequence[Span], instead: str, sink: Sink) -> None:
    """Report all uses of a degree of freedom but the first.

    Args:
        called: its name, as written.
        places: where it is used.
        instead: what to do with the moved frame.
        sink: collects the errors.
    """
    for place in places[1:]:
        message, hint = f"`{called}` is used more than once", f"{instead}, and use that"
        sink.error(Code.BAD_DOF_USE, message, place, hint, [(places[0], "first here")])


def _amount(
    function: Literal["rot", "move"],
    axis: ir.Axis,
    expr: s.Expr,
    elaborate: Elaborate,
    scope: Scope,
    sink: Sink,
) -> ir.Expr:
    """The angle or distance: either a degree of freedom or a scalar."""
    if isinstance(expr, s.Member | s.Name):
        dof = scope.dof(expr)
        if dof is not None:
            _check_dof(function, axis, dof, expr, sink)
            return scope.use_dof(expr)
    value = elaborate(expr)
    if function == "rot":
        warn_turn(value, expr.span, sink)
    else:
        warn_implausible(value, LENGTH, expr, None, sink)
    return require_scalar(value, ONE if function == "rot" else LENGTH, expr.span, sink)


def _in_plane(function: Literal["rot", "move"], axis: ir.Axis) -> bool:
    return (axis in {"z", "-z"}) == (function == "rot")


def _shift(expr: s.Expr, elaborate: Elaborate, scope: Scope, sink: Sink) -> Typed:
    value = elaborate(expr)
    vector = require_vector(value, LENGTH, expr.span, sink)
    warn_implausible_vector(value, LENGTH, expr, sink)
    return Typed(ir.Shift(vector, scope.mentions([expr])), Sort.FRAME, None)


def _misused(call: s.Call, scope: Scope) -> Typed:
    """UNKNOWN; its degrees of freedom count as used, so that they cause no further error."""
    for found in readings(a.value for a in call.arguments):
        if scope.dof(found) is not None:
            scope.use_dof(found)
    return UNKNOWN


def frame_call(
    function: Literal["rot", "move"],
    call: s.Call,
    elaborate: Elaborate,
    scope: Scope,
    sink: Sink,
) -> Typed:
    """The frame of a ``rot`` or ``move`` call."""
    arguments = [a.value for a in call.arguments if a.name is None]
    if len(arguments) == len(call.arguments) == 1 and function == "move":
        return _shift(arguments[0], elaborate, scope, sink)
    if len(arguments) != 2 or len(call.arguments) != 2:
        form = (
            "`rot(axis, angle)`"
            if function == "rot"
            else "`move(axis, distance)` or `move((x, y, z))`"
        )
        message = f"`{function}` does not take these arguments"
        sink.error(Code.SORT_MISMATCH, message, call.span, f"write {form}")
        return _misused(call, scope)
    last = axis_of(arguments[1])
    if last is not None and axis_of(arguments[0]) is None:
        message, hint = f"`{function}` takes the axis first", f"write `{function}({last}, …)`"
        sink.error(Code.SORT_MISMATCH, message, call.span, hint)
        return _misused(call, scope)
    axis = require_axis(arguments[0], sink)
    before = len(sink.found)
    amount = _amount(function, axis, arguments[1], elaborate, scope, sink)
    if not _in_plane(function, axis) and not Sink(sink.found[before:]).has_errors:
        what = "rotation about" if function == "rot" else "move along"
        message = f"a {what} {axis} leaves the plane"
        scope.uses.append(DimensionUse(3, arguments[0].span, message))
    step = ir.Rot if function == "rot" else ir.Move
    return Typed(step(axis, amount, scope.mentions([arguments[1]])), Sort.FRAME, None)
