"""Wider ranges of joints that ``why`` tries: finite ones, in the unit in which they are written."""

from __future__ import annotations

from fractions import Fraction
from math import atan2, degrees

import pytest

from grammar_lang import ir
from solvers.explanation.change import Change
from solvers.explanation.explanation import Asked, Tried, explain
from solvers.explanation.run import Runs, Suggestion
from solvers.explanation.scale import scales
from solvers.explanation.suggestions import SuggestionSearch
from solvers.explanation.task_line import task_lines
from solvers.run_context import RunContext
from tests.oracles.small_specs import SLIDER, TURNER, replaced
from tests.solvers.test_changes import Vain, line, posed

ONE_LINK = "accept matches B eps JO eps L eps EN;"
ARM = replaced(TURNER, "accept contains EN and starts with B eps JO;", ONE_LINK)
ARM = replaced(ARM, "[-180, 180] deg", "LIMITS")
"""The hand has to turn from -0.3/1.2 to 0.3/1.2 on one side, to 1.2/0.3 at least, counted up."""
LEAST = degrees(atan2(1.2, 0.3))


def arm(limits: str) -> str:
    return ARM.replace("LIMITS", limits)


def tried(text: str) -> list[str]:
    """The changes of the range of the joint that are tried, none of which helps."""
    asked = posed(text)
    runs = Vain(RunContext(), limit=100)
    SuggestionSearch(asked, runs).after_conflicts([line(asked, "joint_range")], ())
    return [change.says for change in runs.failed]


@pytest.mark.parametrize(
    ("limits", "same", "up", "says"),
    [
        ("[-20, 30] deg", "[-20, 60] deg", 60, "up to 60 deg"),
        ("[-20 deg, pi/6]", "[-20, 60] deg", 60, "up to 60 deg"),
        ("[-20, 30] deg rate in [-1, 1] rad/s", "[-20, 60] deg rate in [-1, 1] rad/s", 60,
         "up to 60 deg"),
        ("[-0.3, 0.5]", "[-0.3, 1.4] rad", Fraction(7, 5), "up to 1.4 rad"),
        ("[-0.3, 0.5] rate in [-9, 9] deg/s", "[-0.3, 1.4] rate in [-9, 9] deg/s",
         Fraction(7, 5), "up to 1.4 rad"),
        ("[-pi/3, pi/6]", "[-pi/3, 1.4] rad", Fraction(7, 5), "up to 1.4 rad"),
        ("[-0.3 deg, 0.5 rad]", "[-0.3 deg, 1.4 rad]", Fraction(7, 5), "up to 1.4 rad"),
    ],
)  # fmt: skip
def test_a_range_is_wider_in_the_unit_in_which_it_is_written(
    limits: str, same: str, up: Fraction, says: str
) -> None:
    asked = posed(arm(limits))
    change = next(scales(asked, line(asked, "joint_range"))).at(Fraction(up))
    assert change.says == f"with `JO.q` {says}"
    wanted = posed(arm(same)).program.modules["JO"].dofs[0]
    assert change.posed.program.modules["JO"].dofs[0] == wanted


@pytest.mark.parametrize(
    ("limits", "same", "up", "unit"),
    [
        ("[0, 40] cm", "[0, 60] cm", 60, "cm"),
        ("[0 m, 400 mm]", "[0 m, 600 mm]", 600, "mm"),
        ("[0, 40]", "[0, 60] m", 60, "m"),
    ],
)
def test_a_slide_is_longer_in_the_unit_in_which_it_is_written(
    limits: str, same: str, up: int, unit: str
) -> None:
    asked, wanted = (posed(replaced(SLIDER, "[0, 3] m", each)) for each in (limits, same))
    change = next(scales(asked, line(asked, "joint_range"))).at(Fraction(up))
    assert change.says == f"with `P.q` up to {up} {unit}"
    assert change.posed.program.modules["P"].dofs[0] == wanted.program.modules["P"].dofs[0]


