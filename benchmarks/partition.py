"""Measure the partition of workspaces into cells, against the library `polytope`.

Random boxes, 16 boxes without 54 others, and tilted rectangles by the hundred.
"""

from __future__ import annotations

import argparse
import logging
import math
import multiprocessing
import random
import sys
from collections.abc import Callable
from fractions import Fraction
from statistics import median
from typing import Any

from timing import HEAD, ROOT, Line, machine, paired, seconds

sys.path.insert(0, str(ROOT))

from compiler.workspaces.abstraction import Abstraction, abstract
from compiler.workspaces.bisection import bisections
from compiler.workspaces.partition import remainder
from compiler.workspaces.polytope import Polytope, polytope_of
from grammar_lang.ir import Hull, Region, Workspace

NEARLY = 1e-6
logging.disable(logging.WARNING)  # the library tells at every start which solver it has not found


# --- worlds --------------------------------------------------------------------------------------


def world(count: int, side: int, *, tilted: bool, seed: int = 0) -> Workspace:
    """Rectangles with sides of 0.4 m to 3 m about random points of a square, in millimetres."""
    rng = random.Random(seed)
    regions = []
    for number in range(count):
        x, y = rng.uniform(0, side), rng.uniform(0, side)
        a, b = rng.uniform(0.2, 1.5), rng.uniform(0.2, 1.5)
        turn = rng.uniform(0, math.pi) if tilted else 0.0
        c, s = math.cos(turn), math.sin(turn)
        signs = ((-1, -1), (1, -1), (1, 1), (-1, 1))
        corners = [(x + p * a * c - q * b * s, y + p * a * s + q * b * c) for p, q in signs]
        regions.append(Region(f"O{number}", "obstacle", _hull(corners)))
    bounds = Region("bounds", "bounds", _hull([(0, 0), (side, 0), (side, side), (0, side)]))
    return Workspace("W", 2, bounds, tuple(regions))


def _hull(corners: list[tuple[float, float]]) -> Hull:
    return Hull(tuple(tuple(Fraction(round(1000 * x), 1000) for x in p) for p in corners))


def shapes_of(workspace: Workspace) -> tuple[Polytope, list[Polytope]]:
    """The bounds, and the regions as they are declared."""
    shapes = [polytope_of(r.shape, 2).irredundant() for r in workspace.regions]
    return polytope_of(workspace.bounds.shape, 2).irredundant(), shapes


# --- the library ---------------------------------------------------------------------------------


def theirs(shape: Polytope) -> Any:
    """A polytope of the library."""
    import polytope

    return polytope.Polytope(shape.A.copy(), shape.b.copy())


def their_pieces(found: Any) -> list[Any]:
    """The full-dimensional polytopes of a result of the library."""
    import polytope

    parts = found.list_poly if isinstance(found, polytope.Region) and len(found) else [found]
    return [part for part in parts if polytope.is_fulldim(part)]


def their_partition(bounds: Any, regions: list[Any]) -> list[Any]:
    """The partition as TuLiP's ``prop2part`` makes it: each piece in and outside of each region."""
    import polytope

    pieces = [bounds]
    for region in regions:
        finer: list[Any] = []
        for piece in pieces:
            common = piece.intersect(region)
            if polytope.is_fulldim(common):
                finer += [common, *their_pieces(piece.diff(region))]
            else:
                finer.append(piece)
        pieces = finer
    return pieces


def their_adjacency(pieces: list[Any]) -> list[tuple[int, int]]:
    """The pairs of pieces that the library calls adjacent."""
    import polytope

    return [
        (i, j)
        for j in range(len(pieces))
        for i in range(j)
        if polytope.is_adjacent(pieces[i], pieces[j])
    ]


def area(pieces: list[Any]) -> float:
    """The area of disjoint polytopes of the library."""
    import polytope
    from scipy.spatial import ConvexHull

    return sum(float(ConvexHull(polytope.extreme(piece)).volume) for piece in pieces)


def agree(found: float, expected: Fraction, what: str) -> None:
    """End the benchmark where an answer of the library is another one."""
    if abs(found - float(expected)) > NEARLY * float(expected):
        raise SystemExit(f"{what}: area {found} instead of {float(expected)}")


# --- measurements --------------------------------------------------------------------------------


def checked(workspace: Workspace) -> Abstraction:
    """The abstraction, with its area compared exactly."""
    found = abstract(workspace)
    whole = polytope_of(workspace.bounds.shape, 2).volume
    if sum(cell.volume for cell in found.cells) != whole:
        raise SystemExit("the cells do not make up the bounds")
    return found


