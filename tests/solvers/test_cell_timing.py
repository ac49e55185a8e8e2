"""A motion near a facet is bound to the path that it was freed along, and not to another one."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from solvers.run_context import RunContext
from solvers.search import cell_timing
from solvers.trajectory.path_following import PathProblem
from tests.solvers.test_path_following import path_problem


def test_entries_belong_to_the_cells_that_are_bound(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Two cells were visited, where three were planned."""
    first = path_problem(tmp_path)
    cells = first.abstraction
    start, near = cells.index("S"), cells.neighbours[cells.index("S")][0]
    planned = replace(first, cells=(start, near, start))
    visited = (start, near), (0, 3)
    outcome: Any = SimpleNamespace(trajectory=None, robustness=1.0, feasible=True)
    better: Any = SimpleNamespace(trajectory=None, robustness=1.1, feasible=True)
    bound = list[tuple[PathProblem, tuple[int, ...]]]()

    def bind(own: PathProblem, _: object, entries: tuple[int, ...], __: object) -> None:
        bound.append((own, entries))

    monkeypatch.setattr(cell_timing, "visited_cells", lambda *_: visited)
    monkeypatch.setattr(cell_timing, "_freed", lambda *_: better)
    monkeypatch.setattr(cell_timing, "depth_in_cells", lambda *_: 0.0)
    monkeypatch.setattr(cell_timing.Timed, "gains", lambda *_: False)
    monkeypatch.setattr(cell_timing, "_bound", bind)
    found = cell_timing.settled(planned, outcome, (0, 2, 5), RunContext())
    assert found is not None
    assert found.outcome is better
    ((own, entries),) = bound
    assert (own.cells, entries, own.bound) == (*visited, True)
    assert np.isfinite(own.margin)
