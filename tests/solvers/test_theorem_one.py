"""Theorem 1: adding a module never lowers the best robustness; true only under its hypothesis."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import solvers.handing_on
from grammar_lang.load import load
from solvers.progress import Conduct
from solvers.structure_search import StructureSearch
from solvers.synthesis import Synthesis, synthesise
from tests.oracles.extended_arm import best_robustness, extended_arm

Run = Callable[[str], Synthesis]


@pytest.fixture
def run(tmp_path: Path) -> Run:
    def all_designs(extension: str) -> Synthesis:
        path = tmp_path / "arm.srg"
        path.write_text(extended_arm(extension), encoding="utf-8")
        program = load(path).program
        assert program is not None
        (task,) = program.tasks.values()
        return synthesise(program, task, Conduct(), every=True)

    return all_designs


def robustness(result: Synthesis) -> list[float]:
    return [proved.design.robustness for proved in result.designs]


def test_where_the_hypothesis_holds_the_longer_robot_is_as_robust(run: Run) -> None:
    """Lengths from 0: the extension is neutral at 0, and any length of it only costs."""
    result = run("[0, 1]")
    shorter, longer = robustness(result)
    assert longer >= shorter - 1e-6
    # Both have the same optimum, that of mechanics, which no motion exceeds.
    optimum = best_robustness(1.0)
    assert optimum - 0.01 < shorter < optimum
    assert longer < optimum
    assert [proved.number for proved in result.designs] == [0, 1]
    assert result.ended is None


def test_where_it_fails_the_longer_robot_is_less_robust(run: Run) -> None:
    """Lengths from 0.5 m: the longer arm reaches 1.5 m at least; the proved motion beats that."""
    result = run("[0.5, 1]")
    shorter, longer = robustness(result)
    assert best_robustness(1.5) < shorter < best_robustness(1.0)
    assert longer < best_robustness(1.5) < shorter - 0.3
    assert [record.reason for record in result.records] == ["proved", "proved"]


def test_what_is_handed_on_is_kept_where_the_search_finds_less(
    run: Run, monkeypatch: pytest.MonkeyPatch
) -> None:
    """With a search of the longer robot that finds nothing, the shorter one's motion is proved."""
    searched = StructureSearch.design

    def only_the_first(self: StructureSearch, recorded: int):
        return searched(self, recorded) if self.number == 0 else (None, "nothing was found")

    monkeypatch.setattr(StructureSearch, "design", only_the_first)
    monkeypatch.setattr(solvers.handing_on, "_improved", lambda *_: None)
    first, second = (proved.design for proved in run("[0, 1]").designs)
    assert first.inputs == second.inputs
    assert first.start == second.start
    assert [item.value for item in second.parameters] == [first.parameters[0].value, "0"]
    assert [item.symbol for item in second.parameters] == [4, 6]
    assert second.robustness == first.robustness


def test_a_shortfall_is_said(run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    """Where nothing can be handed on, the record of the longer robot names the shorter one."""
    monkeypatch.setattr(solvers.handing_on, "_improved", lambda *_: None)
    monkeypatch.setattr(solvers.handing_on, "_kept", lambda *_: None)
    searched = StructureSearch.design

    def weaker(self: StructureSearch, recorded: int):
        design, reason = searched(self, recorded)
        if self.number == 0 or design is None:
            return design, reason
        outcome = replace(design.configuration.outcome, robustness=0.1)
        return replace(design, configuration=replace(design.configuration, outcome=outcome)), reason

    monkeypatch.setattr(StructureSearch, "design", weaker)
    result = run("[0, 1]")
    assert result.records[1].reason.startswith("proved; less robust than structure 0")


def test_a_longer_robot_is_tried_at_what_was_best_of_the_shorter(run: Run) -> None:
    result = run("[0, 1]")
    first = {each.structure: each.samples[0].theta for each in reversed(result.samples)}
    best = result.designs[0].design.configuration.outcome.trajectory.theta
    np.testing.assert_allclose(first[1], [best[0], 0.0], rtol=1e-12)
