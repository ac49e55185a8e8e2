"""What `verify` prints of many findings."""

from __future__ import annotations

from solvers.verifier.proofs.checked_condition import CheckedCondition
from solvers.verifier.proofs.tube_checks import Status
from solvers.verifier.verification import Outcome, Report
from srgc.text_reports.verification_report import verification_text


def clear(name: str, margin: float, status: Status = Status.HOLDS) -> CheckedCondition:
    return CheckedCondition(
        f"clearance of effector to {name}", status, margin, "m", 1.0, (0.5, 0.25)
    )


def printed(*findings: CheckedCondition) -> list[str]:
    report = Report(Outcome.VALID, "found", "validated", None, findings)
    head, *lines = verification_text(report).splitlines()
    assert head == "valid: found, level validated"
    return lines


def test_the_pieces_of_a_map_are_one_line_with_the_least_margin() -> None:
    yard = [clear(f"yard.{n}", 3.0 - n / 10) for n in range(1, 8)]
    lines = printed(*yard, clear("post", 0.5), clear("hall.1", 0.1))
    assert [line.split("to ")[1].split("  ")[0].split(" margin")[0].strip() for line in lines] == [
        "hall.1",
        "post",
        "yard.7 and 6 more pieces",
    ]
    assert "margin 2.3 m  at 1.000 s (0.5000, 0.2500)" in lines[2]


def test_pieces_that_hold_do_not_hide_one_that_fails() -> None:
    lines = printed(
        clear("yard.1", 0.2), clear("yard.2", 0.3), clear("yard.3", 0.4, Status.UNDECIDED)
    )
    assert [line.split()[0] for line in lines] == ["undecided", "holds"]
    assert "yard.1 and 1 more pieces" in lines[1]


def test_names_are_in_one_column() -> None:
    long = CheckedCondition(
        "satisfy 1: eventually[0 s, 3 s] (A and eventually B)", Status.HOLDS, 0.1, "m"
    )
    lines = printed(long, clear("post", 0.5))
    assert len({line.index("margin") for line in lines}) == 1
