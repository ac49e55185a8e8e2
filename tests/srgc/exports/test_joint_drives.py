"""Rotors, friction and limits of accelerations, as MuJoCo and Pinocchio read them."""

from __future__ import annotations

import json
import xml.etree.ElementTree as ET
from collections.abc import Callable
from pathlib import Path

import mujoco
import numpy as np
import pytest
import yaml

from compiler.arrays import Array
from compiler.dynamics.equations_of_motion import robot_graph
from srgc.results.found_design import found_design
from tests.conftest import srgc_process
from tests.oracles import geared_arm as arm
from tests.oracles import result_files
from tests.oracles.mujoco_dynamics import of_file
from tests.oracles.robots import evaluate
from tests.oracles.small_specs import replaced
from tests.srgc.conftest import Ran

Export = Callable[..., Ran]
RELATIVE = 1e-9
NOTHING = np.array([])


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return arm.geared_arm(tmp_path_factory.mktemp("geared") / "out")


def states(least: float, count: int = 30) -> list[tuple[Array, Array, Array]]:
    """Angles, rates of at least ``least`` rad/s on a scale of powers, accelerations."""
    rng = np.random.default_rng(4)
    signs = rng.choice([-1, 1], (count, 4))
    rates = signs * least * (1.5 / least) ** rng.uniform(size=(count, 4))
    angles = rng.uniform(-arm.RANGE, arm.RANGE, (count, 4))
    return list(zip(angles, rates, rng.uniform(-9, 9, (count, 4)), strict=True))


def without_dry_friction(folder: Path, q: Array, v: Array, a: Array) -> Array:
    """M a + c + g of our equations, rotors among it, and viscous friction by hand."""
    design = found_design(folder)
    graph = robot_graph(design.model, design.task.gravity)
    mass = evaluate(graph, "mass_matrix", q, NOTHING)
    return mass @ a + evaluate(graph, "bias", q, v, NOTHING) + arm.VISCOUS * v


def close(found: Array, expected: Array) -> None:
    scale = np.abs(expected).max()
    assert scale > 0
    np.testing.assert_allclose(found, expected, rtol=0, atol=RELATIVE * scale)


# --- MuJoCo --------------------------------------------------------------------------------------


def test_the_inverse_dynamics_of_mujoco_are_ours(
    srgc: Export, folder: Path, tmp_path: Path
) -> None:
    path = tmp_path / "arm.xml"
    assert srgc("export", folder, "--to", "mjcf", "-o", path) == Ran(0, "", "")
    robot = of_file(path)
    model, data = robot.model, robot.data
    assert [model.joint(i).name for i in range(4)] == list(arm.JOINTS)
    close(model.dof_armature, arm.ARMATURE)
    assert model.dof_damping.tolist() == arm.VISCOUS.tolist()
    assert model.dof_frictionloss.tolist() == arm.COULOMB.tolist()
    for q, v, a in states(0.02):
        data.qpos[:], data.qvel[:], data.qacc[:] = q, v, a
        mujoco.mj_inverse(model, data)
        due = without_dry_friction(folder, q, v, a)
        close(data.qfrc_inverse, due + arm.COULOMB * np.sign(v))
        # Without its constraints, of which dry friction is one.
        close(data.qfrc_inverse + data.qfrc_constraint, due)


def spun(
    srgc: Export, folder: Path, torques: list[tuple[float, float]], shorter: int = 1
) -> tuple[float, float]:
    """The angle and rate in MuJoCo after torques have been held for so many seconds each.

    In steps that are so many times ``shorter`` than those of the file.
    """
    path = folder / "wheel.xml"
    assert srgc("export", folder, "--to", "mjcf", "-o", path) == Ran(0, "", "")
    model = mujoco.MjModel.from_xml_path(str(path))
    model.opt.timestep /= shorter
    data = mujoco.MjData(model)
    for torque, seconds in torques:
        data.ctrl[:] = torque
        mujoco.mj_step(model, data, nstep=round(seconds / model.opt.timestep))
    return float(data.qpos[0]), float(data.qvel[0])


