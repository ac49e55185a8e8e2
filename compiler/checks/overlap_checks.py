"""Notes about regions of a workspace that overlap; it is allowed, and often not meant."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping
from itertools import islice

from compiler.checks.end_checks import Shapes
from compiler.workspaces.overlaps import candidates, interiors_meet
from compiler.workspaces.polytope import Polytope
from grammar_lang.diagnostics.codes import Code
from grammar_lang.diagnostics.diagnostic import Sink
from grammar_lang.ir import Region, Workspace

REPORTED = 20
CANDIDATE_LIMIT = 5_000


def overlap_diagnostics(
    workspace: Workspace,
    inside: Mapping[str, Polytope],
    told: Collection[tuple[str, str]],
    sink: Sink,
) -> None:
    """Note the pairs of regions whose interiors meet within the bounds.

    Two obstacles may overlap as they like.  The first ``REPORTED`` pairs in order of declaration
    are noted one by one, the others by their number; at most ``CANDIDATE_LIMIT`` pairs whose
    bounding boxes overlap are looked at.

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
        _note(regions[i], regions[j], shapes[i], shapes[j], sink)
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
    """The candidates that there is something to say about."""
    for i, j in candidates(shapes):
        first, second = regions[i], regions[j]
        names = first.name, second.name
        if not (
            (first.kind == "obstacle" and second.kind == "obstacle")
            or names in told
            or names[::-1] in told
        ):
            yield i, j


def _note(first: Region, second: Region, one: Polytope, other: Polytope, sink: Sink) -> None:
    """One pair, at the region that is declared later."""
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
        hint="a point of both has both propositions; move one of them if that is not meant",
        notes=((first.span, f"`{first.name}` is declared here"),),
    )


def map_overlap_diagnostics(
    workspace: Workspace, shapes: Shapes, told: Collection[tuple[str, str]], sink: Sink
) -> None:
    """Note the regions, obstacles aside, whose interiors meet that of a map; each pair once.

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
                    hint="a point of both has both propositions; change one if that is not meant",
                    notes=((found.span, f"`{found.name}` is declared here"),),
                )
