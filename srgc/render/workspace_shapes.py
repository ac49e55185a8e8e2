"""The sets of a workspace as corners and edges: bounds, cells, regions, obstacles and targets."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from compiler.geometry.abstraction import Abstraction
from compiler.geometry.polytope import Polytope, polytope_of
from compiler.geometry.volume import around
from grammar_lang.ir import Workspace

Array = NDArray[np.float64]
ShapeKind = Literal["bounds", "cell", "region", "obstacle", "target"]


@dataclass(frozen=True, slots=True)
class WorkspaceShape:
    """A convex polytope to be drawn.

    ``corners`` has shape (m, d), in the plane in order round it; ``edges`` are pairs of corners.
    ``label`` is empty where a piece of a map is not the first.
    """

    kind: ShapeKind
    name: str
    label: str
    corners: Array
    edges: tuple[tuple[int, int], ...]


def workspace_shapes(workspace: Workspace, cells: Abstraction) -> tuple[WorkspaceShape, ...]:
    """Bounds, cells, then regions, in the order in which they are drawn.

    Of a region that has no end, the part within the bounds; empty ones and flat ones are left out.
    """
    bounds = polytope_of(workspace.bounds.shape, workspace.dimension)
    found = [_shape("bounds", "bounds", "", bounds)]
    found += [_shape("cell", cell.name, "", cell.polytope) for cell in cells.cells]
    found += _regions(workspace, bounds)
    return tuple(found)


def _regions(workspace: Workspace, bounds: Polytope) -> Iterator[WorkspaceShape]:
    named: set[str] = set()
    for region in workspace.regions:
        polytope = polytope_of(region.shape, workspace.dimension)
        if not polytope.is_bounded:
            polytope = polytope.intersection(bounds)
        if polytope.is_empty or not polytope.has_interior:
            continue
        name = region.name.partition(".")[0]
        yield _shape(region.kind, region.name, "" if name in named else name, polytope)
        named.add(name)


def _shape(kind: ShapeKind, name: str, label: str, polytope: Polytope) -> WorkspaceShape:
    corners = polytope.vertices
    places = {corner: number for number, corner in enumerate(corners)}
    if polytope.dimension == 2:
        rims = [corners]
    else:
        whole = polytope.irredundant()
        rims = [around([vertex.point() for vertex in whole.face(i)]) for i in whole.facets]
    edges = {
        (min(places[a], places[b]), max(places[a], places[b]))
        for rim in rims
        for a, b in pairwise((*rim, rim[0]))
    }
    return WorkspaceShape(kind, name, label, np.array(corners, dtype=float), tuple(sorted(edges)))