@pytest.mark.parametrize("shorter", [1, 10])
def test_a_disc_turns_back_against_its_friction_as_it_should(
    srgc: Export, tmp_path: Path, shorter: int
) -> None:
    """By hand: 1.5 a = u - 1.2 forwards, u + 1.2 backwards; the change of sign takes two steps."""
    folder = arm.flywheel(tmp_path / "out")
    angle, rate = spun(srgc, folder, [(4, 1), (-2.5, 2)], shorter)
    faster, slower, back = 2.8 / 1.5, 3.7 / 1.5, 1.3 / 1.5
    rests = faster / slower
    assert rate == pytest.approx(-back * (2 - rests), abs=2e-3 / shorter)
    reached = faster / 2 + faster**2 / slower / 2
    assert angle == pytest.approx(reached - back * (2 - rests) ** 2 / 2, abs=2e-3 / shorter)


def test_a_torque_below_the_friction_moves_nothing(srgc: Export, tmp_path: Path) -> None:
    angle, rate = spun(srgc, arm.flywheel(tmp_path / "out"), [(1.1, 2), (-1.1, 2)])
    assert abs(angle) < 1e-6
    assert abs(rate) < 1e-6


def test_a_plain_motor_has_to_give_dry_friction_too(srgc: Export, tmp_path: Path) -> None:
    """Where a module's own dynamics are left out: by hand, 1.5 a and 1.2 against the motion."""
    given = ";\n  input t in [-9, 9] N*m; torque(q) = t;"
    spec = replaced(arm.FLYWHEEL, " effort <= 9 N*m;", given)
    folder = arm.flywheel(tmp_path / "out", spec)
    rows = [["4"]] * 5 + [["-6"]] * 5
    result_files.alter(folder, lambda claim: claim.update(inputs=rows), sign=True)
    motion = json.loads(srgc("export", folder, "--to", "json").out)
    velocity, acceleration = (np.array(motion[key]) for key in ("velocity", "acceleration"))
    assert velocity.min() < 0 < velocity.max()
    way = np.sign(velocity)
    way[0] = 1
    np.testing.assert_allclose(motion["effort"], 1.5 * acceleration + 1.2 * way, rtol=1e-12)


# --- URDF and the file beside it -----------------------------------------------------------------


@pytest.mark.slow
def test_the_inverse_dynamics_of_pinocchio_are_ours(
    srgc: Export, folder: Path, tmp_path: Path
) -> None:
    """Friction by hand from its arrays: its algorithms have none."""
    import pinocchio

    assert srgc("export", folder, "--to", "urdf", "-o", tmp_path / "arm.urdf").status == 0
    model = pinocchio.buildModelFromUrdf(str(tmp_path / "arm.urdf"))
    document = json.loads((tmp_path / "arm.joints.json").read_text(encoding="utf-8"))
    rates = [model.idx_vs[model.getJointId(name)] for name in arm.JOINTS]
    for name, place in zip(arm.JOINTS, rates, strict=True):
        drive = document["drives"][name]
        model.armature[place] = drive["armature"]
        assert model.damping[place] == drive["damping"]
        assert model.friction[place] == drive["friction"]
    close(model.armature[rates], arm.ARMATURE)
    data = model.createData()
    for q, v, a in states(1.001e-3):
        at = pinocchio.integrate(model, pinocchio.neutral(model), q[rates])
        due = without_dry_friction(folder, q, v, a)
        found = pinocchio.rnea(model, data, at, v[rates], a[rates]) + model.damping * v[rates]
        close(found[rates], due)
        assert np.abs(v).min() > 1e-3
        close((found + model.friction * np.sign(v[rates]))[rates], due + arm.COULOMB * np.sign(v))
        free = pinocchio.rnea(model, data, at, v[rates], a[rates])
        close(pinocchio.aba(model, data, at, v[rates], free), a[rates])


