"""A task without some of its lines: each is replaced by one that demands almost nothing.

A relaxed range is not unlimited but far wider than written, since refuters need ranges; a relaxed
place is anywhere within the bounds.
"""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import replace
from fractions import Fraction
from math import ceil
from typing import TypeAlias

from compiler.workspaces.polytope import polytope_of
from grammar_lang import ir
from grammar_lang.ir.constants import rational, to_float
from solvers.explanation.posed_task import PosedTask
from solvers.explanation.task_line import TaskLine

WIDER = 30
"""The factor by which relaxed ranges and bounds are wider."""
DRIVEN = 1000
"""The factor by which relaxed efforts and horizons are larger."""
AMPLE_EFFORT, AMPLE_TIME = Fraction(10**9), Fraction(10**6)
"""The least relaxed efforts (SI), and horizons (s) of tasks without formulas: the stated values may
be too small by any factor."""
EVERYWHERE = "anywhere within the bounds"
"""The name of a region that no region of the language can have."""

Key: TypeAlias = tuple[str | int, ...]


def without(posed: PosedTask, lines: Collection[TaskLine]) -> PosedTask:
    """The task without these lines; places are relaxed last, to the bounds as they are by then."""
    places = {line for line in lines if line.kind in ("start", "reach", "satisfy")}
    dropped = {line for line in lines if line.kind == "carry"}
    for line in lines:
        if line not in places | dropped:
            posed = _relaxed(posed, line)
    if dropped:
        numbers = {line.key[0] for line in dropped}
        kept = (each for i, each in enumerate(posed.task.carries) if i not in numbers)
        posed = posed.with_task(carries=tuple(kept))
    return _placed(posed, places) if places else posed


def _relaxed(posed: PosedTask, line: TaskLine) -> PosedTask:
    match line.kind:
        case "parameter" | "fixed" | "joint_range" | "joint_rate" | "joint_accel" | "joint_effort":
            return _ranged(posed, line)
        case "avoid":
            return posed.without_avoided(int(line.key[0]), str(line.key[1]))
        case "avoid_self":
            return posed.with_task(avoid_self=None)
        case "bounds":
            return posed.with_workspace(grown_bounds(posed.workspace, Fraction(WIDER)))
        case "bounds_body":
            return posed.with_task(bounds_body=False)
        case "effort":
            bound = posed.task.effort[int(line.key[0])].bound
            ample = AMPLE_EFFORT / bound if bound else Fraction(DRIVEN)
            return with_effort(posed, int(line.key[0]), max(Fraction(DRIVEN), ample))
        case "horizon":
            steps = posed.task.steps * DRIVEN
            if not posed.task.demanded:
                steps = max(steps, ceil(AMPLE_TIME / posed.task.step))
            return posed.with_task(steps=steps)
        case "gravity" | "payload":
            return _weightless(posed, line)
        case _:
            raise ValueError(f"a line of kind {line.kind} is not relaxed by itself")


def _weightless(posed: PosedTask, line: TaskLine) -> PosedTask:
    """A copy without gravity, or with a payload of no mass."""
    task = posed.task
    if line.kind == "gravity":
        return posed.with_task(gravity=(Fraction(0),) * len(task.gravity))
    payloads = list(task.payloads)
    payloads[int(line.key[0])] = replace(payloads[int(line.key[0])], mass=Fraction(0))
    return posed.with_task(payloads=tuple(payloads))


# --- ranges --------------------------------------------------------------------------------------


def _ranged(posed: PosedTask, line: TaskLine) -> PosedTask:
    """A copy without a range, a limit of a rate, acceleration or effort, or a fixed value."""
    if line.kind == "fixed":
        return _freed(posed, line.key)
    module, name = (str(part) for part in line.key)
    if line.kind == "joint_rate":
        return posed.with_dof(module, name, rate=None)
    if line.kind == "joint_accel":
        return posed.with_dof(module, name, accel=None)
    if line.kind == "joint_effort":
        return posed.with_dof(module, name, effort=ir.Num(AMPLE_EFFORT))
    if line.kind == "joint_range":
        dof = next(d for d in posed.program.modules[module].dofs if d.name == name)
        if dof.kind != "prismatic" or dof.range is None:
            return posed.with_dof(module, name, range=None)
        return posed.with_dof(module, name, range=_wider(dof.range, signed=True))
    p = next(p for p in posed.program.modules[module].parameters if p.name == name)
    return posed.with_domain(module, name, _wider(p.domain, signed=is_signed(p.domain)))


