"""No path along which a motion was found is ever excluded, over random tasks without any proof."""

from __future__ import annotations

from dataclasses import dataclass, field
from itertools import combinations
from typing import Any

import pytest

from grammar_lang.load import load_text
from solvers.planner import CounterExample, Plan, Planner
from solvers.run_context import RunContext
from solvers.search import motion_proof, path_search
from solvers.search.search_state import Blocked, Cause, PathAttempt
from solvers.search.synthesis import synthesise
from tests.oracles.feasible_tasks import feasible_task

FAMILIES = (
    "two links", "two links with body", "three links", "gravity", "gantries", "visits",
    "slots and small targets", "two arms", "20 to 60 obstacles", "2 cm and 100 m",
)  # fmt: skip
QUICK = ("gravity", "gantries", "slots and small targets")
SEEDS = range(1, 21)
SLOW = 5
"""So many seeds of each family are for `make test-slow`, the rest for campaigns."""


def marks(family: str, seed: int) -> list[pytest.MarkDecorator]:
    usual = seed == 1 and family in QUICK
    return [pytest.mark.slow] * (not usual) + [pytest.mark.campaign] * (seed > SLOW)


CASES = [
    pytest.param(family, seed, marks=marks(family, seed)) for family in FAMILIES for seed in SEEDS
]

Followed = tuple[tuple[int, int], int, tuple[str, ...]]
"""Structure and effector that reaches, the effector that leads, and the names of its cells."""


@dataclass
class Watched:
    """What a search has found, and which found paths it has excluded later."""

    found: list[Followed] = field(default_factory=list[Followed])
    wrong: list[tuple[Followed, tuple[str, ...]]] = field(default_factory=list[Any])
    attempts: int = 0
    now: tuple[int, int] = (0, 0)


@pytest.fixture
def watched(monkeypatch: pytest.MonkeyPatch) -> Watched:
    """The searches of this test, in which every proof fails, so that they go on."""
    seen = Watched()
    attempt, block = path_search.PathSearch.attempt, Planner.block

    def attempted(
        search: path_search.PathSearch, cells: Any, plan: Plan, *, explaining: bool
    ) -> PathAttempt:
        tried = attempt(search, cells, plan, explaining=explaining)
        seen.attempts += 1
        seen.now = search.structure.number, search.recorded
        if tried.nearest is not None and tried.nearest.feasible:
            path = search.leader(plan)
            names = tuple(cells.cells[cell].name for cell in path.cells)
            seen.found.append((seen.now, path.effector, names))
        return tried

    def blocked(planner: Planner, item: CounterExample) -> None:
        cells = tuple(planner.problem.names[cell] for cell in item.cells)
        for each in seen.found:
            where, effector, names = each
            same = (where, effector) == (seen.now, item.effector)
            in_turn = cells in combinations(names, len(cells))
            if same and (in_turn if item.ordered else set(cells) <= set(names)):
                seen.wrong.append((each, cells))
        block(planner, item)

    def unproved(_proof: Any, _problem: Any, found: Any, _label: str) -> motion_proof.ProofAttempt:
        return motion_proof.ProofAttempt(Blocked(Cause.UNPROVED), found.outcome.robustness)

    monkeypatch.setattr(path_search.PathSearch, "attempt", attempted)
    monkeypatch.setattr(Planner, "block", blocked)
    monkeypatch.setattr(motion_proof.MotionProof, "attempt", unproved)
    monkeypatch.setattr(motion_proof.MotionProof, "prepared", lambda *_: None)
    return seen


@pytest.mark.parametrize(("family", "seed"), CASES)
def test_no_path_with_a_motion_is_excluded(family: str, seed: int, watched: Watched) -> None:
    program = load_text(feasible_task(family, seed).text, "task.srg").program
    assert program is not None
    (task,) = program.tasks.values()
    # One structure after the other, so that what is blocked belongs to what was tried last.
    synthesise(program, task, RunContext(paths=4, evaluations=4), every=True)
    assert watched.attempts
    assert watched.wrong == []
