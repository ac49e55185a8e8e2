"""Whether joints can be where a task lets a motion start, and as far off as it allows."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction

from compiler.checks.starting_robots import starting_robots
from compiler.expressions.evaluators.balls import closed_ball, working_precision
from compiler.robots.given_start import PRECISION
from compiler.robots.robot import RobotModel
from grammar_lang import ir
from grammar_lang.diagnostics.diagnostic import Code, Sink
from grammar_lang.source import Span

AT_REST = ir.Num(Fraction(0))


@dataclass(frozen=True, slots=True)
class _Beyond:
    """A radius that certainly takes a coordinate, or its rate, out of its range.

    ``values`` are the numbers, from 0, of the values of the start whose sum is the coordinate.
    """

    radius: str
    values: tuple[int, ...]
    is_rate: bool


def given_start_diagnostics(program: ir.Program, sink: Sink) -> None:
    """Report ``start at`` coordinates outside the ranges of joints, and radii that lead outside.

    Coordinates are reported if no robot of a small family has them in its ranges. A radius is an
    error if every such robot leaves its ranges, and a warning if only some robots do. Another
    check, which needs no start, reports a radius that is too wide for a whole range.
    """
    for task in program.tasks.values():
        if not isinstance(task.start, ir.StartAt):
            continue
        robots = starting_robots(program, task, task.start)
        if not robots:
            continue
        inside = [
            (model, start.values)
            for model, start in robots
            if not start.fault and _fits(model, start.values)
        ]
        if not inside:
            outside = [_outside_of(m, start.values) for m, start in robots if not start.fault]
            _report_unfit(task, task.start, outside, sink)
        elif task.robust is not None:
            radii = task.robust.start
            found = [list(_beyond(model, values, radii)) for model, values in inside]
            for beyond in dict.fromkeys(each for robot in found for each in robot):
                at = task.robust.clauses.get(f"start {beyond.radius}", task.span)
                if (Code.WIDE_RADIUS, at) not in {(each.code, each.span) for each in sink.found}:
                    _report(task.start, beyond, at, sink, certain=all(found))


def _fits(model: RobotModel, values: Sequence[ir.Expr]) -> bool:
    """Whether coordinates may be in their ranges, and a rate of zero in those of the rates."""
    at_rest = not any(_outside(AT_REST, dof.rate) for dof in model.dofs)
    return at_rest and not _outside_of(model, values)


def _outside_of(model: RobotModel, values: Sequence[ir.Expr]) -> frozenset[int]:
    """The numbers, from 0, of the values of a start that are certainly outside a range."""
    pairs = zip(model.dofs, values, strict=True)
    out = {k for k, (dof, value) in enumerate(pairs) if _outside(value, dof.range)}
    return frozenset(i for i, joint in enumerate(model.word_dofs) if joint.dof in out)


def _report_unfit(
    task: ir.Task, start: ir.StartAt, outside: Sequence[frozenset[int]], sink: Sink
) -> None:
    """Report a start outside the ranges of all robots: the first value that fits none of them."""
    message = f"no robot of `{task.grammar}` has these values in the ranges of its joints"
    hint, span = "write others, at rest; as it is, `synth` finds none", start.span
    common = frozenset.intersection(*outside) if outside else frozenset[int]()
    if common:
        number = min(common)
        message = f"value {number + 1} of the start is outside the range of its joint"
        hint = "write another one; as it is, `synth` finds no robot"
        if len(outside) > 1:
            message += f" in each robot of `{task.grammar}`"
        span = start.places[number] if start.places else span
    sink.warning(Code.START_OF_NO_ROBOT, message, span, hint)


def _beyond(model: RobotModel, values: Sequence[ir.Expr], radii: ir.Radii) -> Iterator[_Beyond]:
    for k, (dof, value) in enumerate(zip(model.dofs, values, strict=True)):
        revolute = dof.kind == "revolute"
        words = tuple(i for i, joint in enumerate(model.word_dofs) if joint.dof == k)
        radius = radii.angle if revolute else radii.length
        if _leaves(value, radius, dof.range):
            yield _Beyond("angle" if revolute else "length", words, is_rate=False)
        radius = radii.angular_rate if revolute else radii.speed
        if _leaves(AT_REST, radius, dof.rate):
            yield _Beyond("angular_rate" if revolute else "speed", words, is_rate=True)


def _leaves(value: ir.Expr, radius: Fraction, interval: ir.Interval | None) -> bool:
    """Whether a value certainly leaves an interval if it is off by a non-zero radius."""
    return radius > 0 and _outside(value, interval, radius)


def _outside(value: ir.Expr, interval: ir.Interval | None, radius: Fraction = Fraction(0)) -> bool:
    """Whether some value within a radius of the given one is certainly outside an interval."""
    if interval is None:
        return False
    with working_precision(PRECISION):
        middle, off = closed_ball(value), closed_ball(ir.Num(radius))
        lower, upper = closed_ball(interval.lower), closed_ball(interval.upper)
        return bool(middle - off < lower) or bool(middle + off > upper)


def _report(start: ir.StartAt, beyond: _Beyond, at: Span, sink: Sink, *, certain: bool) -> None:
    """Report which value leaves a range."""
    listed = " and ".join(str(number + 1) for number in beyond.values)
    several = len(beyond.values) > 1
    values = f"values {listed}" if several else f"value {listed}"
    of = "their joints" if several else "its joint"
    message = f"with these errors {values} of the start may leave the range of {of}"
    hint = "write less, or start further from the ends of the range"
    if beyond.is_rate:
        message = (
            f"with these errors the joint of {values} of the start may be too fast for its range"
        )
        hint = "write less: the motion starts at rest"
    places = [start.places[number] for number in beyond.values if start.places] or [start.span]
    notes = [(place, "it starts here") for place in places]
    report = sink.error if certain else sink.warning
    report(Code.WIDE_RADIUS, message, at, hint, notes)
