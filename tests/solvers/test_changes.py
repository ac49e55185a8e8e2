"""Changes of a line: what they are called, and that the task is changed so and not otherwise."""

from __future__ import annotations

from fractions import Fraction

import pytest

import solvers.explanation.run as run_module
from compiler.time_limits.time_limit import OutOfTimeError
from grammar_lang import ir
from grammar_lang.ir.constants import rational
from grammar_lang.load import load_text
from solvers.explanation.change import (
    Change,
    single_changes,
    with_budget,
    with_feedback,
    with_shorter_steps,
)
from solvers.explanation.explanation import Asked, Tried, explain
from solvers.explanation.posed_task import PosedTask
from solvers.explanation.relaxation import without
from solvers.explanation.run import Runs, Suggestion
from solvers.explanation.scale import Scale, scales
from solvers.explanation.suggestions import SuggestionSearch
from solvers.explanation.task_line import TaskLine, control_line, task_lines
from solvers.run_context import RunContext
from solvers.search.synthesis import Synthesis
from tests.oracles.small_specs import TURNER, replaced


def posed(text: str) -> PosedTask:
    program = load_text(text, "spec.srg").program
    assert program is not None
    (task,) = program.tasks.values()
    return PosedTask(program, task)


def line(asked: PosedTask, kind: str) -> TaskLine:
    return next(each for each in task_lines(asked) if each.kind == kind)


def scale(asked: PosedTask, kind: str, number: int = 0) -> Scale:
    return list(scales(asked, line(asked, kind)))[number]


def domain(asked: PosedTask) -> ir.Interval | ir.Choices:
    return asked.program.modules["L"].parameters[0].domain


def test_a_range_goes_up_or_down_by_two_digits() -> None:
    asked = posed(TURNER)
    up, down = scales(asked, line(asked, "parameter"))
    assert [float(value) for value in up.values[:2]] == [2.1, 2.2]
    assert [float(value) for value in down.values[:2]] == [0.99, 0.98]
    change = up.at(Fraction(21, 10))
    assert change.says == "with `L.length` up to 2.1 m"
    assert domain(change.posed) == ir.Interval(ir.Num(Fraction(1)), ir.Num(Fraction(21, 10)))
    lower = down.at(Fraction(99, 100))
    assert lower.says == "with `L.length` down to 0.99 m"
    assert domain(lower.posed) == ir.Interval(ir.Num(Fraction(99, 100)), ir.Num(Fraction(2)))


def test_a_choice_more() -> None:
    asked = posed(replaced(TURNER, "in [1, 2] m", "in {1, 1.5} m"))
    found = domain(scale(asked, "parameter").at(Fraction(8, 5)).posed)
    assert isinstance(found, ir.Choices)
    assert [rational(value) for value in found.values] == [1, Fraction(3, 2), Fraction(8, 5)]


def test_an_effort_and_a_horizon_grow() -> None:
    asked = posed(TURNER)
    effort = scale(asked, "effort")
    assert (effort.values[0], effort.values[-1]) == (11, 640)
    change = effort.at(Fraction(12))
    assert change.says == "with `effort <= 12 N*m`"
    assert [each.bound for each in change.posed.task.effort] == [12]
    horizon = scale(asked, "horizon")
    assert (horizon.values[0], horizon.values[-1]) == (11, 40)
    assert horizon.at(Fraction(13)).posed.task.steps == 13
    long = posed(replaced(TURNER, "horizon 10", "horizon 201"))
    assert scale(long, "horizon").values[-1] == 302


def test_changes_keep_that_a_motion_may_be_shorter() -> None:
    asked = posed(replaced(TURNER, "horizon 10", "horizon at most 10"))
    about = line(asked, "horizon")
    assert about.says == "the motion ends after at most 10 steps"
    assert line(posed(TURNER), "horizon").says == "the motion ends after 10 steps"
    longer = scale(asked, "horizon").at(Fraction(13))
    assert longer.says == "with at most 13 steps"
    finer = with_shorter_steps(asked, about, 2)
    assert finer.says == "with `horizon at most 20 steps of 0.1 s`"
    relaxed = without(asked, [about]).task
    for task in (longer.posed.task, finer.posed.task, relaxed):
        assert task.at_most
    assert relaxed.steps >= 1000 * 10


def test_fewer_steps_are_no_change_where_they_do_the_task(monkeypatch: pytest.MonkeyPatch) -> None:
    tried = list[str]()
    monkeypatch.setattr(Runs, "run", lambda _, change: tried.append(change.says))
    for most, fewer in (("", True), ("at most ", False)):
        tried.clear()
        asked = posed(replaced(TURNER, "horizon 10", f"horizon {most}10"))
        runs = Runs(RunContext())
        SuggestionSearch(asked, runs).otherwise(line(asked, "horizon"))
        assert ("with 7 steps" in tried) == fewer
        assert f"with `horizon {most}20 steps of 0.1 s`" in tried


