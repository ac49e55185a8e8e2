from __future__ import annotations

import random
import time
from fractions import Fraction

import numpy as np
import pytest

from compiler.workspaces.abstraction import abstract
from compiler.workspaces.adjacency import shared_facets
from compiler.workspaces.bisection import bisections, halving, short_between
from compiler.workspaces.partition import Cut
from grammar_lang.ir import Workspace
from tests.oracles.planes import bench, box, row
from tests.oracles.random_worlds import plane_world, space_world


def random_cuts(abstraction, count, seed):
    """Cuts through random inner points of random cells, in random rational directions."""
    rng = random.Random(seed)
    shapes = [cell.polytope for cell in abstraction.cells]
    cuts = []
    for _ in range(count):
        number = rng.randrange(len(shapes))
        normal = [rng.randrange(-3, 4) for _ in range(abstraction.dimension)]
        normal[0] = normal[0] or 1
        offset = sum(a * x for a, x in zip(normal, shapes[number].centre, strict=True))
        cut = Cut(number, row(*normal, offset))
        cuts.append(cut)
        inside, outside = shapes[number].halves(cut.half_space)
        shapes[number] = inside
        shapes.append(outside)
    return tuple(cuts)


@pytest.mark.parametrize("seed", range(8))
@pytest.mark.parametrize("dimension", [2, 3])
def test_cuts_keep_what_was_and_facets_are_those_of_all_cells(seed, dimension):
    if dimension == 2:
        workspace = plane_world(seed, obstacles=6, side=4)
    else:
        workspace = space_world(seed, obstacles=2)
    coarse = abstract(workspace)
    finer, children = coarse.refined(random_cuts(coarse, 12, seed))
    assert len(finer.cells) == len(coarse.cells) + 12
    assert sorted(new for parts in children for new in parts) == list(range(len(finer.cells)))
    for old, parts in zip(coarse.cells, children, strict=True):
        assert sum(finer.cells[new].volume for new in parts) == old.volume
        for new in parts:
            cell = finer.cells[new]
            assert (cell.region, cell.kind, cell.propositions) == (
                old.region, old.kind, old.propositions,
            )  # fmt: skip
            assert old.polytope.contains(cell.polytope)
            assert len(cell.polytope.facets) == len(cell.polytope.rows)
    # the local update agrees with the facets computed from scratch
    assert dict(finer.facets) == shared_facets([cell.polytope for cell in finer.cells])
    assert list(finer.facets) == sorted(finer.facets)


def test_cells_are_named_anew_by_region_and_place():
    coarse = abstract(bench())
    target = coarse.index("T")
    finer = coarse.cut([Cut(target, row(1, 0, "3.9")), Cut(target, row(0, 1, 4))])
    names = [cell.name for cell in finer.cells]
    assert names == ["O", "T.1", "T.2", "T.3", "S", *(f"free.{i}" for i in range(1, 11))]
    assert [cell.volume for cell in finer.cells[1:4]] == [
        Fraction("0.08"), Fraction("0.2"), Fraction("0.21"),
    ]  # fmt: skip
    assert finer.index("T.2") == 2
    # the second cut went to the inner half, which kept the number
    assert finer.numbers[1:4] == (target, len(coarse.cells) + 1, len(coarse.cells))
    assert coarse.cut([]) is coarse


def test_cuts_replay_to_the_same_cells_in_one_go():
    coarse = abstract(bench())
    first = coarse.cut(random_cuts(coarse, 5, 1))
    second = first.cut(random_cuts(first, 7, 2))
    third = second.cut([halving(second, second.index("O"))])
    again = abstract(bench()).cut(third.cuts)
    assert len(third.cuts) == 13
    assert again == third
    assert again.describe() == third.describe()


def test_a_cut_must_meet_the_inside_of_a_cell():
    coarse = abstract(bench())
    obstacle = coarse.index("O")
    for cut, message in (
        (Cut(obstacle, row(1, 0, 3)), "misses"),
        (Cut(obstacle, row(1, 0, 1)), "misses"),
        (Cut(obstacle, row(0, 0, 1)), "misses"),
        (Cut(99, row(1, 0, 2)), "no cell"),
        (Cut(-1, row(1, 0, 2)), "no cell"),
    ):
        with pytest.raises(ValueError, match=message):
            coarse.cut([cut])


def test_halving_a_cell():
    coarse = abstract(bench())
    target = coarse.index("T")  # [3.5, 4.2] x [3.8, 4.5]
    assert halving(coarse, target) == Cut(target, row(1, 0, "3.85"))
    assert halving(coarse, target, (0.0, -2.0)) == Cut(target, row(0, -1, "-4.15"))
    tilted = halving(coarse, target, np.array([1.0, 0.51]))
    assert tilted.half_space.normal == (2, 1)
    parts = [cell for cell in coarse.cut([tilted]).cells if cell.region == "T"]
    assert len(parts) == 2
    for part in parts:
        assert Fraction(2, 5) < part.volume / Fraction("0.49") < Fraction(3, 5)
    with pytest.raises(ValueError, match="zero"):
        halving(coarse, target, (0.0, 0.0))


def test_places_of_cuts_are_short():
    assert short_between(Fraction("1.2"), Fraction("2.9")) == 2
    assert short_between(Fraction(0), Fraction(5)) in (Fraction("2.5"), 2, 3)
    assert short_between(Fraction(1, 3), Fraction(1, 3) + Fraction(1, 10**9)).denominator <= 10**11
    rng = random.Random(0)
    for _ in range(300):
        low = Fraction(rng.randrange(-(10**6), 10**6), rng.randrange(1, 10**5))
        high = low + Fraction(rng.randrange(1, 10**6), rng.randrange(1, 10**8))
        place = short_between(low, high)
        assert abs(place - (low + high) / 2) <= (high - low) / 16
        digits = 0
        while place * 10**digits % 1:
            digits += 1
        if digits:
            scale = 10 ** (digits - 1)
            coarser = Fraction(round((low + high) / 2 * scale), scale)
            assert abs(coarser - (low + high) / 2) > (high - low) / 16


@pytest.mark.parametrize("count", [1, 14, 40, 300])
def test_bisections_always_halve_the_largest(count):
    coarse = abstract(bench())
    cuts = bisections(coarse, count)
    assert cuts == bisections(abstract(bench()), count)
    finer = coarse.cut(cuts)
    assert len(finer.cells) == max(count, len(coarse.cells))
    if cuts:
        # what was halved last was the largest: nothing left is larger, and no part far smaller
        volumes = {n: cell.volume for n, cell in zip(finer.numbers, finer.cells, strict=True)}
        last = volumes[cuts[-1].cell] + volumes[len(finer.cells) - 1]
        assert max(volumes.values()) <= last
        made = {cut.cell for cut in cuts} | set(range(len(coarse.cells), len(finer.cells)))
        assert min(volumes[n] for n in made) > last * Fraction(2, 5)


@pytest.mark.slow
def test_hundreds_of_cells_in_a_moment():
    cube = Workspace("W", 3, box("bounds", "bounds", (0, 2), (0, 2), (0, 2)), ())
    for workspace in (bench(), cube):
        coarse = abstract(workspace)
        started = time.process_time()
        finer = coarse.cut(bisections(coarse, 500))
        assert time.process_time() - started < 5
        assert len(finer.cells) == 500
        assert finer.touches
