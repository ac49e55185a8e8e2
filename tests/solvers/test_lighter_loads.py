"""Payloads that are lighter, and the order in which changes of conflicts are tried."""

from __future__ import annotations

from fractions import Fraction
from math import pi

import pytest

from solvers.explanation.change import Change
from solvers.explanation.run import Runs, Suggestion
from solvers.explanation.suggestions import SuggestionSearch
from solvers.explanation.task_line import task_lines
from solvers.run_context import RunContext
from solvers.search.synthesis import synthesise
from tests.oracles.small_specs import TURNER, replaced
from tests.solvers.test_changes import Vain, line, posed, scale

CARRIES = replaced(TURNER, "reach T;", "reach T; payload 3 kg;")


def test_a_payload_gets_lighter_by_two_digits() -> None:
    asked = posed(CARRIES)
    lighter = scale(asked, "payload")
    assert lighter.values[:2] == (Fraction(29, 10), Fraction(28, 10))
    assert lighter.values[-1] == Fraction(3, 20)
    change = lighter.at(Fraction(6, 5))
    assert change.says == "with `payload 1.2 kg`"
    assert [each.mass for each in change.posed.task.payloads] == [Fraction(6, 5)]
    named = posed(replaced(CARRIES, "3 kg", "300 g by effector 1"))
    heavy = scale(named, "payload").at(Fraction(1, 5))
    assert heavy.says == "with `payload 0.2 kg by effector 1`"
    assert named.program.tasks.keys() == heavy.posed.program.tasks.keys()


class Below(Vain):
    """Runs that find a robot wherever a payload is below a bound."""

    most = Fraction(0)

    def run(self, change: Change) -> Suggestion | None:
        (payload,) = change.posed.task.payloads or (None,)
        mass = 0 if payload is None else payload.mass
        if change.line is None or change.line.kind != "payload" or mass > self.most:
            self.failed.append(change)
            return None
        self.found.append(Suggestion(change, (), 0.0, 0.0, {}))
        return self.found[-1]


@pytest.mark.parametrize("most", ["2.95", "2", "0.4", "0.16"])
def test_the_heaviest_payload_is_found_within_a_few_runs(most: str) -> None:
    """The bound is met within a factor of 20^(1/8), from four runs."""
    asked = posed(CARRIES)
    runs = Below(RunContext(), limit=100)
    runs.most = Fraction(most)
    SuggestionSearch(asked, runs).lighter(line(asked, "payload"))
    best = max(each.change.value or 0 for each in runs.found)
    assert len(runs.found) + len(runs.failed) <= 4
    assert best <= runs.most <= best * Fraction(3, 2)


def test_where_no_payload_helps_the_last_try_is_without_it() -> None:
    asked = posed(CARRIES)
    runs = Vain(RunContext(), limit=100)
    SuggestionSearch(asked, runs).lighter(line(asked, "payload"))
    assert [each.says for each in runs.failed] == ["with `payload 0.15 kg`", "without the payload"]


def test_ranges_are_widened_at_once_where_poses_say_nothing() -> None:
    """Poses are there already: the largest change first, drives and payloads before ranges.

    Before the largest effort comes that of a straight motion: at most 5.8 times half a turn over
    the square of 2 s, for 3 kg at 2 m and the link.
    """
    asked = posed(CARRIES)
    runs = Vain(RunContext(), limit=100)
    kinds = ("parameter", "payload", "effort")
    SuggestionSearch(asked, runs).after_conflicts([line(asked, kind) for kind in kinds], ())
    straight, *said = [each.says for each in runs.failed]
    assert straight.startswith("with `effort <= ")
    assert 10 < (runs.failed[0].value or 0) <= 5.8 * pi / 2**2 * (3 * 2**2 + 2**3 / 3)
    assert said == [
        "with `effort <= 640 N*m`", "with `payload 0.15 kg`", "without the payload",
        "with `L.length` up to 4.2 m", "with `L.length` down to 0.5 m",
    ]  # fmt: skip


HOIST = """
module Rail { role base; dof sx: prismatic x in [-1, 1] m effort <= 50 N; port out: P;
  frame out = in * move(x, sx); }
module Boom { role joint; dof sy: prismatic x in [-1, 1] m effort <= 50 N; port in: P; port out: Q;
  point(frame: in, mass: 1 kg); frame out = in * move(x, sy); }
module Hook { role effector; dof sz: prismatic y in [-1, 1] m effort <= 15 N; port in: Q;
  frame end = in * move(y, sz); point(frame: end, mass: 2 kg); effector(frame: end); }
grammar Hoist from ports { start Rail; with Boom, Hook; accept count(Boom) == 1; }
workspace W { plane xy; bounds box [-2, 2] x [-2, 2] m;
  region S box [-0.1, 0.1] x [-0.1, 0.1] m; target T box [0.4, 0.6] x [0.4, 0.6] m; }
task Lift { robot Hoist; workspace W; start in S at rest; reach T at rest;
  gravity (0, -9.81) m/s^2; horizon 20 steps of 0.1 s; }
"""


def test_the_drive_that_carries_the_weight_comes_first() -> None:
    """It is the last in the file: 2 kg weigh 19.6 N, and it has 15 N."""
    asked = posed(HOIST)
    runs = Vain(RunContext(), limit=100)
    SuggestionSearch(asked, runs).drives(task_lines(asked))
    drives = ["Hook.sz", "Boom.sy", "Rail.sx"]
    said = [each.says.partition(" of ")[2].strip("`") for each in runs.failed]
    assert said[0] == drives[0]
    assert sorted(list(dict.fromkeys(said))[:3]) == sorted(drives)
    first = runs.failed[0].value
    # The weight, and at most what half a metre in 2 s takes besides: 5.8 * 0.5 m / 4 s^2 * 2 kg.
    assert first is not None
    assert 19.62 <= first <= 19.62 + 1.45 + 0.8
    assert runs.failed[-1].line is not None
    assert runs.failed[-1].line.kind == "horizon"


def test_a_run_ends_with_its_first_proof() -> None:
    """Which shows that there is a robot; what would improve it is not tried."""
    told = list[Suggestion]()
    runs = Runs(RunContext(), helps=told.append)
    found = runs.run(scale(posed(TURNER), "horizon").at(Fraction(13)))
    assert found is not None
    assert told == [found]
    whole = synthesise(found.change.posed.program, found.change.posed.task, RunContext())
    assert whole.design is not None
    assert found.robustness < whole.design.configuration.outcome.robustness
