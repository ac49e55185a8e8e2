"""What `benchmarks/tube_tightening.py` optimises and measures is what it says."""

from __future__ import annotations

import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.sparse import csc_matrix

from benchmarks.tube_optimisation import (
    Method,
    PricedSolver,
    motion_gradient,
    tube_estimate,
    tube_problem,
)
from compiler.arrays import Array
from solvers.backends.conic import ConvexProgram, Optimum
from solvers.trajectory.path_following import PathProblem
from solvers.trajectory.trajectory import Trajectory
from solvers.verifier.certified_tube import certified_tube
from tests.oracles.benchmark_cases import programs_of
from tests.oracles.small_specs import CLOSED
from tests.solvers.test_disturbance_spread import SUBSTEPS, moved
from tests.solvers.test_disturbed_proof import TWO

ROOT = Path(__file__).parents[1]
SCRIPT = ROOT / "benchmarks" / "tube_tightening.py"


def disturbed_pair() -> tuple[PathProblem, Trajectory]:
    """Two links that swing, under all kinds of disturbances."""
    rng = np.random.default_rng(5)
    disturbances = "robust start 1 deg; robust start 1 deg/s; robust effort 2 %;"
    disturbances += "robust measure 0.1 deg, 0.5 deg/s; robust mass 2 %;"
    start, u = np.array([0.4, -1.1, 0.3, 0.7]), rng.uniform(-1, 1, (8, 2))
    where, numeric, motion = moved(TWO, disturbances, start, u)
    problem = PathProblem(
        numeric, where.workspace, where.task, where.abstraction, 0, (0,), 2e-3, 0,
        substeps=SUBSTEPS, feedback=True,
    )  # fmt: skip
    return problem, motion


def test_gradient_against_differences_along_a_direction() -> None:
    problem, motion = disturbed_pair()
    gains = problem.gains(motion)
    by_x, by_u = motion_gradient(problem, motion, gains)
    rng = np.random.default_rng(1)
    for _ in range(3):
        x, u = rng.normal(size=motion.x.shape), rng.normal(size=motion.u.shape)

        def cost(sign: float, x: Array = x, u: Array = u) -> float:
            there = Trajectory(motion.x + sign * 1e-5 * x, motion.u + sign * 1e-5 * u, motion.theta)
            return tube_estimate(problem, there).cost(gains)

        slope = (cost(1) - cost(-1)) / 2e-5
        assert np.sum(by_x * x) + np.sum(by_u * u) == pytest.approx(slope, rel=2e-2)


def test_refined_gains_leave_a_narrower_tube() -> None:
    problem, motion = disturbed_pair()
    better = tube_problem(problem, Method(refined=True))
    found, spread = better.controlled(motion)
    estimate = tube_estimate(problem, motion)
    assert estimate.cost(found) < estimate.cost(problem.gains(motion))
    assert spread is not None
    assert spread.widest == estimate.spread(found).widest
    # They are kept: the proof is about the gains that the motion was planned with.
    count = better.record.estimates
    np.testing.assert_array_equal(replace(better, margin=1.0).gains(motion), found)
    assert better.record.estimates == count
    np.testing.assert_array_equal(
        tube_problem(problem, Method()).gains(motion), problem.gains(motion)
    )


def test_prices_are_added_to_programs() -> None:
    """min x^2 + y^2 - 2 y within [-9, 9]^2 is at (0, 1); with prices 3 and 1, at (-1.5, 0.5)."""
    none, free = csc_matrix((0, 2)), np.full(2, 9.0)
    program = ConvexProgram(
        np.array([2.0, 2.0]), np.array([0.0, -2.0]), none, np.zeros(0), none, np.zeros(0),
        -free, free,
    )  # fmt: skip
    for price, expected in (([0.0], [0.0, 1.0]), ([3.0, 1.0], [-1.5, 0.5])):
        found = PricedSolver(np.array(price)).solve(program, 1e-9)
        assert isinstance(found, Optimum)
        np.testing.assert_allclose(found.point, expected, atol=1e-6)


@pytest.mark.slow
def test_cases_are_sound_and_get_feedback() -> None:
    programs = programs_of("tube_tightening")
    assert len(programs) >= 5
    for program in programs.values():
        (task,) = program.tasks.values()
        assert task.robust is not None
        assert task.control == "feedback"


@pytest.mark.slow
def test_widths_are_those_of_the_certified_tube(tmp_path: Path) -> None:
    spec = tmp_path / "closed.srg"
    spec.write_text(CLOSED, encoding="utf-8")
    command = [sys.executable, str(SCRIPT), "--specs", str(spec), "-o", str(tmp_path / "kept")]
    ran = subprocess.run(command, capture_output=True, text=True, check=True, cwd=ROOT)
    rows = [each for each in ran.stdout.splitlines() if each.startswith("closed  ")]
    assert len(rows) == 6
    assert all(" yes " in each for each in rows)
    folder = tmp_path / "o"
    command = [sys.executable, "-m", "srgc", "synth", str(spec), "-o", str(folder), "-q"]
    subprocess.run(command, check=True, cwd=ROOT)
    bounds = certified_tube(folder).sample_points[1:]
    halves = np.linalg.norm((bounds[..., 1] - bounds[..., 0]) / 2, axis=2).max(axis=1)
    enclosed, widest = map(float, rows[0].removeprefix("closed").split()[5:7])
    assert enclosed == pytest.approx(100 * halves.mean(), rel=0.02)
    assert widest == pytest.approx(100 * halves.max(), rel=0.02)
