"""A robot with drives from data sheets: found, proved, exported, the same dynamics in MuJoCo."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from solvers.verifier.verification import Outcome, verify_directory
from tests.oracles import result_files
from tests.oracles.command_line import quiet, synthesised
from tests.oracles.mujoco_dynamics import of_file
from tests.oracles.rod_pair import rod_pair

JOINTS = """\
module Big { role joint;
  dof q: revolute z in [-170, 170] deg rate in [-3, 3] rad/s effort <= 12 N*m;
  drive q: gear 100 rotor 1e-5 kg*m^2 viscous 0.3 N*m*s; }
module Small { role joint; dof q: revolute z in [-170, 170] deg effort <= 5 N*m;
  drive q: viscous 0.1 N*m*s gear 50 rotor 2e-5 kg*m^2; }
"""


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    spec = rod_pair(JOINTS, "reach T; horizon 10 steps of 0.2 s;")
    return synthesised(tmp_path_factory.mktemp("drives"), spec)


def mass(q: np.ndarray) -> np.ndarray:
    """M of two rods, by hand, with 100^2 1e-5 and 50^2 2e-5 on its diagonal."""
    long, m, k, n = 0.6, 0.6, 0.45, 0.9
    both = n * long * k / 2 * np.cos(q[1])
    end = n * k**2 / 3
    first = m * long**2 / 3 + n * long**2 + 2 * both + end
    return np.array([[first + 0.1, both + end], [both + end, end + 0.05]])


def test_the_motion_obeys_the_equations_with_rotors_and_friction(folder: Path) -> None:
    """Two steps in time by an integrator of its own."""
    assert verify_directory(folder).outcome is Outcome.VALID
    certificate = result_files.read(folder)
    state = np.array([float(x) for x in certificate["start"]])

    def rates(x: np.ndarray, u: np.ndarray) -> np.ndarray:
        q, v = x[:2], x[2:]
        sway = 0.9 * 0.6 * 0.45 / 2 * np.sin(q[1])
        bias = sway * np.array([-v[1] * (2 * v[0] + v[1]), v[0] ** 2])
        return np.concatenate([v, np.linalg.solve(mass(q), u - [0.3, 0.1] * v - bias)])

    for row in certificate["inputs"]:
        u, h = np.array([float(x) for x in row]), 0.2 / 200
        assert np.all(np.abs(u) <= [12, 5])
        for _ in range(200):
            a = rates(state, u)
            b = rates(state + h / 2 * a, u)
            c = rates(state + h / 2 * b, u)
            state = state + h / 6 * (a + 2 * b + 2 * c + rates(state + h * c, u))
    tip = [0.6 * f(state[0]) + 0.45 * f(state[0] + state[1]) for f in (np.cos, np.sin)]
    assert -0.3 <= tip[0] <= 0.2
    assert 0.6 <= tip[1] <= 0.9


def test_the_export_has_armatures_friction_and_bounds(folder: Path) -> None:
    exported = folder / "robot.xml"
    assert quiet("export", folder, "--to", "mjcf", "-o", exported) == 0
    robot = of_file(exported)
    rng, still = np.random.default_rng(1), np.zeros(2)
    for q in rng.uniform(-3, 3, (20, 2)):
        robot.put(q, still, still)
        assert np.allclose(robot.mass_matrix(), mass(q), rtol=1e-9, atol=1e-12)
    assert robot.model.dof_damping.tolist() == [0.3, 0.1]
    assert np.allclose(robot.model.actuator_ctrlrange, [[-12, 12], [-5, 5]], rtol=1e-15)
    text = folder / "robot.urdf"
    assert quiet("export", folder, "--to", "urdf", "-o", text) == 0
    written = text.read_text(encoding="utf-8")
    assert 'effort="12.0"' in written
    assert 'effort="5.0"' in written
    assert "the rotor adds 0.1 in SI units" in written


def test_a_bound_that_the_motion_does_not_keep_is_refuted(folder: Path) -> None:
    certificate = result_files.read(folder)
    most = max(abs(float(row[0])) for row in certificate["inputs"])
    old, new = "effort <= 12 N*m", f"effort <= {0.9 * most:.6f} N*m"
    result_files.alter_spec(folder, old, new, sign=True)
    report = verify_directory(folder)
    result_files.alter_spec(folder, new, old, sign=True)
    assert report.outcome is Outcome.REFUTED
    assert "effort of Big.q" in str(report.reason)
