"""What the benchmark of shared parameters measures is what it says."""

from __future__ import annotations

import importlib
from collections.abc import Callable
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

from solvers.search.evaluation import evaluate
from solvers.trajectory.control_problem import IterationBudget
from solvers.trajectory.shared_control import shared_control
from solvers.trajectory.shared_parameters import parameter_box, shared_motion
from tests.oracles.turning_link import DT
from tests.solvers.test_shared_parameters import STEPS, by_angle, check_links, to_height

ROOT = Path(__file__).resolve().parents[1]
Load = Callable[[str], ModuleType]


@pytest.fixture
def load(monkeypatch: pytest.MonkeyPatch) -> Load:
    """The modules of the benchmark import each other by their bare names."""
    monkeypatch.syspath_prepend(str(ROOT / "benchmarks"))
    return importlib.import_module


@pytest.mark.parametrize("seed", [0, 1, 9])
def test_both_tasks_are_for_one_robot(load: Load, seed: int) -> None:
    tasks = load("shared_tasks")
    pair = tasks.pair_of(seed)
    assert pair == tasks.pair_of(seed)
    assert pair.texts[0] != pair.texts[1]
    one, other = (tasks.path_problem(text) for text in pair.texts)
    assert [p.domain for p in one.model.parameters] == [p.domain for p in other.model.parameters]
    assert len(one.model.parameters) == pair.links
    assert len(one.model.dofs) == pair.links + pair.space


def test_consensus_and_one_program_agree_where_the_best_length_is_known(load: Load) -> None:
    """The lengths at which both tasks are as hard as each other, as in the tests of the program."""
    by_consensus = load("shared_consensus").by_consensus
    height, angle, bounds = 1.4, 1.0, (10.0, 14.0)
    tasks = [by_angle(bounds[0], angle, 1.6), to_height(bounds[1], height, 1.6)]
    link = [[(0, 0), (1, 0)]]
    length = height / np.sin(angle * bounds[1] / bounds[0])
    share = 1 - 4 * angle * length**3 / (3 * (STEPS * DT) ** 2 * bounds[0])
    for solve in (by_consensus, shared_control):
        found = solve(tasks, link)
        assert found is not None
        assert found.share == pytest.approx(share, rel=1e-4)
        check_links(found, link)


@pytest.mark.parametrize("seed", [10, 14])
def test_pairs_of_the_benchmark(load: Load, seed: int, tmp_path: Path) -> None:
    benchmark = load("shared_parameters")
    told = benchmark.told_of(seed, tmp_path / "pair.json", mine=True)
    ways = told["result"]["ways"]
    assert ways["block"]["share"] >= ways["apart"]["share"] > 0
    assert ways["consensus"]["share"] >= ways["apart"]["share"] - 1e-6
    assert benchmark.told_of(seed, tmp_path / "pair.json", mine=False) == told


def test_motions_along_paths_share_their_lengths(load: Load) -> None:
    """From motions with other lengths each, of which one that is not linked stays free."""
    tasks = load("shared_tasks")
    paths = [tasks.path_problem(text) for text in tasks.pair_of(10).texts]
    lengths = [np.array([1.2, 0.8]), np.array([1.15, 0.85])]
    known = [evaluate(path, theta) for path, theta in zip(paths, lengths, strict=True)]
    assert all(each.feasible for each in known)
    starts = [each.trajectory for each in known]
    links = [[(0, 0), (1, 0)]]
    boxes = [(np.array([0.4, 0.5]), np.array([1.16, 1.6])), parameter_box(paths[1], lengths[1])]
    budget = IterationBudget(10, 1e-3, 1e-8, 6, 1, 2e-3)
    found = shared_motion(paths, starts, links, budget, boxes=boxes)
    assert found is not None
    assert found.feasible
    check_links(found, links)
    assert found.trajectories[0].theta[0] <= 1.16
    assert found.trajectories[0].theta[1] != found.trajectories[1].theta[1]
    for path, outcome, share in zip(paths, found.outcomes, found.shares, strict=True):
        peak = np.max(np.abs(outcome.trajectory.u))
        assert share == pytest.approx(1 - peak / path.groups[0].upper, abs=1e-9)
    narrow = [(np.array([0.4, 0.5]), np.array([0.6, 1.6])), (np.array([0.7, 0.5]), boxes[1][1])]
    assert shared_motion(paths, starts, links, budget, boxes=narrow) is None
