"""What a motion of some number of steps does is not impossible for one of any number up to more."""

from __future__ import annotations

import random
from dataclasses import replace
from fractions import Fraction

import pytest

from grammar_lang import ir
from grammar_lang.diagnostics.diagnostic import Severity
from grammar_lang.load import load_text
from solvers.conflicts.vacuity import formula_findings
from solvers.run_context import RunContext
from solvers.search.synthesis import Synthesis, synthesise
from tests.oracles.slides import slides
from tests.oracles.small_specs import replaced
from tests.oracles.some_cases import some

STEPS = 5
ENDS = ("at rest", "", "at rest for 0.3 s", "rates <= 0.2 m/s for 0.5 s")
FORMULAS = (
    "last[{a} s] {one}", "always[{a} s, {b} s] {one}", "eventually[{a} s, {b} s] {one}",
    "not {one} until {two}", "always[{a} s, 9 s] not {one}", "next {one}", "not next not {one}",
    "eventually ({one} and always[{a} s, {b} s] {two})", "last[{a} s] eventually[{b} s, 9 s] {one}",
    "always ({one} implies eventually[{a} s, {b} s] {two})", "not last[{a} s] {one}",
)  # fmt: skip


def spec(seed: int) -> str:
    """A slide with a random end, or random formulas with windows about its horizon."""
    chance = random.Random(f"steps {seed}")
    effort = chance.choice((3, 8, 20, 60))
    text = slides("const mass = 1 kg", effort=f"effort <= {effort} N;", steps=STEPS, end=ENDS[0])
    text = replaced(text, "steps of 0.1 s", "steps of 0.2 s")
    text = replaced(text, "target Goal", "region Mid box [0.5, 0.9] x [-0.1, 0.1] m; target Goal")
    asked = []
    for _ in range(chance.randint(0, 2)):
        first, second = sorted(chance.choice(range(12)) for _ in range(2))
        one, two = (chance.choice(("Home", "Mid", "Goal")) for _ in range(2))
        form = chance.choice(FORMULAS)
        asked.append(f"satisfy {form.format(a=first / 10, b=(second + 1) / 10, one=one, two=two)};")
    end = f"reach Goal {chance.choice(ENDS)};"
    if asked and chance.random() < 0.6:
        end = ""
    return replaced(text, "reach Goal at rest;", " ".join([end, *asked]))


def tried(text: str, steps: int, *, at_most: bool) -> Synthesis:
    program = load_text(text, "spec.srg").program
    assert program is not None
    task = replace(program.tasks["Go"], steps=steps, at_most=at_most)
    return synthesise(program, task, RunContext(paths=2, evaluations=8))


def agree(seed: int) -> set[str]:
    """The verdicts of each number of steps do not contradict that of any number."""
    text = spec(seed)
    whole = tried(text, STEPS, at_most=True)
    fewest = fewest_steps(text)
    found = {steps: tried(text, steps, at_most=False).verdict for steps in range(fewest, STEPS + 1)}
    if whole.verdict == "impossible":
        assert "found" not in found.values(), (text, found)
    if whole.design is not None:
        assert found[len(whole.design.inputs)] != "impossible", (text, found)
    return {whole.verdict}


def fewest_steps(text: str) -> int:
    program = load_text(text, "spec.srg").program
    assert program is not None
    return replace(program.tasks["Go"], at_most=True).fewest_steps


@pytest.mark.parametrize("seed", some(list(range(12)), 4))
def test_random_tasks(seed: int) -> None:
    agree(seed)


@pytest.mark.slow
def test_many_random_tasks() -> None:
    verdicts = set[str]()
    for seed in range(12, 50):
        verdicts |= agree(seed)
    assert verdicts >= {"found", "impossible"}


@pytest.mark.parametrize(
    ("clause", "longest"),
    [
        # Goal within one second, and it is not in Home any more: a motion that ends before.
        ("reach Goal at rest; satisfy always[1.2 s, 2 s] Home;", 5),
        ("satisfy eventually Mid and last[0.2 s] Mid and always[1 s, 9 s] not Mid;", 4),
    ],
)
def test_tasks_that_only_shorter_motions_do(clause: str, longest: int) -> None:
    text = slides("const mass = 1 kg", effort="effort <= 60 N;", steps=10)
    text = replaced(text, "steps of 0.1 s", "steps of 0.2 s")
    text = replaced(text, "target Goal", "region Mid box [0.5, 0.9] x [-0.1, 0.1] m; target Goal")
    text = replaced(text, "reach Goal at rest;", clause)
    result = tried(text, 10, at_most=True)
    assert result.verdict == "found", result.reason
    assert result.design is not None
    assert len(result.design.inputs) <= longest
    assert tried(text, 10, at_most=False).verdict != "found"


# --- findings of the check ------------------------------------------------------------------------


def errors(text: str) -> list[str]:
    program = load_text(text, "spec.srg").program
    assert program is not None
    found = formula_findings(program, program.tasks["Go"])
    return [each.severity.value for each in found if each.severity is not Severity.NOTE]


@pytest.mark.parametrize(
    "clause",
    [
        "satisfy last[0.2 s] Goal and always[0.5 s, 2 s] Home;",
        "satisfy eventually[3 s, 4 s] Goal;",
        "satisfy always[3 s, 4 s] Goal;",
    ],
)
def test_no_finding_is_about_the_longest_motion_alone(clause: str) -> None:
    """A contradiction at the horizon, and a window that only the horizon cuts off."""
    text = replaced(slides("const mass = 1 kg"), "reach Goal at rest;", clause)
    assert errors(text) != []
    assert errors(replaced(text, "horizon 20", "horizon at most 20")) == []


def test_motions_for_ever_are_judged_whatever_the_horizon() -> None:
    clause = "satisfy always Home and eventually Goal; repeat;"
    text = replaced(slides("const mass = 1 kg"), "reach Goal at rest;", clause)
    assert errors(text) == errors(replaced(text, "horizon 20", "horizon at most 20")) == ["error"]


def test_what_is_fixed_has_one_number_of_steps() -> None:
    program = load_text(slides("const mass = 1 kg"), "spec.srg").program
    assert program is not None
    task: ir.Task = program.tasks["Go"]
    assert (task.fewest_steps, task.step) == (20, Fraction(1, 10))
