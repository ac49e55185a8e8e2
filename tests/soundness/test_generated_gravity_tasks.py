"""Generated tasks under gravity are feasible, as MuJoCo has it, and some of them are found."""

from __future__ import annotations

import hashlib
import json
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from solvers.verifier.verification import Outcome, verify_directory
from srgc.cli import run
from tests.oracles.generated_gravity_tasks import (
    EFFORT_SHARE,
    MARGIN,
    GravityTask,
    gravity_task,
)
from tests.oracles.hand_arms import HandArm, SimulatedArm
from tests.oracles.hand_motions import sampled_motion
from tests.oracles.rod_chains import FINE, RodChain

RESULTS = Path(__file__).parents[2] / "benchmarks" / "results" / "gravity"
QUICK_SEEDS = (3, 7, 10)
FOUND_SEEDS = (3, 6, 9)
made = cache(gravity_task)


def simulated(arm: RodChain) -> SimulatedArm:
    """The same arm for MuJoCo."""
    built = HandArm().move(*arm.base)
    for i, (axis, length) in enumerate(zip(arm.axes, arm.lengths, strict=True)):
        slides = axis.isupper()
        built.joint(i, "xyz".index(axis.lower()), "slide" if slides else "hinge")
        if slides:
            built.point(arm.carriage)
        mass = arm.density * length
        if length:
            moment = mass * length**2 / 12
            built.solid(mass, (length / 2, 0, 0), (0, moment, moment)).move(length)
    return SimulatedArm(built.point(arm.payload).effector(), arm.down)


@pytest.mark.parametrize("axes", ["zz", "zzzz", "zyy", "XY", "zXy", "XzYyZ", "zxyZz"])
def test_accelerations_are_those_of_mujoco(axes: str) -> None:
    lengths = (0.4, 0.7, 0.3, 0.5, 0.6)[: len(axes)]
    down = (0.0, -9.81, 0.0) if axes in ("zz", "zzzz") else (0.3, 0.2, -9.81)
    rods = (0.0, *lengths[1:]) if "y" in axes else lengths
    arm = RodChain(axes, rods, 1.3, (0.1, 0.0, 0.5), down, carriage=0.7)
    other, rng = simulated(arm), np.random.default_rng(1)
    for _ in range(10):
        state, u = rng.normal(size=2 * len(axes)), rng.normal(size=len(axes)) * 10
        assert np.allclose(arm.slope(state, u), other.slope(state, u), rtol=1e-6, atol=1e-6)


@pytest.mark.parametrize("seed", QUICK_SEEDS)
def test_a_reference_motion_keeps_its_task(seed: int) -> None:
    task = made(seed)
    count = len(task.arm.axes)
    start = task.states[0]
    assert not start[count:].any()
    motion = sampled_motion(simulated(task.arm), start, list(task.inputs), task.step, FINE)
    assert np.allclose(motion.states, task.states, atol=1e-4)
    assert np.abs(task.inputs).max() <= EFFORT_SHARE * task.effort
    assert 1.3 * task.static - 0.05 <= task.effort <= 2 * task.static + 0.05
    assert (np.abs(motion.states[:, :count]) < task.ranges).all()
    tips = motion.tips[:, 0]
    for spot, (low, high) in ((tips[0], task.home), (tips[-1], task.goal)):
        assert ((low + 0.02 < spot) & (spot < high - 0.02))[: 3 if task.arm.base[2] else 2].all()
    for block in task.blocks:
        assert block.distances(tips).min() > MARGIN
        if task.body:
            ends = np.array([task.arm.places(q)[2] for q in motion.states[:, :count]])
            middles = (ends[:, 1:] + ends[:, :-1]) / 2
            assert min(block.distances(points).min() for points in (ends, middles)) > MARGIN


def test_a_seed_gives_the_same_task_again() -> None:
    first, again = made(3), gravity_task(3)
    assert first.text == again.text
    assert made(7).text != first.text
    assert np.array_equal(first.states, again.states)


@pytest.mark.parametrize("seed", QUICK_SEEDS)
def test_the_recorded_results_are_about_these_tasks(seed: int) -> None:
    digest = hashlib.sha256(made(seed).text.encode()).hexdigest()
    files = sorted(RESULTS.glob("*.json"))
    assert files
    for file in files:
        tasks = json.loads(file.read_text(encoding="utf-8"))["tasks"]
        assert [t["text_sha256"] for t in tasks if t["seed"] == seed] in ([], [digest])


@pytest.mark.slow
@pytest.mark.parametrize("seed", FOUND_SEEDS)
def test_a_task_is_found_and_proved(seed: int, tmp_path: Path) -> None:
    task: GravityTask = made(seed)
    path, folder = tmp_path / "task.srg", tmp_path / "out"
    path.write_text(task.text, encoding="utf-8")
    assert run(["synth", str(path), "-q", "-o", str(folder)]) == 0
    assert verify_directory(folder).outcome is Outcome.VALID