def _freed(posed: PosedTask, key: Key) -> PosedTask:
    """A copy with a fixed parameter of the existing robot set free."""
    origin = posed.task.origin
    if origin is None:
        return posed
    fixed = tuple(each for each in origin.fixed if (each.symbol, each.name) != key)
    return posed.with_task(origin=replace(origin, fixed=fixed))


def ends(domain: ir.Interval | ir.Choices) -> tuple[Fraction, Fraction]:
    """The least and the largest value of a domain; irrational ones are rounded."""
    values = (domain.lower, domain.upper) if isinstance(domain, ir.Interval) else domain.values
    exact = [(rational(value), value) for value in values]
    numbers = [Fraction(to_float(at)) if value is None else value for value, at in exact]
    return min(numbers), max(numbers)


def is_signed(domain: ir.Interval | ir.Choices) -> bool:
    """Whether a range has negative values, so that it is not one of lengths or masses."""
    return ends(domain)[0] < 0


def width(domain: ir.Interval | ir.Choices) -> Fraction:
    """The width of a range; for a single value its size, or 1 for 0."""
    low, high = ends(domain)
    return high - low or abs(high) or Fraction(1)


def _wider(domain: ir.Interval | ir.Choices, *, signed: bool) -> ir.Interval:
    """An interval far wider than the domain.

    A range of lengths, masses and the like stays positive and grows by a factor at both ends. A
    ``signed`` one grows by its width, since an end at or near 0 would hardly move by a factor.
    """
    low, high = ends(domain)
    if signed:
        aside = width(domain) * WIDER / 2
        low, high = low - aside, high + aside
    else:
        low, high = low / WIDER, high * WIDER
    return ir.Interval(ir.Num(low), ir.Num(high))


# --- bounds and efforts --------------------------------------------------------------------------


def grown_bounds(workspace: ir.Workspace, width: Fraction) -> ir.Workspace:
    """A box around the old bounds, wider on every side by ``width`` times its size, as bounds."""
    box = polytope_of(workspace.bounds.shape, workspace.dimension).vertices
    rows = []
    for axis in range(workspace.dimension):
        low, high = min(p[axis] for p in box), max(p[axis] for p in box)
        aside = (high - low) * width
        unit = tuple(Fraction(int(i == axis)) for i in range(workspace.dimension))
        rows += [
            ir.HalfSpace(unit, high + aside),
            ir.HalfSpace(tuple(-a for a in unit), aside - low),
        ]
    bounds = replace(workspace.bounds, shape=ir.Inequalities(tuple(rows)))
    return replace(workspace, bounds=bounds)


def with_effort(posed: PosedTask, index: int, factor: int | Fraction) -> PosedTask:
    """A copy with an effort bound multiplied."""
    efforts = list(posed.task.effort)
    efforts[index] = replace(efforts[index], bound=efforts[index].bound * factor)
    return posed.with_task(effort=tuple(efforts))


# --- places --------------------------------------------------------------------------------------


def _placed(posed: PosedTask, lines: Collection[TaskLine]) -> PosedTask:
    """A copy without a start, a target or formulas: places are anywhere within the bounds."""
    workspace, task = posed.workspace, posed.task
    anywhere = ir.Region(EVERYWHERE, "region", workspace.bounds.shape)
    posed = posed.with_workspace(replace(workspace, regions=(*workspace.regions, anywhere)))
    kinds = {line.kind for line in lines}
    start, reach = task.start, task.reach
    if "start" in kinds:
        start = ir.StartIn(EVERYWHERE, None, Fraction(0))
    dropped = {line.key[0] for line in lines if line.kind == "satisfy"}
    satisfy = tuple(clause for i, clause in enumerate(task.satisfy) if i not in dropped)
    if "reach" in kinds or (reach is None and not satisfy):
        reach = ir.Reach(EVERYWHERE, None)
    return posed.with_task(start=start, reach=reach, satisfy=satisfy)
