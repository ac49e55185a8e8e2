"""What of a landscape is asked for: two parameters of a robot, ranges, marks; checked."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from compiler.arrays import Array
from compiler.robots.robot import RobotModel, RobotParameter
from grammar_lang import ir
from grammar_lang.ir.constants import to_float
from srgc.session import UsageFault

POINTS = {1: 41, 2: 11}
"""By the number of axes, per axis: so many evaluations of two links take half a minute."""


@dataclass(frozen=True, slots=True)
class LandscapeRequest:
    """The options as they were given; None: the default."""

    over: str | None
    ranges: tuple[str, ...]
    points: int | None
    marks: tuple[str, ...]
    labels: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class Axis:
    """A parameter: its place among those of the robot, and the values looked at, ascending, SI.

    ``discrete``: these are all values of its finite domain within the range.
    """

    place: int
    name: str
    module: str
    unit: str
    values: Array
    discrete: bool


@dataclass(frozen=True, slots=True)
class Mark:
    """A point to be marked, by its values on the axes."""

    values: tuple[float, ...]
    label: str


def axes_of(model: RobotModel, request: LandscapeRequest) -> tuple[Axis, ...]:
    """One or two axes.

    Raises:
        UsageFault: there is no such parameter, or it has one value only, or a range is none.
    """
    named = {p.label: i for i, p in enumerate(model.parameters)}
    wide = [name for name, i in named.items() if _is_wide(model.parameters[i].domain)]
    if not wide:
        raise UsageFault("the robot has no parameter that may vary: there is no landscape")
    chosen = wide[:2] if request.over is None else request.over.split(",")
    if len(chosen) > 2 or len(set(chosen)) < len(chosen):
        raise UsageFault("--over names one parameter, or two different ones")
    ranges = dict(_range(text) for text in request.ranges)
    if len(ranges) < len(request.ranges):
        raise UsageFault("--range is given twice for one parameter")
    for name in (*chosen, *ranges):
        if name not in named:
            raise UsageFault(f"the robot has no parameter `{name}`: it has {', '.join(named)}")
        if name not in wide:
            raise UsageFault(f"the parameter `{name}` has one value only: choose another")
    unused = [name for name in ranges if name not in chosen]
    if unused:
        raise UsageFault(f"--range is about `{unused[0]}`, which --over does not name")
    points = POINTS[len(chosen)] if request.points is None else request.points
    return tuple(
        _axis(model.parameters[named[name]], named[name], ranges.get(name), points)
        for name in chosen
    )


def marks_of(axes: Sequence[Axis], request: LandscapeRequest) -> tuple[Mark, ...]:
    """The points to be marked.

    Raises:
        UsageFault: a mark has not one value per axis within the values looked at, or there are
            more labels than marks.
    """
    if len(request.labels) > len(request.marks):
        raise UsageFault("there are more --label than --mark")
    found = []
    for number, text in enumerate(request.marks):
        values = tuple(_number(part) for part in text.split(","))
        if len(values) != len(axes):
            raise UsageFault(f"--mark {text}: {len(axes)} numbers are due, separated by a comma")
        for axis, value in zip(axes, values, strict=True):
            low, high = float(axis.values[0]), float(axis.values[-1])
            if not low <= value <= high:
                raise UsageFault(
                    f"--mark {text}: {value:g} is not within [{low:g}, {high:g}], which is looked "
                    f"at of `{axis.name}`"
                )
        label = request.labels[number] if number < len(request.labels) else f"({text})"
        found.append(Mark(values, label))
    return tuple(found)


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
    if not first < last:
        raise UsageFault(f"--range {name}={first:g}:{last:g}: the lower end comes first")
    if not low <= first < last <= high:
        raise UsageFault(f"--range {name}={first:g}:{last:g} is not within [{low:g}, {high:g}]")
    if isinstance(parameter.domain, ir.Choices):
        choices = sorted({to_float(value) for value in parameter.domain.values})
        values = np.array([value for value in choices if first <= value <= last])
        if len(values) < 2:
            raise UsageFault(f"--range {name}={first:g}:{last:g} leaves fewer than two values")
    else:
        values = np.linspace(first, last, points)
    discrete = isinstance(parameter.domain, ir.Choices)
    return Axis(place, name, parameter.module, parameter.unit, values, discrete)


def _range(text: str) -> tuple[str, tuple[float, float]]:
    """``NAME=LOW:HIGH``."""
    name, _, ends = text.partition("=")
    low, separator, high = ends.partition(":")
    if not separator:
        raise UsageFault(f"--range {text}: write it as in 4.length=1:2.5")
    return name, (_number(low), _number(high))


def _number(text: str) -> float:
    try:
        value = float(text)
    except ValueError:
        raise UsageFault(f"`{text}` is no number") from None
    if not math.isfinite(value):
        raise UsageFault(f"`{text}` is no number")
    return value
