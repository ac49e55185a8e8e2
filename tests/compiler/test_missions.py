"""What rebuilding robots costs, cheapest chains, and boxes of parameters, against brute force."""

from __future__ import annotations

import random
from collections.abc import Iterator
from fractions import Fraction
from itertools import pairwise, product

import pytest

from compiler.missions.chains import ChainCosts, Link, cheapest_chain, word_costs
from compiler.missions.parameter_boxes import BoxTree, Cut, choices_halved, parts
from compiler.missions.parameter_ranges import Range, Ranges, meet, ranges_of, single
from compiler.missions.robot_changes import Built, BuiltModule, changes, cost_of_changes
from grammar_lang import ir
from tests.oracles.mission_robots import keeping

NAMES = "ABC"
Robot = list[tuple[str, dict[str, list[tuple[int, int]]]]]
"""Modules with the parameters that are known: each a union of open or closed whole intervals."""
PRICES = [
    ("1", "1", "0"),
    ("2", "1", "1/2"),
    ("0", "1/3", "5"),
    ("0.25", "3.5", "0.1"),
    ("0", "0", "0"),
]


def drawn(choose: random.Random, most: int) -> Robot:
    """A robot of some modules, of which A and B have parameters."""
    found: Robot = []
    for _ in range(choose.randrange(most + 1)):
        name, values = choose.choice(NAMES), dict[str, list[tuple[int, int]]]()
        for parameter in {"A": "pq", "B": "p", "C": ""}[name]:
            if choose.random() < 0.8:
                ends = [sorted(choose.sample(range(6), 2)) for _ in range(choose.choice([1, 1, 2]))]
                values[parameter] = [(low, high) for low, high in ends]
                if choose.random() < 0.5:
                    values[parameter] = [(low, low) for low, _ in values[parameter]]
        found.append((name, values))
    return found


def built(robot: Robot) -> Built:
    return tuple(
        BuiltModule(
            name,
            {
                parameter: tuple(Range(Fraction(low), Fraction(high)) for low, high in spans)
                for parameter, spans in values.items()
            },
        )
        for name, values in robot
    )


def least(old: Robot, new: Robot, prices: ir.Prices, free: set[tuple[str, str]]) -> Fraction:
    """The least cost over all alignments."""
    costs = list[Fraction]()
    for pairs in keeping([name for name, _ in old], [name for name, _ in new]):
        apart = [
            (old[i][0], p)
            for i, j in pairs
            for p, spans in old[i][1].items()
            if p in new[j][1]
            and not any(a <= d and c <= b for a, b in spans for c, d in new[j][1][p])
        ]
        if set(apart) <= free:
            gone, come = len(old) - len(pairs), len(new) - len(pairs)
            costs.append(prices.remove * gone + prices.add * come + prices.change * len(apart))
    return min(costs)


def cases(count: int, seed: str) -> Iterator[tuple[Robot, Robot, ir.Prices, set[tuple[str, str]]]]:
    choose = random.Random(seed)
    for _ in range(count):
        prices = ir.Prices(*map(Fraction, choose.choice(PRICES)))
        free = {each for each in [("A", "p"), ("A", "q"), ("B", "p")] if choose.random() < 0.4}
        yield drawn(choose, 4), drawn(choose, 4), prices, free


def test_changes_against_all_alignments() -> None:
    for old, new, prices, free in cases(300, "changes"):
        cost = least(old, new, prices, free)
        assert cost_of_changes(built(old), built(new), prices, free) == cost
        way = changes(built(old), built(new), prices, free)
        assert way.cost == cost
        check_way(way.kept, way.removed, way.added, len(old), len(new))
        assert cost == (
            prices.remove * len(way.removed)
            + prices.add * len(way.added)
            + prices.change * len(way.changed)
        )
        assert {(old[i][0], p) for i, _, p in way.changed} <= free
        assert all(old[i][0] == new[j][0] for i, j in way.kept)


def check_way(
    kept: tuple[tuple[int, int], ...], removed: tuple[int, ...], added: tuple[int, ...],
    n: int, m: int,
) -> None:  # fmt: skip
    """Every module is in one place, and those that are kept are in order."""
    assert sorted([*removed, *(i for i, _ in kept)]) == list(range(n))
    assert sorted([*added, *(j for _, j in kept)]) == list(range(m))
    assert [j for _, j in kept] == sorted(j for _, j in kept)
    assert [i for i, _ in kept] == sorted(i for i, _ in kept)


def test_equal_robots_are_kept_whole() -> None:
    robot = built([("A", {"p": [(1, 1)]}), ("A", {"p": [(2, 2)]}), ("C", {})])
    way = changes(robot, robot, ir.Prices(), frozenset())
    assert way.kept == ((0, 0), (1, 1), (2, 2))
    assert way.cost == 0


