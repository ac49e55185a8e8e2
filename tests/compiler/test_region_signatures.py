from __future__ import annotations

from fractions import Fraction
from itertools import product

from hypothesis import given, settings
from hypothesis import strategies as st

from compiler.tasks.region_signatures import region_signatures
from compiler.workspaces.polytope import Polytope
from grammar_lang.ir import HalfSpace

SIDE = 4


def box(x0: int, x1: int, y0: int, y1: int) -> Polytope:
    rows = [((-1, 0), -x0), ((1, 0), x1), ((0, -1), -y0), ((0, 1), y1)]
    return Polytope(
        tuple(HalfSpace(tuple(map(Fraction, normal)), Fraction(b)) for normal, b in rows)
    )


SPAN = st.tuples(st.integers(-1, SIDE), st.integers(1, 3)).map(lambda p: (p[0], p[0] + p[1]))


@settings(deadline=None, max_examples=60)
@given(st.lists(st.tuples(SPAN, SPAN), max_size=4))
def test_signatures_of_boxes(spans: list[tuple[tuple[int, int], tuple[int, int]]]) -> None:
    """Boxes with whole corners: the multiples of 1/2 meet every cell of the arrangement."""
    points = [Fraction(k, 2) for k in range(2 * SIDE + 1)]
    expected = {
        sum(
            1 << k
            for k, ((x0, x1), (y0, y1)) in enumerate(spans)
            if x0 <= x <= x1 and y0 <= y <= y1
        )
        for x, y in product(points, points)
    }
    regions = [box(*xs, *ys) for xs, ys in spans]
    found = region_signatures(box(0, SIDE, 0, SIDE), regions, 64)
    assert found is not None
    assert found == tuple(sorted(found))
    assert set(found) >= expected
    flat = {bits for bits in found if bits not in expected}
    # Only what has no interior may be kept although other regions cover it together.
    for bits in flat:
        cell = box(0, SIDE, 0, SIDE)
        for k, region in enumerate(regions):
            if bits >> k & 1:
                cell = cell.intersection(region)
        assert not cell.has_interior


def test_an_unbounded_region_and_one_outside() -> None:
    half = Polytope((HalfSpace((Fraction(1), Fraction(0)), Fraction(2)),))
    assert region_signatures(box(0, 4, 0, 4), [half, box(8, 9, 0, 1)], 64) == (0, 1)


def test_two_regions_cover_a_third() -> None:
    regions = [box(1, 3, 1, 2), box(0, 2, 0, 4), box(2, 4, 0, 4)]
    found = region_signatures(box(-1, 5, -1, 5), regions, 64)
    assert found == (0b000, 0b010, 0b011, 0b100, 0b101, 0b110, 0b111)


def test_too_many() -> None:
    regions = [box(k, k + 9, 0, 9) for k in range(8)]
    assert region_signatures(box(0, 20, 0, 20), regions, 4) is None
