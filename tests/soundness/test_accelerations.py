"""Limits of accelerations: motions keep them between samples, too, and what breaks them is not."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from solvers.verifier.verification import Outcome, verify_directory
from tests.oracles import result_files
from tests.oracles.command_line import quiet, synthesised
from tests.oracles.rod_pair import rod_pair

MOST = (1.1, 2.3)
"""rad/s^2; without the limits the fastest motions have twice as much."""
JOINTS = """\
module Big { role joint; dof q: revolute z in [-170, 170] deg accel <= 1.1 rad/s^2; }
module Small { role joint;
  dof q: revolute z in [-170, 170] deg rate in [-3, 3] rad/s accel <= 2.3 rad/s^2 effort <= 9 N*m; }
"""
ARM = rod_pair(
    JOINTS,
    "reach T at rest; effort <= 12 N*m; gravity (0, -2) m/s^2; horizon 14 steps of 0.15 s; EXTRA",
)


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return synthesised(tmp_path_factory.mktemp("accel"), ARM.replace("EXTRA", ""))


@pytest.fixture(scope="module")
def controlled(tmp_path_factory: pytest.TempPathFactory) -> Path:
    extra = "robust start 0.1 deg, 0.1 deg/s; robust effort 0.1 % of bound; control feedback;"
    text = ARM.replace("EXTRA", extra).replace("horizon 14", "horizon 20")
    text = text.replace("reach T at rest", "reach T rates <= 0.3 rad/s")
    return synthesised(tmp_path_factory.mktemp("robust"), text)


def acceleration(x: np.ndarray, u: np.ndarray) -> np.ndarray:
    """Of two rods under gravity 2 m/s^2 downwards, by hand."""
    q, v, long, m, k, n = x[:2], x[2:], 0.6, 0.6, 0.45, 0.9
    both, end = n * long * k / 2, n * k**2 / 3
    first = m * long**2 / 3 + n * long**2 + 2 * both * np.cos(q[1]) + end
    mass = np.array([[first, both * np.cos(q[1]) + end], [both * np.cos(q[1]) + end, end]])
    bias = both * np.sin(q[1]) * np.array([-v[1] * (2 * v[0] + v[1]), v[0] ** 2])
    outer = n * 2 * k / 2 * np.cos(q[0] + q[1])
    weight = np.array([(m / 2 + n) * long * 2 * np.cos(q[0]) + outer, outer])
    return np.asarray(np.linalg.solve(mass, u - bias - weight))


def peaks(certificate: dict[str, object], rng: np.random.Generator | None = None) -> np.ndarray:
    """The largest accelerations along a simulated motion, a disturbed one with an ``rng``."""

    def numbers(rows: object) -> np.ndarray:
        return np.array([[float(item) for item in row] for row in rows])  # type: ignore[attr-defined]

    state = np.array([float(item) for item in certificate["start"]])  # type: ignore[attr-defined]
    inputs, found = numbers(certificate["inputs"]), np.zeros(2)
    claims = certificate.get("claims", [])
    law = claims[0] if claims else None  # type: ignore[index]
    if rng is not None:
        state = state + np.radians(0.1) * rng.choice([-1, 1], 4)
    for number, row in enumerate(inputs):
        u = row
        if law is not None:
            gains = np.array(law["gains"][number], float)  # type: ignore[index]
            u = u - gains @ (state - np.array(law["reference"][number], float))  # type: ignore[index]
        if rng is not None:
            u = u + 0.001 * np.array([12, 9]) * rng.choice([-1, 1], 2)

        def rates(_: float, x: np.ndarray, u: np.ndarray = u) -> np.ndarray:
            return np.concatenate([x[2:], acceleration(x, u)])

        run = solve_ivp(rates, (0, 0.15), state, rtol=1e-10, atol=1e-12, dense_output=True)
        for time in np.linspace(0, 0.15, 31):
            found = np.maximum(found, np.abs(acceleration(run.sol(time), u)))
        state = run.y[:, -1]
    return found


def test_accelerations_keep_their_limits_and_come_near_them(folder: Path) -> None:
    assert verify_directory(folder).outcome is Outcome.VALID
    seen = peaks(result_files.read(folder))
    assert np.all(seen < MOST)
    assert np.any(seen > 0.9 * np.array(MOST))


def test_without_limits_the_same_task_accelerates_more(tmp_path: Path) -> None:
    text = ARM.replace("EXTRA", "").replace("accel <= 1.1 rad/s^2", "")
    free = synthesised(tmp_path, text.replace("accel <= 2.3 rad/s^2", ""))
    assert np.any(peaks(result_files.read(free)) > MOST)


@pytest.mark.parametrize(("joint", "old"), [(1, "1.1"), (2, "2.3")])
def test_a_limit_that_the_motion_does_not_keep_is_refuted(
    folder: Path, joint: int, old: str
) -> None:
    most = peaks(result_files.read(folder))[joint - 1]
    before, after = f"accel <= {old} rad/s^2", f"accel <= {0.999 * most:.9f} rad/s^2"
    result_files.alter_spec(folder, before, after, sign=True)
    report = verify_directory(folder)
    result_files.alter_spec(folder, after, before, sign=True)
    assert report.outcome is Outcome.REFUTED
    name = ("Big.q", "Small.q")[joint - 1]
    assert f"acceleration of {name}" in str(report.reason)


def test_disturbed_motions_keep_them_with_feedback(controlled: Path) -> None:
    assert verify_directory(controlled).outcome is Outcome.VALID
    certificate, rng = result_files.read(controlled), np.random.default_rng(3)
    seen = np.max([peaks(certificate, rng) for _ in range(20)], axis=0)
    assert np.all(seen < MOST)
    assert np.any(seen > peaks(certificate))


SLIDER = """\
module B { role base; }
module R { role joint; dof s: prismatic x in [-1, 3] m accel <= 0.5 m/s^2; }
module E { role effector; }
grammar G { start N; all: N -> B R E; }
semantics G { all {
  this.at = move(x, R.s);
  point(frame: this.at, mass: 2 kg);
  effector(frame: this.at);
} }
workspace W {
  plane xy;
  bounds box [-2, 4] x [-1, 1] m;
  region S box [-0.01, 0.01] x [-0.1, 0.1] m;
  target T box [1, 1.02] x [-0.1, 0.1] m;
}
task Go { robot G; workspace W; start in S at rest; reach T at rest;
  effort <= 50 N; horizon STEPS steps of 0.1 s; }
"""


@pytest.mark.parametrize(
    ("steps", "verdict"),
    # A metre (less 1 cm at the start) from rest to rest takes 2 sqrt(0.99 / 0.5) = 2.814 s.
    [(30, "found"), (28, "unknown"), (19, "impossible")],
)
def test_a_slider_needs_its_time(tmp_path: Path, steps: int, verdict: str) -> None:
    (tmp_path / "s.srg").write_text(SLIDER.replace("STEPS", str(steps)), encoding="utf-8")
    exits = {"found": 0, "impossible": 3, "unknown": 4}
    assert quiet("synth", tmp_path / "s.srg", "-o", tmp_path / "out", "-q") == exits[verdict]
    if verdict != "unknown":
        assert verify_directory(tmp_path / "out").outcome is Outcome.VALID
        design = json.loads((tmp_path / "out" / "design.json").read_text())
        assert design["verdict"] == verdict
