"""A task with narrower bounds: exactly the inputs that keep a share keep it."""

from __future__ import annotations

import random
from dataclasses import replace
from fractions import Fraction
from pathlib import Path

import pytest

from compiler.robots.normal_form import family_of
from compiler.robots.robot import RobotModel
from compiler.robots.state_and_input import InputBound, input_bounds
from compiler.tasks.tightened import tightened
from compiler.words.structures import structures
from grammar_lang import ir
from grammar_lang.load import load_text
from tests.oracles.slides import slides

SPECS = Path(__file__).parents[2] / "specs"
MOTOR_ARM = (SPECS / "motor_arm.srg").read_text(encoding="utf-8")
SHARES = (Fraction(0), Fraction(1, 4), Fraction(9207, 10_000))


def read(text: str) -> tuple[ir.Program, ir.Task]:
    program = load_text(text, "spec.srg").program
    assert program is not None
    (task,) = program.tasks.values()
    return program, task


def first_robot(program: ir.Program, task: ir.Task, word: str | None = None) -> RobotModel:
    family = family_of(program, task)
    for derivation in structures(family.language, 9):
        if word in (None, " ".join(derivation.word)):
            return family.robot(derivation)
    raise AssertionError(word)


def share(bounds: tuple[InputBound, ...], row: list[Fraction]) -> Fraction:
    """By the definition: the least part of its widest distance that an input keeps."""
    found = []
    for bound in bounds:
        for place in bound.inputs:
            middle, half = (bound.lower + bound.upper) / 2, (bound.upper - bound.lower) / 2
            if half:
                found.append(1 - abs(row[place] - middle) / half)
    return min(found)


@pytest.mark.parametrize(
    ("text", "word"),
    [
        (MOTOR_ARM, "B eps M eps L eps JO eps L eps EN"),
        (slides("const mass = 2 kg"), None),
        (slides("const mass = 2 kg", travel="[0, 2] m effort <= 3 N"), None),
        (slides("const mass = 2 kg", travel="[0, 2] m effort <= sqrt(2) * 1 N"), None),
    ],
)  # fmt: skip
def test_inputs_keep_a_share(text: str, word: str | None) -> None:
    program, task = read(text)
    bounds = input_bounds(first_robot(program, task, word), task)
    count, rng = 1 + max(place for bound in bounds for place in bound.inputs), random.Random(0)
    for kept in SHARES:
        narrow, due = tightened(program, task, kept)
        narrowed = input_bounds(first_robot(narrow, due, word), due)
        assert [b.inputs for b in narrowed] == [b.inputs for b in bounds]
        seen = set()
        for _ in range(200):
            row = [Fraction(rng.randint(-1000, 1000), 997) for _ in range(count)]
            scale = Fraction(rng.randint(1, 90), 2) * (1 - kept)
            row = [scale * value for value in row]
            within = all(
                bound.lower <= row[place] <= bound.upper
                for bound in narrowed
                for place in bound.inputs
            )
            assert within is (share(bounds, row) >= kept)
            seen.add(within)
        assert seen == {True, False}


def test_a_range_is_drawn_together_about_its_middle() -> None:
    program, task = read(MOTOR_ARM)
    motor = program.modules["M"]
    (given,) = motor.inputs
    lopsided = ir.Interval(ir.Num(Fraction(2)), ir.Num(Fraction(10)))
    changed = ir.Input(given.name, lopsided, given.unit)
    modules = {**program.modules, "M": replace(motor, inputs=(changed,))}
    narrow, _ = tightened(replace(program, modules=modules), task, Fraction(3, 4))
    assert narrow.modules["M"].inputs[0].domain == ir.Interval(
        ir.Num(Fraction(5)), ir.Num(Fraction(7))
    )


def test_norms_and_all_else() -> None:
    program, task = read(slides("const mass = 2 kg", effort="effort <= 20 N norm 2;"))
    narrow, due = tightened(program, task, Fraction(1, 8))
    assert due.effort[0].norm2 is True
    assert due.effort[0].bound == Fraction(35, 2)
    assert narrow.grammars == program.grammars
    assert narrow.workspaces == program.workspaces