def measure_alone(what: str, workspace: Workspace, runs: int) -> list[Line]:
    """The abstraction of a workspace: cells, facets, adjacency."""
    found = checked(workspace)
    took = median(seconds(lambda: abstract(workspace)) for _ in range(runs))
    free = sum(cell.kind == "free" for cell in found.cells)
    note = f"{len(found.cells)} cells, {free} of them free, {len(found.facets)} facets"
    return [Line(what, runs, took, note=note)]


def measure_boxes(count: int, side: int) -> list[Line]:
    """A partition with its adjacency, ours and the library's; the library's answer is checked."""
    workspace = world(count, side, tilted=False)
    bounds, shapes = shapes_of(workspace)
    pieces: list[Any] = []

    def peer() -> None:
        pieces[:] = their_partition(theirs(bounds), [theirs(shape) for shape in shapes])
        their_adjacency(pieces)

    what = f"{count} random boxes in {side} m, adjacency too"
    (ours,) = measure_alone(what, workspace, 3)
    took = seconds(peer)
    agree(area(pieces), bounds.volume, "partition by polytope")
    note = f"{len(pieces)} cells, {took / ours.wall:.1f} times the line above"
    return [ours, Line("the same with polytope", 1, took, note=note)]


def measure_remainders(runs: int) -> list[Line]:
    """16 boxes without 54 others, as convex pieces."""
    _, shapes = shapes_of(world(70, 10, tilted=False))
    first, others = shapes[:16], shapes[16:]
    expected = sum((p.volume for shape in first for p in remainder(shape, others)), Fraction(0))

    def peer() -> list[Any]:
        # One at a time: without a region of all others its pieces overlap (polytope 0.2.5).
        found: list[Any] = []
        for shape in first:
            pieces = [theirs(shape)]
            for other in others:
                cutter = theirs(other)
                pieces = [part for piece in pieces for part in their_pieces(piece.diff(cutter))]
            found += pieces
        return found

    agree(area(peer()), expected, "difference by polytope")
    names = ("16 boxes without 54 others", "the same with polytope")
    return paired(names, (lambda: [remainder(shape, others) for shape in first], peer), runs)


def measure_tilted(count: int, side: int, limit: float, runs: int) -> list[Line]:
    """Tilted rectangles: ours with adjacency, the library's partition alone, up to a limit."""
    workspace = world(count, side, tilted=True)
    (ours,) = measure_alone(f"{count} tilted in {side} m, adjacency too", workspace, runs)
    took = within(limit, _their_tilted, count, side)
    name = "the same with polytope, no adjacency"
    if took is None:
        note = f"no answer in {limit:.0f} s: over {limit / ours.wall:.0f} times the line above"
        return [ours, Line(name, 1, limit, note=note)]
    return [ours, Line(name, 1, took, note=f"{took / ours.wall:.1f} times the line above")]


def _their_tilted(count: int, side: int) -> float:
    bounds, shapes = shapes_of(world(count, side, tilted=True))
    peers = [theirs(shape) for shape in shapes]
    return seconds(lambda: their_partition(theirs(bounds), peers))


def within(limit: float, action: Callable[..., float], *arguments: object) -> float | None:
    """What a call returns in a process of its own, None if it takes longer than a limit."""
    with multiprocessing.get_context("spawn").Pool(1) as pool:
        try:
            return pool.apply_async(action, arguments).get(timeout=limit)
        except multiprocessing.TimeoutError:
            return None


def measure_cells(count: int) -> list[Line]:
    """Halving the cells of 50 tilted rectangles until there are so many."""
    coarse = checked(world(50, 20, tilted=True))
    took = seconds(lambda: coarse.cut(bisections(coarse, count)))
    finer = coarse.cut(bisections(coarse, count))
    if len(finer.cells) != count or sum(c.volume for c in finer.cells) != 400:
        raise SystemExit("the halves do not make up the bounds")
    note = f"from {len(coarse.cells)}; {len(finer.facets)} facets"
    return [Line(f"halved until there are {count} cells", 1, took, note=note)]


def main() -> None:
    """Print the tables."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--runs", type=int, default=3)
    parser.add_argument("--limit", type=float, default=60.0, help="seconds for the library alone")
    parser.add_argument("--cells", type=int, default=10_000)
    choice = parser.parse_args()
    print(machine())
    print(HEAD, flush=True)
    measurements: list[Callable[[], list[Line]]] = [
        lambda: measure_boxes(16, 10),
        lambda: measure_remainders(choice.runs),
        lambda: measure_alone("70 random boxes in 10 m", world(70, 10, tilted=False), choice.runs),
        lambda: measure_tilted(200, 60, choice.limit, choice.runs),
        lambda: measure_tilted(200, 20, choice.limit, choice.runs),
        lambda: measure_cells(choice.cells),
    ]
    for measurement in measurements:
        for line in measurement():
            print(line, flush=True)


if __name__ == "__main__":
    main()
