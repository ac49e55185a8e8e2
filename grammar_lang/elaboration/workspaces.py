"""Workspaces (Section 3): bounds and named closed convex regions, all exact."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal

from grammar_lang import ir
from grammar_lang import syntax as s
from grammar_lang.diagnostics.diagnostic import Code, Sink
from grammar_lang.elaboration.region_shapes import RegionShapes
from grammar_lang.elaboration.scenes import placed
from grammar_lang.names.declarations import duplicate, map_name
from grammar_lang.source import Span
from grammar_lang.syntax import tasks as t


@dataclass(slots=True)
class _Reader:
    sink: Sink
    shapes: RegionShapes
    bounds: ir.Region | None = None
    bounded: Span | None = None
    regions: dict[str, ir.Region] = field(default_factory=dict[str, ir.Region])
    names: dict[str, Span] = field(default_factory=dict[str, Span])

    def region(self, item: t.Region) -> None:
        shape = self.shapes.lower(item.shape, item.kind) or ir.Inequalities(())
        if item.name is None:
            self._bounds(item, shape)
        elif self.named(item.name):
            name = item.name.text
            self.regions[name] = ir.Region(name, item.kind, shape, item.name.span)

    def named(self, name: s.Ident, hint: str = "choose another name") -> bool:
        """Whether a region or map is the first of its name; reported if not."""
        first = self.names.setdefault(name.text, name.span)
        if first is not name.span:
            duplicate(name, first, self.sink, hint)
        return first is name.span

    def _bounds(self, item: t.Region, shape: ir.RegionShape) -> None:
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


def lower_workspace(
    workspace: t.Workspace, maps: Mapping[Span, ir.ObstacleMap], sink: Sink
) -> ir.Workspace:
    """The workspace; errors in it are reported, and wrong shapes are left empty."""
    size = _dimension(workspace, sink)
    found: list[ir.ObstacleMap] = []
    reader = _Reader(sink, RegionShapes(sink, size))
    for item in workspace.items:
        match item:
            case t.Region():
                reader.region(item)
            case t.ObstaclesFrom():
                name_of_map = s.Ident(map_name(item.path.text), item.path.span)
                if item.path.span not in maps:
                    reader.names.setdefault(name_of_map.text, name_of_map.span)
                elif reader.named(name_of_map, "a map is named after its file: rename one of them"):
                    made = placed(item, size, maps[item.path.span], sink)
                    found += [] if made is None else [made]
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


def check_round(
    name: s.Ident,
    workspace: ir.Workspace | None,
    kinds: tuple[ir.RegionKind, ...],
    rule: str,
    sink: Sink,
) -> None:
    """Report a round region of another kind, whose polytope may be on the wrong side of it.

    ``rule`` says what a round region has to be here.
    """
    for region in () if workspace is None else workspace.regions:
        round_one = region.name == name.text and isinstance(region.shape, ir.Round)
        if round_one and region.kind not in kinds:
            message = f"`{name.text}` is a round `{region.kind}`; {rule}"
            hint = "declare it as a box, a polytope or a hull"
            if kinds:
                hint = f"write `{kinds[0]} {name.text}` where it is declared"
            notes = [(region.span, "declared here")]
            sink.error(Code.WRONG_KIND, message, name.span, hint, notes)