def test_a_range_is_wider_on_both_sides() -> None:
    asked = posed(arm("[-20, 20] deg"))
    *sides, both = scales(asked, line(asked, "joint_range"))
    assert [each.last for each in sides] == [False, False]
    assert both.last
    change = both.at(Fraction(75))
    assert change.says == "with `JO.q` in `[-75, 75] deg`"
    wanted = posed(arm("[-75, 75] deg")).program.modules["JO"].dofs[0]
    assert change.posed.program.modules["JO"].dofs[0] == wanted
    one_sided = posed(arm("[-20, 30] deg"))
    assert len(list(scales(one_sided, line(one_sided, "joint_range")))) == 2


def test_every_angle_is_within_reach_one_way_or_the_other() -> None:
    asked = posed(arm("[-20, 40] deg"))
    up, down = scales(asked, line(asked, "joint_range"))
    assert (up.values[0], up.values[-1]) == (41, 190)
    assert (down.values[0], down.values[-1]) == (-21, -170)
    whole = posed(arm("[-180, 180] deg"))
    assert not any(each.values for each in scales(whole, line(whole, "joint_range")))


def test_an_angle_beyond_the_least_with_a_pose_is_tried_first() -> None:
    """Then twice as many degrees more, and without the limit, as nothing helps here."""
    *angles, last = tried(arm("[-20, 20] deg"))
    assert all(says.startswith("with `JO.q` up to ") for says in angles[:2])
    first, second = (float(says.split()[-2]) for says in angles[:2])
    assert abs(first - 20 - 1.2 * (LEAST - 20)) <= 3
    assert abs(second - 20 - 2 * (LEAST - 20)) <= 6
    assert last == "without a limit of `JO.q`"


class Easy(Runs):
    """Runs that all succeed, at once."""

    def run(self, change: Change) -> Suggestion:
        self.found.append(Suggestion(change, (), 0.0, 0.0, {}))
        return self.found[-1]


def test_the_least_angle_with_a_pose_is_tried_where_more_helps() -> None:
    """At the least angle, a robot may only just touch what it has to reach."""
    asked, runs = posed(arm("[-20, 20] deg")), Easy(RunContext())
    SuggestionSearch(asked, runs).after_conflicts([line(asked, "joint_range")], ())
    first, least = (float(each.change.value or 0) for each in runs.found[:2])
    assert LEAST <= least <= LEAST + 2
    assert least < first


def test_both_sides_are_tried_where_one_side_does_not_do() -> None:
    """The start is from -1.36 rad to -0.40 rad, the target from 1.33 rad on."""
    start = "region S box [0.4, 1.9] x [-1.9, -0.8]"
    text = replaced(arm("[-0.3, 0.3]"), "region S box [1.2, 1.9] x [-0.3, 0.3]", start)
    first = tried(text)[0]
    assert first.startswith("with `JO.q` in `[-1.")
    # By six fifths of what is needed at least, in two digits.
    beyond = float(first.split("[-")[1].split(",")[0]) - 0.3
    assert 1.2 * (1.325 - 0.3) - 0.1 <= beyond <= 1.2 * (1.5 - 0.3)


def test_what_is_tried_is_told() -> None:
    """Each line of the conflict with its number, while poses are searched."""
    asked, told = posed(arm("[-20, 20] deg")), list[str]()
    lines = [line(asked, kind) for kind in ("reach", "joint_range")]
    runs = Vain(RunContext(), limit=1, step=told.append)
    SuggestionSearch(asked, runs).after_conflicts(lines, ())
    assert told[0] == "line 1 of 2, an effector ends in `T`"
    assert told[1] == "line 2 of 2, the range of `JO.q`"
    assert set(told[2:]) == {f"{told[1]}: looking for values with poses"}


