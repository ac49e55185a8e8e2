"""A hand that points somewhere and carries something: found, proved, and simulated by hand."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from compiler.arrays import Array
from solvers.verifier.verification import Outcome, verify_directory
from tests.oracles import result_files
from tests.oracles.command_line import quiet, synthesised
from tests.oracles.mujoco_dynamics import of_file
from tests.oracles.planar_chain import chain_dynamics
from tests.oracles.small_specs import replaced

SPEC = """\
module B { role base; }
module J { role joint; dof q: revolute z in [-170, 170] deg; }
module Upper { role link; const length = 0.6 m; const density = 1 kg/m; }
module Fore { role link; const length = 0.45 m; const density = 2 kg/m; }
module Palm { role link; const length = 0.2 m; const density = 0.5 kg/m; }
module E { role effector; }
grammar Arm { start N; base: N -> B; joint: N -> N J; upper: N -> N Upper; fore: N -> N Fore;
  palm: N -> N Palm; tool: N -> N E; accept matches B J Upper J Fore J Palm E; }
semantics Arm {
  base { this.frame = world; }
  joint { this.frame = N.frame * rot(z, J.q); }
  upper { this.frame = N.frame * move(x, Upper.length);
    rod(frame: N.frame, axis: x, length: Upper.length, density: Upper.density); }
  fore { this.frame = N.frame * move(x, Fore.length);
    rod(frame: N.frame, axis: x, length: Fore.length, density: Fore.density); }
  palm { this.frame = N.frame * move(x, Palm.length);
    rod(frame: N.frame, axis: x, length: Palm.length, density: Palm.density); }
  tool { this.frame = N.frame; effector(frame: N.frame); }
}
workspace Table {
  plane xy;
  bounds box [-3, 3] x [-3, 3] m;
  region S box [0.7, 0.9] x [0.1, 0.4] m;
  obstacle O hull (1.0, 0.7), (1.2, 0.9), (0.9, 1.2), (0.7, 1.0) m;
  target T box [-0.3, 0.2] x [0.6, 0.9] m;
}
task Turn { robot Arm; workspace Table; start in S at rest;
  reach T oriented rot(z, 130 deg) within 3 deg; avoid O with effector; payload 0.3 kg;
  effort <= 20 N*m; control open loop; gravity (0, -1.62) m/s^2; horizon 20 steps of 0.1 s; }
