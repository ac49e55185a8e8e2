"""Row 4.11: a counterexample is about the parameters at which it was found."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from grammar_lang.load import load
from solvers.run_context import RunContext
from solvers.search.search_state import StructureState
from solvers.search.structure_search import StructureSearch
from solvers.search.synthesis import synthesise
from solvers.trajectory.control import synthesise_control
from solvers.trajectory.linear_model import PositionRows
from tests.oracles.small_specs import TURNER, replaced
from tests.oracles.turning_link import DT, one_link

GIVEN_UP = StructureState(reason="no path can be followed")
STEPS, HEIGHT, BOUND = 8, 1.0, 1.2


def least_torque(length: float) -> float:
    """To lift the tip of a rod to the height from rest, with a constant torque for T = 1 s."""
    return 2 * length**3 / 3 * np.arcsin(HEIGHT / length) / (STEPS * DT) ** 2


@pytest.mark.parametrize(("length", "possible"), [(1.5, False), (1.05, True)])
def test_what_one_length_cannot_follow_another_can(length: float, *, possible: bool) -> None:
    """1.64 N m are needed with 1.5 m, 0.97 N m with 1.05 m, and 1.2 N m there are."""
    assert (least_torque(length) < BOUND) == possible
    problem, seed = one_link(STEPS, BOUND, np.inf)
    rows = PositionRows(
        np.array([STEPS]), np.array([0]), np.array([[0.0, -1.0]]), np.array([-HEIGHT])
    )
    seed = replace(seed, theta=np.array([length]))
    outcome = synthesise_control(replace(problem, rows_of=lambda *_: rows), seed)
    assert outcome.feasible == possible
    if possible:
        assert outcome.effort_peak == pytest.approx(least_torque(length), rel=1e-3)


def test_a_search_that_finds_nothing_refutes_nothing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """However many paths were blocked: the verdict is unknown, also with a bound on modules."""
    path = tmp_path / "turner.srg"
    text = replaced(TURNER, "  horizon 10", "  modules <= 4;\n  horizon 10")
    path.write_text(text, encoding="utf-8")
    program = load(path).program
    assert program is not None
    monkeypatch.setattr(StructureSearch, "states", lambda *_: iter([GIVEN_UP]))
    result = synthesise(program, program.tasks["Turn"], RunContext())
    assert result.verdict == "unknown"
    unresolved = [record for record in result.records if record.verdict == "unresolved"]
    assert [" ".join(record.word) for record in unresolved] == ["B eps JO eps L eps EN"]
