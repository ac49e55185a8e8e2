"""Changes of two lines that ``why`` tries if no change of one line helps."""

from __future__ import annotations

from math import atan2, degrees

import pytest

from solvers.explanation.change import Change
from solvers.explanation.explanation import Asked, Explanation, Tried, explain
from solvers.explanation.pairs import MOST_PAIRS, PairSearch
from solvers.explanation.posed_task import PosedTask
from solvers.explanation.run import Runs, Suggestion
from solvers.explanation.suggestions import SuggestionSearch
from solvers.explanation.task_line import task_lines
from solvers.run_context import RunContext
from srgc.text_reports.why_report import why_text
from tests.oracles.small_specs import TURNER, replaced
from tests.solvers.test_changes import Vain, line, posed
from tests.solvers.test_straight_motions import gantry

SLOW = "rate in [-0.1, 0.1] m/s"
ARM = replaced(TURNER, "contains EN and starts with B eps JO", "matches B eps JO eps L eps EN")
NARROW = replaced(ARM, "[-180, 180] deg", "[-20, 30] deg")
"""The target is from atan2(1.2, 0.3) on, counted up."""
ANGLE = degrees(atan2(1.2, 0.3))


def tried(asked: PosedTask, *kinds: str) -> list[Change]:
    """The pairs that are tried after single changes of lines; none of them helps."""
    runs, lines = Vain(RunContext(), limit=100), [line(asked, kind) for kind in kinds]
    SuggestionSearch(asked, runs).after_conflicts(lines, ())
    before = len(runs.failed)
    PairSearch(asked, runs).search(lines)
    return runs.failed[before:]


def test_two_rates_that_are_too_low() -> None:
    """Neither four times the time nor any rate of one axis does; 15/8 m/s of both do, at least."""
    first, *_ = tried(posed(gantry(SLOW, SLOW)), "joint_rate", "horizon")
    assert first.lines == 2
    one, other = (part.split("rate in [-")[1] for part in first.says.split(" and "))
    assert one.endswith("of `Rail.sx`")
    assert other.endswith("of `Hook.sy`")
    for text in (one, other):
        assert 15 / 8 * 0.97 * 0.95 <= float(text.split(",")[0]) <= 15 / 8 * 1.03 + 0.1
    for module in ("Rail", "Hook"):
        (dof,) = first.posed.program.modules[module].dofs
        (old,) = posed(gantry(SLOW, SLOW)).program.modules[module].dofs
        assert dof.rate != old.rate


def test_a_range_and_an_effort() -> None:
    """A quarter turn in 2 s takes more than 0.1 N*m; what a straight motion takes is tried."""
    asked = posed(replaced(NARROW, "effort <= 10 N*m", "effort <= 0.1 N*m"))
    first, *_ = tried(asked, "joint_range")
    assert first.says.startswith("with `JO.q` up to ")
    assert " and with `effort <= " in first.says
    assert first.posed.task.effort[0].bound > asked.task.effort[0].bound
    assert first.posed.program.modules["JO"].dofs != asked.program.modules["JO"].dofs


def test_two_ranges() -> None:
    """One link that is too short, on a joint that turns too little."""
    asked = posed(replaced(NARROW, "[1, 2] m", "[0.5, 1] m"))
    first, second, *more = tried(asked, "parameter")
    assert len(more) <= MOST_PAIRS - 2
    for change in (first, second):
        length, _, angle = change.says.partition(" and ")
        assert 1.2 <= float(length.removeprefix("with `L.length` up to ").split()[0]) <= 1.7
        assert ANGLE <= float(angle.removeprefix("with `JO.q` up to ").split()[0]) <= 95
    assert first.says < second.says


def test_no_pair_is_tried_where_bounds_are_kept() -> None:
    """Straight motions keep all bounds as it is, and there are poses: nothing points to a pair."""
    assert not tried(posed(gantry()), "joint_effort", "horizon")


def test_a_pair_is_told_as_one() -> None:
    asked = posed(TURNER)
    about = task_lines(asked)[0]
    found = Explanation(asked, Tried("impossible", "", ()), runs=3)
    for count, head in ((2, "Two together do, as a run has proved,"), (1, "It is possible, as ")):
        change = Change(about, "with this and with that", asked, lines=count)
        found.suggestions = (Suggestion(change, ("B",), 0.0, 0.0, {}),)
        said = why_text(found)
        assert head in said
        assert ("No change of a single line" in said) is (count == 2)
        assert "\n  with this and with that: B\n" in said


def test_pairs_come_only_where_no_single_change_has_helped(monkeypatch: pytest.MonkeyPatch) -> None:
    asked, searched = posed(gantry(SLOW, SLOW)), list[bool]()
    monkeypatch.setattr(PairSearch, "search", lambda *_: searched.append(True))
    labels = Tried("unknown", "", ())

    def helped(runs: Runs, change: Change) -> Suggestion | None:
        one = Suggestion(change, ("Rail", "Hook"), 0.0, 0.0, {})
        runs.found.append(one)
        return one

    with monkeypatch.context() as patched:
        patched.setattr(Runs, "run", helped)
        explain(asked, labels, Asked(runs=3, pairs=MOST_PAIRS))
    assert not searched
    monkeypatch.setattr(Runs, "run", Vain.run)
    explain(asked, labels, Asked(runs=3))
    assert not searched
    explain(asked, labels, Asked(runs=3, pairs=MOST_PAIRS))
    assert searched


@pytest.mark.slow
def test_a_run_proves_a_pair() -> None:
    asked = posed(gantry(SLOW, SLOW))
    found = explain(asked, Tried("unknown", "", ()), Asked(runs=3, pairs=MOST_PAIRS))
    (one,) = found.suggestions
    assert one.change.lines == 2
    assert one.word == ("Rail", "Hook")
