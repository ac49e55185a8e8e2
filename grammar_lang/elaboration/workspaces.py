"""Workspaces (Section 3): bounds and named closed convex regions, exact."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from fractions import Fraction
from typing import Literal

from grammar_lang import ir
from grammar_lang import syntax as s
from grammar_lang.diagnostics.codes import Code
from grammar_lang.diagnostics.diagnostic import Sink
from grammar_lang.elaboration.closed import Constants, ListUnit, coordinates, list_unit
from grammar_lang.elaboration.linear import Inequalities
from grammar_lang.names.declarations import duplicate
from grammar_lang.names.entities import map_name
from grammar_lang.source import Span
from grammar_lang.syntax import tasks as t
from grammar_lang.units import LENGTH


@dataclass(frozen=True, slots=True)
class _Shapes:
    """Reads the shapes of a workspace of that dimension."""

    sink: Sink
    size: Literal[2, 3]

    def lower(self, shape: t.Shape) -> ir.Inequalities | ir.Hull | None:
        match shape:
            case t.Box():
                return self._box(shape)
            case t.Polytope():
                return self._polytope(shape)
            case t.Hull():
                return self._hull(shape)

    def _units(self, units: tuple[s.Ident | None, ...]) -> list[ListUnit]:
        """The unit of each part; the last part's stands for those that have none."""
        last = list_unit(units[-1], LENGTH, self.sink)
        own = [last if u is None else list_unit(u, LENGTH, self.sink) for u in units[:-1]]
        return [*own, last]

    def _box(self, box: t.Box) -> ir.Inequalities | None:
        if len(box.sides) != self.size:
            where = "the plane" if self.size == 2 else "space"
            message = f"a box in {where} has {self.size} sides, not {len(box.sides)}"
            hint = f"write `box {' x '.join(['[…]'] * self.size)}`"
            self.sink.error(Code.OUT_OF_PLANE, message, box.span, hint)
            return None
        units = self._units(tuple(side.unit for side in box.sides))
        rows: list[ir.HalfSpace] = []
        for index, (side, unit) in enumerate(zip(box.sides, units, strict=True)):
            rows += self._side(index, side, unit)
        return ir.Inequalities(tuple(rows)) if len(rows) == 2 * self.size else None

    def _side(self, index: int, side: s.Interval, unit: ListUnit) -> list[ir.HalfSpace]:
        """The rows ``-x <= -lower`` and ``x <= upper``; none where an error was reported."""
        reader = Constants(self.sink)
        lower = reader.rational(side.lower, LENGTH, unit)
        upper = reader.rational(side.upper, LENGTH, unit)
        if lower is None or upper is None:
            return []
        if lower > upper:
            self.sink.error(
                Code.EMPTY_INTERVAL,
                "this interval is empty: its lower bound exceeds its upper bound",
                side.span,
                "exchange the bounds",
            )
            return []
        axis = tuple(Fraction(int(i == index)) for i in range(self.size))
        return [
            ir.HalfSpace(tuple(-c for c in axis), -lower, side.lower.span),
            ir.HalfSpace(axis, upper, side.upper.span),
        ]

    def _polytope(self, polytope: t.Polytope) -> ir.Inequalities | None:
        unit = list_unit(polytope.unit, LENGTH, self.sink)
        reader = Inequalities(self.sink, unit, self.size)
        rows = [reader.lower(row) for row in polytope.rows]
        found = tuple(row for row in rows if row is not None)
        return ir.Inequalities(found) if len(found) == len(rows) else None

    def _hull(self, hull: t.Hull) -> ir.Hull | None:
        reader = Constants(self.sink)
        units = self._units(tuple(point.unit for point in hull.points))
        points = [
            coordinates(reader, point.items, unit, LENGTH, self.size, point.span)
            for point, unit in zip(hull.points, units, strict=True)
        ]
        found = tuple(p for p in points if p is not None)
        return ir.Hull(found) if len(found) == len(points) else None


