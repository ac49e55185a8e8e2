"""Claims of a loop, true ones and altered ones, each judged right."""

from __future__ import annotations

from collections.abc import Callable
from decimal import Decimal
from fractions import Fraction
from pathlib import Path

import pytest

from solvers.verifier.verification import Outcome, verify_directory
from tests.oracles.altered_claims import Change, Content, claimed, judged
from tests.oracles.result_files import alter_spec, read, write
from tests.oracles.some_cases import some


def loop(content: Content) -> Content:
    return claimed(content, "loop")


@pytest.fixture
def folder(result: Callable[[str], Path]) -> Path:
    found = result("looped")
    (found / "design.json").unlink()
    return found


def test_all_rounds_are_proved(made: Callable[[str], Path]) -> None:
    folder = made("looped") / "out"
    report = verify_directory(folder)
    assert report.outcome is Outcome.VALID
    names = {condition.name: condition.margin for condition in report.conditions}
    assert 0 <= names["entry into the loop"] < 1
    assert 0 <= names["return of the loop"] < 1
    assert 0 < names["effort (N)"] < names["planned effort (N)"] < 10
    assert read(folder)["format"] == 4
    assert read(folder, "design.json")["loop"] == 0
    said = (made("looped") / "stdout").read_text(encoding="utf-8")
    assert "repeats: from 0 s to 3.2 s again and again, for ever\n" in said


def flat(content: Content) -> None:
    loop(content)["generators"] = [["1", "2"], ["2", "4"]]


def narrow(content: Content) -> None:
    loop(content)["generators"].pop()


def long_row(content: Content) -> None:
    loop(content)["generators"][0].append("0")


def long_centre(content: Content) -> None:
    loop(content)["centre"].append("0")


def no_number(content: Content) -> None:
    loop(content)["centre"][0] = "NaN"


def infinite(content: Content) -> None:
    loop(content)["generators"][0][0] = "Infinity"


def beyond(content: Content) -> None:
    loop(content)["first"] = content["steps"]


def before(content: Content) -> None:
    loop(content)["first"] = -1


def no_whole_number(content: Content) -> None:
    loop(content)["first"] = 0.5


def truth(content: Content) -> None:
    loop(content)["first"] = False


def twice(content: Content) -> None:
    content["claims"].append(loop(content))


def unknown_field(content: Content) -> None:
    loop(content)["rounds"] = 7


def none_at_all(content: Content) -> None:
    content["claims"].remove(loop(content))


@pytest.mark.parametrize(
    ("change", "reason"),
    [
        (flat, "the set of the loop is flat"),
        (narrow, "as many generators as states"),
        (long_row, "as many generators as states"),
        (long_centre, "the set of the loop is not one of 2 states"),
        (no_number, "malformed"),
        (infinite, "malformed"),
        (beyond, "does not begin within the 16 steps"),
        (before, "does not begin within the 16 steps"),
        (no_whole_number, "a whole number is expected"),
        (truth, "a whole number is expected"),
        (twice, "more than one loop"),
        (unknown_field, "`rounds` is unknown"),
        (none_at_all, "the motion of the task goes on for ever"),
    ],
)
def test_what_is_false_or_malformed_is_refuted(folder: Path, change: Change, reason: str) -> None:
    outcome, said = judged(folder, change)
    assert outcome is Outcome.REFUTED
    assert reason in said


def test_a_loop_of_a_motion_that_ends_is_refuted(folder: Path) -> None:
    alter_spec(folder, "  repeat;\n", "", sign=True)
    report = verify_directory(folder)
    assert report.outcome is Outcome.REFUTED
    assert "the motion of the task ends" in (report.reason or "")


def times(factor: str) -> Change:
    def change(content: Content) -> None:
        found = loop(content)
        found["generators"] = [
            [str(Decimal(x) * Decimal(factor)) for x in row] for row in found["generators"]
        ]

    return change


