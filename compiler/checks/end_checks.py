"""Findings about the ends of tasks: what bounds and avoided regions leave of start and target.

The rules are those of the language reference, "Geometry": sets are closed, `bounds` binds every
effector, and a region the task starts in or reaches must leave room outside what it avoids.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from itertools import islice

from compiler.workspaces.overlaps import interiors_meet
from compiler.workspaces.partition import remainder
from compiler.workspaces.polytope import Polytope
from grammar_lang.diagnostics.codes import Code
from grammar_lang.diagnostics.diagnostic import Sink
from grammar_lang.ir import Region, StartIn, Task
from grammar_lang.source import Span

LISTED = 5


@dataclass(frozen=True, slots=True)
class Shapes:
    """The sound polytopes of a workspace, and the parts of the regions within the bounds.

    The parts are given by their facets; a region without interior there has none.  ``maps`` are
    the pieces of the maps that have an interior within the bounds.
    """

    bounds: Polytope
    regions: Mapping[str, Polytope]
    inside: Mapping[str, Polytope]
    maps: Mapping[str, Sequence[Polytope]] = field(default_factory=dict[str, Sequence[Polytope]])

    def parts(self, name: str) -> Sequence[Polytope]:
        """What is avoided with a region or a map."""
        return [self.inside[name]] if name in self.inside else self.maps.get(name, ())


@dataclass(frozen=True, slots=True)
class End:
    """The start or the reach clause of a task, with its region."""

    role: str
    region: Region
    span: Span
    code: Code


def ends(regions: Mapping[str, Region], task: Task) -> Iterator[End]:
    """The clauses of a task that put an effector in a region of the workspace."""
    if isinstance(task.start, StartIn) and task.start.region in regions:
        region = regions[task.start.region]
        yield End("start", region, task.start.span, Code.START_IN_OBSTACLE)
    if task.reach is not None and task.reach.region in regions:
        region = regions[task.reach.region]
        yield End("target", region, task.reach.span, Code.TARGET_IN_OBSTACLE)


def end_diagnostics(task: Task, end: End, shapes: Shapes, sink: Sink) -> None:
    """Report an end outside the bounds or in what is avoided: an error wholly, a warning partly."""
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
    _blocked(task, end, shapes, sink)


def _blocked(task: Task, end: End, shapes: Shapes, sink: Sink) -> None:
    """What the avoided regions leave of an end; two tests, as only `with effector` binds it."""
    part = shapes.inside[end.region.name]
    nearby = _avoided(task, ("effector", "body"), part, shapes)
    if not nearby:
        return
    binding = _avoided(task, ("effector",), part, shapes)
    name, notes = end.region.name, ((end.region.span, f"`{end.region.name}` is declared here"),)
    hint = f"move `{name}`, or avoid less"
    if _covered(part, _together(binding)):
        message = f"the {end.role} `{name}` lies wholly inside {_listed(binding)}, which is avoided"
        sink.error(end.code, message, end.span, hint, notes)
    elif len(nearby) > len(binding) and _covered(part, _together(nearby)):
        sink.warning(
            end.code,
            f"the {end.role} `{name}` lies wholly inside {_listed(nearby)}, which the body avoids",
            end.span,
            "only an effector that is no part of a body can be there",
            notes,
        )
    else:
        sink.warning(
            Code.REGION_PARTLY_BLOCKED,
            f"a part of the {end.role} `{name}` lies inside {_listed(nearby)}, which is avoided",
            end.span,
            hint,
            notes,
        )


def _listed(names: Collection[str]) -> str:
    """The first names, and how many more there are."""
    shown = ", ".join(f"`{name}`" for name in islice(names, LISTED))
    rest = len(names) - LISTED
    return f"{shown} and {rest} more" if rest > 0 else shown


def _covered(part: Polytope, regions: Sequence[Polytope]) -> bool:
    """Whether the union of regions covers a polytope."""
    common = (part.intersection(region).volume for region in regions)
    # Cutting the part into pieces is dear, and of no use where the regions are too small together.
    return sum(common, Fraction(0)) >= part.volume and not remainder(part, regions)


def _together(avoided: Mapping[str, Sequence[Polytope]]) -> list[Polytope]:
    """All that is avoided, without its names."""
    return [piece for pieces in avoided.values() for piece in pieces]


def _avoided(
    task: Task, subjects: tuple[str, ...], part: Polytope, shapes: Shapes
) -> dict[str, list[Polytope]]:
    """What the task avoids by name, in the order named, as far as it meets the interior of a part.

    Of a map only the pieces that do so count.
    """
    names = [name for avoid in task.avoid if avoid.subject in subjects for name in avoid.regions]
    found = {
        name: [piece for piece in shapes.parts(name) if interiors_meet(piece, part)]
        for name in names
    }
    return {name: pieces for name, pieces in found.items() if pieces}
