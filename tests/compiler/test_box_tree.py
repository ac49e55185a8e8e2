from __future__ import annotations

from fractions import Fraction
from itertools import pairwise

import pytest
from flint import arb
from hypothesis import given
from hypothesis import strategies as st

from compiler.unreachability.box_tree import (
    LEAF,
    MOST_HALVINGS,
    BoxTreeError,
    ChoiceSide,
    ParameterLeaf,
    Part,
    RangeSide,
    coordinate_boxes,
    parameter_boxes,
    parse,
    text,
)
from tests.oracles.coverings import covering

coordinate_trees = st.recursive(
    st.just((LEAF,)),
    lambda below: st.tuples(st.integers(0, 25), below, below).map(
        lambda node: (node[0], *node[1], *node[2])
    ),
    max_leaves=12,
)
parameter_trees = st.recursive(
    st.builds(ParameterLeaf, st.sampled_from("|!"), coordinate_trees).map(lambda leaf: (leaf,))
    | st.just((ParameterLeaf("$", ()),)),
    lambda below: st.tuples(st.integers(0, 25), below, below).map(
        lambda node: (node[0], *node[1], *node[2])
    ),
    max_leaves=6,
)


@given(parameter_trees, st.randoms(use_true_random=False))
def test_what_is_written_is_read_again_whatever_the_blanks(tree, choose):
    content = text(tree)
    assert parse(content) == tree
    header, _, body = content.partition("\n")
    blanks = "".join(letter + choose.choice(["", " ", "\n", "\t"]) for letter in body)
    assert parse(f"{header}\n{blanks}") == tree
    assert all(len(line) <= 100 for line in content.splitlines())


def test_the_letters_of_a_small_tree():
    tree = parse("boxes 1\nB |a.b.. !.\n")
    assert tree == (1, ParameterLeaf("|", (0, LEAF, 1, LEAF, LEAF)), ParameterLeaf("!", (LEAF,)))
    (one, first), (other, second) = parameter_boxes(tree, 2)
    assert one == (Part(), Part(0, 1))
    assert other == (Part(), Part(1, 1))
    assert list(coordinate_boxes(first.coordinates, 2)) == [
        (Part(0, 1), Part()),
        (Part(1, 1), Part(0, 1)),
        (Part(1, 1), Part(1, 1)),
    ]
    assert list(coordinate_boxes(second.coordinates, 0)) == [()]


@pytest.mark.parametrize(
    ("content", "reason"),
    [
        ("", "first line"),
        ("boxes 2\n|.", "first line"),
        ("|.", "first line"),
        ("boxes 1\n", "too early"),
        ("boxes 1\nA|.", "too early"),
        ("boxes 1\n|a.", "too early"),
        ("boxes 1\n|..", "follows"),
        ("boxes 1\n|.|.", "follows"),
        ("boxes 1\n.", "unexpected `.`"),
        ("boxes 1\n|A..", "unexpected `A`"),
        ("boxes 1\n|ä..", "unexpected `ä`"),
        ("boxes 1\nÄ|.|.", "unexpected `Ä`"),
        ("boxes 1\n|" + "a" * 1_000_001, "more than"),
    ],
)
def test_what_is_no_covering(content, reason):
    with pytest.raises(BoxTreeError, match=reason):
        parse(content)


def test_what_the_robot_does_not_have_is_not_halved():
    for content, parameters in (("boxes 1\nB|.|.", 1), (covering("A", ""), 0)):
        with pytest.raises(BoxTreeError, match="does not have"):
            list(parameter_boxes(parse(content), parameters))
    with pytest.raises(BoxTreeError, match="does not have"):
        list(coordinate_boxes((1, LEAF, LEAF), 1))


def test_a_side_is_not_halved_for_ever():
    deep = [0] * (MOST_HALVINGS + 1) + [LEAF] * (MOST_HALVINGS + 2)
    with pytest.raises(BoxTreeError, match="more than 60 times"):
        list(coordinate_boxes(tuple(deep), 1))


@given(st.integers(-50, 50), st.integers(1, 9), st.integers(0, 20), st.data())
def test_the_parts_of_a_range_cover_it_and_share_their_ends(low, width, halvings, data):
    number = data.draw(st.integers(0, (1 << halvings) - 1))
    ends = RangeSide(arb(low), arb(low + width)).enclosure(Part(number, halvings))
    exact = [low + Fraction(width * n, 1 << halvings) for n in (number, number + 1)]
    assert [Fraction(float(end)) for end in (ends.low, ends.high)] == exact
    halves = Part(number, halvings).halves()
    parts = [RangeSide(arb(low), arb(low + width)).enclosure(half) for half in halves]
    assert (parts[0].low, parts[1].high) == (ends.low, ends.high)
    assert parts[0].high == parts[1].low


def test_a_range_with_irrational_ends_is_covered_by_its_parts():
    side = RangeSide(-arb.pi(), arb(2).sqrt())
    for halvings in range(6):
        parts = [side.enclosure(Part(n, halvings)) for n in range(1 << halvings)]
        assert parts[0].low <= (-arb.pi()).lower()
        assert parts[-1].high >= arb(2).sqrt().upper()
        assert all(a.high >= b.low for a, b in pairwise(parts))


@given(st.integers(1, 40), st.randoms(use_true_random=False))
def test_the_halves_of_a_list_are_in_order_the_first_the_larger(count, choose):
    values = choose.sample(range(1000), count)
    side = ChoiceSide(tuple(map(arb, values)))
    part, left = Part(), values
    while len(left) > 1:
        half = choose.randrange(2)
        middle = (len(left) + 1) // 2
        left = left[middle:] if half else left[:middle]
        part = part.halves()[half]
        first, last = side.chosen(part)
        assert values[first:last] == left
        ends = side.enclosure(part)
        assert (float(ends.low), float(ends.high)) == (min(left), max(left))
    with pytest.raises(BoxTreeError, match="single value"):
        side.chosen(part.halves()[0])


def test_the_tree_of_the_documentation():
    tree = parse("boxes 1\nA|a..|aa...\n")
    (lower, first), (upper, second) = parameter_boxes(tree, 1)
    assert (lower, upper) == ((Part(0, 1),), (Part(1, 1),))
    counts = [len(list(coordinate_boxes(leaf.coordinates, 1))) for leaf in (first, second)]
    assert counts == [2, 3]