def test_runs_do_not_look_for_the_least_time(monkeypatch: pytest.MonkeyPatch) -> None:
    asked = posed(
        replaced(TURNER, "horizon 10", "minimize modules then time then mass; horizon at most 10")
    )
    kinds = list[str]()

    def synthesised(_: object, task: ir.Task, __: object) -> object:
        kinds.extend(each.kind for each in task.minimize)
        raise OutOfTimeError

    monkeypatch.setattr(run_module, "synthesise", synthesised)
    with pytest.raises(OutOfTimeError):
        Runs(RunContext()).run(scale(asked, "effort").at(Fraction(12)))
    assert kinds == ["modules", "mass"]


def test_bounds_grow_on_every_side() -> None:
    change = scale(posed(TURNER), "bounds").at(Fraction(5))
    shape = change.posed.workspace.bounds.shape
    assert isinstance(shape, ir.Inequalities)
    rows = {(row.normal, row.offset) for row in shape.rows}
    wanted = {((1, 0), 3.2), ((-1, 0), 1.2), ((0, 1), 3.2), ((0, -1), 1.2)}
    assert {(tuple(map(int, n)), float(b)) for n, b in rows} == wanted


SLIDE = """
module B { role base; }
module Lift { role joint; dof s: prismatic y in RANGE; }
module Hand { role effector; }
edge e;
grammar G {
  start S; b: S -> B; l: S -> S e Lift; h: S -> S e Hand; accept matches B e Lift e Hand;
}
semantics G {
  b { this.frame = world; }
  l { this.frame = S.frame * move(y, Lift.s); point(frame: this.frame, mass: 1 kg); }
  h { this.frame = S.frame; effector(frame: this.frame); }
}
workspace W {
  plane xy; bounds box [-3, 3] x [-3, 3] m; region A box [-1, 1] x [-1, 1] m; target T box TARGET m;
}
task Go { robot G; workspace W; start in A; reach T; effort <= 90 N; horizon 20 steps of 0.1 s; }
"""


@pytest.mark.parametrize(
    ("limits", "target", "wanted", "least"),
    [
        ("[-25, 0] cm", "[-1, 1] x [0.7, 0.9]", "with `Lift.s` up to", 70),
        ("[-25, 1] cm", "[-1, 1] x [0.7, 0.9]", "with `Lift.s` up to", 70),
        ("[0, 50] cm", "[-1, 1] x [-0.9, -0.7]", "with `Lift.s` down to", -70),
        ("[10, 50] cm", "[-1, 1] x [-0.9, -0.7]", "with `Lift.s` down to", -70),
    ],
)
def test_a_slide_whose_range_ends_near_zero(
    limits: str, target: str, wanted: str, least: float
) -> None:
    """An end at 0 moves as far as any other: the conflict names the range, a run its end in cm."""
    asked = posed(SLIDE.replace("RANGE", limits).replace("TARGET", target))
    tried = Tried("impossible", "", (("h", "l", "b"),))
    found = explain(asked, tried, Asked(runs=4))
    kinds = {line.kind for conflict in found.conflicts.found for line in conflict.lines}
    assert kinds == {"joint_range", "reach"}
    changes = [each.change for each in found.suggestions if each.change.line is not None]
    (end,) = {each.value for each in changes if each.says.startswith(wanted)}
    assert end is not None
    assert 1 <= float(end) / least <= 2


@pytest.mark.parametrize(
    ("old", "new", "kind", "wanted"),
    [
        ("reach T;", "reach T by effector 1 at rest;", "reach",
         ["with any effector ending in `T`", "without `at rest` at the end"]),
        ("reach T;", "reach T at rest for 0.3 s;", "reach",
         ["with `at rest` at the last instant alone", "without `at rest` at the end"]),
        ("reach T;", "reach T rates <= 0.02 rad/s;", "reach",
         ["without `rates <= 0.02` at the end"]),
        ("start in S at rest;", "start in S by effector 1 at rest;", "start",
         ["with any effector starting in `S`"]),
        ("with effector;", "with body margin 1 cm;", "avoid",
         ["without the margin", "with `O` avoided by effectors alone", "without avoiding `O`"]),
        ("reach T;", "reach T; bounds with body;", "bounds_body", ["without `bounds with body`"]),
        ("reach T;", "reach T; satisfy always not O;", "satisfy", ["without this formula"]),
        ("reach T;", "satisfy eventually T;", "satisfy", []),
        ("reach T;", "reach T;", "joint_range", ["without a limit of `JO.q`"]),
    ],
)  # fmt: skip
def test_parts_that_are_dropped(old: str, new: str, kind: str, wanted: list[str]) -> None:
    asked = posed(replaced(TURNER, old, new))
    changes = list(single_changes(asked, line(asked, kind)))
    assert [change.says for change in changes] == wanted
    assert all(change.posed != asked for change in changes)


DISTURBED = replaced(
    TURNER,
    "  effort <= 10 N*m;\n",
    "  effort <= 10 N*m;\n  control open loop;\n"
    "  robust start 2 deg, 2 deg/s;\n  robust effort 2 % of bound;\n",
)
"""Errors that no fixed list of inputs bears: 0.9 m after two seconds."""


