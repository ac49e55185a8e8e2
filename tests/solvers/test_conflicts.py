"""The conflicts of small robots against what elementary geometry says of their reach."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from itertools import combinations

import pytest

from compiler.robots.normal_form import family_of
from compiler.words.derivation import Derivation
from compiler.words.structures import derivations_of, structures
from grammar_lang.load import load_text
from solvers.explanation import explanation, required_poses
from solvers.explanation.change import Change
from solvers.explanation.conflict import Conflict, ConflictSearch, Evidence, separation_conflict
from solvers.explanation.explanation import Asked, Tried, explain, quick_conflict
from solvers.explanation.posed_task import PosedTask
from solvers.explanation.relaxation import without
from solvers.explanation.required_poses import first_with_poses
from solvers.explanation.run import Runs
from solvers.explanation.suggestions import SuggestionSearch
from solvers.explanation.task_line import TaskLine, task_lines
from solvers.run_context import RunContext
from tests.oracles.small_specs import SLIDER, TURNER, replaced

ONE_LINK = ("B", "eps", "JO", "eps", "L", "eps", "EN")
TWO_LINKS = ("B", "eps", "JO", "eps", "L", "eps", "JO", "eps", "L", "eps", "EN")
TWO_HANDS = """\
module B { role base; }
module J { role joint; dof q: revolute z; }
module K { role joint; dof q: revolute z; }
module L { role link; param length in [1, 2] m; }
module H { role link; param length in [0.5, 0.8] m; }
module EN { role effector; const mass = 1 kg; }
edge eps, '[', ']';
grammar Hands {
  start R;
  body: R -> B '[' left:Long ']' '[' right:Short ']';
  far:  Long -> J eps L eps EN;
  near: Short -> K eps H eps EN;
}
semantics Hands {
  body { left.at = this.frame; right.at = this.frame; }
  far {
    this.end = this.at * rot(z, J.q) * move(x, L.length);
    point(frame: this.end, mass: EN.mass); effector(frame: this.end);
  }
  near {
    this.end = this.at * rot(z, K.q) * move(x, H.length);
    point(frame: this.end, mass: EN.mass); effector(frame: this.end);
  }
}
workspace W {
  plane xy;
  bounds box [-3, 3] x [-3, 3] m;
  region S box [1.2, 1.4] x [-0.1, 0.1] m;
  target T box [1.2, 1.4] x [0.2, 0.4] m;
}
task Reach {
  robot Hands; workspace W;
  start in S by effector 1; reach T by effector 2;
  effort <= 10 N*m; horizon 10 steps of 0.2 s; modules <= 7;
}
"""


def posed(text: str) -> PosedTask:
    program = load_text(text, "spec.srg").program
    assert program is not None
    (task,) = program.tasks.values()
    return PosedTask(program, task)


def conflict(text: str, word: tuple[str, ...]) -> tuple[TaskLine, ...] | None:
    asked = posed(text)
    language = family_of(asked.program, asked.task).language
    (derivation,) = derivations_of(language, word)
    return ConflictSearch(asked, RunContext()).conflict(derivation)


def names(lines: tuple[TaskLine, ...] | None) -> set[str]:
    assert lines is not None
    return {" ".join((line.kind, *map(str, line.key))) for line in lines}


def lengths(low: float, high: float, near: float, far: float) -> str:
    """Links; a start ``near`` to ``far`` m from the base, and a target 1.25 to 1.94 m from it."""
    region = f"region S box [{near}, {far}] x [-0.05, 0.05] m"
    text = replaced(TURNER, "region S box [1.2, 1.9] x [-0.3, 0.3] m", region)
    text = replaced(text, "x [1.2, 1.9] m;", "x [1.25, 1.9] m;")
    return replaced(text, "[1, 2] m", f"[{low}, {high}] m")


@pytest.mark.parametrize(
    ("low", "high", "near", "far", "wanted"),
    [
        (0.3, 1.0, 0.9, 1.4, {"reach", "parameter L length"}),  # 1.25 m is out of reach
        (0.3, 2.0, 0.5, 0.6, {"start", "reach"}),  # no length serves both places
        (
            1.0,
            1.2,
            1.3,
            1.4,
            {"start", "parameter L length"},
        ),  # neither is in reach: the first is told
    ],
)
def test_one_link(low: float, high: float, near: float, far: float, wanted: set[str]) -> None:
    assert names(conflict(lengths(low, high, near, far), ONE_LINK)) == wanted


def test_two_links_are_not_refuted() -> None:
    assert conflict(lengths(0.3, 1.0, 0.5, 0.6), TWO_LINKS) is None


@pytest.mark.parametrize("bound", ["1e-3", "1e-9", "1e-90"])
def test_an_effort_too_small_by_any_factor_is_named(bound: str) -> None:
    """Without it the slider is found: all other lines do not rule it out."""
    weak = replaced(SLIDER, "effort <= 10 N;", f"effort <= {bound} N;")
    found = conflict(weak, ("B", "eps", "P", "eps", "M", "eps", "EN"))
    assert found is not None
    assert "effort" in {line.kind for line in found}


def test_a_robot_without_a_link_cannot_start() -> None:
    assert names(conflict(lengths(0.3, 1.0, 0.5, 0.6), ("B", "eps", "JO", "eps", "EN"))) == {
        "start"
    }


def test_the_hand_that_is_named_is_too_short() -> None:
    """Only the second hand is: 0.8 m for the target at 1.21 m; any hand would do otherwise."""
    asked = posed(TWO_HANDS)
    (derivation,) = structures(family_of(asked.program, asked.task).language, 7)
    found = ConflictSearch(asked, RunContext()).conflict(derivation)
    assert names(found) == {"reach", "parameter H length"}


def test_no_proper_part_of_a_conflict_is_refuted() -> None:
    asked = posed(TWO_HANDS)
    (derivation,) = structures(family_of(asked.program, asked.task).language, 7)
    search = ConflictSearch(asked, RunContext())
    found = search.conflict(derivation)
    assert found is not None
    parts = [part for n in range(len(found)) for part in combinations(found, n)]
    assert search.evidence(derivation, found)
    assert not any(search.evidence(derivation, part) for part in parts)


def test_the_conflict_at_the_end_of_a_synthesis_takes_few_questions(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    asked = posed(TWO_HANDS)
    (derivation,) = structures(family_of(asked.program, asked.task).language, 7)
    assert quick_conflict(asked, derivation, RunContext()).conflicts.found
    monkeypatch.setattr(explanation, "MOST_QUICK", 3)
    assert not quick_conflict(asked, derivation, RunContext()).conflicts.found


class Foreseen(ConflictSearch):
    """Refuted by the lines of places among poses where there is no link, else by the effort."""

    def evidence(
        self, derivation: Derivation, kept: Sequence[TaskLine], *, late: bool = False
    ) -> Evidence | None:
        del late
        self.questions += 1
        kinds = {line.kind for line in kept}
        self.step(f"{len(derivation.word)} {sorted(kinds)}")
        if "L" not in derivation.word:
            return "poses" if "start" in kinds else None
        return "drives" if {"effort", "horizon"} <= kinds else None


def words(asked: PosedTask, *texts: tuple[str, ...]) -> list[Derivation]:
    language = family_of(asked.program, asked.task).language
    return [next(iter(derivations_of(language, word))) for word in texts]


BARE = ("B", "eps", "JO", "eps", "EN")


def test_conflicts_of_other_evidence_are_not_tried() -> None:
    """Among poses, a refuter may search for long for what the drives rule out."""
    asked, steps = posed(TURNER), list[str]()
    search = Foreseen(asked, RunContext(), step=steps.append)
    found = search.conflicts(words(asked, BARE, ONE_LINK, TWO_LINKS))
    assert [names(each.lines) for each in found.found] == [{"effort 0", "horizon"}, {"start"}]
    assert [len(each.words) for each in found.found] == [2, 1]
    assert f"{len(ONE_LINK)} ['start']" not in steps
    # The conflict of the first robot with links is tried for the second.
    second = [step for step in steps if step.startswith(f"{len(TWO_LINKS)} ")]
    assert second[1] == f"{len(TWO_LINKS)} ['effort', 'horizon']"


def test_each_conflict_is_told_when_it_is_found() -> None:
    asked, told = posed(TURNER), list[Conflict | str]()
    search = Foreseen(asked, RunContext(), step=told.append, tell=told.append)
    robots = words(asked, BARE, ONE_LINK, TWO_LINKS)
    search.conflicts(robots, 1)
    assert isinstance(told[-1], Conflict)
    assert (names(told[-1].lines), told[-1].words) == ({"start"}, (BARE,))
    assert search.found(3).left == 2
    search.conflicts(robots)
    assert [each.words for each in told if isinstance(each, Conflict)] == [(BARE,), (ONE_LINK,)]
    assert search.found(3).left == 0


def test_changes_are_tried_before_all_robots_are_examined(monkeypatch: pytest.MonkeyPatch) -> None:
    asked, tried = posed(TURNER), list[list[str]]()

    def after(_search: SuggestionSearch, lines: Sequence[TaskLine], _bounds: object) -> None:
        tried.append(sorted(line.kind for line in lines))

    monkeypatch.setattr(explanation, "ConflictSearch", Foreseen)
    monkeypatch.setattr(explanation, "FIRST_QUESTIONS", 1)
    monkeypatch.setattr(SuggestionSearch, "after_conflicts", after)
    refuted = tuple(each.labels for each in words(asked, BARE, ONE_LINK, TWO_LINKS))
    found = explain(asked, Tried("unknown", "", refuted), Asked())
    assert tried == [["start"], ["effort", "horizon"]]
    assert found.conflicts.left == 0


class Vain(Runs):
    """Runs that all fail, at once."""

    def run(self, change: Change) -> None:
        self.failed.append(change)


def test_effort_and_horizon_are_changed_before_ranges() -> None:
    """There may be more changes of ranges than there are runs."""
    asked = posed(TURNER)
    runs = Vain(RunContext(), limit=3)
    lines = [x for x in task_lines(asked) if x.kind in ("parameter", "effort", "horizon")]
    SuggestionSearch(asked, runs).after_conflicts(lines, ())
    assert [change.line.kind for change in runs.failed] == ["effort", "horizon", "parameter"]


@pytest.mark.parametrize(("some", "found"), [((5, 60), 5), ((0, 2), 0), ((137, 138), 137)])
def test_poses_that_the_search_misses_in_a_range_far_too_wide(
    monkeypatch: pytest.MonkeyPatch, some: tuple[int, int], found: int
) -> None:
    one = posed(TURNER)
    asked = [replace(one) for _ in range(138)]

    def with_poses(given: PosedTask, *_: object, **__: object) -> tuple[str, ...]:
        place = next(i for i, each in enumerate(asked) if each is given)
        return ("robot",) if some[0] <= place < some[1] else ()

    monkeypatch.setattr(required_poses, "with_poses", with_poses)
    assert first_with_poses(asked, (), 0) == found
    nothing = asked[some[1] :] or asked[: some[0]]
    assert first_with_poses(nothing, (), 0) is None


WALLS = """\
  obstacle V box [0.4, 0.6] x [-1, 0.6] m;
  obstacle H box [0.4, 3] x [0.6, 0.8] m;
  obstacle O box [1.4, 2.5] x [1.4, 2.5] m;
