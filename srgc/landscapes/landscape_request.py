"""A checked request for a landscape: one or two parameters of a robot, ranges and marks."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from compiler.arrays import Array
from compiler.robots.robot import RobotModel, RobotParameter
from grammar_lang import ir
from grammar_lang.ir.constants import to_float
from srgc.faults import Argument, UsageFault, argument

POINTS = {1: 41, 2: 11}
"""Points per axis, by the number of axes; this many take half a minute for two links."""


OVER, RANGE, MARK = argument("over"), Argument("--range", "`ranges`"), Argument("--mark", "`marks`")


@dataclass(frozen=True, slots=True)
class Mark:
    """A point to mark, given by its values on the axes."""

    values: tuple[float, ...]
    label: str


@dataclass(frozen=True, slots=True)
class LandscapeRequest:
    """A request for a landscape.

    ``over`` names one or two parameters; None for the first two that can vary.  ``ranges`` maps
    names to the lowest and highest value to look at.  ``points`` is the number of values per axis;
    None for that of ``POINTS``.
    """

    over: tuple[str, ...] | None
    ranges: Mapping[str, tuple[float, float]]
    points: int | None
    marks: tuple[Mark, ...]


@dataclass(frozen=True, slots=True)
class Axis:
    """A parameter: its index in the robot, and the values to look at, ascending, in SI units.

    ``discrete``: whether these are all values of its finite domain within the range.
    """

    place: int
    name: str
    module: str
    unit: str
    values: Array
    discrete: bool


def axes_of(model: RobotModel, request: LandscapeRequest) -> tuple[Axis, ...]:
    """The one or two axes of a landscape.

    Raises:
        UsageFault: there is no such parameter, it has only one value, or a range is not valid.
    """
    named = {p.label: i for i, p in enumerate(model.parameters)}
    wide = [name for name, i in named.items() if _is_wide(model.parameters[i].domain)]
    if not wide:
        raise UsageFault("the robot has no parameter that may vary: there is no landscape")
    chosen = tuple(wide[:2]) if request.over is None else request.over
    if not 1 <= len(set(chosen)) == len(chosen) <= 2:
        raise UsageFault(OVER, " names one parameter, or two different ones")
    ranges = request.ranges
    for name in (*chosen, *ranges):
        if name not in named:
            raise UsageFault(f"the robot has no parameter `{name}`: it has {', '.join(named)}")
        if name not in wide:
            raise UsageFault(f"the parameter `{name}` has one value only: choose another")
    unused = [name for name in ranges if name not in chosen]
    if unused:
        raise UsageFault(RANGE, f" is about `{unused[0]}`, which ", OVER, " does not name")
    points = POINTS[len(chosen)] if request.points is None else request.points
    return tuple(
        _axis(model.parameters[named[name]], named[name], ranges.get(name), points)
        for name in chosen
    )


def refuse_marks(axes: Sequence[Axis], marks: Sequence[Mark]) -> None:
    """Refuse marks that are not on the axes.

    Raises:
        UsageFault: a mark does not have one value per axis within the range of that axis.
    """
    for mark in marks:
        said = ",".join(f"{value:g}" for value in mark.values)
        if len(mark.values) != len(axes):
            due = f" {said}: {len(axes)} numbers are expected, separated by a comma"
            raise UsageFault(MARK, due)
        for axis, value in zip(axes, mark.values, strict=True):
            low, high = float(axis.values[0]), float(axis.values[-1])
            if not low <= value <= high:
                raise UsageFault(
                    MARK,
                    f" {said}: {value:g} is not within [{low:g}, {high:g}], which is looked at of "
                    f"`{axis.name}`",
                )


def _is_wide(domain: ir.Interval | ir.Choices) -> bool:
    low, high = _ends(domain)
    return low < high


def _ends(domain: ir.Interval | ir.Choices) -> tuple[float, float]:
    if isinstance(domain, ir.Interval):
        return to_float(domain.lower), to_float(domain.upper)
    values = [to_float(value) for value in domain.values]
    return min(values), max(values)


def _axis(
    parameter: RobotParameter, place: int, asked: tuple[float, float] | None, points: int
) -> Axis:
    low, high = _ends(parameter.domain)
    name = parameter.label
    first, last = (low, high) if asked is None else asked
    said = f" {name}={first:g}:{last:g}"
    if not first < last:
        raise UsageFault(RANGE, f"{said}: the lower end comes first")
    if not low <= first < last <= high:
        raise UsageFault(RANGE, f"{said} is not within [{low:g}, {high:g}]")
    if isinstance(parameter.domain, ir.Choices):
        choices = sorted({to_float(value) for value in parameter.domain.values})
        values = np.array([value for value in choices if first <= value <= last])
        if len(values) < 2:
            raise UsageFault(RANGE, f"{said} leaves fewer than two values")
    else:
        values = np.linspace(first, last, points)
    discrete = isinstance(parameter.domain, ir.Choices)
    return Axis(place, name, parameter.module, parameter.unit, values, discrete)
