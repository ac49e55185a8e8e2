"""What the benchmarks of control and co-design measure is what they say."""

from __future__ import annotations

import importlib
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from benchmarks.codesign_starts import REACHED, random_starts
from benchmarks.control_cases import Case, case, path_problem, quarter_turn, shared_problem
from benchmarks.control_curves import Curve, draw, exponent
from benchmarks.control_cvxpy import CvxpyLoop, Form
from benchmarks.control_ipopt import ipopt_problem
from benchmarks.solver_time import counted
from solvers.parameters.parameter_search import parameter_space
from solvers.trajectory.control import synthesise_control
from solvers.trajectory.control_problem import ControlProblem
from solvers.trajectory.convex_step import PositionRows
from solvers.trajectory.trajectory import Trajectory

ROOT = Path(__file__).resolve().parents[1]
STEPS = 21
AGREEMENT = 1e-4
Shared = tuple[Case, ControlProblem, PositionRows, float]


@pytest.fixture(scope="module")
def shared() -> Shared:
    """A small problem, everybody's half-planes and our rho for them."""
    one = case((2.23, 3.35), STEPS)
    problem, rows, _ = shared_problem(one)
    return one, problem, rows, synthesise_control(problem, one.seed).robustness


def is_kept(problem: ControlProblem, rows: PositionRows, at: Trajectory, margin: float) -> None:
    """The motion is one of our robot, within the same bounds."""
    after = problem.numeric.step(at.x[:-1], at.u, at.theta, problem.dt, problem.substeps).value
    assert np.max(np.abs(after - at.x[1:])) < 1e-6
    places = problem.numeric.points(at.x[:, : problem.numeric.n], at.theta)
    assert np.max(rows.excess(places)) < 1e-6
    assert problem.scale - np.max(np.abs(at.u)) == pytest.approx(margin, abs=1e-6)


def test_ipopt_and_our_control_synthesis_have_the_same_optimum(shared: Shared) -> None:
    one, problem, rows, rho = shared
    answer = ipopt_problem(problem, rows, STEPS, one.theta).solve(one.seed)
    assert answer.solved
    assert answer.margin == pytest.approx(rho, rel=AGREEMENT)
    is_kept(problem, rows, answer.trajectory, answer.margin)


