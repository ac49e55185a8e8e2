"""What robots have of an objective, and the least that their structures can have of it."""

from __future__ import annotations

import random
from dataclasses import replace
from fractions import Fraction
from itertools import islice
from pathlib import Path

import numpy as np
import pytest

from compiler.expressions.exact_numbers import rational_bounds
from compiler.objectives.least_values import Amount, amounts, mass_bounds
from compiler.objectives.objective_text import gap_text
from compiler.objectives.values import MotionValues, value_bounds
from compiler.robots.normal_form import family_of
from compiler.robots.parameter_values import ParameterValue, stated_value
from compiler.robots.robot import RobotModel
from compiler.words.structures import structures
from grammar_lang import ir
from grammar_lang.load import load, load_text
from srgc.exports.urdf import urdf_text
from tests.oracles.exported_robots import exported, random_lengths, solid_robot
from tests.oracles.least_specs import link, spec
from tests.oracles.small_families import SmallFamily

SPECS = Path(__file__).parents[2] / "specs"
NAMES = ("planar_arm_paper", "prismatic", "two_arm", "walled_arm", "weak_drives", "reconfigure")
ROD = (
    "this.frame = Arm.frame * move(x, B.length);"
    "rod(frame: Arm.frame, axis: x, length: B.length, density: 0.3 kg/m);"
)
ARMS = "matches Base eps Joint eps (A eps | B eps)+ Hand"

NO_TIME = Fraction(0)
NOTHING = MotionValues(None, NO_TIME, None)


def only_task(program: ir.Program) -> ir.Task:
    return next(iter(program.tasks.values()))


def read(text: str) -> tuple[ir.Program, ir.Task]:
    program = load_text(text, "spec.srg").program
    assert program is not None
    return program, only_task(program)


def robots(
    program: ir.Program, task: ir.Task, count: int
) -> list[tuple[tuple[str, ...], RobotModel]]:
    family = family_of(program, task)
    found = islice(structures(family.language, task.modules or 6), count)
    return [(each.word, family.robot(each)) for each in found]


def some_values(model: RobotModel, choose: random.Random) -> list[ParameterValue]:
    """Values of its parameters, at random or at an end."""
    found: list[ParameterValue] = []
    for parameter in model.parameters:
        domain = parameter.domain
        if isinstance(domain, ir.Interval):
            low, high = rational_bounds(domain.lower)[1], rational_bounds(domain.upper)[0]
            part = Fraction(choose.choice([0, 1, choose.randrange(1025)]), 1024)
            value = stated_value(parameter, low + min(part, Fraction(1)) * (high - low))
        else:
            value = stated_value(parameter, rational_bounds(choose.choice(domain.values))[0])
        assert value is not None
        found.append(value)
    return found


def mass_of(model: RobotModel, values: list[ParameterValue]) -> tuple[Fraction, Fraction]:
    bounds = mass_bounds(model, [value.exact for value in values])
    assert bounds is not None
    return bounds


# --- Masses ---------------------------------------------------------------------------------------


@pytest.mark.parametrize("dimension", [2, 3])
@pytest.mark.parametrize("tree", [False, True])
def test_masses_are_those_that_pinocchio_reads(dimension: int, tree: bool) -> None:
    pinocchio = pytest.importorskip("pinocchio")
    pull = (Fraction(0), Fraction(-9), Fraction(0))[:dimension]
    for seed in range(5):
        model = solid_robot(seed, dimension, 4, tree=tree)
        theta = random_lengths(seed, model)
        other = pinocchio.buildModelFromXML(urdf_text(exported(model, theta, pull)))
        bounds = mass_bounds(model, theta)
        assert bounds is not None
        # What does not move belongs to the world there, and to no joint.
        fixed = sum(each.mass for each in other.inertias[:1])
        total = pinocchio.computeTotalMass(other) + fixed
        np.testing.assert_allclose(float(bounds[0]), total, rtol=1e-9)


def test_masses_of_rods_and_points() -> None:
    """The sum of what is written: rods, points, and links that weigh as their lengths say."""
    blocks = {
        "a": ("eps A", link("0.5 m", "1.25 kg", "A.own")),
        "b": (
            "eps B",
            f"{ROD} point(frame: Arm.frame, mass: B.length * B.length * 2 kg/m^2);",
        ),
    }
    modules = {"A": "const own = 1/3 * 1 kg;", "B": "param length in [0.1, 0.7] m;"}
    program, task = read(spec(modules, blocks, "modules <= 5; minimize mass;", accept=ARMS))
    choose = random.Random(1)
    (amount,) = amounts(program, task)
    for word, model in robots(program, task, 10):
        for _ in range(20):
            values = some_values(model, choose)
            total = Fraction(19, 12) * word.count("A")
            for each in values:
                assert isinstance(each.exact, Fraction)
                total += Fraction(3, 10) * each.exact + 2 * each.exact**2
            assert value_bounds(amount, word, model, values, NOTHING) == (total, total)


def test_loads_are_left_out() -> None:
    blocks = {"a": ("eps A", link("0.5 m", "1 kg"))}
    for clause in ("payload 2 kg by effector 1;", ""):
        text = spec({"A": ""}, blocks, f"{clause} minimize mass;", accept="matches "
                    "Base eps Joint eps A eps Hand")  # fmt: skip
        program, task = read(text)
        ((_, model),) = robots(program, task, 2)
        assert mass_bounds(model, []) == (1, 1)


