"""Geometric checks of workspaces and of the tasks in them, all exact."""

from __future__ import annotations

import posixpath
from collections.abc import Collection, Iterator, Mapping, Sequence
from fractions import Fraction
from itertools import islice
from typing import assert_never

from compiler.checks.region_checks import Shapes, end_diagnostics, ends, sound_polytope
from compiler.tasks.obstacle_pieces import pieces_of, polytopes_within
from compiler.workspaces.convex_objects import hollow_objects
from compiler.workspaces.hull import turn
from compiler.workspaces.map_header import MapFault
from compiler.workspaces.overlaps import candidates, interiors_meet
from compiler.workspaces.pieces import Pieces, sides
from compiler.workspaces.polytope import Polytope
from grammar_lang import ir
from grammar_lang.diagnostics.diagnostic import Code, Sink
from grammar_lang.diagnostics.wording import counted
from grammar_lang.ir import ObstacleMap, Region, Workspace


def workspace_diagnostics(program: ir.Program, sink: Sink, *, complete: bool = True) -> None:
    """Report errors in the regions of every workspace and in the ends of every task.

    An error if nothing can satisfy the task or the set is not a full-dimensional polytope, a
    warning if a part of a region is useless, a note if regions overlap.

    Args:
        program: the program.
        sink: where to report.
        complete: False if items with errors were left out of the program; then nothing is
            reported that they might refute, and there are no notes in addition to the errors.
    """
    tasks: dict[str, list[ir.Task]] = {}
    for task in program.tasks.values():
        tasks.setdefault(task.workspace, []).append(task)
    for workspace in program.workspaces.values():
        # A file without tasks is meant to be included: other files say what is avoided.
        if complete and program.tasks:
            _unused_obstacles(workspace, tasks.get(workspace.name, []), sink)
        _workspace(workspace, tasks.get(workspace.name, []), sink, complete=complete)


def _workspace(
    workspace: ir.Workspace, tasks: Sequence[ir.Task], sink: Sink, *, complete: bool
) -> None:
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
    return Shapes(bounds, regions, inside, map_shapes(workspace, bounds, sink))


def _common(bounds: Polytope, shape: Polytope) -> Polytope:
    """The part of a region within the bounds; most regions lie wholly within them."""
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
    """Report regions outside the bounds that are not an end of a task (these have an error)."""
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


# --- Notes about regions of a workspace that overlap: allowed, but often not intended -------------


REPORTED = 20
CANDIDATE_LIMIT = 5_000


def overlap_diagnostics(
    workspace: Workspace,
    inside: Mapping[str, Polytope],
    told: Collection[tuple[str, str]],
    sink: Sink,
) -> None:
    """Note the pairs of regions whose interiors meet within the bounds.

    Obstacles may overlap each other freely. The first ``REPORTED`` pairs in order of declaration
    are noted one by one, the others by their number; at most ``CANDIDATE_LIMIT`` pairs whose
    bounding boxes overlap are examined.

    Args:
        workspace: the workspace.
        inside: the parts of its regions within the bounds, by facets; regions without are left out.
        told: pairs of names, in any order, about which there is another finding already.
        sink: where to report.
    """
    regions = [region for region in workspace.regions if region.name in inside]
    shapes = [inside[region.name] for region in regions]
    looked_at = list(islice(_worth(regions, shapes, told), CANDIDATE_LIMIT + 1))
    cut = len(looked_at) > CANDIDATE_LIMIT
    pairs = sorted(
        (i, j) for i, j in looked_at[:CANDIDATE_LIMIT] if interiors_meet(shapes[i], shapes[j])
    )
    for i, j in pairs[:REPORTED]:
        _overlap_note(regions[i], regions[j], shapes[i], shapes[j], sink)
    rest = len(pairs) - REPORTED
    if rest > 0:
        some = "1 more pair" if rest == 1 else f"{rest} more pairs"
        sink.note(
            Code.OVERLAPPING_REGIONS,
            f"{'at least ' if cut else ''}{some} of regions of workspace `{workspace.name}` "
            f"overlap{'s' if rest == 1 else ''}",
            workspace.span,
            hint="a point of several regions has the propositions of all of them",
        )


def _worth(
    regions: list[Region], shapes: list[Polytope], told: Collection[tuple[str, str]]
) -> Iterator[tuple[int, int]]:
    """The candidates that deserve a note."""
    for i, j in candidates(shapes):
        first, second = regions[i], regions[j]
        names = first.name, second.name
        if not (
            (first.kind == "obstacle" and second.kind == "obstacle")
            or names in told
            or names[::-1] in told
        ):
            yield i, j