def test_where_feedback_may_help() -> None:
    """Where inputs are fixed, or motions are disturbed; not where nothing asks for it."""
    asked = posed(DISTURBED)
    found = control_line(asked)
    assert found is not None
    assert DISTURBED[found.span.start : found.span.end].startswith("control open loop")
    change = with_feedback(asked, found)
    assert (change.says, change.posed.task.control) == ("with `control feedback`", "feedback")
    assert change.posed.task.robust == asked.task.robust
    either = control_line(posed(replaced(DISTURBED, "  control open loop;\n", "")))
    assert either is not None
    assert DISTURBED.replace("  control open loop;\n", "")[either.span.start :].startswith("robust")
    assert control_line(posed(TURNER)) is None
    assert control_line(posed(replaced(DISTURBED, "control open loop", "control feedback"))) is None


def test_feedback_is_suggested_where_a_run_proves_it() -> None:
    told: list[str] = []
    found = explain(posed(DISTURBED), Tried("unknown", "", ()), Asked(runs=1, tell=told.append))
    (suggestion,) = found.suggestions
    assert suggestion.change.says == "with `control feedback`"
    assert suggestion.change.line.kind == "control"
    assert 0 < suggestion.effort_peak < 10
    assert told == ["run 1 of at most 1: with `control feedback`"]


SLOW = replaced(
    replaced(TURNER, "10 steps of 0.2 s", "4 steps of 0.5 s"),
    "  effort <= 10 N*m;\n",
    "  effort <= 10 N*m;\n  control feedback;\n  robust effort 30 % of bound;\n",
)
"""3 N*m on at most 8/3 kg*m^2 turn the link by 0.14 rad within a step, and on 1/3 by 1.1 rad."""


def test_shorter_steps_take_as_long() -> None:
    asked = posed(SLOW)
    change = with_shorter_steps(asked, line(asked, "horizon"), 5)
    assert change.says == "with `horizon 20 steps of 0.1 s`"
    before, after = asked.task, change.posed.task
    assert (after.steps, after.step) == (20, Fraction(1, 10))
    assert after.steps * after.step == before.steps * before.step
    assert after.robust == before.robust


def test_shorter_steps_may_be_copied_into_the_spec() -> None:
    text = replaced(SLOW, "4 steps of 0.5 s", "6 steps of (1/3) s")
    asked = posed(text)
    change = with_shorter_steps(asked, line(asked, "horizon"), 2)
    clause = change.says.removeprefix("with `horizon ").removesuffix("`")
    again = posed(replaced(text, "6 steps of (1/3) s", clause)).task
    assert (again.steps, again.step) == (12, Fraction(1, 6))


def test_a_controller_that_samples_too_seldom_samples_more_often() -> None:
    told: list[str] = []
    found = explain(posed(SLOW), Tried("unknown", "", ()), Asked(runs=1, tell=told.append))
    assert [each.change.says for each in found.suggestions] == ["with `horizon 20 steps of 0.1 s`"]
    assert told == ["run 1 of at most 1: with `horizon 20 steps of 0.1 s`"]


@pytest.mark.parametrize("clause", ["control open loop;\n  robust effort 30 % of bound;", ""])
def test_shorter_steps_are_not_tried_where_nothing_is_fed_back(clause: str) -> None:
    text = replaced(SLOW, "control feedback;\n  robust effort 30 % of bound;", clause)
    asked = posed(text)
    runs = Runs(RunContext(), 1)
    SuggestionSearch(asked, runs).shorter(line(asked, "horizon"))
    assert runs.made == 0


class Vain(Runs):
    """Runs that all fail, at once."""

    def run(self, change: Change) -> Suggestion | None:
        self.failed.append(change)
        return None


def test_where_nothing_helps_shorter_horizons_finer_steps_and_budgets_are_tried() -> None:
    """Of ten steps of 0.2 s; limits of joints come after all of them."""
    asked = posed(TURNER)
    runs = Vain(RunContext(paths=3, evaluations=5), limit=100)
    SuggestionSearch(asked, runs).after_motions(task_lines(asked), ())
    said = [change.says for change in runs.failed]
    tried = [
        "with 7 steps", "with 5 steps", "with `horizon 20 steps of 0.1 s`",
        "with `--paths 6 --evaluations 10`",
    ]  # fmt: skip
    first = said.index(tried[0])
    assert said[first : first + 4] == tried
    assert all("limit of" not in each for each in said[:first])
    assert [each.line for each in runs.failed if each.budget > 1] == [None]


def test_a_larger_budget_is_what_its_run_has(monkeypatch: pytest.MonkeyPatch) -> None:
    asked, seen = posed(TURNER), list[RunContext]()

    def searched(_: object, __: object, context: RunContext, *, told: object = None) -> Synthesis:
        seen.append(context)
        raise OutOfTimeError

    monkeypatch.setattr(run_module, "synthesise", searched)
    runs = Runs(RunContext(paths=3, evaluations=5))
    for change in (with_budget(asked, 4, 3, 5), scale(asked, "horizon").at(Fraction(13))):
        with pytest.raises(OutOfTimeError):
            runs.run(change)
    assert [(each.paths, each.evaluations) for each in seen] == [(12, 20), (3, 5)]
