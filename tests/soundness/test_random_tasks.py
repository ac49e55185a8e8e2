"""Verdicts on random tasks: MuJoCo replays what is found, brute force doubts what is impossible."""

from __future__ import annotations

from collections import Counter

import pytest

from srgc.cli import run
from tests.oracles import result_files
from tests.oracles.exported_motions import replay
from tests.oracles.random_sweeps import counterexample, drives_reach, flooded
from tests.oracles.random_tasks import random_task
from tests.oracles.some_cases import campaign, some
from tests.oracles.spec_figures import figures_of
from tests.soundness.task_trials import FOUND, IMPOSSIBLE, INFLATED, farthest, tried

pytestmark = pytest.mark.usefixtures("without_pictures")


QUICK = {12: FOUND, 16: FOUND, 28: FOUND, 17: IMPOSSIBLE, 18: IMPOSSIBLE, 22: IMPOSSIBLE}
PART, PARTS = 10, 20


@pytest.mark.parametrize("seed", some([12, 16, 17, 18, 22, 28], 4))
def test_single_random_tasks(tmp_path, seed):
    verdict = tried(seed, tmp_path, 60_000)
    assert verdict.objection is None
    assert verdict.status == QUICK[seed]


def test_random_tasks_are_of_all_kinds():
    tasks = [random_task(seed) for seed in range(60)]
    assert len({task.words for task in tasks}) == 6
    assert any(task.space for task in tasks)
    assert any("with body" in task.text for task in tasks)
    assert any("gravity" in task.text for task in tasks)
    assert len({task.text for task in tasks}) == 60


@pytest.mark.slow
def test_another_input_leaves_the_tube(made, tmp_path):
    """An oracle of the oracle: a thousandth of one input for one step is seen."""
    folder, target = made("spatial") / "out", tmp_path / "arm.xml"
    assert run(["export", str(folder), "--to", "mjcf", "-o", str(target)]) == 0
    text, claim = target.read_text(encoding="utf-8"), result_files.read(folder)
    assert farthest(folder, replay(text, claim)) < INFLATED
    claim["inputs"][2][1] = str(float(claim["inputs"][2][1]) * 1.001 + 1e-4)
    assert farthest(folder, replay(text, claim)) > 5 * INFLATED


def test_brute_force_finds_what_was_found():
    """Of a task that a found robot does it finds the poses, the way, and inputs."""
    task = random_task(16)
    figures = figures_of(task.text)
    lengths = counterexample(task, figures, 60_000, 0)
    assert lengths is not None
    assert flooded(task, figures, task.words[0], lengths, 200)
    assert drives_reach(task, figures, lengths, 0, 40)


@pytest.mark.parametrize("part", campaign(range(PARTS), 6))
def test_two_hundred_random_tasks(tmp_path, part):
    verdicts = [tried(seed, tmp_path) for seed in range(part * PART, part * PART + PART)]
    assert [v for v in verdicts if v.objection] == []
    seen = Counter(v.status for v in verdicts)
    assert seen[FOUND] + seen[IMPOSSIBLE] >= PART // 3