"""
"""A corner of the bounds is walled off, with the start in it."""


def test_walls_about_the_start() -> None:
    text = replaced(TURNER, "  obstacle O box [1.4, 2.5] x [1.4, 2.5] m;\n", WALLS)
    found = separation_conflict(posed(replaced(text, "avoid O with", "avoid O, V, H with")))
    assert found is not None
    assert names(found.lines) == {"start", "reach", "avoid 0 V", "avoid 0 H", "bounds"}
    assert separation_conflict(posed(TURNER)) is None


def test_lines_stand_where_they_are_written() -> None:
    asked = posed(replaced(TURNER, "horizon", "gravity (0, -1) m/s^2; modules <= 4; horizon"))
    (source,) = asked.program.sources
    written = {
        " ".join((line.kind, *map(str, line.key))): source.text[line.span.start : line.span.end]
        for line in task_lines(asked)
    }
    assert written == {
        "start": "start in S at rest;",
        "reach": "reach T;",
        "parameter L length": "param length in [1, 2] m;",
        "joint_range JO q": "dof q: revolute z in [-180, 180] deg;",
        "avoid 0 O": "O",
        "effort 0": "10 N*m",
        "horizon": "horizon 10 steps of 0.2 s;",
        "gravity": "gravity (0, -1) m/s^2;",
        "bounds": "bounds box [-1, 3] x [-1, 3] m;",
    }


def test_a_line_without_which_nothing_else_changes() -> None:
    asked = posed(TURNER)
    for line in task_lines(asked):
        relaxed = without(asked, [line])
        assert relaxed != asked
        assert relaxed.program.tasks[asked.task.name] == relaxed.task
        changed = {
            name
            for name in asked.task.__slots__
            if getattr(asked.task, name) != getattr(relaxed.task, name)
        }
        assert len(changed) <= 1
        assert relaxed.program.grammars == asked.program.grammars
