"""Minimal conflicts against all subsets by brute force."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations

from hypothesis import example, given
from hypothesis import strategies as st

from solvers.explanation.conflict import minimal_conflict

ITEMS = range(7)
SETS = st.lists(st.frozensets(st.sampled_from(ITEMS)), max_size=4)


def subsets(items: Sequence[int]) -> list[frozenset[int]]:
    return [frozenset(each) for n in range(len(items) + 1) for each in combinations(items, n)]


@given(SETS)
def test_it_is_refuted_and_no_part_of_it_is(conflicts: list[frozenset[int]]) -> None:
    def refuted(kept: Sequence[int]) -> bool:
        return any(conflict <= set(kept) for conflict in conflicts)

    found = minimal_conflict(list(ITEMS), refuted)
    if not conflicts:
        assert found is None
        return
    assert found is not None
    assert refuted(found)
    assert not any(refuted(sorted(part)) for part in subsets(found) if part < frozenset(found))


@example(frozenset(map(frozenset, [{3, 4}, {3, 4, 6}, {3, 4, 5, 6}, {0}, {1}, {2}, {3}, {4}])))
@given(st.frozensets(st.sampled_from(subsets(ITEMS)), max_size=40))
def test_a_refuter_that_gives_up_at_random(answered: frozenset[frozenset[int]]) -> None:
    """More constraints may be harder: what is returned is refuted, and nothing can be spared."""

    def refuted(kept: Sequence[int]) -> bool:
        return frozenset(kept) in answered or len(kept) == len(ITEMS)

    found = minimal_conflict(list(ITEMS), refuted)
    assert found is not None
    assert refuted(found)
    assert not any(refuted([i for i in found if i != spared]) for spared in found)


def test_the_first_of_equals_is_preferred_and_questions_are_few() -> None:
    questions: list[int] = []

    def refuted(kept: Sequence[int]) -> bool:
        questions.append(len(kept))
        return 2 in kept and (5 in kept or 60 in kept)

    assert minimal_conflict(range(64), refuted) == (2, 5)
    assert len(questions) < 30