def _overlap_note(
    first: Region, second: Region, one: Polytope, other: Polytope, sink: Sink
) -> None:
    """Note one pair, at the region that is declared later."""
    a, b = f"{first.kind} `{first.name}`", f"{second.kind} `{second.name}`"
    forth, back = other.contains(one), one.contains(other)
    if forth and back:
        message = f"{b} is the same set as {a}"
    elif forth or back:
        message = f"{b} {'contains' if forth else 'lies inside'} {a}"
    else:
        message = f"{b} overlaps {a}"
    sink.note(
        Code.OVERLAPPING_REGIONS,
        message,
        second.span,
        hint="a point of both has both propositions; move one of them if that is not intended",
        notes=((first.span, f"`{first.name}` is declared here"),),
    )


def map_overlap_diagnostics(
    workspace: Workspace, shapes: Shapes, told: Collection[tuple[str, str]], sink: Sink
) -> None:
    """Note the regions, except obstacles, whose interiors meet that of a map; each pair once.

    Args:
        workspace: the workspace.
        shapes: its regions and maps within the bounds.
        told: pairs of a region and a map about which there is another finding already.
        sink: where to report.
    """
    for region in workspace.regions:
        part = shapes.inside.get(region.name)
        if part is None or region.kind == "obstacle":
            continue
        for found in workspace.maps:
            pieces = shapes.maps.get(found.name, ())
            if (region.name, found.name) not in told and any(
                interiors_meet(piece, part) for piece in pieces
            ):
                sink.note(
                    Code.OVERLAPPING_REGIONS,
                    f"{region.kind} `{region.name}` overlaps obstacle `{found.name}`",
                    region.span,
                    hint="a point of both has both propositions; change one if that is unintended",
                    notes=((found.span, f"`{found.name}` is declared here"),),
                )


# --- Findings about maps of obstacles: what each consists of, or why it cannot be used ------------


def map_shapes(
    workspace: Workspace, bounds: Polytope, sink: Sink
) -> dict[str, tuple[Polytope, ...]]:
    """The pieces of every map within the bounds, by name, and a note about each.

    A map that cannot be used is an error and has no pieces; a map without obstacles within the
    bounds gets a warning.
    """
    shapes: dict[str, tuple[Polytope, ...]] = {}
    for found in workspace.maps:
        try:
            every, inside = pieces_of(found), polytopes_within(found, workspace.bounds)
        except MapFault as fault:
            fault.report(found, sink)
            continue
        shapes[found.name] = inside
        if every.count and not inside:
            sink.warning(
                Code.REGION_OUTSIDE_BOUNDS,
                f"obstacle `{found.name}` lies outside the bounds and has no effect",
                found.span,
                hint="move it, or widen the bounds",
                notes=((workspace.bounds.span, "the bounds"),),
            )
        else:
            _map_note(found, every, len(inside), bounds, sink)
    return shapes


def _map_note(found: ObstacleMap, every: Pieces, inside: int, bounds: Polytope, sink: Sink) -> None:
    """Note what a map consists of, how far it was rounded, and whether the bounds exceed it."""
    parts = [f"{counted(inside, 'convex piece')} from {every.origin}"]
    if every.inflation:
        parts.append(f"rounded outwards by at most {_above(every.inflation)} m")
    outside = every.count - inside
    if outside:
        parts.append(f"{counted(outside, 'more piece')} outside the bounds left out")
    hollow = 0 if found.scene is None else hollow_objects(found.scene)
    if hollow:
        objects = f"{hollow:,} of {counted(every.count, 'object')}"
        parts.append(f"{objects} not convex, or not closed: hollows are filled")
        message = f"obstacle `{found.name}`: {', '.join(parts)}"
        cut = f"`srgc import scene {posixpath.basename(found.path)}` cuts it into convex pieces"
        sink.warning(Code.FILLED_HOLLOWS, message, found.span, cut)
        return
    hint = None
    if every.extent is not None and not _holds(every.extent, bounds):
        hint = "the bounds go on beyond the image, where there is no obstacle"
    sink.note(Code.MAP_PIECES, f"obstacle `{found.name}`: {', '.join(parts)}", found.span, hint)


def _above(value: Fraction) -> str:
    """A decimal of two digits that is not below the given positive value."""
    exponent = 0
    while value * 10**exponent < 10:
        exponent += 1
    digits = -(-value.numerator * 10**exponent // value.denominator)
    return f"{float(Fraction(digits, 10**exponent)):.2g}"


def _holds(extent: tuple[tuple[Fraction, Fraction], ...], bounds: Polytope) -> bool:
    """Whether the bounds lie within a convex polygon."""
    return all(turn(a, b, (x, y)) >= 0 for a, b in sides(extent) for x, y in bounds.vertices)