"""
LENGTHS, DENSITIES, PULL = np.array([0.6, 0.45, 0.2]), np.array([1, 2, 0.5]), (0.0, -1.62)


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return synthesised(tmp_path_factory.mktemp("poses"), SPEC)


def dynamics(q: Array, v: Array, carried: float) -> tuple[Array, Array]:
    """M, and all else that the torques have to balance, of three rods with a mass at the tip."""
    mass, bias, weight = chain_dynamics(LENGTHS, DENSITIES, q, v, PULL)
    angles, turning = np.cumsum(q), np.cumsum(v)
    # Column j: how the tip moves with joint j, which turns all links from j on.
    ends = np.stack([-LENGTHS * np.sin(angles), LENGTHS * np.cos(angles)])
    jacobian = np.cumsum(ends[:, ::-1], axis=1)[:, ::-1]
    towards = np.stack([np.cos(angles), np.sin(angles)]) * LENGTHS * turning**2
    pulled = -np.sum(towards, axis=1) - np.array(PULL)
    return mass + carried * jacobian.T @ jacobian, bias + weight + carried * jacobian.T @ pulled


def last_state(certificate: dict, carried: float) -> Array:
    state = np.array([float(x) for x in certificate["start"]])

    def rates(_: float, x: Array, u: Array) -> Array:
        mass, rest = dynamics(x[:3], x[3:], carried)
        return np.concatenate([x[3:], np.linalg.solve(mass, u - rest)])

    for row in certificate["inputs"]:
        u = np.array([float(x) for x in row])
        assert np.all(np.abs(u) <= 20)
        found = solve_ivp(rates, (0, 0.1), state, args=(u,), rtol=1e-10, atol=1e-12)
        state = found.y[:, -1]
    return state


def off(state: Array) -> float:
    """By how many degrees the hand is turned otherwise."""
    return float(abs(np.degrees(np.sum(state[:3])) - 130))


@pytest.mark.slow
def test_the_simulated_hand_points_where_it_is_to(folder: Path) -> None:
    assert verify_directory(folder).outcome is Outcome.VALID
    certificate = result_files.read(folder)
    state = last_state(certificate, 0.3)
    angles = np.cumsum(state[:3])
    tip = LENGTHS @ np.cos(angles), LENGTHS @ np.sin(angles)
    assert -0.3 <= tip[0] <= 0.2
    assert 0.6 <= tip[1] <= 0.9
    assert off(state) <= 3
    # Without what it carries it would be elsewhere.
    assert np.linalg.norm(last_state(certificate, 0.0) - state) > 0.1


@pytest.mark.slow
@pytest.mark.parametrize(
    ("old", "new", "said"),
    [("within 3 deg", "within {:.6f} deg", "pose at T"), ("0.3 kg", "0.6 kg", "")],
)
def test_a_motion_of_another_task_is_refuted(folder: Path, old: str, new: str, said: str) -> None:
    state = last_state(result_files.read(folder), 0.3)
    new = new.format(off(state) - 0.001)
    result_files.alter_spec(folder, old, new, sign=True)
    report = verify_directory(folder)
    result_files.alter_spec(folder, new, old, sign=True)
    assert report.outcome is Outcome.REFUTED
    assert said in str(report.reason)


@pytest.mark.slow
def test_an_exported_robot_carries_its_payload(folder: Path) -> None:
    exported = folder / "robot.xml"
    assert quiet("export", folder, "--to", "mjcf", "-o", exported) == 0
    robot = of_file(exported)
    rng, still = np.random.default_rng(1), np.zeros(3)
    for q in rng.uniform(-2.5, 2.5, (20, 3)):
        robot.put(q, still, still)
        assert np.allclose(
            robot.mass_matrix(), dynamics(q, np.zeros(3), 0.3)[0], rtol=1e-9, atol=1e-12
        )


def test_what_one_joint_cannot_point_at_is_impossible(tmp_path: Path) -> None:
    """A single link in T points at least 60 degrees away from x."""
    text = replaced(SPEC, "matches B J Upper J Fore J Palm E", "matches B J Upper E")
    text = replaced(text, "region S box [0.7, 0.9] x", "region S box [0.5, 0.9] x")
    text = replaced(
        text, "target T box [-0.3, 0.2] x [0.6, 0.9] m", "target T box [-0.3, 0.3] x [0.5, 0.9] m"
    )
    text = replaced(
        text, "oriented rot(z, 130 deg) within 3 deg", "aligned x to (1, 0) within {} deg"
    )
    text = replaced(text, "avoid O with effector; ", "")
    for angle, due in ((55, 3), (75, 0)):
        spec = tmp_path / f"{angle}.srg"
        spec.write_text(text.replace("{}", str(angle)), encoding="utf-8")
        assert quiet("synth", spec, "-o", tmp_path / str(angle), "-q") == due
        assert verify_directory(tmp_path / str(angle)).outcome is Outcome.VALID


# --- Poses in formulas ----------------------------------------------------------------------------

ON_THE_WAY = "satisfy eventually (M aligned y to (-1, 0) within 12 deg); reach T"
TOUR = replaced(
    replaced(SPEC, "  target T", "  region M box [0.2, 0.7] x [0.5, 1.0] m;\n  target T"),
    "reach T oriented rot(z, 130 deg) within 3 deg",
    ON_THE_WAY,
)
KEPT = replaced(
    TOUR, ON_THE_WAY, "satisfy always not (T aligned -x to (1, -1) within 60 deg); reach T"
)


def simulated(certificate: dict, fine: int) -> Array:
    """The states (K, 6) of a motion at so many instants of each step, by the dynamics by hand."""
    state, found = np.array([float(x) for x in certificate["start"]]), list[Array]()
    times = np.linspace(0, 0.1, fine + 1)

    def rates(_: float, x: Array, u: Array) -> Array:
        mass, rest = dynamics(x[:3], x[3:], 0.3)
        return np.concatenate([x[3:], np.linalg.solve(mass, u - rest)])

    for row in certificate["inputs"]:
        u = np.array([float(x) for x in row])
        part = solve_ivp(rates, (0, 0.1), state, args=(u,), t_eval=times, rtol=1e-10, atol=1e-12)
        state = part.y[:, -1]
        found += list(part.y.T)
    return np.array(found)


def seen(states: Array) -> tuple[Array, Array]:
    """Where the tip is, (2, K), and by what angle its frame is turned, in degrees, (K,)."""
    angles = np.cumsum(states[:, :3], axis=1)
    tip = np.stack([np.cos(angles) @ LENGTHS, np.sin(angles) @ LENGTHS])
    return tip, np.degrees(angles[:, 2])


def turned_off(angles: Array, due: float) -> Array:
    return np.asarray(np.abs((angles - due + 180) % 360 - 180))


@pytest.mark.slow
def test_a_hand_that_is_turned_somewhere_on_the_way(tmp_path: Path) -> None:
    result = synthesised(tmp_path, TOUR)
    assert verify_directory(result).outcome is Outcome.VALID
    tip, angles = seen(simulated(result_files.read(result), 400))
    inside = (tip[0] >= 0.2) & (tip[0] <= 0.7) & (tip[1] >= 0.5) & (tip[1] <= 1.0)
    # The axis y points along (-1, 0) where the frame is turned by a quarter.
    least = np.min(turned_off(angles[inside], 90))
    assert least <= 12
    # A pose that it misses by little is refuted.
    new = f"within {least - 0.05:.6f} deg"
    result_files.alter_spec(result, "within 12 deg", new, sign=True)
    assert verify_directory(result).outcome is Outcome.REFUTED


@pytest.mark.slow
def test_a_hand_that_is_never_turned_like_that_there(tmp_path: Path) -> None:
    result = synthesised(tmp_path, KEPT)
    assert verify_directory(result).outcome is Outcome.VALID
    tip, angles = seen(simulated(result_files.read(result), 400))
    inside = (tip[0] >= -0.3) & (tip[0] <= 0.2) & (tip[1] >= 0.6) & (tip[1] <= 0.9)
    assert inside[-1]
    # -x points along (1, -1) where x points along (-1, 1).
    least = np.min(turned_off(angles[inside], 135))
    assert least >= 60
    new = f"within {least + 0.05:.6f} deg"
    result_files.alter_spec(result, "within 60 deg", new, sign=True)
    assert verify_directory(result).outcome is Outcome.REFUTED


@pytest.mark.slow
def test_a_hand_that_comes_to_a_pose_again_and_again(tmp_path: Path) -> None:
    text = replaced(SPEC, "within 3 deg;", "within 3 deg; repeat;")
    text = replaced(text, "control open loop; gravity (0, -1.62) m/s^2; horizon 20", "horizon 40")
    result = synthesised(tmp_path, text)
    assert verify_directory(result).outcome is Outcome.VALID
    result_files.alter_spec(result, "rot(z, 130 deg)", "rot(z, 140 deg)", sign=True)
    report = verify_directory(result)
    assert report.outcome is Outcome.REFUTED
    assert "target T" in str(report.reason)