def test_what_is_irrational_is_enclosed() -> None:
    blocks = {"a": ("eps A", link("0.5 m", "sqrt(A.own * 1 kg)"))}
    text = spec(
        {"A": "param own in [1, 3] kg;"}, blocks, "minimize mass;",
        accept="matches Base eps Joint eps A eps Hand",
    )  # fmt: skip
    program, task = read(text)
    ((word, model),) = robots(program, task, 2)
    (amount,) = amounts(program, task)
    values = [stated_value(model.parameters[0], Fraction(2))]
    assert values[0] is not None
    bounds = value_bounds(amount, word, model, [values[0]], NOTHING)
    assert bounds is not None
    low, high = bounds
    assert low**2 < 2 < high**2
    assert high - low <= Fraction(1, 10**9)
    assert Fraction(99, 100) < amount.of_robot(word, model) <= 1


# --- Least values ---------------------------------------------------------------------------------


def check_bounds(
    program: ir.Program, task: ir.Task, choose: random.Random, draws: int, count: int
) -> None:
    """No robot has less than its structure can have, and that no less than its word says."""
    asked = (ir.Objective("mass"), ir.Objective("modules"))
    known = amounts(program, replace(task, minimize=asked))
    for word, model in robots(program, task, count):
        for amount in known:
            least = amount.of_robot(word, model)
            assert amount.of_word(word) <= least
            for _ in range(draws):
                values = some_values(model, choose)
                bounds = value_bounds(amount, word, model, values, NOTHING)
                assert bounds is not None
                assert least <= bounds[0] <= bounds[1]


@pytest.mark.parametrize("name", NAMES)
def test_shipped_robots_have_no_less(name: str) -> None:
    program = load(SPECS / f"{name}.srg").program
    assert program is not None
    check_bounds(program, only_task(program), random.Random(name), 40, 5)


@pytest.mark.slow
@pytest.mark.parametrize("name", NAMES)
def test_shipped_robots_have_no_less_at_thousand_values(name: str) -> None:
    program = load(SPECS / f"{name}.srg").program
    assert program is not None
    check_bounds(program, only_task(program), random.Random(name), 1000, 5)


@pytest.mark.parametrize("seed", range(12))
def test_random_robots_have_no_less(seed: int) -> None:
    program, task = read(SmallFamily(seed).text)
    check_bounds(program, task, random.Random(seed), 10, 10)


# --- Sums -----------------------------------------------------------------------------------------


def _priced(modules: dict[str, str]) -> tuple[ir.Program, ir.Task, Amount]:
    blocks = {"a": ("eps A", link("0.5 m", "1 kg")), "b": ("eps B", link("0.25 m", "0.3 kg"))}
    text = spec(modules, blocks, "modules <= 6; minimize sum(price);", accept=ARMS,
                joint="const price = 0.1;", hand="const price = 1/7;")  # fmt: skip
    program, task = read(text)
    (amount,) = amounts(program, task)
    return program, task, amount


def test_sums_of_constants_are_exact() -> None:
    program, task, amount = _priced({"A": "const price = 1/3;", "B": "const price = 2.5;"})
    assert amount.exact
    for word, model in robots(program, task, 20):
        total = Fraction(1, 10) + Fraction(1, 7)
        total += word.count("A") * Fraction(1, 3) + word.count("B") * Fraction(5, 2)
        assert amount.of_word(word) == amount.of_robot(word, model) == total
        assert value_bounds(amount, word, model, [], NOTHING) == (total, total)


def test_sums_of_parameters() -> None:
    """Parameters of the same name add what they are; others do not."""
    program, task, amount = _priced(
        {"A": "param price in [1/3, 2]; param other in [5, 6];", "B": "param price in {4, 3.5};"}
    )
    assert not amount.exact
    choose = random.Random(3)
    for word, model in robots(program, task, 20):
        least = Fraction(1, 10) + Fraction(1, 7)
        least += word.count("A") * Fraction(1, 3) + word.count("B") * Fraction(7, 2)
        assert amount.of_word(word) == amount.of_robot(word, model) == least
        for _ in range(10):
            values = some_values(model, choose)
            total = Fraction(1, 10) + Fraction(1, 7)
            for each in values:
                if each.parameter.name == "price":
                    assert isinstance(each.exact, Fraction)
                    total += each.exact
            assert value_bounds(amount, word, model, values, NOTHING) == (total, total)


def test_irrational_ends() -> None:
    program, task, amount = _priced({"A": "param price in [sqrt(2), 2];", "B": "const price = 9;"})
    for word, model in robots(program, task, 4):
        least = amount.of_robot(word, model)
        rest = least - Fraction(1, 10) - Fraction(1, 7) - 9 * word.count("B")
        count = word.count("A")
        assert rest**2 <= 2 * count**2
        assert count == 0 or float(rest) == pytest.approx(2**0.5 * count)


def test_efforts_are_what_is_not_kept() -> None:
    program, task, _ = _priced({"A": "const price = 1;", "B": "const price = 1;"})
    (amount,) = amounts(program, replace(task, minimize=(ir.Objective("effort"),)))
    ((word, model),) = robots(program, task, 1)
    for share, value in [(0.75, Fraction(1, 4)), (0.1, Fraction(9, 10)), (None, Fraction(0))]:
        assert value_bounds(amount, word, model, [], MotionValues(share, NO_TIME, None)) == (
            value,
            value,
        )
    assert amount.of_robot(word, model) == 0


@pytest.mark.parametrize(
    ("gap", "text"),
    [
        (Fraction(3, 200), "1.5 %"),
        (Fraction(1, 10**6), "0.0001 %"),
        (Fraction(1, 10**9), "below 0.0001 %"),
        (Fraction(0), "0 %"),
    ],
)
def test_gaps_are_rounded_up_if_they_are_not_tiny(gap: Fraction, text: str) -> None:
    assert gap_text(gap) == text
