from __future__ import annotations

from fractions import Fraction

import pytest
from hypothesis import given
from hypothesis import strategies as st

from compiler.robots.alignment import Alignment, alignment
from tests.oracles.word_changes import cheapest

MODULES = frozenset("abc")
WORDS = st.lists(st.sampled_from("abcxy"), max_size=7).map(tuple)


def cost(found: Alignment) -> tuple[int, int]:
    return found.distance, found.edges


@given(WORDS, WORDS)
def test_the_cheapest_of_all_common_subsequences(old, new):
    found = alignment(old, new, MODULES)
    assert cost(found) == cheapest(old, new, MODULES)
    assert all(old[i] == new[j] and old[i] in MODULES for i, j in found.kept)
    for kept, changed, word in (
        ([i for i, _ in found.kept], found.removed, old),
        ([j for _, j in found.kept], found.added, new),
    ):
        assert kept == sorted(kept)
        places = [place for place, symbol in enumerate(word) if symbol in MODULES]
        assert sorted([*kept, *changed]) == places


@given(WORDS, WORDS, WORDS)
def test_a_metric(one, two, three):
    def apart(old, new):
        """Modules and edges, as one number in which no number of edges makes a module."""
        modules, edges = cost(alignment(old, new, MODULES))
        return modules + Fraction(edges, 100)

    assert (apart(one, two) == 0) == (one == two)
    assert apart(one, two) == apart(two, one)
    assert apart(one, three) <= apart(one, two) + apart(two, three)


@pytest.mark.parametrize(
    ("old", "new", "kept"),
    [
        # The old links stay the first ones, and the arm is opened once, before the tool.
        ("BJLJLE", "BJLJLJLE", [(0, 0), (1, 1), (2, 2), (3, 3), (4, 4), (5, 7)]),
        ("BJLE", "BJLLE", [(0, 0), (1, 1), (2, 2), (3, 4)]),
        ("BJLLE", "BJLE", [(0, 0), (1, 1), (2, 2), (4, 3)]),
        # One opening rather than two, though an earlier link could stay.
        ("BLE", "BJLLE", [(0, 0), (1, 3), (2, 4)]),
        # Whatever is kept of two that changed places, the first of the old word stays.
        ("BJL", "BLJ", [(0, 0), (1, 2)]),
    ],
)
def test_of_several(old, new, kept):
    assert alignment(old, new, frozenset("BJLE")).kept == tuple(kept)