def moved_by(part: str) -> Change:
    """The centre by so much of a generator."""

    def change(content: Content) -> None:
        found = loop(content)
        found["centre"] = [
            str(Decimal(x) + Decimal(part) * Decimal(row[0]))
            for x, row in zip(found["centre"], found["generators"], strict=True)
        ]

    return change


def later(content: Content) -> None:
    """Half of the loop does not come back."""
    loop(content)["first"] = 8


def without_gains(content: Content) -> None:
    law = claimed(content, "controller")
    law["gains"] = [[["0"] * len(row) for row in step] for step in law["gains"]]


@pytest.mark.parametrize(
    "change",
    some([times("0.5"), moved_by("1"), times("0.1")], 2),
    ids=["half", "moved", "tenth"],
)
def test_a_set_that_rounds_leave_proves_nothing(folder: Path, change: Change) -> None:
    outcome, said = judged(folder, change)
    assert outcome is Outcome.UNDECIDED, said


def test_a_half_of_the_loop_asks_for_jumps(folder: Path) -> None:
    """Its second round begins two metres from where its reference does, at 3.2 s.

    The input after that is the worst, and the same in every round of 1.6 s.
    """
    outcome, said = judged(folder, later)
    assert outcome is Outcome.REFUTED
    violated = "effort (N): violated by the planned motion at"
    assert said in (f"{violated} 3.4 s", f"{violated} 5 s")


def test_without_gains_a_push_moves_the_load_off_the_rail(folder: Path) -> None:
    """By 0.1 N, a kilogram is 0.5 m off after 3.2 seconds, and 2 m off after two rounds."""
    outcome, said = judged(folder, without_gains)
    assert outcome is Outcome.REFUTED
    assert ": violated by a disturbed motion at " in said


def test_a_larger_set_that_is_returned_into_is_as_good(folder: Path) -> None:
    assert judged(folder, times("1.05"))[0] is Outcome.VALID


def test_a_plan_beside_the_middle_of_the_set_is_accepted(folder: Path) -> None:
    assert judged(folder, moved_by("0.01"))[0] is Outcome.VALID


def test_the_folder_says_what_is_proved(result: Callable[[str], Path]) -> None:
    folder = result("looped")

    write(folder, {**read(folder, "design.json"), "loop": 3}, "design.json")
    report = verify_directory(folder)
    assert report.outcome is Outcome.REFUTED
    assert "`loop`" in (report.reason or "")


def test_another_formula_fails(folder: Path) -> None:
    """The mass does not stay."""
    asked = "always (eventually T and eventually S)"
    alter_spec(folder, asked, "eventually always T", sign=True)
    assert verify_directory(folder).outcome is Outcome.REFUTED
    assert Fraction(read(folder)["step"]) == Fraction(1, 5)


def test_a_disturbed_motion_that_asks_for_too_much_is_shown(folder: Path) -> None:
    """A kilogram that is pushed wherever it goes: more than 10 N are commanded."""
    alter_spec(folder, "robust effort 1 % of bound", "robust effort 60 % of bound", sign=True)
    content = read(folder)
    law, step = claimed(content, "controller"), 0.2
    x, v = (float(each) for each in content["start"])
    most = 0.0
    for _ in range(3):
        for k, (planned,) in enumerate(content["inputs"]):
            (gains,) = law["gains"][k]
            goal = [float(each) for each in law["reference"][k]]
            u = float(planned) - float(gains[0]) * (x - goal[0]) - float(gains[1]) * (v - goal[1])
            most = max(most, abs(u))
            push = 6.0 if v > 0 else -6.0
            x, v = x + v * step + (u + push) * step**2 / 2, v + (u + push) * step
    assert most > 10.01
    report = verify_directory(folder)
    assert report.outcome is Outcome.REFUTED
    assert report.reason is not None
    assert ": violated by a disturbed motion at " in report.reason
