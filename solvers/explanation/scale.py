"""The values that a line of a task may have instead of its own, the nearest first.

Each of the tasks of a scale is weaker than those before, or has less to carry.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import TypeVar

from compiler.expressions.exact_numbers import rational_bounds
from grammar_lang import ir
from grammar_lang.ir.constants import rational
from grammar_lang.ir.expression_text import number_text
from solvers.explanation.change import Change, at_most
from solvers.explanation.posed_task import PosedTask
from solvers.explanation.relaxation import (
    WIDER,
    ends,
    grown_bounds,
    is_signed,
    width,
    with_effort,
)
from solvers.explanation.task_line import TaskLine
from solvers.explanation.two_digits import index_above, index_below, number_of, rounded_up
from solvers.explanation.written_range import written_range

Carried = TypeVar("Carried", ir.Payload, ir.Carry)

MOST_STEPS = 160
"""The most steps of a longer horizon; it is also at most four times as long. A horizon near or
above this limit still becomes half as long again."""
MOST_RAISED = 64
"""The largest factor by which a bound of an effort, a rate or an acceleration is raised."""
LIGHTEST = 20
"""The largest factor by which a payload is reduced."""
MOST_LISTED = 6
"""Lists of more values are not written out."""
BOUNDS_GROWN = (1, 2, 5, 10, 20, 50, 100)
"""Percentages of their width by which bounds are moved outwards."""


@dataclass(frozen=True, slots=True)
class Scale:
    """The changes of a line by a value, the smallest change first.

    Steps further away are multiples of the distance from ``origin``; None: of the value.  A
    ``last`` one is tried only if no other scale of the line has helped.  Poses are searched for the
    task ``with_all`` values up to one, where a change with that one alone is not weaker than those
    before: a list with one more value.
    """

    line: TaskLine
    values: tuple[Fraction, ...]
    at: Callable[[Fraction], Change]
    origin: Fraction | None = None
    last: bool = False
    with_all: Callable[[Fraction], PosedTask] | None = None

    def posed_at(self, value: Fraction) -> PosedTask:
        """The task for which poses are searched: weaker than with the values before."""
        return self.at(value).posed if self.with_all is None else self.with_all(value)

    def further(self, value: Fraction, more: Fraction) -> Fraction:
        """The value nearest to one that is ``more`` times as far out as a given one."""
        if self.origin is not None:
            wanted = self.origin + (value - self.origin) * more
        else:
            wanted = value * more if self.values[0] < self.values[-1] else value / more
        return min(self.values, key=lambda each: abs(each - wanted))


def scales(posed: PosedTask, line: TaskLine) -> Iterator[Scale]:
    """The scales of a line; none if it has no value to change."""
    match line.kind:
        case "parameter":
            yield from _parameter(posed, line)
        case "joint_range":
            yield from _joint_range(posed, line)
        case "effort":
            yield _effort(posed, line)
        case "joint_effort" | "joint_accel":
            yield _joint_bound(posed, line)
        case "joint_rate":
            yield _joint_rate(posed, line)
        case "horizon":
            yield _horizon(posed, line)
        case "bounds":
            yield _bounds(posed, line)
        case "payload":
            yield _payload(posed, line)
        case "carry":
            yield _load(posed, line)
        case _:
            return


def _parameter(posed: PosedTask, line: TaskLine) -> Iterator[Scale]:
    """A range that extends further up or down, or a list with one more value above or below."""
    module, name = (str(part) for part in line.key)
    p = next(p for p in posed.program.modules[module].parameters if p.name == name)
    low, high = ends(p.domain)

    def at(value: Fraction, way: str) -> Change:
        wider = _with_value(p.domain, value)
        says = _parameter_text(f"{module}.{name}", wider, value, way, p.unit)
        return Change(line, says, posed.with_domain(module, name, wider), value, way)

    def with_all(value: Fraction) -> PosedTask:
        every = ir.Interval(ir.Num(min(low, value)), ir.Num(max(high, value)))
        return posed.with_domain(module, name, every)

    def scale(values: tuple[Fraction, ...], way: str, origin: Fraction | None = None) -> Scale:
        listed = isinstance(p.domain, ir.Choices)
        every = with_all if listed else None
        return Scale(line, values, lambda value: at(value, way), origin, with_all=every)

    if is_signed(p.domain):
        size = width(p.domain)
        up, down = _further((low, high), size, size * WIDER / 2)
        yield scale(up, "up to", high)
        yield scale(down, "down to", low)
        return
    if high > 0:
        indices = range(index_above(high), index_above(high * WIDER) + 1)
        yield scale(tuple(v for v in map(number_of, indices) if v > high), "up to")
    if low > 0:
        indices = range(index_below(low), index_below(low / WIDER) - 1, -1)
        yield scale(tuple(v for v in map(number_of, indices) if v < low), "down to")


def _parameter_text(
    called: str, wider: ir.Interval | ir.Choices, value: Fraction, way: str, unit: str
) -> str:
    """A wider range or list in words; a list as the language writes it, if it is short."""
    of, number = ("" if unit == "1" else f" {unit}"), number_text(value)
    if isinstance(wider, ir.Interval):
        return f"with `{called}` {way} {number}{of}"
    values = [rational(each) for each in wider.values]
    known = sorted(each for each in values if each is not None)
    if len(known) < len(values) or len(known) > MOST_LISTED:
        return f"with `{number}{of}` in the list of `{called}`"
    return f"with `{called}` in `{{{', '.join(map(number_text, known))}}}{of}`"


def _joint_range(posed: PosedTask, line: TaskLine) -> Iterator[Scale]:
    """The range of a joint, extended further up, down, or both ways if it is symmetric.

    That of a revolute joint grows by half of what lacks to a whole turn: so one way or the other it
    gets to every angle.
    """
    module, dof = _joint(posed, line)
    old, written = dof.range, written_range(posed, dof)
    if old is None or written is None:
        return
    low, high, unit, called = written.low, written.high, written.unit, f"{module}.{dof.name}"
    size = high - low or abs(high) or Fraction(1)

    def changed(says: str, wider: ir.Interval, value: Fraction, way: str) -> Change:
        return Change(line, says, posed.with_dof(module, dof.name, range=wider), value, way)

    def at(value: Fraction, way: str) -> Change:
        end = written.end(value)
        wider = replace(old, upper=end) if value > high else replace(old, lower=end)
        return changed(f"with `{called}` {way} {number_text(value)} {unit}", wider, value, way)

    def both(value: Fraction) -> Change:
        wider = ir.Interval(written.end(-value), written.end(value))
        number = number_text(value)
        return changed(f"with `{called}` in `[-{number}, {number}] {unit}`", wider, value, "both")

    most = (size * WIDER if written.turn is None else max(Fraction(0), written.turn - size)) / 2
    up, down = _further((low, high), size, most)
    yield Scale(line, up, lambda value: at(value, "up to"), origin=high)
    yield Scale(line, down, lambda value: at(value, "down to"), origin=low)
    if low == -high < 0:
        indices = range(index_above(high), index_above(high + most) + 1)
        values = tuple(v for v in map(number_of, indices) if high < v <= high + most)
        yield Scale(line, values, both, origin=high, last=True)


def _further(
    limits: tuple[Fraction, Fraction], size: Fraction, most: Fraction
) -> tuple[tuple[Fraction, ...], tuple[Fraction, ...]]:
    """New upper and lower ends of a range with negative values, whose ends may be 0.

    They are beyond its ``limits``, by ``most`` at most; ``size`` is its width.
    """
    low, high = limits
    indices = range(index_above(size / WIDER), index_above(most + abs(low) + abs(high)) + 1)
    grid = [number_of(index) for index in indices]
    grid = [*(-value for value in reversed(grid)), Fraction(0), *grid]
    up = tuple(value for value in grid if high < value <= high + most)
    return up, tuple(value for value in reversed(grid) if low - most <= value < low)


def _with_value(domain: ir.Interval | ir.Choices, value: Fraction) -> ir.Interval | ir.Choices:
    """A domain that also has the value: an interval is extended to it."""
    number = ir.Num(value)
    if isinstance(domain, ir.Choices):
        return ir.Choices((*domain.values, number))
    return (
        replace(domain, upper=number) if value > ends(domain)[1] else replace(domain, lower=number)
    )


def _effort(posed: PosedTask, line: TaskLine) -> Scale:
    index = int(line.key[0])
    clause = posed.task.effort[index]
    unit = "N*m" if clause.kind == "revolute" else "N"

    def at(value: Fraction) -> Change:
        changed = with_effort(posed, index, value / clause.bound)
        return Change(line, f"with `effort <= {number_text(value)} {unit}`", changed, value)

    return Scale(line, _stronger(clause.bound), at)


def _stronger(bound: Fraction) -> tuple[Fraction, ...]:
    if not bound:
        return ()
    indices = range(index_above(bound), index_above(bound * MOST_RAISED) + 1)
    return tuple(v for v in map(number_of, indices) if v > bound)


def _joint(posed: PosedTask, line: TaskLine) -> tuple[str, ir.Dof]:
    """The module and the degree of freedom that a line is about."""
    module, name = (str(part) for part in line.key)
    return module, next(d for d in posed.program.modules[module].dofs if d.name == name)


def _joint_rate(posed: PosedTask, line: TaskLine) -> Scale:
    """A faster joint: the larger end of its rates is the value, the other one keeps its share."""
    module, dof = _joint(posed, line)
    low, high = (Fraction(0),) * 2 if dof.rate is None else ends(dof.rate)
    most = max(abs(low), abs(high))
    unit = "rad/s" if dof.kind == "revolute" else "m/s"

    def raised(end: Fraction, value: Fraction) -> Fraction:
        size = rounded_up(abs(end) * value / most) if end else end
        return -size if end < 0 else size

    def at(value: Fraction) -> Change:
        one, other = raised(low, value), raised(high, value)
        changed = posed.with_dof(module, dof.name, rate=ir.Interval(ir.Num(one), ir.Num(other)))
        rates = f"rate in [{number_text(one)}, {number_text(other)}] {unit}"
        return Change(line, f"with `{rates}` of `{module}.{dof.name}`", changed, value)

    return Scale(line, _stronger(most), at)


def _joint_bound(posed: PosedTask, line: TaskLine) -> Scale:
    """A stronger drive of one joint, or more acceleration; bounds of the task stay as they are."""
    module, dof = _joint(posed, line)
    name = "effort" if line.kind == "joint_effort" else "accel"
    written = dof.effort if name == "effort" else dof.accel
    bound = Fraction(0) if written is None else rational_bounds(written)[0]
    units = {"effort": ("N*m", "N"), "accel": ("rad/s^2", "m/s^2")}
    unit = units[name][dof.kind != "revolute"]

    def at(value: Fraction) -> Change:
        changed = posed.with_dof(module, dof.name, **{name: ir.Num(value)})
        says = f"with `{name} <= {number_text(value)} {unit}` of `{module}.{dof.name}`"
        return Change(line, says, changed, value)

    return Scale(line, _stronger(bound), at)


def _horizon(posed: PosedTask, line: TaskLine) -> Scale:
    steps = posed.task.steps

    def at(value: Fraction) -> Change:
        return Change(
            line, f"with {at_most(posed)}{value} steps", posed.with_task(steps=int(value)), value
        )

    longest = max(min(4 * steps, MOST_STEPS), steps + (steps + 1) // 2)
    values = tuple(Fraction(value) for value in range(steps + 1, longest + 1))
    return Scale(line, values, at)


def _payload(posed: PosedTask, line: TaskLine) -> Scale:
    payloads, index = posed.task.payloads, int(line.key[0])
    effector = payloads[index].effector
    who = "" if effector is None else f" by effector {effector}"

    def at(value: Fraction) -> Change:
        lighter = posed.with_task(payloads=_with_mass(payloads, index, value))
        return Change(line, f"with `payload {number_text(value)} kg{who}`", lighter, value)

    return Scale(line, _lighter(payloads[index].mass), at)


def _load(posed: PosedTask, line: TaskLine) -> Scale:
    loads, index = posed.task.carries, int(line.key[0])

    def at(value: Fraction) -> Change:
        lighter = posed.with_task(carries=_with_mass(loads, index, value))
        return Change(line, f"with a load of {number_text(value)} kg", lighter, value)

    return Scale(line, _lighter(loads[index].mass), at)


def _with_mass(clauses: Sequence[Carried], index: int, mass: Fraction) -> tuple[Carried, ...]:
    return tuple(replace(c, mass=mass) if i == index else c for i, c in enumerate(clauses))


def _lighter(mass: Fraction) -> tuple[Fraction, ...]:
    if not mass:
        return ()
    indices = range(index_below(mass), index_below(mass / LIGHTEST) - 1, -1)
    return tuple(v for v in map(number_of, indices) if v < mass)


def _bounds(posed: PosedTask, line: TaskLine) -> Scale:
    def at(value: Fraction) -> Change:
        workspace = grown_bounds(posed.workspace, value / 100)
        says = f"with bounds wider by {value} % on every side"
        return Change(line, says, posed.with_workspace(workspace), value)

    return Scale(line, tuple(map(Fraction, BOUNDS_GROWN)), at)
