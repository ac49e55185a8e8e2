"""Where Theorem 1 holds, the best of a robot is handed on to the longer one.

Where it does not: ``tests/errata/test_row_4_09.py``.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np
import pytest

import solvers.handing_on
from solvers.structure_search import StructureSearch
from solvers.synthesis import Synthesis
from tests.oracles.extended_arm import all_designs

Run = Callable[[str], Synthesis]


@pytest.fixture
def run(tmp_path: Path) -> Run:
    return partial(all_designs, tmp_path)


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
