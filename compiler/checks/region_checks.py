"""Diagnostics about single regions, and about the ends of tasks in them."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from typing import Literal

from compiler.workspaces.hull import Point
from compiler.workspaces.inner_offset import inner_offset
from compiler.workspaces.overlaps import interiors_meet
from compiler.workspaces.partition import remainder
from compiler.workspaces.polytope import AXES, Polytope, refuting_polytope
from grammar_lang.diagnostics.diagnostic import Code, Sink
from grammar_lang.ir import NOWHERE, HalfSpace, Hull, Region, Round, StartIn, Task
from grammar_lang.source import Span

# --- Findings about single regions: empty, flat and unbounded sets, with the reason why -----------


def sound_polytope(region: Region, dimension: Literal[2, 3], sink: Sink) -> Polytope | None:
    """The polytope of a region with an interior; if it is the bounds, it must also be bounded.

    Anything else is reported, an unbounded region as a warning.
    """
    shape = refuting_polytope(region.shape, dimension)
    if not shape.has_interior:
        _no_interior(region, shape, sink)
        return None
    if shape.is_bounded:
        return shape
    report = sink.error if region.kind == "bounds" else sink.warning
    tail = "are unbounded"
    if region.kind != "bounds":
        tail = "is unbounded, it counts up to the bounds of the workspace"
    report(
        Code.UNBOUNDED_POLYTOPE,
        f"{_called(region)} {tail}",
        region.span,
        hint=f"add inequalities that close the set towards {', '.join(_open_sides(shape))}",
    )
    return None if region.kind == "bounds" else shape


def _called(region: Region) -> str:
    return "the bounds" if region.kind == "bounds" else f"{region.kind} `{region.name}`"


def _open_sides(shape: Polytope) -> Iterator[str]:
    """The directions along the axes in which a set is unbounded, at least one."""
    for axis, name in enumerate(AXES[: shape.dimension]):
        if shape.extends(axis, -1):
            yield f"-{name}"
        if shape.extends(axis, 1):
            yield f"+{name}"


def _no_interior(region: Region, shape: Polytope, sink: Sink) -> None:
    verb = "have" if region.kind == "bounds" else "has"
    lacking = "no point" if shape.is_empty else "no interior"
    code = Code.EMPTY_POLYTOPE if shape.is_empty else Code.FLAT_POLYTOPE
    notes: list[tuple[Span, str]] = []
    if isinstance(region.shape, Hull):
        reason, hint = _flat_hull(region.shape.points, shape)
    else:
        # A round region has an interior.
        rows = () if isinstance(region.shape, Round) else region.shape.rows
        reason, hint, notes = _contradiction(rows, shape)
    sink.error(code, f"{_called(region)} {verb} {lacking}: {reason}", region.span, hint, notes)


def _flat_hull(points: Sequence[Point], shape: Polytope) -> tuple[str, str]:
    """Why a hull has no interior, and what would give it one."""
    where = {0: "are all the same", 1: "lie on one line", 2: "lie in one plane"}
    reason = f"its points {where[shape.affine_dimension]}" if len(points) > 1 else "it is one point"
    repeated = len(points) - len(set(points))
    if repeated and shape.affine_dimension:
        reason += f", {repeated} of them {'is' if repeated == 1 else 'are'} repeated"
    needed = "three points that are not on one line"
    if shape.dimension == 3:
        needed = "four points that are not in one plane"
    return reason, f"a hull needs {needed}"


def _contradiction(
    rows: Sequence[HalfSpace], shape: Polytope
) -> tuple[str, str, list[tuple[Span, str]]]:
    """The reason why inequalities leave nothing, a hint, and a few contradicting ones as notes."""
    if shape.is_empty:
        few = irreducible_rows(rows, lambda part: part.is_empty)
        does = "contradict each other" if len(few) > 1 else "never holds"
        hint = "change one of the inequalities marked here: check signs and units"
    else:
        few = irreducible_rows(rows, lambda part: not part.has_interior)
        does = "leave no room between them"
        hint = f"a region needs a positive {'area' if shape.dimension == 2 else 'volume'}"
    reason = f"{len(few)} of its {len(rows)} inequalities {does}"
    if len(few) == len(rows):
        reason = f"its inequalities {does}" if len(rows) > 1 else f"its inequality {does}"
    notes: dict[Span, list[str]] = {}
    for row in few:
        if row.span != NOWHERE:
            notes.setdefault(row.span, []).append(f"`{_inequality(row)}`")
    said = [(span, f"asks for {' and '.join(texts)}, in metres") for span, texts in notes.items()]
    return reason, hint, said


def _inequality(row: HalfSpace) -> str:
    """A row as text; for a bound of one coordinate, only the coordinate on the left."""
    terms = [(axis, entry) for axis, entry in zip(AXES, row.normal, strict=False) if entry]
    if len(terms) != 1:
        return Polytope((row,)).inequalities()[0]
    axis, entry = terms[0]
    return f"{axis} {'<=' if entry > 0 else '>='} {row.offset / entry}"


# --- Few inequalities that already contradict each other, or that leave no interior ---------------
#
# Source: Chinneck, *Feasibility and Infeasibility in Optimization* (2008), section 6.2 (additive
# method), with the bisection of Junker, *QuickXplain* (2004). By Helly's theorem an irreducible set
# of half-spaces in dimension d without a common point has at most d + 1 members; the same is true
# for their interiors.


def irreducible_rows(
    rows: Sequence[HalfSpace], fails: Callable[[Polytope], bool]
) -> tuple[HalfSpace, ...]:
    """A subset of the rows for which ``fails`` holds and that is irreducible, in the order given.

    Args:
        rows: half-spaces of one dimension for which ``fails`` holds.
        fails: a test that more rows can only make true, such as emptiness.
    """
    kept: list[int] = []
    pending = range(len(rows))
    while not kept or not fails(_polytope(rows, kept)):
        low, high = 1, len(pending)
        while low < high:
            middle = (low + high) // 2
            if fails(_polytope(rows, [*kept, *pending[:middle]])):
                high = middle
            else:
                low = middle + 1
        kept.append(pending[low - 1])
        pending = pending[: low - 1]
    return tuple(rows[i] for i in sorted(kept))


def _polytope(rows: Sequence[HalfSpace], chosen: Sequence[int]) -> Polytope:
    return Polytope(tuple(rows[i] for i in chosen))


# --------------------------------------------------------------------------------------------------
# Findings about the ends of tasks: what bounds and avoided regions leave of start and target.
#
# The rules are those of the language reference, "Geometry": sets are closed, `bounds` constrains
# every effector, and a region that the task starts in or reaches must leave room outside what it
# avoids.


LISTED = 5


@dataclass(frozen=True, slots=True)
class Shapes:
    """The sound polytopes of a workspace, and the parts of the regions within the bounds.

    The parts are given by their facets; a region without an interior within the bounds has no part.
    ``maps`` are the pieces of the maps that have an interior within the bounds.
    """

    bounds: Polytope
    regions: Mapping[str, Polytope]
    inside: Mapping[str, Polytope]
    maps: Mapping[str, Sequence[Polytope]] = field(default_factory=dict[str, Sequence[Polytope]])

    def parts(self, name: str) -> Sequence[Polytope]:
        """The parts that a region or a map excludes if it is avoided."""
        return [self.inside[name]] if name in self.inside else self.maps.get(name, ())


@dataclass(frozen=True, slots=True)
class End:
    """The start or the reach clause of a task, or an end of a carried load, with its region."""

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
    for carry in task.carries:
        for name in (carry.source, carry.target):
            if name in regions:
                region = regions[name]
                yield End("place of the load", region, carry.span, Code.TARGET_IN_OBSTACLE)


def end_diagnostics(task: Task, end: End, shapes: Shapes, sink: Sink) -> None:
    """Report an end that is wholly (error) or partly (warning) outside the bounds or avoided."""
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
            f"a part of the {end.role} `{name}` lies outside the bounds and has no effect",
            end.span,
            hint="shrink it, or widen the bounds",
            notes=declared,
        )
    _blocked(task, end, shapes, sink)


def _blocked(task: Task, end: End, shapes: Shapes, sink: Sink) -> None:
    """Report what the avoided regions leave of an end; only `with effector` constrains it."""
    part = shapes.inside[end.region.name]
    nearby = _avoided(task, ("effector", "body"), part, shapes)
    if not nearby:
        return
    binding = _avoided(task, ("effector",), part, shapes)
    name, notes = end.region.name, ((end.region.span, f"`{end.region.name}` is declared here"),)
    if cover := _cover(part, binding):
        message = (
            f"the {end.role} `{name}` lies wholly inside {cover.text}, which {cover.verb} avoided"
        )
        sink.error(end.code, message, end.span, f"move `{name}`, or {cover.remedy}", notes)
    elif cover := _cover(part, nearby):
        sink.warning(
            end.code,
            f"the {end.role} `{name}` lies wholly inside {cover.text}, which the body avoids",
            end.span,
            "only an effector that is not part of a body can be there",
            notes,
        )
    elif met := [avoided for avoided in nearby if avoided.pieces]:
        sink.warning(
            Code.REGION_PARTLY_BLOCKED,
            f"a part of the {end.role} `{name}` lies inside {_listed(met)}, "
            f"which {'are' if len(met) > 1 else 'is'} avoided",
            end.span,
            f"move `{name}`, or avoid less",
            notes,
        )


@dataclass(frozen=True, slots=True)
class _Avoided:
    """A region or map that is avoided near an end of a task.

    ``pieces`` are those of its own that meet the interior of the end, ``zone`` the same with the
    margin around them.
    """

    name: str
    pieces: Sequence[Polytope]
    zone: Sequence[Polytope]


def _avoided(
    task: Task, subjects: tuple[str, ...], part: Polytope, shapes: Shapes
) -> list[_Avoided]:
    """The sets that the task avoids and whose zones meet the interior of a part, in order."""
    margins: dict[str, Fraction] = {}
    for avoid in task.avoid:
        if avoid.subject in subjects:
            for name in avoid.regions:
                margins[name] = max(avoid.margin, margins.get(name, avoid.margin))
    found: list[_Avoided] = []
    for name, margin in margins.items():
        near = [piece for piece in shapes.parts(name) if _boxes_meet(piece, part, margin)]
        zone = [
            grown for piece in near if interiors_meet(grown := inner_offset(piece, margin), part)
        ]
        if zone:
            met = [piece for piece in near if interiors_meet(piece, part)]
            found.append(_Avoided(name, met, zone))
    return found


def _boxes_meet(first: Polytope, second: Polytope, margin: Fraction) -> bool:
    """Whether the bounding boxes, the first grown by a margin, have a common interior point."""
    spans = zip(*first.vertices, strict=True), zip(*second.vertices, strict=True)
    return all(
        min(ours) - margin < max(theirs) and min(theirs) < max(ours) + margin
        for ours, theirs in zip(*spans, strict=True)
    )


@dataclass(frozen=True, slots=True)
class _Cover:
    """Sets that cover an end, in words, and what to do about it."""

    text: str
    verb: str
    remedy: str


def _cover(part: Polytope, avoided: Sequence[_Avoided]) -> _Cover | None:
    """The sets that cover a polytope, alone or with their margins; None if they do not."""
    met = [one for one in avoided if one.pieces]
    if _covered(part, [piece for one in met for piece in one.pieces]):
        return _Cover(_listed(met), "are" if len(met) > 1 else "is", "avoid less")
    if _covered(part, [piece for one in avoided for piece in one.zone]):
        remedy = "ask for a smaller margin"
        if len(avoided) > 1:
            return _Cover(f"{_listed(avoided)} with their margins", "are", remedy)
        return _Cover(f"{_listed(avoided)} with its margin", "is", remedy)
    return None


def _listed(avoided: Sequence[_Avoided]) -> str:
    """The first names, and how many more there are."""
    shown = ", ".join(f"`{one.name}`" for one in avoided[:LISTED])
    rest = len(avoided) - LISTED
    return f"{shown} and {rest} more" if rest > 0 else shown


def _covered(part: Polytope, regions: Sequence[Polytope]) -> bool:
    """Whether the union of regions covers a polytope."""
    common = (part.intersection(region).volume for region in regions)
    # Cutting the part into pieces is expensive, and useless if the total volume is too small.
    return sum(common, Fraction(0)) >= part.volume and not remainder(part, regions)
