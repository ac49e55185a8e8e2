"""The fewest steps that are found, against closed forms of the least time; and what is tried."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from itertools import pairwise
from math import asin, ceil, degrees, sqrt

import pytest

from grammar_lang import ir
from grammar_lang.load import load_text
from solvers.run_context import PATHS, RunContext
from solvers.search.round_task import tasks_by_length, tasks_of_other_lengths
from solvers.search.shorter_motion import _cut_short, _scaled, _with_the_end
from solvers.search.synthesis import Synthesis, synthesise
from tests.oracles.bang_bang import swing_up
from tests.oracles.slides import slides
from tests.oracles.small_specs import replaced
from tests.oracles.some_cases import some
from tests.solvers.test_time_optimal import DENSITY, GRAVITY, INERTIA, LENGTH, arm

MASS, FORCE, WAY, STEP = 1.5, 2.0, 0.8, 0.1
A = FORCE / MASS


def timed(end: str = "at rest", clauses: str = "", most: int = 40) -> str:
    """A mass on rails from [0.1, 0.3] to [1.1, 1.4], with the least time."""
    text = slides(f"const mass = {MASS} kg", effort=f"effort <= {FORCE} N;", steps=most, end=end)
    return replaced(text, f"horizon {most}", f"{clauses} minimize time; horizon at most {most}")


def task_of(text: str) -> ir.Task:
    program = load_text(text, "spec.srg").program
    assert program is not None
    return program.tasks["Go"]


def searched(text: str, paths: int = PATHS) -> Synthesis:
    program = load_text(text, "spec.srg").program
    assert program is not None
    return synthesise(program, program.tasks["Go"], RunContext(paths=paths))


def steps_of(text: str, paths: int = PATHS) -> int:
    result = searched(text, paths)
    assert result.design is not None, result.reason
    return len(result.design.inputs)


def within_a_step(found: int, least: float, step: float = STEP) -> None:
    fewest = ceil(least / step - 1e-9)
    assert fewest <= found <= fewest + 1, (found, least / step)


def limited(text: str, limit: str) -> str:
    return replaced(text, "in [0, 2] m", f"in [0, 2] m {limit}")


@pytest.mark.parametrize(
    ("text", "least"),
    some(
        [
            (timed(), 2 * sqrt(WAY / A)),
            (timed(end=""), sqrt(2 * WAY / A)),
            (limited(timed(), "rate in [-0.6, 0.6] m/s"), WAY / 0.6 + 0.6 / A),
            (limited(timed(), "accel <= 0.5 m/s^2"), 2 * sqrt(WAY / 0.5)),
            (timed(end="at rest for 0.7 s"), 2 * sqrt(WAY / A) + 0.7),
            (timed(end="", clauses="satisfy last[0.4 s] Goal;"), sqrt(2 * WAY / A) + 0.1),
        ],
        3,
    ),
)
def test_a_slide_takes_its_least_time(text: str, least: float) -> None:
    found = steps_of(text)
    if "last[" in text:
        # It passes through the target, 0.3 m wide, in the last 0.4 s: braking there.
        assert found <= ceil(2 * sqrt((WAY + 0.3) / A) / STEP) + 1
        assert found >= least / STEP
        return
    within_a_step(found, least)


@pytest.mark.parametrize("strength", some([1.6, 3.0, 1.2], 1))
def test_a_pendulum_takes_its_least_time(strength: float) -> None:
    """From hanging down to a place sideways, at rest there, with more torque than gravity asks."""
    weight = DENSITY * LENGTH**2 / 2 * GRAVITY
    torque, near, step = strength * weight, 0.5, 0.02
    text = arm(clauses=f"minimize time; gravity (0, -{GRAVITY}) m/s^2;")
    text = replaced(text, "effort <= 0.4 N*m", f"effort <= {torque} N*m")
    text = replaced(text, "start in A at rest", "start at (-90 deg)")
    text = replaced(text, "reach A", "reach Goal")
    text = replaced(text, "region A box [-9, 9] x [-9, 9] m;",
                    f"region Goal box [{near}, {near + 0.1}] x [-0.7, 0] m;")  # fmt: skip
    text = replaced(text, "40 steps of 0.1 s", f"60 steps of {step} s")
    assert degrees(asin(near / LENGTH)) < 60
    least = swing_up(torque, weight, INERTIA, asin(near / LENGTH))
    within_a_step(steps_of(text), least, step)


def test_the_same_search_finds_the_same() -> None:
    one, two = (searched(timed()) for _ in range(2))
    assert one.design is not None
    assert two.design is not None
    assert one.design.inputs == two.design.inputs
    assert one.design.start == two.design.start


def test_a_task_of_fewer_steps_only() -> None:
    """What is asked for later than the motion ends is not asked for."""
    text = timed(clauses="satisfy always[1.8 s, 4 s] Home;", most=40)
    found = steps_of(text, paths=1)
    within_a_step(found, 2 * sqrt(WAY / A))
    assert found < 18
    fixed = replaced(replaced(text, "at most 40", "40"), "minimize time;", "")
    assert searched(fixed).design is None


# --- which numbers of steps, in turn --------------------------------------------------------------


def test_parts_of_the_horizon() -> None:
    def numbers(text: str) -> list[int]:
        return [each.steps for each in tasks_by_length(task_of(text))]

    assert numbers(timed()) == [40, 20, 30, 10]
    assert numbers(timed(most=2)) == [2, 1]
    assert numbers(timed(end="at rest for 1.5 s")) == [40, 20, 30, 15]
    assert numbers(replaced(timed(), "at most ", "")) == [40]
    assert not any(each.at_most for each in tasks_by_length(task_of(timed())))


@pytest.mark.parametrize(
    ("most", "clauses"), [(40, ""), (7, "satisfy last[0.2 s] Goal;"), (400, "satisfy next Home;")]
)
def test_other_numbers_where_there_are_formulas(most: int, clauses: str) -> None:
    task = task_of(timed(clauses=clauses, most=most))
    usual = {each.steps for each in tasks_by_length(task)}
    others = [each.steps for each in tasks_of_other_lengths(task)]
    assert len(set(others)) == len(others)
    assert not usual & set(others)
    if not clauses:
        assert others == []
    elif most == 7:
        assert usual | set(others) == set(range(1, 8))
    else:
        assert len(others) == 40
        gaps = [one - other for one, other in pairwise(sorted([1, *others, 400], reverse=True))]
        assert max(gaps) <= 16
        assert max(abs(a - b) for a, b in pairwise(sorted([1, *others[:3], 400]))) <= 110
    assert tasks_of_other_lengths(replace(task, at_most=False)) == ()


# --- entries of shorter motions -------------------------------------------------------------------


@pytest.mark.parametrize("shorten", [_scaled, _with_the_end, _cut_short])
@pytest.mark.parametrize("entries", [(0,), (0, 7, 74), (0, 1, 2, 3), (0, 30, 31, 79)])
def test_entries_of_fewer_steps_stay_in_order(
    shorten: Callable[[tuple[int, ...], int, int], tuple[int, ...]], entries: tuple[int, ...]
) -> None:
    for steps in range(len(entries), 81):
        found = shorten(entries, 80, steps)
        assert len(found) == len(entries)
        assert found[0] == 0
        assert all(one < other for one, other in pairwise(found))
    assert shorten(entries, 80, 80) == entries


def test_entries_keep_what_the_end_takes() -> None:
    assert _scaled((0, 7, 74), 80, 40) == (0, 4, 37)
    assert _with_the_end((0, 7, 74), 80, 40) == (0, 3, 34)
    assert _cut_short((0, 7, 74), 80, 40) == (0, 7, 34)
