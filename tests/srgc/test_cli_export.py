"""``srgc export``: what is written, what is refused, and the case study driven in MuJoCo."""

from __future__ import annotations

import csv
import subprocess
import sys
import xml.etree.ElementTree as ET
from collections.abc import Callable
from pathlib import Path

import mujoco
import numpy as np
import pytest

from srgc.cli.export import BINARY, FOLDERS, FORMS
from srgc.exports import design_export
from srgc.exports.urdf import urdf_text
from tests.conftest import srgc_process
from tests.oracles import result_files
from tests.oracles.driven_claims import CRANE
from tests.oracles.exported_robots import exported, random_lengths, solid_robot
from tests.oracles.found_folders import claim_found
from tests.oracles.small_specs import TURNER, replaced
from tests.oracles.some_cases import some
from tests.srgc.conftest import ROOT, Ran

Export = Callable[..., Ran]
Result = Callable[[str], Path]


@pytest.fixture
def crane(tmp_path: Path) -> Path:
    word = "B eps V eps H eps L eps P eps L eps EN"
    return claim_found(tmp_path / "crane", CRANE, word, ["1.5", "1.25"])


def test_the_formats_that_the_command_offers_are_those_that_there_are() -> None:
    """The command has lists of its own, so that its help loads no export."""
    assert set(FORMS) == set(design_export.FORMS)
    assert (FOLDERS, BINARY) == (design_export.FOLDERS, design_export.BINARY)


def check_urdf(path: Path) -> list[str]:
    """What the parser of ROS makes of a file."""
    program = Path(sys.executable).parent / "check_urdf"
    ran = subprocess.run([program, path], capture_output=True, text=True, check=False)
    assert ran.returncode == 0, ran.stdout + ran.stderr
    assert "Successfully Parsed XML" in ran.stdout
    return ran.stdout.splitlines()


# --- the case study ------------------------------------------------------------------------------


