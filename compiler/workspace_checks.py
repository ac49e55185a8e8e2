"""Geometric checks of workspaces and of the tasks in them, all exact.

The rules are those of the language reference, "Geometry": sets are closed, `bounds` binds every
effector, and a region the task starts in or reaches must leave room outside what it avoids.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction

from compiler.partition import remainder
from compiler.polytope import Polytope, polytope_of
from grammar_lang.codes import Code
from grammar_lang.diagnostics import Sink
from grammar_lang.ir import Hull, Inequalities, Program, Region, StartIn, Task, Workspace
from grammar_lang.source import Span


@dataclass(frozen=True, slots=True)
class _Shapes:
    """The sound polytopes of a workspace, and the parts of the regions within the bounds."""

    bounds: Polytope
    regions: Mapping[str, Polytope]
    inside: Mapping[str, Polytope]


@dataclass(frozen=True, slots=True)
class _End:
    """The start or the reach clause of a task."""

    role: str
    region: Region
    span: Span
    code: Code


def workspace_diagnostics(program: Program, sink: Sink) -> None:
    """Report what is wrong with the regions of every workspace and the ends of every task.

    An error where nothing can satisfy the task or the set is no full-dimensional polytope, a
    warning where a part of a region is of no use.
    """
    for workspace in program.workspaces.values():
        tasks = [task for task in program.tasks.values() if task.workspace == workspace.name]
        _unused_obstacles(workspace, tasks, sink)
        shapes = _shapes(workspace, sink)
        if shapes is None:
            continue
        _useless_regions(workspace, tasks, shapes, sink)
        for task in tasks:
            for end in _ends(workspace, task):
                if end.region.name in shapes.regions:
                    _check_end(task, end, shapes, sink)


def _shapes(workspace: Workspace, sink: Sink) -> _Shapes | None:
    bounds = _sound(workspace.bounds, workspace.dimension, sink)
    regions: dict[str, Polytope] = {}
    for region in workspace.regions:
        shape = _sound(region, workspace.dimension, sink)
        if shape is not None:
            regions[region.name] = shape
    if bounds is None:
        return None
    parts = {name: bounds.intersection(shape) for name, shape in regions.items()}
    inside = {name: part.irredundant() for name, part in parts.items() if part.has_interior}
    return _Shapes(bounds, regions, inside)


def _sound(region: Region, dimension: int, sink: Sink) -> Polytope | None:
    """The polytope of a region that is one with interior (and bounded, for the bounds)."""
    shape = polytope_of(region.shape, dimension)
    called = "the bounds" if region.kind == "bounds" else f"{region.kind} `{region.name}`"
    verb = "have" if region.kind == "bounds" else "has"
    if shape.is_empty:
        sink.error(
            Code.EMPTY_POLYTOPE,
            f"{called} {verb} no point",
            region.span,
            hint="no point satisfies all the inequalities: check their signs",
            notes=_culprit(region.shape, -1, "no point is left once this is added"),
        )
        return None
    if not shape.has_interior:
        sink.error(
            Code.FLAT_POLYTOPE,
            f"{called} {verb} no interior",
            region.span,
            hint="a region needs a positive " + ("area" if dimension == 2 else "volume"),
            notes=_culprit(region.shape, dimension - 1, "no interior is left once this is added"),
        )
        return None
    if not shape.is_bounded:
        if region.kind == "bounds":
            sink.error(
                Code.UNBOUNDED_POLYTOPE,
                f"{called} are unbounded",
                region.span,
                hint="add inequalities that close the set on every side",
            )
            return None
        sink.warning(
            Code.UNBOUNDED_POLYTOPE,
            f"{called} is unbounded, it counts up to the bounds of the workspace",
            region.span,
            hint="add inequalities that close the set on every side",
        )
    return shape


def _culprit(
    shape: Inequalities | Hull, dimension: int, message: str
) -> tuple[tuple[Span, str], ...]:
    """The first inequality with which the ones before it leave at most ``dimension``."""
    if isinstance(shape, Hull):
        return ()
    for count in range(1, len(shape.rows) + 1):
        if Polytope(shape.rows[:count]).affine_dimension <= dimension:
            return ((shape.rows[count - 1].span, message),)
    return ()


def _ends(workspace: Workspace, task: Task) -> list[_End]:
    by_name = {region.name: region for region in workspace.regions}
    ends: list[_End] = []
    if isinstance(task.start, StartIn) and task.start.region in by_name:
        region = by_name[task.start.region]
        ends.append(_End("start", region, task.start.span, Code.START_IN_OBSTACLE))
    if task.reach.region in by_name:
        region = by_name[task.reach.region]
        ends.append(_End("target", region, task.reach.span, Code.TARGET_IN_OBSTACLE))
    return ends


def _unused_obstacles(workspace: Workspace, tasks: Sequence[Task], sink: Sink) -> None:
    avoided = {name for task in tasks for avoid in task.avoid for name in avoid.regions}
    for region in workspace.regions:
        if region.kind == "obstacle" and region.name not in avoided:
            sink.warning(
                Code.UNUSED_OBSTACLE,
                f"no task avoids obstacle `{region.name}`",
                region.span,
                hint=f"add `avoid {region.name} with effector;` or `with body` to a task, "
                "or declare a region",
            )


def _useless_regions(
    workspace: Workspace, tasks: Sequence[Task], shapes: _Shapes, sink: Sink
) -> None:
    """Regions outside the bounds that are no end of a task (for those there is an error)."""
    ends = {end.region.name for task in tasks for end in _ends(workspace, task)}
    for region in workspace.regions:
        name = region.name
        if name in shapes.regions and name not in shapes.inside and name not in ends:
            sink.warning(
                Code.REGION_OUTSIDE_BOUNDS,
                f"{region.kind} `{name}` lies outside the bounds and has no effect",
                region.span,
                hint="move it, or widen the bounds",
                notes=((workspace.bounds.span, "the bounds"),),
            )


def _check_end(task: Task, end: _End, shapes: _Shapes, sink: Sink) -> None:
    name, declared = end.region.name, ((end.region.span, f"`{end.region.name}` is declared here"),)
    if name not in shapes.inside:
        sink.error(
            Code.REGION_OUTSIDE_BOUNDS,
            f"the {end.role} `{name}` lies outside the bounds, which bind every effector",
            end.span,
            hint="move it, or widen the bounds",
            notes=declared,
        )
        return
    shape = shapes.regions[name]
    if shape.is_bounded and not shapes.bounds.contains(shape):
        sink.warning(
            Code.REGION_PARTLY_OUTSIDE,
            f"a part of the {end.role} `{name}` lies outside the bounds and is of no use",
            end.span,
            hint="shrink it, or widen the bounds",
            notes=declared,
        )
    _check_blocked(task, end, shapes, sink)


def _check_blocked(task: Task, end: _End, shapes: _Shapes, sink: Sink) -> None:
    """What the avoided regions leave of an end; two tests, as only `with effector` binds it."""
    part = shapes.inside[end.region.name]
    binding = _avoided(task, ("effector",), part, shapes)
    nearby = _avoided(task, ("effector", "body"), part, shapes)
    names = ", ".join(f"`{name}`" for name in nearby)
    notes = ((end.region.span, f"`{end.region.name}` is declared here"),)
    hint = f"move `{end.region.name}`, or avoid less"
    if not remainder(part, list(binding.values())):
        listed = ", ".join(f"`{name}`" for name in binding)
        message = (
            f"the {end.role} `{end.region.name}` lies wholly inside {listed}, which is avoided"
        )
        sink.error(end.code, message, end.span, hint, notes)
        return
    left = remainder(part, list(nearby.values()))
    if not left:
        sink.warning(
            end.code,
            f"the {end.role} `{end.region.name}` lies wholly inside {names}, which the body avoids",
            end.span,
            "only an effector that is no part of a body can be there",
            notes,
        )
    elif sum((piece.volume for piece in left), Fraction(0)) < part.volume:
        sink.warning(
            Code.REGION_PARTLY_BLOCKED,
            f"a part of the {end.role} `{end.region.name}` lies inside {names}, which is avoided",
            end.span,
            hint,
            notes,
        )


def _avoided(
    task: Task, subjects: tuple[str, ...], part: Polytope, shapes: _Shapes
) -> dict[str, Polytope]:
    """The regions the task avoids that meet the interior of ``part``, in the order named."""
    names = [name for avoid in task.avoid if avoid.subject in subjects for name in avoid.regions]
    return {
        name: shapes.inside[name]
        for name in names
        if name in shapes.inside and not shapes.inside[name].separated_interiors(part)
    }
