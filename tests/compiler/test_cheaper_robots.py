"""Boxes of parameters whose robots have too much of an objective, against single robots in them."""

from __future__ import annotations

from fractions import Fraction
from random import Random

import pytest
from flint import arb

from compiler.expressions.evaluators.balls import ball
from compiler.expressions.evaluators.intervals import Ends
from compiler.objectives.cheaper_robots import CheaperRobots, Less
from compiler.objectives.least_values import Amount, amounts
from compiler.robots.candidate import candidates
from compiler.robots.normal_form import family_of
from grammar_lang.load import load_text
from tests.oracles.least_specs import link, spec

MODULES = {
    "A": "param length in [0.2, 1] m; param wall in [1, 3] mm;",
    "B": "const length = 0.4 m;",
    "C": "param length in {0.9, 0.3, 0.5} m;",
}
BLOCKS = {
    "a": (
        "eps A",
        link("A.length", "A.length * A.wall * 500 kg/m^2", "1 kg - A.length * 0.5 kg/m"),
    ),
    "b": ("eps B", link("B.length", "0.3 kg")),
    "c": ("eps C", link("C.length", "2 kg")),
}  # fmt: skip
TEXT = spec(
    MODULES, BLOCKS, "modules <= 7; minimize sum(length) then mass;",
    accept="matches Base eps Joint eps A eps B eps C eps A eps Hand",
)  # fmt: skip
PROGRAM = load_text(TEXT, "spec.srg").program
assert PROGRAM is not None
TASK = PROGRAM.tasks["Reach"]
LENGTH, MASS = amounts(PROGRAM, TASK)
(ROBOT,) = candidates(family_of(PROGRAM, TASK), 7, None)
RANGES = [(0.2, 1.0), (0.001, 0.003), (0.3, 0.9), (0.2, 1.0), (0.001, 0.003)]
"""Length and wall of the first A, C, length and wall of the second A."""
CHOICES = (0.9, 0.3, 0.5)
"""Of C."""


def length(values: list[float]) -> float:
    return values[0] + 0.4 + values[2] + values[3]


def mass(values: list[float]) -> float:
    tubes = [(values[0], values[1]), (values[3], values[4])]
    return sum(500 * a * b + 1 - a / 2 for a, b in tubes) + 0.3 + 2


def cheaper(*less: Less) -> CheaperRobots:
    assert ROBOT.model is not None
    assert [each.name for each in ROBOT.model.parameters] == [
        "length", "wall", "length", "length", "wall",
    ]  # fmt: skip
    return CheaperRobots(ROBOT.derivation.word, ROBOT.model, less)


def boxes(seed: int, count: int) -> list[list[tuple[float, float]]]:
    draw = Random(seed)
    found = []
    for _ in range(count):
        box = []
        for low, high in RANGES:
            ends = sorted(draw.uniform(low, high) for _ in range(2))
            box.append((low, high) if draw.random() < 0.3 else (ends[0], ends[1]))
        if not any(box[2][0] <= value <= box[2][1] for value in CHOICES):
            box[2] = RANGES[2]
        found.append(box)
    return found


def robot_in(box: list[tuple[float, float]], draw: Random) -> list[float]:
    """Parameters in a box, one of them a single value."""
    values = [draw.uniform(*side) for side in box]
    values[2] = draw.choice([value for value in CHOICES if box[2][0] <= value <= box[2][1]])
    return values


def ends(box: list[tuple[float, float]]) -> list[Ends]:
    return [Ends(arb(low), arb(high)) for low, high in box]


@pytest.mark.parametrize(("amount", "value"), [(LENGTH, length), (MASS, mass)])
def test_the_least_of_a_box_is_no_more_than_that_of_a_robot_in_it(amount: Amount, value) -> None:
    draw, robots = Random(1), cheaper()
    for box in boxes(2, 100):
        least = float(robots.least(amount, ends(box)))
        inside = [value(robot_in(box, draw)) for _ in range(50)]
        assert least <= min(inside) + 1e-12


def test_the_least_of_a_single_robot_is_its_value() -> None:
    draw, robots = Random(3), cheaper()
    for _ in range(20):
        values = robot_in(RANGES, draw)
        point = ends([(value, value) for value in values])
        assert float(robots.least(LENGTH, point)) == pytest.approx(length(values), abs=1e-8)
        assert float(robots.least(MASS, point)) == pytest.approx(mass(values), abs=1e-8)


def test_single_values_are_exact() -> None:
    """No binary number is 0.3, which a side around it is known to have alone."""
    robots = cheaper()
    box = ends(RANGES)
    box[2] = Ends(ball(Fraction("0.3")).lower(), ball(Fraction("0.3")).upper())
    box[0] = box[3] = Ends(arb(0.25), arb(0.25))
    assert robots.least(LENGTH, box) == Fraction("1.2")


@pytest.mark.parametrize("seed", range(3))
def test_what_is_cut_off_has_none_of_them(seed: int) -> None:
    draw = Random(seed)
    kept = excluded = 0
    for box in boxes(seed, 25):
        most, bound = Fraction(draw.uniform(1, 2.2)), Fraction(draw.uniform(2.5, 4.5))
        robots = cheaper(Less((), LENGTH, most), Less(((LENGTH, most + 1),), MASS, bound))
        sides, none = robots.narrowed(ends(box)), robots.none_in(ends(box))
        excluded += none
        for _ in range(60):
            values = robot_in(box, draw)
            short = length(values) < most
            light = length(values) <= most + 1 and mass(values) < bound
            if short or light:
                assert not none
                assert all(
                    side.low <= value <= side.high
                    for side, value in zip(sides, values, strict=True)
                )
                kept += 1
    assert kept > 100
    assert excluded > 0


def test_sums_are_cut_off_where_they_are_too_large() -> None:
    """The first tube has at most what the others leave, to a 64th of its range."""
    robots = cheaper(Less((), LENGTH, Fraction("1.4")))
    first, wall, *_ = robots.narrowed(ends([*RANGES[:2], (0.3, 0.3), *RANGES[3:]]))
    assert 0.5 <= float(first.high) <= 0.5 + 0.8 / 64 + 1e-9
    assert float(first.low) == 0.2
    assert [wall.low, wall.high] == [ball(Fraction(0.001)), ball(Fraction(0.003))]
