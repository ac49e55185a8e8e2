"""What convex solvers say in their own words is printed for those alone who ask."""

from __future__ import annotations

import pytest

from solvers.backends.conic import NotSolved, Status
from srgc.text_reports.solver_words import without_solver_words
from tests.oracles.small_specs import SLIDER, replaced

BEFORE = "1 of 2 structures are neither built nor refuted; the first is A B: 1 path tried, best "
BEFORE += "robustness -0.2; convex step: "


@pytest.mark.parametrize("status", Status)
@pytest.mark.parametrize("detail", ["", "PrimalInfeasible", "OSError: (11, 'no')", "a " * 200])
@pytest.mark.parametrize("after", ["", "; larger robots were not tried", ")", "\nrobot:   A B"])
def test_no_status_is_left(status: Status, detail: str, after: str) -> None:
    text = BEFORE + NotSolved(status, detail).text + after
    shown = without_solver_words(text)
    assert shown == BEFORE.replace("convex step: ", "a convex program was not solved") + after


def test_other_texts_stay() -> None:
    text = "verdict: found (least price 177)\nrobust: an infeasible convex step (of 2)\n"
    assert without_solver_words(text) == text


def test_the_command_line(srgc, spec, tmp_path, monkeypatch) -> None:
    """All solvers claim that every program is infeasible.

    1.5 m from rest to rest in 2 s take at least 1.5 N, and that only by full thrust both ways: the
    smooth motions with which the search begins need more than 1.6 N.
    """
    from solvers.backends import portfolio

    def claimed(*_arguments: object) -> NotSolved:
        return NotSolved(Status.INFEASIBLE, "PrimalInfeasible")

    monkeypatch.setattr(portfolio, "_guarded", claimed)
    at_rest = replaced(SLIDER, "reach T;", "reach T at rest;").replace(
        "start in S;", "start in S at rest;"
    )
    weak = replaced(at_rest, "effort <= 10 N;", "effort <= 1.6 N;")
    asked = ("synth", spec(weak), "-o", tmp_path / "out", "-q")
    plain = srgc(*asked)
    assert plain.status == 4
    assert "a convex program was not solved" in plain.out
    assert "nfeasible" not in plain.out
    assert "convex step: infeasible (PrimalInfeasible)" in srgc(*asked, "--verbose").out
    why = ("why", tmp_path / "out", "-q", "--no-runs")
    assert "nfeasible" not in srgc(*why).out
    assert "PrimalInfeasible" in srgc(*why, "--verbose").out
