"""Geometric checks of workspaces and of the tasks in them, all exact."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import assert_never

from compiler.checks.end_checks import Shapes, end_diagnostics, ends
from compiler.checks.overlap_checks import map_overlap_diagnostics, overlap_diagnostics
from compiler.checks.shape_checks import sound_polytope
from compiler.workspaces.polytope import Polytope
from grammar_lang import ir
from grammar_lang.diagnostics.codes import Code
from grammar_lang.diagnostics.diagnostic import Sink


def workspace_diagnostics(program: ir.Program, sink: Sink, *, complete: bool = True) -> None:
    """Report what is wrong with the regions of every workspace and the ends of every task.

    An error where nothing can satisfy the task or the set is no full-dimensional polytope, a
    warning where a part of a region is of no use, a note where regions overlap.

    Args:
        program: the program.
        sink: where to report.
        complete: False where items with errors were left out of the program; nothing is then
            said that they might refute, and there are no notes beside the errors.
    """
    tasks: dict[str, list[ir.Task]] = {}
    for task in program.tasks.values():
        tasks.setdefault(task.workspace, []).append(task)
    for workspace in program.workspaces.values():
        _workspace(workspace, tasks.get(workspace.name, []), sink, complete=complete)


def _workspace(
    workspace: ir.Workspace, tasks: Sequence[ir.Task], sink: Sink, *, complete: bool
) -> None:
    if complete:
        _unused_obstacles(workspace, tasks, sink)
    shapes = _shapes(workspace, sink)
    if shapes is None:
        return
    regions = {region.name: region for region in workspace.regions}
    used: set[str] = set()
    told: set[tuple[str, str]] = set()
    for task in tasks:
        avoided = [name for avoid in task.avoid for name in avoid.regions]
        for end in ends(regions, task):
            used.add(end.region.name)
            told.update((end.region.name, name) for name in avoided)
            if end.region.name in shapes.regions:
                end_diagnostics(task, end, shapes, sink)
    _useless_regions(workspace, used, shapes, sink)
    if complete:
        overlap_diagnostics(workspace, shapes.inside, told, sink)
        if shapes.maps:
            map_overlap_diagnostics(workspace, shapes, told, sink)


def _shapes(workspace: ir.Workspace, sink: Sink) -> Shapes | None:
    bounds = sound_polytope(workspace.bounds, workspace.dimension, sink)
    regions: dict[str, Polytope] = {}
    for region in workspace.regions:
        shape = sound_polytope(region, workspace.dimension, sink)
        if shape is not None:
            regions[region.name] = shape
    if bounds is None:
        return None
    parts = {name: _common(bounds, shape) for name, shape in regions.items()}
    inside = {name: part.irredundant() for name, part in parts.items() if part.has_interior}
    if not workspace.maps:
        return Shapes(bounds, regions, inside)
    # Loaded where there is a map alone, so that other checks start fast.
    from compiler.checks.map_checks import map_shapes

    return Shapes(bounds, regions, inside, map_shapes(workspace, bounds, sink))


def _common(bounds: Polytope, shape: Polytope) -> Polytope:
    """The part of a region within the bounds; most regions lie there wholly."""
    if shape.is_bounded and bounds.contains(shape):
        return shape
    return bounds.intersection(shape)


def _unused_obstacles(workspace: ir.Workspace, tasks: Sequence[ir.Task], sink: Sink) -> None:
    used = {name for task in tasks for avoid in task.avoid for name in avoid.regions}
    for task in tasks:
        for clause in task.satisfy:
            used.update(_named(clause.formula))
    for region in workspace.regions:
        if region.kind == "obstacle" and region.name not in used:
            sink.warning(
                Code.UNUSED_OBSTACLE,
                f"no task avoids obstacle `{region.name}`",
                region.span,
                hint=f"add `avoid {region.name} with effector;` or `with body` to a task, "
                "or declare a region",
            )
    for found in workspace.maps:
        if found.name not in used:
            sink.warning(
                Code.UNUSED_OBSTACLE,
                f"no task avoids obstacle `{found.name}`",
                found.span,
                hint=f"add `avoid {found.name} with effector;` or `with body` to a task",
            )


def _named(formula: ir.Formula) -> Iterator[str]:
    """The regions that a formula names."""
    todo = [formula]
    while todo:
        node = todo.pop()
        match node:
            case ir.Atom(region):
                yield region
            case ir.Not(operand) | ir.Always(operand) | ir.Eventually(operand) | ir.Next(operand):
                todo.append(operand)
            case ir.Last(operand=operand):
                todo.append(operand)
            case ir.And(operands) | ir.Or(operands):
                todo += operands
            case ir.Implies(left, right) | ir.Until(left, right):
                todo += (left, right)
            case _:
                assert_never(node)


def _useless_regions(workspace: ir.Workspace, used: set[str], shapes: Shapes, sink: Sink) -> None:
    """Regions outside the bounds that are no end of a task (for those there is an error)."""
    for region in workspace.regions:
        name = region.name
        if name in shapes.regions and name not in shapes.inside and name not in used:
            sink.warning(
                Code.REGION_OUTSIDE_BOUNDS,
                f"{region.kind} `{name}` lies outside the bounds and has no effect",
                region.span,
                hint="move it, or widen the bounds",
                notes=((workspace.bounds.span, "the bounds"),),
            )