def test_questions_about_conflicts_are_told() -> None:
    asked, told = posed(arm("[-20, 20] deg")), list[str]()
    tried = Tried("impossible", "", (("tool", "link", "joint", "base"),))
    explain(asked, tried, Asked(runs=0, step=told.append))
    robot = "B eps JO eps L eps EN"
    count = len(task_lines(asked))
    assert told[0] == f"robot 1 of 1: whether {count} of {count} lines rule out {robot}"
    assert all(each.startswith("robot 1 of 1: whether ") for each in told)


# --- lists of values ------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("listed", "number", "value", "says", "same"),
    [
        ("{0.3 m, 50 cm}", 0, "0.83", "with `L.length` in `{0.3, 0.5, 0.83} m`",
         "{0.3, 0.5, 0.83} m"),
        ("{0.5, 0.3} m", 1, "0.2", "with `L.length` in `{0.2, 0.3, 0.5} m`", "{0.2, 0.3, 0.5} m"),
        ("{1/3, 1} m", 0, "1.5", "with `L.length` in `{1/3, 1, 1.5} m`", "{1/3, 1, 1.5} m"),
        ("{1, 2, 3, 4, 5, 6} m", 0, "8", "with `8 m` in the list of `L.length`",
         "{1, 2, 3, 4, 5, 6, 8 m} m"),
        ("{1, sqrt(2)} m", 0, "2", "with `2 m` in the list of `L.length`", "{1, sqrt(2), 2 m} m"),
        ("[1, 2] m", 0, "3", "with `L.length` up to 3 m", "[1, 3] m"),
    ],
)  # fmt: skip
def test_a_list_gets_one_more_value(
    listed: str, number: int, value: str, says: str, same: str
) -> None:
    def lengths(text: str) -> set[ir.Expr]:
        (p,) = posed(replaced(TURNER, "[1, 2] m", text)).program.modules["L"].parameters
        return values_of(p.domain)

    def values_of(domain: ir.Interval | ir.Choices) -> set[ir.Expr]:
        return set(
            domain.values if isinstance(domain, ir.Choices) else (domain.lower, domain.upper)
        )

    asked = posed(replaced(TURNER, "[1, 2] m", listed))
    change = list(scales(asked, line(asked, "parameter")))[number].at(Fraction(value))
    assert change.says == says
    (p,) = change.posed.program.modules["L"].parameters
    assert values_of(p.domain) == lengths(same)


def test_the_least_value_with_a_pose_is_tried_for_a_list_too() -> None:
    """A hand at 1.2 m and more: {0.3, 0.5, 15} has no pose, nor have most lists up to that."""
    listed, whole = (values_tried(limits) for limits in ("{0.3, 0.5} m", "[0.3, 0.5] m"))
    assert listed[0] == whole[1]
    assert 1.2 <= listed[0] <= 1.3
    assert 1.2 * listed[0] == pytest.approx(whole[0], rel=0.03)


def values_tried(lengths: str) -> list[float]:
    """The lengths beyond a domain that are tried for one link, with which all runs succeed."""
    asked = posed(replaced(arm("[-180, 180] deg"), "[1, 2] m", lengths))
    runs = Easy(RunContext())
    SuggestionSearch(asked, runs).after_conflicts([line(asked, "parameter")], ())
    return [float(each.change.value or 0) for each in runs.found]


def test_a_list_is_called_one() -> None:
    listed = posed(replaced(TURNER, "[1, 2] m", "{1, 2} m"))
    assert line(listed, "parameter").says == "the list of `L.length`"
    assert line(posed(TURNER), "parameter").says == "the range of `L.length`"


@pytest.mark.slow
def test_a_run_finds_a_robot_with_a_wider_range() -> None:
    asked = posed(arm("[-20, 20] deg"))
    labels = ("tool", "link", "joint", "base")
    found = explain(asked, Tried("impossible", "", (labels,)), Asked(runs=3))
    ranges = [one.change for one in found.suggestions if "`JO.q`" in one.change.says]
    (change,) = ranges
    assert change.says.endswith(" deg")
    assert LEAST <= float(change.value or 0) <= 180