def test_a_length_that_is_hardly_another_one_is_another_one() -> None:
    old, new = (
        (BuiltModule("A", {"p": single(Fraction(1) + shift)}),)
        for shift in (Fraction(0), Fraction(1, 10**9))
    )
    prices = ir.Prices(Fraction(2), Fraction(1), Fraction(1, 2))
    assert changes(old, new, prices, {("A", "p")}).changed == ((0, 0, "p"),)
    assert cost_of_changes(old, new, prices, {("A", "p")}) == Fraction(1, 2)
    assert cost_of_changes(old, new, prices, {("B", "p")}) == 3
    assert cost_of_changes(old, new, prices, frozenset()) == 3


# --- words and chains -----------------------------------------------------------------------------


def test_costs_of_words_against_all_alignments() -> None:
    choose = random.Random("words")
    words = [tuple(choose.choices(NAMES, k=choose.randrange(5))) for _ in range(16)]
    for add, remove in [(1, 1), (3, 2), (0, 5), (7, 0)]:
        costs = word_costs(words, words[::-1], add, remove)
        prices = ir.Prices(Fraction(add), Fraction(remove))
        for (i, old), (j, new) in product(enumerate(words), enumerate(words[::-1])):
            one, other = ([(name, {}) for name in word] for word in (old, new))
            assert costs[i, j] == least(one, other, prices, set())


def test_cheapest_chains_against_all_chains() -> None:
    choose = random.Random("chains")
    for _, _, prices, free in cases(50, "prices of chains"):
        layers = [
            [(drawn(choose, 3), choose.randrange(4)) for _ in range(choose.randint(1, 4))]
            for _ in range(choose.randint(1, 4))
        ]
        existing = drawn(choose, 3) if choose.random() < 0.5 else None
        given = None if existing is None else Link(built(existing), narrow=True)
        links = [[Link(built(r), rank, narrow=True) for r, rank in layer] for layer in layers]
        blocked = [
            (k, choose.randrange(len(layers[k])), choose.randrange(len(layers[k + 1])))
            for k in range(len(layers) - 1)
            for _ in range(choose.randrange(3))
        ]
        found = cheapest_chain(ChainCosts(prices, free, given), links, blocked)
        every = list[tuple[Fraction, int]]()
        for way in product(*(range(len(layer)) for layer in layers)):
            robots = [layer[i][0] for layer, i in zip(layers, way, strict=True)]
            steps = list(pairwise(way))
            if any((k, i, j) in blocked for k, (i, j) in enumerate(steps)):
                continue
            cost = sum(
                (least(a, b, prices, free) for a, b in pairwise(robots)),
                Fraction(0),
            )
            cost += 0 if existing is None else least(existing, robots[0], prices, free)
            every.append((cost, sum(layer[i][1] for layer, i in zip(layers, way, strict=True))))
        if found is None:
            assert not every
        else:
            ranks = sum(layer[i][1] for layer, i in zip(layers, found.robots, strict=True))
            assert (found.cost, ranks) == min(every)


def test_words_bound_what_robots_cost_whose_parameters_are_not_known() -> None:
    old, new = ([("A", {"p": [(1, 1)]})], [("A", {"p": [(2, 2)]})])
    costs = ChainCosts(ir.Prices(), frozenset())
    for narrow, cost in [((True, True), 2), ((True, False), 0), ((False, True), 0)]:
        layers = [[Link(built(r), narrow=n)] for r, n in zip((old, new), narrow, strict=True)]
        found = cheapest_chain(costs, layers)
        assert found is not None
        assert found.cost == cost


@pytest.mark.parametrize("price", ["1000000000.000000001", "1e18", "123456789012.123456789"])
def test_prices_of_many_digits(price: str) -> None:
    """Costs as whole numbers, times the ranks of robots, are beyond 64 bits."""
    prices = ir.Prices(Fraction(price), Fraction("0.000000007"))
    robots = [[("A", {})], [("C", {})]]
    layers = [[Link(built(robot), 900 + n) for n in range(3)] for robot in robots]
    found = cheapest_chain(ChainCosts(prices, frozenset()), layers)
    assert found is not None
    assert found.cost == Fraction(price) + Fraction("0.000000007")


def test_a_layer_without_robots_has_no_chain() -> None:
    robot = Link(built([("A", {})]))
    costs = ChainCosts(ir.Prices(), frozenset())
    assert cheapest_chain(costs, [[robot], []]) is None
    assert cheapest_chain(costs, [[robot], [robot]], [(0, 0, 0)]) is None