@pytest.mark.parametrize("solver", ["fatrop", "ipopt"])
def test_the_problem_stage_by_stage_has_the_same_optimum(
    shared: Shared, solver: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.syspath_prepend(str(ROOT / "benchmarks"))
    stages = importlib.import_module("control_stages")
    one, problem, rows, rho = shared
    answer = stages.staged_problem(problem, rows, STEPS, one.theta, solver).solve(one.seed)
    assert answer.solved
    assert answer.margin == pytest.approx(rho, rel=AGREEMENT)
    is_kept(problem, rows, answer.trajectory, answer.margin)


def test_the_optimum_depends_on_the_half_planes(shared: Shared) -> None:
    """Else their agreement would say nothing about them."""
    one, problem, rows, rho = shared
    wider = PositionRows(rows.sample, rows.point, rows.normal, rows.offset + 0.05)
    answer = ipopt_problem(problem, wider, STEPS, one.theta).solve(one.seed)
    assert answer.margin > rho * (1 + 10 * AGREEMENT)


@pytest.mark.parametrize("form", Form)
def test_every_loop_over_cvxpy_has_the_same_optimum(shared: Shared, form: Form) -> None:
    one, problem, rows, rho = shared
    loop = CvxpyLoop(problem, rows, STEPS, form)
    loop.prepare(one.seed)
    answer = loop.solve(one.seed)
    assert answer.violation < AGREEMENT
    assert answer.margin == pytest.approx(rho, rel=AGREEMENT)


def test_unknown_lengths_have_the_same_optimum(shared: Shared) -> None:
    one, problem, rows, rho = shared
    box = np.array([2.1, 3.2]), np.array([2.5, 3.6])
    outcome = synthesise_control(problem, one.seed, box)
    answer = ipopt_problem(problem, rows, STEPS, box).solve(one.seed)
    assert outcome.feasible
    assert answer.solved
    assert answer.margin == pytest.approx(outcome.robustness, rel=AGREEMENT)
    assert answer.margin > rho
    assert (answer.trajectory.theta > box[0] - 1e-6).all()
    assert (answer.trajectory.theta < box[1] + 1e-6).all()


@pytest.mark.parametrize("links", [1, 2, 4])
def test_arms_of_any_number_of_links_do_the_quarter_turn(links: int) -> None:
    one = quarter_turn(links, STEPS)
    assert one.path_problem.numeric.n == links
    at = one.path_problem.numeric.points(one.seed.x[[0, -1], :links], one.theta).value[:, 0]
    assert np.linalg.norm(at - one.path_problem.waypoints()[0][[0, -1]], axis=1).max() < 0.1
    assert synthesise_control(one.problem, one.seed).feasible


def test_random_starts_follow_the_path_where_they_can() -> None:
    path = path_problem(2, STEPS)
    starts = random_starts(path, 12, 5)
    place, space = path.waypoints()[0], parameter_space(path.model)
    distance = np.linalg.norm(place, axis=1)
    reached = 0
    for start in starts:
        first, second = start.theta
        assert (start.theta >= space.lower).all()
        assert (start.theta <= space.upper).all()
        # The triangle inequality says what an arm of two links reaches.
        within = (distance < first + second) & (distance > abs(first - second))
        angles = start.x[:, 0], start.x[:, 0] + start.x[:, 1]
        x = first * np.cos(angles[0]) + second * np.cos(angles[1])
        y = first * np.sin(angles[0]) + second * np.sin(angles[1])
        off = np.hypot(x - place[:, 0], y - place[:, 1]).max()
        assert (off <= 2 * REACHED) == within.all()
        if not within.all():
            assert np.max(np.abs(x * place[:, 1] - y * place[:, 0])) < 1e-9
        reached += int(within.all())
    assert 0 < reached < len(starts)
    again = random_starts(path, 12, 5)
    assert all(np.array_equal(a.x, b.x) for a, b in zip(starts, again, strict=True))


def test_the_time_inside_the_solver_is_counted(shared: Shared) -> None:
    one, problem, _, rho = shared
    with counted() as counter:
        outcome = synthesise_control(problem, one.seed)
    assert outcome.robustness == rho
    assert counter.solves >= outcome.iterations
    assert counter.seconds > 0
    before = counter.seconds
    synthesise_control(problem, one.seed)
    assert counter.seconds == before


@pytest.mark.slow
def test_exponents_are_those_of_powers(tmp_path: Path) -> None:
    sizes = (2, 3, 7, 20)
    times = tuple(0.5 * size**1.7 for size in sizes)
    assert exponent(sizes, times) == pytest.approx((1.7, 0.5))
    curve = Curve("size", sizes, times, times)
    for name in "ab":
        draw([curve, curve], tmp_path / f"{name}.svg")
    assert "exponent 1.70" in (tmp_path / "a.svg").read_text()
    assert (tmp_path / "a.svg").read_bytes() == (tmp_path / "b.svg").read_bytes()


@pytest.mark.slow
@pytest.mark.parametrize(
    ("arguments", "lines"),
    [
        (["control.py", "--small", "--rounds", "1"], ["optima differ by", "inside the convex"]),
        (
            ["control.py", "--growth-only", "--rounds", "1", "--horizons", "11", "21",
             "--links", "1", "2", "-o", "growth.svg"],
            ["exponent"],
        ),
        (
            ["codesign.py", "--steps", "21", "--starts", "2", "--rounds", "1", "--no-synth"],
            ["required: rho within"],
        ),
    ],
)  # fmt: skip
def test_the_benchmarks_run(tmp_path: Path, arguments: list[str], lines: list[str]) -> None:
    command = [sys.executable, str(ROOT / "benchmarks" / arguments[0]), *arguments[1:]]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert all(line in done.stdout for line in lines)
    assert ("-o" in arguments) == (tmp_path / "growth.svg").exists()