def test_the_file_beside_a_urdf_has_what_it_has_no_place_for(
    srgc: Export, folder: Path, tmp_path: Path
) -> None:
    urdf, beside = tmp_path / "arm.urdf", tmp_path / "arm.joints.json"
    ran = srgc("export", folder, "--to", "urdf", "-o", urdf)
    assert ran == Ran(0, f"{urdf}\n{beside}\n", "")
    document = json.loads(beside.read_text(encoding="utf-8"))
    # As YAML, where 1e-05 would be a text: what MoveIt reads.
    assert yaml.safe_load(beside.read_text(encoding="utf-8")) == document
    assert list(document) == ["format", "about", "joint_limits", "drives"]
    assert list(document["drives"]) == list(document["joint_limits"]) == list(arm.JOINTS)
    keys = {"armature": arm.ARMATURE, "damping": arm.VISCOUS, "friction": arm.COULOMB}
    for key, expected in keys.items():
        found = [drive[key] for drive in document["drives"].values()]
        assert found == pytest.approx(expected.tolist(), rel=1e-15)
    for key, bounds in (("acceleration", arm.ACCELERATION), ("velocity", arm.VELOCITY)):
        limits = list(document["joint_limits"].values())
        assert [each.get(f"max_{key}") for each in limits] == list(bounds)
        assert [each[f"has_{key}_limits"] for each in limits] == [b is not None for b in bounds]
    root = ET.parse(urdf).getroot()
    joints = [item for item in root.findall("joint") if item.get("type") != "fixed"]
    assert [item.get("name") for item in joints] == list(arm.JOINTS)
    reductions = [item.text for item in root.iter("mechanicalReduction")]
    assert reductions == ["160", "160", "120", "1"]
    friction = [item.find("dynamics").attrib["friction"] for item in joints]  # type: ignore[union-attr]
    assert [float(text) for text in friction] == arm.COULOMB.tolist()


def test_it_is_the_same_each_time(srgc: Export, folder: Path, tmp_path: Path) -> None:
    arguments = ["export", folder, "--to", "all", "-o", tmp_path / "all"]
    process = srgc_process(arguments, tmp_path, PYTHONHASHSEED="7")
    assert srgc("export", folder, "--to", "urdf", "-o", tmp_path / "robot.urdf").status == 0
    out, _ = process.communicate()
    assert process.returncode == 0
    for name in ("robot.urdf", "robot.joints.json"):
        assert f"{tmp_path / 'all' / name}" in out.decode().splitlines()
        assert (tmp_path / name).read_bytes() == (tmp_path / "all" / name).read_bytes()


def test_a_urdf_that_is_printed_has_nothing_beside_it(srgc: Export, folder: Path) -> None:
    ran = srgc("export", folder, "--to", "urdf")
    assert (ran.status, ran.out[:5]) == (0, "<?xml")
    assert ran.err == (
        "note: URDF has no place for rotors and limits of accelerations; "
        "name a file with -o, and a file beside it has them\n"
    )
    assert srgc("export", folder, "--to", "mjcf").err == ""


def test_dry_friction_alone_needs_no_file(srgc: Export, tmp_path: Path) -> None:
    spec = replaced(arm.FLYWHEEL, "gear 100 rotor 1e-4 kg*m^2 ", "")
    folder = arm.flywheel(tmp_path / "out", spec)
    urdf, beside = tmp_path / "a.b.urdf", tmp_path / "a.b.joints.json"
    assert srgc("export", folder, "--to", "urdf", "-o", urdf) == Ran(0, "", "")
    assert not beside.exists()
    assert '<dynamics friction="1.2"/>' in urdf.read_text(encoding="utf-8")
    beside.write_text("{}", encoding="utf-8")
    ran = srgc("export", folder, "--to", "urdf", "-o", urdf)
    assert ran == Ran(0, "", f"note: {beside} is of an earlier export: remove it\n")
    assert srgc("export", folder, "--to", "urdf").err == ""


def test_an_acceleration_alone_needs_one(srgc: Export, tmp_path: Path) -> None:
    spec = replaced(arm.FLYWHEEL, "effort <= 9", "accel <= 3 rad/s^2 effort <= 9")
    spec = replaced(spec, "  drive q: gear 100 rotor 1e-4 kg*m^2 coulomb 1.2 N*m; }", "}")
    folder = arm.flywheel(tmp_path / "out", spec)
    # Into the result folder itself, whose results have other names.
    assert srgc("export", folder, "--to", "urdf", "-o", folder / "arm.urdf").status == 0
    document = json.loads((folder / "arm.joints.json").read_text(encoding="utf-8"))
    assert document["joint_limits"]["J_1"]["max_acceleration"] == 3
    assert document["drives"]["J_1"] == {"armature": 0, "damping": 0, "friction": 0}
    motion = json.loads(srgc("export", folder, "--to", "json").out)
    assert motion["joints"][0]["acceleration"] == 3


def test_a_file_that_cannot_be_written_is_said(srgc: Export, folder: Path, tmp_path: Path) -> None:
    (tmp_path / "arm.joints.json").mkdir()
    ran = srgc("export", folder, "--to", "urdf", "-o", tmp_path / "arm.urdf")
    assert (ran.status, ran.out) == (2, "")
    assert f"{tmp_path / 'arm.joints.json'}: " in ran.err
