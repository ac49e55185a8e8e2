"""What `verify` prints of many findings."""

from __future__ import annotations

import re
from dataclasses import replace

from hypothesis import given
from hypothesis import strategies as st

from solvers.verifier.proofs.checked_condition import CheckedCondition
from solvers.verifier.proofs.tube_checks import Status
from solvers.verifier.verification import Outcome, Report
from srgc.text_reports.verification_report import after_verification, verification_text


def clear(name: str, margin: float, status: Status = Status.HOLDS) -> CheckedCondition:
    return CheckedCondition(
        f"clearance of effector to {name}", status, margin, "m", 1.0, (0.5, 0.25)
    )


def printed(*findings: CheckedCondition) -> list[str]:
    report = Report(Outcome.VALID, "found", "validated", None, findings)
    head, *lines = verification_text(report).splitlines()
    assert head == "valid: found, level validated"
    return lines


def told(lines: list[str]) -> list[tuple[str, str]]:
    """The status and all else of each condition, whose lines but for the first are indented."""
    found = "\n".join(lines).replace("\n" + " " * 12, " ").splitlines()
    return [(line.split()[0], " ".join(line.split()[1:])) for line in found]


def test_the_pieces_of_a_map_are_one_condition_with_the_least_margin() -> None:
    yard = [clear(f"yard.{n}", 3.0 - n / 10) for n in range(1, 8)]
    at = "m at 1.000 s (0.5000, 0.2500) m"
    assert told(printed(*yard, clear("post", 0.5), clear("hall.1", 0.1))) == [
        ("holds", f"clearance of effector to hall.1 margin 0.1 {at}"),
        ("holds", f"clearance of effector to post margin 0.5 {at}"),
        ("holds", f"clearance of effector to yard.7 and 6 more pieces margin 2.3 {at}"),
    ]


def test_pieces_that_hold_do_not_hide_one_that_fails() -> None:
    first, second = told(
        printed(clear("yard.1", 0.2), clear("yard.2", 0.3), clear("yard.3", 0.4, Status.UNDECIDED))
    )
    assert (first[0], second[0]) == ("undecided", "holds")
    assert "yard.1 and 1 more pieces" in second[1]


def test_a_condition_is_one_line_where_that_has_80_columns() -> None:
    plane = CheckedCondition("target T", Status.HOLDS, 0.000199981, "m", 2.0, (0.1998, -1.2002))
    assert printed(plane) == [
        "  holds     target T       margin 0.000199981 m  at 2.000 s (0.1998, -1.2002) m"
    ]
    space = replace(plane, name="clearance of body 12 to Post", place=(0.1998, -1.2002, 0.5))
    assert printed(space) == [
        "  holds     clearance of body 12 to Post",
        "              margin 0.000199981 m  at 2.000 s (0.1998, -1.2002, 0.5000) m",
    ]


@given(
    name=st.text("ab (,)", max_size=200),
    margin=st.floats(-1e300, 1e300),
    place=st.lists(st.floats(-1e6, 1e6), max_size=3),
    outcome=st.sampled_from(Outcome),
    folder=st.text("ab /'", max_size=120),
)
def test_no_line_has_more_than_80_columns(
    name: str, margin: float, place: list[float], outcome: Outcome, folder: str
) -> None:
    """And no word is lost: all have at most 80 letters here."""
    name = " ".join(re.findall(r"\S{1,60}", name))
    condition = CheckedCondition(name or "x", Status.HOLDS, margin, "N*m", 1.0, tuple(place))
    report = Report(
        outcome, "found", "validated", None, (condition,), "Task", "a.srg", "0" * 64, "feedback"
    )
    text = f"{verification_text(report)}\n{after_verification(report, folder)}"
    assert max(map(len, text.splitlines())) <= 80
    assert set(name.split()) <= set(text.split())


def test_margins_have_units_and_shares_say_of_what() -> None:
    held = CheckedCondition("start held", Status.HOLDS, 0.25, "1", 0.0)
    pivots = CheckedCondition("mass matrix", Status.HOLDS, 0.5, "SI", 0.0)
    rate = CheckedCondition("rate of joint 1", Status.HOLDS, 0.75, "rad/s", 0.0)
    assert told(printed(held, pivots, rate)) == [
        ("holds", "start held margin 0.25 of the bound at 0.000 s"),
        ("holds", "mass matrix margin 0.5 (SI) at 0.000 s"),
        ("holds", "rate of joint 1 margin 0.75 rad/s at 0.000 s"),
    ]
