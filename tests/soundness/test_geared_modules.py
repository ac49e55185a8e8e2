"""An arm of modules with two geared joints each and dry friction: found, proved, taken elsewhere.

Modules of the size of Schunk's Powerball, with gears of 160 turns, rotors of 5.23e-5 kg m^2,
viscous friction of 14 N m s and Coulomb friction of 2 N m at each of four joints.
"""

from __future__ import annotations

import json
from pathlib import Path

import mujoco
import numpy as np
import pytest

from compiler.arrays import Array
from compiler.dynamics.equations_of_motion import robot_graph
from solvers.verifier.verification import Outcome, verify_directory
from srgc.results.found_design import found_design
from tests.oracles.command_line import quiet, synthesised
from tests.oracles.mujoco_dynamics import of_file
from tests.oracles.robots import evaluate

JOINT = """\
dof {0}: revolute z in [-170, 170] deg rate in [-72, 72] deg/s effort <= 75.5 N*m;
  drive {0}: gear 160 rotor 5.23e-5 kg*m^2 viscous 14 N*m*s coulomb 2 N*m;"""
SPEC = f"""\
module Base {{ role base; }}
module Ball {{ role joint;
  {JOINT.format("turn")}
  {JOINT.format("bend")}
}}
module Long {{ role link; }}
module Short {{ role link; }}
module Gripper {{ role effector; }}
grammar Arms {{
  start N;
  base: N -> Base;
  ball: N -> N Ball;
  long: N -> N Long;
  short: N -> N Short;
  tool: N -> N Gripper;
  accept matches Base Ball (Long | Short) Ball Gripper;
}}
semantics Arms {{
  base {{ this.frame = world; this.mid = world; }}
  ball {{
    this.mid = N.frame * rot(z, Ball.turn) * move((0, 101.3, 101.3) mm) * rot(x, -90 deg);
    this.frame = this.mid * rot(z, Ball.bend);
    solid(frame: this.mid, mass: 3.9 kg, com: (0, 18, -82) mm,
      inertia: (0.042799, 0.037801, 0.010997, 0, 0, 0));
  }}
  long {{
    this.mid = N.mid;
    this.frame = N.frame * move((0, -0.35, 0) m) * rot(x, 180 deg);
    solid(frame: N.frame, mass: 1.62 kg, com: (0, -0.175, 0.0132) m,
      inertia: (0.074338, 0.017132, 0.074338, 1e-6, -6e-6, 0.003742));
  }}
  short {{
    this.mid = N.mid;
    this.frame = N.frame * move((0, -0.2, 0) m) * rot(x, 180 deg);
    solid(frame: N.frame, mass: 1.1 kg, com: (0, -0.1, 0.0132) m,
      inertia: (0.02, 0.01, 0.02, 0, 0, 0));
  }}
  tool {{
    this.mid = N.mid;
    this.frame = N.frame * move(z, 163 mm);
    solid(frame: N.frame, mass: 1.4 kg, com: (0, 0, 40) mm,
      inertia: (0.004, 0.0039, 0.0006, 0, 0, 0));
    effector(frame: this.frame);
  }}
}}
workspace Cell {{
  space xyz;
  bounds box [-2, 2] x [-2, 2] x [-2, 2] m;
  region One box [-5, 5] x [-65, -55] x [35, 45] cm;
  target Two box [55, 65] x [-5, 5] x [35, 45] cm;
}}
task Swing {{
  robot Arms; workspace Cell; start in One at rest; reach Two at rest;
  gravity (0, 0, -9.81) m/s^2; horizon 20 steps of 0.15 s;
}}
"""
ROTOR, VISCOUS, COULOMB = 160**2 * 5.23e-5, 14.0, 2.0
RELATIVE = 1e-9
NOTHING = np.array([])


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return synthesised(tmp_path_factory.mktemp("powerball"), SPEC)


def states() -> list[tuple[Array, Array, Array]]:
    """Angles, rates beyond 1e-3 rad/s, accelerations."""
    rng = np.random.default_rng(8)
    rates = rng.choice([-1, 1], (50, 4)) * rng.uniform(1.001e-3, 1.2, (50, 4))
    angles = rng.uniform(-np.radians(170), np.radians(170), (50, 4))
    return list(zip(angles, rates, rng.uniform(-9, 9, (50, 4)), strict=True))


def efforts(folder: Path, q: Array, v: Array, a: Array) -> Array:
    """What joints ask of drives by our equations, but for dry friction; viscous one by hand."""
    design = found_design(folder)
    graph = robot_graph(design.model, design.task.gravity)
    mass = evaluate(graph, "mass_matrix", q, NOTHING)
    return mass @ a + evaluate(graph, "bias", q, v, NOTHING) + VISCOUS * v


def close(found: Array, expected: Array) -> None:
    np.testing.assert_allclose(found, expected, rtol=0, atol=RELATIVE * np.abs(expected).max())


@pytest.mark.slow
def test_it_is_found_and_proved(folder: Path) -> None:
    report = verify_directory(folder)
    assert report.outcome is Outcome.VALID
    named = [each.name for each in report.conditions]
    joints = ("turn (joint 1)", "bend (joint 2)", "turn (joint 3)", "bend (joint 4)")
    assert {f"effort of Ball.{joint} (N*m)" for joint in joints} <= {*named}
    assert quiet("replay", folder, "--in", "mujoco") == 0


@pytest.mark.slow
def test_mujoco_has_its_inverse_dynamics(folder: Path, tmp_path: Path) -> None:
    assert quiet("export", folder, "--to", "mjcf", "-o", tmp_path / "arm.xml") == 0
    robot = of_file(tmp_path / "arm.xml")
    model, data = robot.model, robot.data
    close(model.dof_armature, np.full(4, ROTOR))
    for q, v, a in states():
        data.qpos[:], data.qvel[:], data.qacc[:] = q, v, a
        mujoco.mj_inverse(model, data)
        due = efforts(folder, q, v, a)
        close(data.qfrc_inverse + data.qfrc_constraint, due)
        # Its dry friction is one of its soft constraints: whole from some rate on.
        if np.abs(v).min() > 0.02:
            close(data.qfrc_inverse, due + COULOMB * np.sign(v))


@pytest.mark.slow
def test_pinocchio_has_it_by_the_file_beside_the_urdf(folder: Path, tmp_path: Path) -> None:
    import pinocchio

    assert quiet("export", folder, "--to", "urdf", "-o", tmp_path / "arm.urdf") == 0
    model = pinocchio.buildModelFromUrdf(str(tmp_path / "arm.urdf"))
    drives = json.loads((tmp_path / "arm.joints.json").read_text(encoding="utf-8"))["drives"]
    places = [model.idx_vs[model.getJointId(name)] for name in drives]
    for place, drive in zip(places, drives.values(), strict=True):
        model.armature[place] = drive["armature"]
        assert (model.damping[place], model.friction[place]) == (VISCOUS, COULOMB)
    data = model.createData()
    for q, v, a in states():
        at = pinocchio.integrate(model, pinocchio.neutral(model), q[places])
        found = pinocchio.rnea(model, data, at, v[places], a[places]) + model.damping * v[places]
        due = efforts(folder, q, v, a)
        close(found[places], due)
        close((found + model.friction * np.sign(v[places]))[places], due + COULOMB * np.sign(v))
