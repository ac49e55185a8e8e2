"""Changes that weaken one line of a task, by a value or as a whole, or that change no line.

A scale is a line with the values that it may take, the nearest first; each of its tasks is weaker
than those before, or has less to carry. The text ``says`` of a change describes the new task,
mostly as "with ..." or "without ...".
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import TypeVar

from compiler.expressions.exact_numbers import rational_bounds
from grammar_lang import ir
from grammar_lang.ir.expression_text import number_text
from solvers.explanation.posed_task import PosedTask
from solvers.explanation.relaxation import (
    WIDER,
    ends,
    grown_bounds,
    is_signed,
    width,
    with_effort,
    without,
)
from solvers.explanation.task_line import TaskLine
from solvers.explanation.two_digits import index_above, index_below, number_of

Carried = TypeVar("Carried", ir.Payload, ir.Carry)

MOST_STEPS = 160
"""The most steps of a longer horizon; it is also at most four times as long. A horizon near or
above this limit still becomes half as long again."""
MOST_EFFORT = 64
"""The largest factor by which an effort bound is raised."""
LIGHTEST = 20
"""The largest factor by which a payload is reduced."""
BOUNDS_GROWN = (1, 2, 5, 10, 20, 50, 100)
"""Percentages of their width by which bounds are moved outwards."""


@dataclass(frozen=True, slots=True)
class Change:
    """A weaker task: the changed line, the change in words, and its value if it has one.

    Changes of a line that differ only in their value have the same ``way``. Without a line the task
    is the same, and the search has ``budget`` times as much.
    """

    line: TaskLine | None
    says: str
    posed: PosedTask
    value: Fraction | None = None
    way: str = ""
    budget: int = 1


@dataclass(frozen=True, slots=True)
class Scale:
    """The changes of a line by a value, the smallest change first.

    ``posable``: larger changes allow more poses, so poses show from which value on they may help.
    Steps further away are multiples of the distance from ``origin``; None: of the value.
    """

    line: TaskLine
    values: tuple[Fraction, ...]
    at: Callable[[Fraction], Change]
    posable: bool
    origin: Fraction | None = None


def scales(posed: PosedTask, line: TaskLine) -> Iterator[Scale]:
    """The scales of a line; none if it has no value to change."""
    match line.kind:
        case "parameter":
            yield from _parameter(posed, line)
        case "joint_range":
            yield from _slide(posed, line)
        case "effort":
            yield _effort(posed, line)
        case "joint_effort":
            yield _joint_effort(posed, line)
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


def single_changes(posed: PosedTask, line: TaskLine) -> Iterator[Change]:
    """The changes of a line without a value: parts and names of effectors are dropped."""
    for change in _single(posed, line):
        yield replace(change, way=change.says)


def _single(posed: PosedTask, line: TaskLine) -> Iterator[Change]:
    task = posed.task
    match line.kind:
        case "start" if isinstance(task.start, ir.StartIn):
            yield from _start(posed, task.start, line)
        case "reach" if task.reach is not None:
            yield from _reach(posed, task.reach, line)
        case "avoid":
            yield from _avoid(posed, line)
        case "avoid_self" if task.avoid_self is not None:
            if task.avoid_self.margin:
                touching = replace(task.avoid_self, margin=Fraction(0))
                says = "without the margin between bodies"
                yield Change(line, says, posed.with_task(avoid_self=touching))
            yield Change(line, "without `avoid self`", without(posed, [line]))
        case "satisfy" if task.reach is not None or len(task.satisfy) > 1:
            yield Change(line, "without this formula", without(posed, [line]))
        case "bounds_body" | "payload" | "carry":
            named = {"bounds_body": "`bounds with body`", "carry": "this load"}
            what = named.get(line.kind, "the payload")
            yield Change(line, f"without {what}", without(posed, [line]))
        case "joint_range" | "joint_rate" | "joint_accel":
            module, name = line.key
            of = {"joint_rate": "the rate of ", "joint_accel": "the acceleration of "}
            says = f"without a limit of {of.get(line.kind, '')}`{module}.{name}`"
            yield Change(line, says, without(posed, [line]))
        case "fixed":
            yield Change(line, f"with `{line.key[1]}` free", without(posed, [line]))
        case _:
            return


def _start(posed: PosedTask, start: ir.StartIn, line: TaskLine) -> Iterator[Change]:
    if start.held:
        falling = replace(start, held=False)
        yield Change(line, "without `held`", posed.with_task(start=falling))
    if start.effector is not None:
        anyone = replace(start, effector=None)
        says = f"with any effector starting in `{start.region}`"
        yield Change(line, says, posed.with_task(start=anyone))


def with_feedback(posed: PosedTask, line: TaskLine) -> Change:
    """Inputs follow measurements; everything else stays as before."""
    return Change(line, "with `control feedback`", posed.with_task(control="feedback"))


def with_shorter_steps(posed: PosedTask, line: TaskLine, parts: int) -> Change:
    """Each step is divided into ``parts``: feedback acts more often over the same time."""
    steps, step = parts * posed.task.steps, posed.task.step / parts
    length = number_text(step)
    # Without parentheses, a quotient would be read as that of a number and a time.
    of = f"({length})" if "/" in length else length
    says = f"with `horizon {_at_most(posed)}{steps} steps of {of} s`"
    shorter = posed.with_task(steps=steps, step=step)
    return Change(line, says, shorter, Fraction(steps), "shorter")


def _at_most(posed: PosedTask) -> str:
    return "at most " if posed.task.at_most else ""


def with_fewer_steps(posed: PosedTask, line: TaskLine, steps: int) -> Change:
    """A shorter horizon: a long motion may sway."""
    return Change(
        line, f"with {steps} steps", posed.with_task(steps=steps), Fraction(steps), "fewer"
    )


def with_budget(posed: PosedTask, times: int, paths: int, evaluations: int) -> Change:
    """The same task with ``times`` the budgets of a structure and of a path."""
    says = f"with `--paths {times * paths} --evaluations {times * evaluations}`"
    return Change(None, says, posed, budget=times)


def with_modules(posed: PosedTask, line: TaskLine, modules: int) -> Change:
    """Another bound on modules."""
    changed = posed.with_task(modules=modules)
    return Change(line, f"with `modules <= {modules}`", changed, Fraction(modules))


# --- values --------------------------------------------------------------------------------------


def _parameter(posed: PosedTask, line: TaskLine) -> Iterator[Scale]:
    """A range that extends further up, and one that extends further down."""
    module, name = (str(part) for part in line.key)
    p = next(p for p in posed.program.modules[module].parameters if p.name == name)
    low, high = ends(p.domain)
    unit = "" if p.unit == "1" else f" {p.unit}"

    def at(value: Fraction, way: str) -> Change:
        says = f"with `{module}.{name}` {way} {number_text(value)}{unit}"
        wider = _with_value(p.domain, value)
        return Change(line, says, posed.with_domain(module, name, wider), value, way)

    if is_signed(p.domain):
        yield from _signed(line, p.domain, at)
        return
    if high > 0:
        indices = range(index_above(high), index_above(high * WIDER) + 1)
        up = tuple(v for v in map(number_of, indices) if v > high)
        yield Scale(line, up, lambda value: at(value, "up to"), posable=True)
    if low > 0:
        indices = range(index_below(low), index_below(low / WIDER) - 1, -1)
        down = tuple(v for v in map(number_of, indices) if v < low)
        yield Scale(line, down, lambda value: at(value, "down to"), posable=True)


def _slide(posed: PosedTask, line: TaskLine) -> Iterator[Scale]:
    """The range of a prismatic joint, extended further up or down."""
    module, name = (str(part) for part in line.key)
    dof = next(d for d in posed.program.modules[module].dofs if d.name == name)
    if dof.kind != "prismatic" or dof.range is None:
        return
    domain = dof.range

    def at(value: Fraction, way: str) -> Change:
        says = f"with `{module}.{name}` {way} {number_text(value)} m"
        wider = posed.with_dof(module, name, range=_with_value(domain, value))
        return Change(line, says, wider, value, way)

    yield from _signed(line, domain, at)


def _signed(
    line: TaskLine,
    domain: ir.Interval | ir.Choices,
    at: Callable[[Fraction, str], Change],
) -> Iterator[Scale]:
    """Extensions of a range with negative values, whose ends may be 0: by its width at most."""
    (low, high), size = ends(domain), width(domain)
    most = size * WIDER / 2
    indices = range(index_above(size / WIDER), index_above(most + abs(low) + abs(high)) + 1)
    grid = [number_of(index) for index in indices]
    grid = [*(-value for value in reversed(grid)), Fraction(0), *grid]
    up = tuple(value for value in grid if high < value <= high + most)
    down = tuple(value for value in reversed(grid) if low - most <= value < low)
    yield Scale(line, up, lambda value: at(value, "up to"), posable=True, origin=high)
    yield Scale(line, down, lambda value: at(value, "down to"), posable=True, origin=low)


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

    return Scale(line, _stronger(clause.bound), at, posable=False)


def _stronger(bound: Fraction) -> tuple[Fraction, ...]:
    indices = range(index_above(bound), index_above(bound * MOST_EFFORT) + 1)
    return tuple(v for v in map(number_of, indices) if v > bound)


def _joint_effort(posed: PosedTask, line: TaskLine) -> Scale:
    """A stronger drive of one joint; bounds of the task stay as they are."""
    module, name = (str(part) for part in line.key)
    dof = next(d for d in posed.program.modules[module].dofs if d.name == name)
    bound = Fraction(0) if dof.effort is None else rational_bounds(dof.effort)[0]
    unit = "N*m" if dof.kind == "revolute" else "N"

    def at(value: Fraction) -> Change:
        changed = posed.with_dof(module, name, effort=ir.Num(value))
        says = f"with `effort <= {number_text(value)} {unit}` of `{module}.{name}`"
        return Change(line, says, changed, value)

    return Scale(line, _stronger(bound), at, posable=False)


def _horizon(posed: PosedTask, line: TaskLine) -> Scale:
    steps = posed.task.steps

    def at(value: Fraction) -> Change:
        return Change(
            line, f"with {_at_most(posed)}{value} steps", posed.with_task(steps=int(value)), value
        )

    longest = max(min(4 * steps, MOST_STEPS), steps + (steps + 1) // 2)
    values = tuple(Fraction(value) for value in range(steps + 1, longest + 1))
    return Scale(line, values, at, posable=False)


def _payload(posed: PosedTask, line: TaskLine) -> Scale:
    payloads, index = posed.task.payloads, int(line.key[0])
    effector = payloads[index].effector
    who = "" if effector is None else f" by effector {effector}"

    def at(value: Fraction) -> Change:
        lighter = posed.with_task(payloads=_with_mass(payloads, index, value))
        return Change(line, f"with `payload {number_text(value)} kg{who}`", lighter, value)

    return Scale(line, _lighter(payloads[index].mass), at, posable=False)


def _load(posed: PosedTask, line: TaskLine) -> Scale:
    loads, index = posed.task.carries, int(line.key[0])

    def at(value: Fraction) -> Change:
        lighter = posed.with_task(carries=_with_mass(loads, index, value))
        return Change(line, f"with a load of {number_text(value)} kg", lighter, value)

    return Scale(line, _lighter(loads[index].mass), at, posable=False)


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

    return Scale(line, tuple(map(Fraction, BOUNDS_GROWN)), at, posable=True)


# --- parts ---------------------------------------------------------------------------------------


def _reach(posed: PosedTask, reach: ir.Reach, line: TaskLine) -> Iterator[Change]:
    if reach.effector is not None:
        anyone = posed.with_task(reach=replace(reach, effector=None))
        yield Change(line, f"with any effector ending in `{reach.region}`", anyone)
    if reach.poses:
        turned = posed.with_task(reach=replace(reach, poses=()))
        yield Change(line, f"turned in any way in `{reach.region}`", turned)
    if reach.rates is not None:
        rest = reach.rates.bound == ir.REST_RATE
        bound = "at rest" if rest else f"rates <= {number_text(reach.rates.bound)}"
        if reach.rates.duration:
            brief = replace(reach.rates, duration=Fraction(0))
            says = f"with `{bound}` at the last instant alone"
            yield Change(line, says, posed.with_task(reach=replace(reach, rates=brief)))
        moving = posed.with_task(reach=replace(reach, rates=None))
        yield Change(line, f"without `{bound}` at the end", moving)


def _avoid(posed: PosedTask, line: TaskLine) -> Iterator[Change]:
    """Without the margin, for the effector alone, or without the region."""
    index, region = int(line.key[0]), str(line.key[1])
    clauses = posed.task.avoid
    clause = clauses[index]

    def with_clause(changed: ir.Avoid) -> PosedTask:
        return posed.with_task(avoid=(*clauses[:index], changed, *clauses[index + 1 :]))

    if clause.margin:
        yield Change(line, "without the margin", with_clause(replace(clause, margin=Fraction(0))))
    if clause.subject == "body":
        alone = with_clause(replace(clause, subject="effector"))
        yield Change(line, f"with `{region}` avoided by effectors alone", alone)
    yield Change(line, f"without avoiding `{region}`", without(posed, [line]))