def test_the_stored_torques_drive_the_arm_in_mujoco_as_stored(
    srgc: Export, made: Result, tmp_path: Path
) -> None:
    folder, path = made("planar_arm") / "out", tmp_path / "arm.xml"
    assert srgc("export", folder, "--to", "mjcf", "-o", path) == Ran(0, "", "")
    model = mujoco.MjModel.from_xml_path(str(path))
    data = mujoco.MjData(model)
    assert model.opt.integrator == mujoco.mjtIntegrator.mjINT_RK4
    mujoco.mj_resetDataKeyframe(model, data, model.key("start").id)
    with (folder / "trajectory.csv").open(encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == 82
    count = round(0.125 / model.opt.timestep)
    assert count * model.opt.timestep == pytest.approx(0.125, rel=1e-15)
    moved = 0.0
    for row in rows:
        q = np.array([float(row["q1"]), float(row["q2"])])
        tip = [float(row["e1_x"]), float(row["e1_y"])]
        assert np.abs(data.qpos - q).max() < 1e-6
        mujoco.mj_kinematics(model, data)
        assert np.abs(data.site("EN_10").xpos[:2] - tip).max() < 1e-5
        moved = max(moved, np.abs(q - model.key("start").qpos).max())
        if row["u1"]:
            data.ctrl[:] = [float(row["u1"]), float(row["u2"])]
            mujoco.mj_step(model, data, nstep=count)
    assert moved > 0.5


def test_the_case_study_as_urdf(srgc: Export, made: Result, tmp_path: Path) -> None:
    path = tmp_path / "arm.urdf"
    assert srgc("export", made("planar_arm") / "out", "--to", "urdf", "-o", path).status == 0
    shown = [line.strip() for line in check_urdf(path)]
    assert shown[2:] == [
        "root Link: B_0 has 1 child(ren)", "child(1):  L_4", "child(1):  L_8", "child(1):  EN_10",
    ]  # fmt: skip
    design = result_files.read(made("planar_arm") / "out", "design.json")
    masses = {
        link.attrib["name"]: float(link.find("inertial/mass").attrib["value"])  # type: ignore[union-attr]
        for link in ET.parse(path).getroot().iter("link")
    }
    for parameter in design["parameters"]:  # 1 kg/m
        assert masses[f"L_{parameter['symbol']}"] == pytest.approx(parameter["value"], abs=1e-8)


# --- what is written -----------------------------------------------------------------------------


def test_the_parts_of_a_urdf(srgc: Export, crane: Path, tmp_path: Path) -> None:
    path = tmp_path / "crane.urdf"
    path.write_text(srgc("export", crane, "--to", "urdf").out, encoding="utf-8")
    check_urdf(path)
    root = ET.parse(path).getroot()
    assert [link.attrib["name"] for link in root.iter("link")] == [
        "B_0", "V_2_link", "L_6", "L_10", "EN_12",
    ]  # fmt: skip
    joints = {item.attrib["name"]: item for item in root.findall("joint")}
    kinds = {name: item.attrib["type"] for name, item in joints.items()}
    assert kinds == {
        "V_2": "continuous", "H_4": "revolute", "P_8": "prismatic", "EN_12_fixed": "fixed",
    }  # fmt: skip
    hinge = joints["H_4"].find("limit")
    assert hinge is not None
    assert float(hinge.attrib["lower"]) == -np.pi / 2
    assert float(hinge.attrib["upper"]) == np.pi / 4
    assert float(hinge.attrib["effort"]) == 7
    assert float(hinge.attrib["velocity"]) == 2
    axis = joints["H_4"].find("axis")
    assert axis is not None
    assert [float(x) for x in axis.attrib["xyz"].split()] == [0, -1, 0]
    slide = joints["P_8"].find("limit")
    assert slide is not None
    assert float(slide.attrib["effort"]) == 20
    driven = [item.find("joint").attrib["name"] for item in root.iter("transmission")]  # type: ignore[union-attr]
    assert driven == ["V_2", "H_4", "P_8"]
    for link in root.iter("link"):
        tensor = link.find("inertial/inertia")
        assert tensor is not None
        assert min(float(tensor.attrib[name]) for name in ("ixx", "iyy", "izz")) >= 1e-9
    # Boxes of an inertia are for the eye alone; rods with a radius collide as capsules.
    shown = {
        tag: [item.tag for each in root.iter(tag) for item in each.find("geometry") or ()]
        for tag in ("visual", "collision")
    }
    assert sorted(shown["visual"]) == ["box", "box", "cylinder", "cylinder"]
    assert sorted(shown["collision"]) == ["cylinder"] * 2 + ["sphere"] * 4
    assert {item.attrib["radius"] for item in root.iter("cylinder")} == {"0.05"}


def test_the_parts_of_an_mjcf(srgc: Export, crane: Path) -> None:
    text = srgc("export", crane, "--to", "mjcf").out
    model = mujoco.MjModel.from_xml_string(text)
    assert list(model.opt.gravity) == [0, 1, -9.81]
    assert model.opt.timestep == 0.0125 / 13
    assert model.opt.disableflags & mujoco.mjtDisableBit.mjDSBL_CONTACT
    names = [model.actuator(i).name for i in range(model.nu)]
    assert names == ["V_2", "H_4", "P_8"]
    assert [list(limits) for limits in model.actuator_ctrlrange] == [[-7, 7], [-7, 7], [-20, 20]]
    assert list(model.jnt_limited) == [0, 1, 0]
    assert list(model.joint("H_4").range) == [-np.pi / 2, np.pi / 4]
    # The link between V_2 and H_4 has no mass: one body for both joints.
    assert model.body("L_6").jntnum[0] == 2
    assert model.body("L_6").mass[0] == 3 + 1.5
    np.testing.assert_allclose(model.body_subtreemass[0], 6 + 1.5 + 1.25)
    data = mujoco.MjData(model)
    data.qpos[:] = [0.5, 0.25, 0.75]
    mujoco.mj_kinematics(model, data)
    # By hand: along x by the lengths and the slide, up by the hinge about -y, turned, tilted.
    reach = 1.5 + 0.75 + 1.25
    x, y, z = np.cos(0.25) * np.cos(0.5), np.cos(0.25) * np.sin(0.5), np.sin(0.25)
    c, s = np.cos(np.pi / 6), np.sin(np.pi / 6)
    tip = reach * np.array([x, c * y - s * z, s * y + c * z])
    np.testing.assert_allclose(data.site("EN_12").xpos, tip, atol=1e-14)


def test_both_say_where_they_come_from(srgc: Export, crane: Path) -> None:
    digest = result_files.read(crane)["spec_sha256"]
    version = srgc("--version").out.split()[-1]
    for form in ("urdf", "mjcf"):
        ran = srgc("export", crane, "--to", form)
        assert (ran.status, ran.err) == (0, "")
        for part in ("B eps V eps H eps L eps P eps L eps EN", digest, f"srgc {version}"):
            assert part in ran.out


@pytest.mark.parametrize("form", some(["mjcf", "urdf"], 1))
def test_same_folder_same_bytes(srgc: Export, crane: Path, tmp_path: Path, form: str) -> None:
    path = tmp_path / "out.xml"
    assert srgc("export", crane, "--to", form, "-o", path) == Ran(0, "", "")
    for seed in ("1", "2"):
        process = srgc_process(["export", crane, "--to", form], tmp_path, PYTHONHASHSEED=seed)
        assert process.communicate() == (path.read_bytes(), b"")


@pytest.mark.parametrize(("dimension", "tree"), [(2, False), (2, True), (3, False), (3, True)])
def test_random_urdf_is_valid(tmp_path: Path, dimension: int, tree: bool) -> None:
    for seed in range(3):
        model = solid_robot(seed, dimension, 5, tree=tree)
        path = tmp_path / f"{seed}.urdf"
        path.write_text(urdf_text(exported(model, random_lengths(seed, model))), encoding="utf-8")
        check_urdf(path)


def test_names_follow_the_branches(srgc: Export, tmp_path: Path) -> None:
    text = (ROOT / "specs" / "two_arm.srg").read_text(encoding="utf-8")
    word = "B eps W eps T [ JO eps L eps JO eps L eps EN ] [ JO eps L eps EN ]"
    folder = claim_found(tmp_path / "arms", text, word, ["0.3", "0.4", "0.5"])
    model = mujoco.MjModel.from_xml_string(srgc("export", folder, "--to", "mjcf").out)
    parents = {
        model.body(i).name: model.body(int(model.body_parentid[i])).name
        for i in range(1, model.nbody)
    }
    assert parents == {
        "B_0": "world", "T_4": "B_0", "L_8": "T_4", "L_12": "L_8", "L_19": "T_4",
    }  # fmt: skip
    assert model.site("EN_14").bodyid[0] == model.body("L_12").id
    assert model.site("EN_21").bodyid[0] == model.body("L_19").id
    assert model.joint("JO_17").bodyid[0] == model.body("L_19").id


def hinge(torque: str) -> str:
    """The spec of one link whose joint has this torque, and a parameter b."""
    more = f"torque(q) = {torque}; param b in [0, 1] N*m*s; }}"
    return replaced(TURNER, "in [-180, 180] deg; }", f"in [-180, 180] deg; {more}")


@pytest.mark.parametrize("form", ["urdf", "mjcf"])
@pytest.mark.parametrize(
    "torque",
    [
        "u - b*abs(rate(q))",
        "u - b*rate(q) - 0.1 N*m*q",
        "u + 0.1 N*m*s*rate(q)",
        "2*u - b*rate(q)",
        "u - b*rate(q) + 0.1 N*m",
        "-b*rate(q)",
        "u - u*b*rate(q)/(1 N*m)",
    ],
)
def test_dynamics_of_modules_are_left_out_with_a_note(
    srgc: Export, tmp_path: Path, form: str, torque: str
) -> None:
    folder = claim_found(tmp_path / "arm", hinge(torque), "B eps JO eps L eps EN", ["0.25", "1.5"])
    ran = srgc("export", folder, "--to", form)
    assert ran.status == 0
    assert ran.err.startswith("note: the dynamics of their own of JO (symbol 2) are left out")
    assert "the dynamics of their own of JO (symbol 2) are left out" in ran.out
    assert 'name="JO_2"' in ran.out
    assert "damping" not in ran.out


@pytest.mark.parametrize(
    ("torque", "damping"),
    [
        ("u - 0.1 N*m*s*rate(q)", 0.1),
        ("u - b*rate(q)", 0.25),
        ("-((3 - 1)*b*rate(q)*0.5^2 - (u + rate(q)*b)) - rate(q)*b/0.5", 0.375),
        ("u - (b - 0.25 N*m*s)*rate(q)", 0),
    ],
)
def test_viscous_friction_is_the_damping_of_the_joint(
    srgc: Export, tmp_path: Path, torque: str, damping: float
) -> None:
    folder = claim_found(tmp_path / "arm", hinge(torque), "B eps JO eps L eps EN", ["0.25", "1.5"])
    ran = srgc("export", folder, "--to", "mjcf")
    assert (ran.status, ran.err) == (0, "")
    assert "left out" not in ran.out
    model = mujoco.MjModel.from_xml_string(ran.out)
    data = mujoco.MjData(model)
    data.qvel[0], data.ctrl[0] = -3, 2
    mujoco.mj_forward(model, data)
    # A rod of 1 kg/m about its end: I = l^3/3.
    assert data.qacc[0] == pytest.approx((2 + 3 * damping) / (1.5**3 / 3), rel=1e-12)
    path = tmp_path / "arm.urdf"
    assert srgc("export", folder, "--to", "urdf", "-o", path) == Ran(0, "", "")
    check_urdf(path)
    found = [float(item.attrib["damping"]) for item in ET.parse(path).getroot().iter("dynamics")]
    assert found == ([damping] if damping else [])


# --- what is refused -----------------------------------------------------------------------------


def refused(ran: Ran, reason: str) -> None:
    assert (ran.status, ran.out) == (2, "")
    assert reason in ran.err
    assert ran.err.count("\n") == 1


def test_usage(srgc: Export, crane: Path, tmp_path: Path) -> None:
    for arguments in ((crane,), (crane, "--to", "step"), ("--to", "urdf")):
        ran = srgc("export", *arguments)
        assert (ran.status, ran.out) == (2, "")
    refused(srgc("export", tmp_path / "none", "--to", "urdf"), "is not a folder")
    refused(srgc("export", crane / "certificate.json", "--to", "urdf"), "is not a folder")
    refused(srgc("export", tmp_path, "--to", "mjcf"), "has no certificate")
    refused(srgc("export", crane, "--to", "mjcf", "-o", tmp_path), f"{tmp_path}: ")


@pytest.mark.parametrize(
    "name", ["certificate.json", "design.json", "spec/robot.srg", "proofs/new.xml", "log.json"]
)
def test_results_are_not_overwritten(
    srgc: Export, crane: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, name: str
) -> None:
    before = {path: path.read_bytes() for path in crane.rglob("*") if path.is_file()}
    (tmp_path / "link").symlink_to(crane)
    monkeypatch.chdir(tmp_path)
    for output in (crane / name, Path("link") / name, Path("crane/spec/..") / name):
        refused(srgc("export", crane, "--to", "mjcf", "-o", output), "is one of the results")
    assert {path: path.read_bytes() for path in crane.rglob("*") if path.is_file()} == before
    assert srgc("export", "crane", "--to", "mjcf", "-o", crane / "arm.xml") == Ran(0, "", "")
    assert (crane / "arm.xml").is_file()


def test_a_dash_is_standard_output(
    srgc: Export, crane: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    for form in ("urdf", "mjcf"):
        ran = srgc("export", crane, "--to", form, "-o", "-")
        assert ran == srgc("export", crane, "--to", form)
        assert ran.out.startswith("<?xml")
    spec = crane / "spec" / "robot.srg"
    for command in (
        ("model", spec, "--word", "B eps V eps L eps EN"),
        ("graph", spec, "--of", "sra"),
    ):
        ran = srgc(*command, "-o", "-")
        assert (ran.status, ran.out) == (0, srgc(*command).out)
        assert ran.out
    assert not (tmp_path / "-").exists()


def test_another_verdict(srgc: Export, made: Result) -> None:
    folder = made("beyond_reach") / "out"
    ran = srgc("export", folder, "--to", "urdf")
    assert (ran.status, ran.out) == (2, "")
    assert ran.err == (
        f"error[SRG0735]: {folder} has no robot: its verdict is impossible\n"
        f"  hint: `srgc why {folder}` says why\n"
    )


def test_an_altered_certificate(srgc: Export, crane: Path) -> None:
    result_files.alter(crane, lambda c: c["parameters"][0].update(value="1.75"), sign=False)
    refused(srgc("export", crane, "--to", "mjcf"), "altered")
    (crane / "certificate.json").write_bytes(b"\xff")
    refused(srgc("export", crane, "--to", "mjcf"), "not UTF-8")
    (crane / "certificate.json").unlink()
    (crane / "certificate.json").mkdir()
    refused(srgc("export", crane, "--to", "mjcf"), "certificate.json is a folder")


@pytest.mark.parametrize(
    ("key", "value", "reason"),
    [
        ("parameters", [], "the parameters are not those of the robot"),
        ("derivation", ["base"], "does not derive the word"),
        ("derivation", ["base", "base"], "crane: "),
        ("task", "Drop", "no task `Drop`"),
        ("start", ["0"], "start or the inputs"),
        ("start", ["x"] * 6, "is not an exact number"),
    ],
)
def test_a_claim_about_another_robot(
    srgc: Export, crane: Path, key: str, value: object, reason: str
) -> None:
    result_files.alter(crane, lambda c: c.__setitem__(key, value), sign=True)
    refused(srgc("export", crane, "--to", "mjcf"), reason)


def test_a_value_outside_its_range(srgc: Export, crane: Path) -> None:
    result_files.alter(crane, lambda c: c["parameters"][0].update(value="1000"), sign=True)
    refused(srgc("export", crane, "--to", "mjcf"), "is outside its range")


def test_an_altered_spec(srgc: Export, crane: Path) -> None:
    result_files.alter_spec(crane, "const mass = 3 kg", "const mass = 4 kg", sign=False)
    refused(srgc("export", crane, "--to", "urdf"), "the spec has been altered")


def test_an_inertia_that_no_body_has(srgc: Export, tmp_path: Path) -> None:
    text = replaced(CRANE, "(0.2, 0.3, 0.4, 0,", "(0.2, 0.3, 9, 0,")
    folder = claim_found(tmp_path / "crane", text, "B eps V eps L eps EN", ["1"])
    refused(srgc("export", folder, "--to", "urdf"), "triangle inequality")


def test_what_mujoco_would_not_load(srgc: Export, tmp_path: Path) -> None:
    word = "B eps JO eps L eps EN"
    cases = [
        ("const density = 1 kg/m", "const density = 6e-16 kg/m", "L_4 has 9e-16 kg"),
        ("in [-180, 180] deg; }", "in [10, 10] deg; }", "JO_2 has such a range"),
        (
            "{ role link; param length in [1, 2] m;",
            "{ role link; param length in [1, 1e100] m;",
            "",
        ),
    ]
    for number, (old, new, reason) in enumerate(cases):
        text = replaced(TURNER, old, new)
        if not reason:
            text = replaced(text, "const density = 1 kg/m", "const density = 1e60 kg/m")
        length = "1.5" if reason else f"1{100 * '0'}"
        folder = claim_found(tmp_path / str(number), text, word, [length])
        ran = srgc("export", folder, "--to", "mjcf")
        refused(ran, reason or "too large for a double")
        assert "cannot be exported" in ran.err


def test_what_mujoco_does_load(srgc: Export, tmp_path: Path) -> None:
    """Light and heavy bodies, in the plane and in space, without a message."""
    word = "B eps JO eps L eps EN"
    for planar in (True, False):
        for density in ("1e-15", "1e-12", "1e-6", "1e6", "1e30", "1e100"):
            text = replaced(TURNER, "const density = 1 kg/m", f"const density = {density} kg/m")
            if not planar:
                text = text.replace("plane xy", "space xyz").replace("] m;", "] x [0, 1] m;")
                text = text.replace(
                    "param length in [1, 2] x [0, 1] m;", "param length in [1, 2] m;"
                )
            folder = claim_found(tmp_path / f"{density} {planar}", text, word, ["1.5"])
            ran = srgc("export", folder, "--to", "mjcf")
            assert (ran.status, ran.err) == (0, "")
            model = mujoco.MjModel.from_xml_string(ran.out)
            assert model.body("L_4").mass[0] == pytest.approx(1.5 * float(density), rel=1e-15)


def test_a_robot_without_degrees_of_freedom_has_a_start(srgc: Export, tmp_path: Path) -> None:
    text = replaced(TURNER, " and starts with B eps JO", "")
    folder = claim_found(tmp_path / "pole", text, "B eps L eps EN", ["1.5"])
    model = mujoco.MjModel.from_xml_string(srgc("export", folder, "--to", "mjcf").out)
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, model.key("start").id)
    assert (model.nq, model.nkey) == (0, 1)
    mujoco.mj_forward(model, data)
    assert list(data.site("EN_4").xpos) == [1.5, 0, 0]


TWO_TOOLS = """\
module B { role base; } module J { role joint; dof q: revolute z; }
module F { role effector; } module E { role effector; }
grammar G { start R; r: R -> B J X E; go: X -> F; }
semantics G {
  r {
    this.a = this.frame * rot(z, J.q);
    point(frame: this.a * move(x, 0.2), mass: 3);
    X.at = this.a * move(x, 1);
    effector(frame: this.a * move(x, 2));
  }
  go { effector(frame: this.at); }
}
workspace W {
  plane xy; bounds box [-20, 20] x [-20, 20] m;
  region S box [-18, 18] x [-18, 18] m; target T box [-19, 19] x [-19, 19] m;
}
task Go {
  robot G; workspace W; start in S rates <= 0.5; reach T; effort <= 30 N*m;
  horizon 8 steps of 0.125 s; modules <= 40;
}
"""


def test_effectors_are_where_their_modules_are(srgc: Export, tmp_path: Path) -> None:
    folder = claim_found(tmp_path / "two", TWO_TOOLS, "B J F E", [])
    model = mujoco.MjModel.from_xml_string(srgc("export", folder, "--to", "mjcf").out)
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    assert data.site("F_2").xpos[0] == 1
    assert data.site("E_3").xpos[0] == 2
    root = ET.fromstring(srgc("export", folder, "--to", "urdf").out)
    origins = {item.attrib["name"]: item.find("origin") for item in root.findall("joint")}
    for name, x in (("F_2_fixed", 1), ("E_3_fixed", 2)):
        origin = origins[name]
        assert origin is not None
        assert [float(item) for item in origin.attrib["xyz"].split()] == [x, 0, 0]