@dataclass(slots=True)
class _Reader:
    sink: Sink
    shapes: _Shapes
    bounds: ir.Region | None = None
    bounded: Span | None = None
    regions: dict[str, ir.Region] = field(default_factory=dict[str, ir.Region])
    names: dict[str, Span] = field(default_factory=dict[str, Span])

    def region(self, item: t.Region) -> None:
        shape = self.shapes.lower(item.shape) or ir.Inequalities(())
        if item.name is None:
            self._bounds(item, shape)
        elif self.named(item.name):
            name = item.name.text
            self.regions[name] = ir.Region(name, item.kind, shape, item.name.span)

    def named(self, name: s.Ident, hint: str = "choose another name") -> bool:
        """Whether a region or map is the first of its name; else that is reported."""
        first = self.names.setdefault(name.text, name.span)
        if first is not name.span:
            duplicate(name, first, self.sink, hint)
        return first is name.span

    def _bounds(self, item: t.Region, shape: ir.Inequalities | ir.Hull) -> None:
        if self.bounded is not None:
            notes = [(self.bounded, "first here")]
            hint = "a workspace has one `bounds`"
            self.sink.error(Code.REPEATED_CLAUSE, "a second `bounds`", item.span, hint, notes)
        else:
            self.bounded = item.span
            self.bounds = ir.Region("bounds", "bounds", shape, item.span)


def _dimension(workspace: t.Workspace, sink: Sink) -> Literal[2, 3]:
    found = [item for item in workspace.items if isinstance(item, t.Dimension)]
    if not found:
        message = f"workspace `{workspace.name.text}` does not say `plane xy` or `space xyz`"
        sink.error(Code.MISSING_CLAUSE, message, workspace.name.span, "add `plane xy;`")
        return 2
    for item in found[1:]:
        notes = [(found[0].span, "first here")]
        sink.error(
            Code.REPEATED_CLAUSE, "a second `plane` or `space`", item.span, "remove one", notes
        )
    return found[0].value


def _map(
    item: t.ObstaclesFrom, size: Literal[2, 3], maps: Mapping[Span, ir.ObstacleMap], sink: Sink
) -> list[ir.ObstacleMap]:
    """The file of obstacles; none where it could not be read, or in space."""
    if size == 3:
        message = "a map of obstacles lies in the plane, this workspace in space"
        hint = "say `plane xy`, or write the obstacles as boxes, polytopes or hulls"
        sink.error(Code.OUT_OF_PLANE, message, item.span, hint)
        return []
    found = maps.get(item.path.span)
    return [] if found is None else [found]


def lower_workspace(
    workspace: t.Workspace, maps: Mapping[Span, ir.ObstacleMap], sink: Sink
) -> ir.Workspace:
    """The workspace; whatever is wrong with it is reported, wrong shapes are left empty."""
    size = _dimension(workspace, sink)
    found: list[ir.ObstacleMap] = []
    reader = _Reader(sink, _Shapes(sink, size))
    for item in workspace.items:
        match item:
            case t.Region():
                reader.region(item)
            case t.ObstaclesFrom():
                name_of_map = s.Ident(map_name(item.path.text), item.path.span)
                if item.path.span not in maps:
                    reader.names.setdefault(name_of_map.text, name_of_map.span)
                elif reader.named(name_of_map, "a map is named after its file: rename one of them"):
                    found += _map(item, size, maps, sink)
            case t.Dimension():
                pass
    if reader.bounds is None:
        message = f"workspace `{workspace.name.text}` has no `bounds`"
        hint = "add `bounds box [0, 5] x [0, 5] m;` or another shape"
        sink.error(Code.MISSING_CLAUSE, message, workspace.name.span, hint)
    bounds = reader.bounds or ir.Region("bounds", "bounds", ir.Inequalities(()))
    regions = tuple(reader.regions.values())
    name, span = workspace.name.text, workspace.span
    return ir.Workspace(name, size, bounds, regions, span, tuple(found))