# --- ranges and boxes -----------------------------------------------------------------------------


def has(range_: Range, value: Fraction) -> bool:
    above = range_.low < value or (value == range_.low and not range_.low_open)
    return above and (value < range_.high or (value == range_.high and not range_.high_open))


def test_ranges_meet_where_they_have_a_value_in_common() -> None:
    """Values at quarters are enough: ends are whole numbers."""
    values = [Fraction(k, 4) for k in range(-4, 20)]
    spans = [
        Range(Fraction(low), Fraction(high), left, right)
        for low, high in [(0, 0), (0, 1), (1, 2), (1, 3), (2, 2)]
        for left, right in product([False, True], repeat=2)
    ]
    for one, other in product(spans, repeat=2):
        common = any(has(one, v) and has(other, v) for v in values)
        assert one.meets(other) is common, (one, other)
        assert meet((one,), (Range(Fraction(9), Fraction(9)), other)) is common


def box() -> tuple[ir.Interval | ir.Choices, ...]:
    choices = ir.Choices(tuple(ir.Num(Fraction(k)) for k in (1, 2, 4, 7)))
    return ir.Interval(ir.Num(Fraction(0)), ir.Num(Fraction(8))), choices


def test_random_trees_part_their_box() -> None:
    """A value is refuted exactly if all leaves that have it are; open leaves have all others."""
    choose = random.Random("trees")
    places = [(Fraction(k, 4), Fraction(c)) for k in range(33) for c in (1, 2, 4, 7)]
    for _ in range(20):
        tree = BoxTree(box())
        for _ in range(choose.randrange(7)):
            leaf = choose.choice(list(tree.leaves()))
            side = choose.randrange(2)
            at = Fraction(choose.randrange(1, 8)) if not side else choose.randrange(1, 4)
            try:
                leaf.split(Cut(side, at))
            except ValueError:
                assert not can_be_cut(leaf, side, at)
        for leaf in tree.leaves():
            leaf.refuted = choose.random() < 0.5
        for place in places:
            holders = [leaf for leaf in tree.leaves() if is_in(closed(leaf), place)]
            assert holders
            is_open = all(not leaf.refuted for leaf in holders)
            stated = [leaf for leaf in tree.open_leaves() if is_in(leaf.ranges(), place)]
            if is_open:
                assert stated
            if not any(not leaf.refuted for leaf in holders):
                assert not stated
        assert tree.is_refuted is all(leaf.refuted for leaf in tree.leaves())


def closed(leaf: BoxTree) -> tuple[Ranges, ...]:
    return tuple(map(ranges_of, leaf.box))


def is_in(ranges: tuple[Ranges, ...], place: tuple[Fraction, Fraction]) -> bool:
    return all(any(has(r, v) for r in some) for some, v in zip(ranges, place, strict=True))


def can_be_cut(leaf: BoxTree, side: int, at: Fraction | int) -> bool:
    domain = leaf.box[side]
    if isinstance(domain, ir.Choices):
        return 0 < at < len(domain.values)
    (own,) = ranges_of(domain)
    return own.low < at < own.high


def test_an_end_is_open_once_the_other_part_is_refuted() -> None:
    tree = BoxTree(box())
    low, high = tree.split(Cut(0, Fraction(3)))
    assert low.ranges()[0] == (Range(Fraction(0), Fraction(3)),)
    high.refuted = True
    assert low.ranges()[0] == (Range(Fraction(0), Fraction(3), high_open=True),)
    one, other = low.split(Cut(0, Fraction(1)))
    one.refuted = True
    assert other.ranges()[0] == (Range(Fraction(1), Fraction(3), low_open=True, high_open=True),)
    assert tree.open_leaves() == [other]


@pytest.mark.parametrize(
    "cut",
    [
        Cut(0, Fraction(0)), Cut(0, Fraction(8)), Cut(0, Fraction(9)), Cut(0, 3), Cut(1, 0),
        Cut(1, 4), Cut(1, Fraction(2)), Cut(2, Fraction(1)), Cut(-1, 1),
    ],
)  # fmt: skip
def test_cuts_that_are_none(cut: Cut) -> None:
    with pytest.raises(ValueError, match=r"cut in two|no such parameter"):
        parts(box(), cut)


def test_the_longest_choices_are_halved() -> None:
    tree = BoxTree(box())
    waiting, values = [tree], list[str]()
    while waiting:
        leaf = waiting.pop(0)
        cut = choices_halved(leaf.box)
        if cut is None:
            values += map(str, leaf.box[1].values)  # type: ignore[union-attr]
        else:
            waiting = [*leaf.split(cut), *waiting]
    assert len(values) == len(set(values)) == 4
    assert choices_halved(()) is None
