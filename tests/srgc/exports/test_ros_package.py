"""``srgc export --to ros2-package``: read by the parsers that ROS has, and compared by hand."""

from __future__ import annotations

import ast
import re
import shutil
import subprocess
import sys
import types
import xml.etree.ElementTree as ET
from collections.abc import Callable
from pathlib import Path
from typing import Any

import mujoco
import numpy as np
import pytest
import xacro
import yaml
from catkin_pkg.package import Package, parse_package

from srgc.cli import run
from tests.conftest import srgc_process
from tests.oracles import shaped_arm as arm
from tests.oracles.driven_claims import CASES
from tests.oracles.found_folders import claim_found
from tests.oracles.small_specs import TURNER, replaced
from tests.srgc.conftest import Ran

Export = Callable[..., Ran]
NAME = "pick_it_robot"
FILES = {
    "CMakeLists.txt", "package.xml", "config/joint_limits.yaml", "config/joint_names.yaml",
    "config/kinematics.yaml", "config/moveit_controllers.yaml", f"config/{NAME}.srdf",
    "config/ros2_controllers.yaml", "config/trajectory.yaml", "launch/display.launch.py",
    "meshes/hull_1.stl", "rviz/display.rviz", f"urdf/{NAME}.urdf", f"urdf/{NAME}.urdf.xacro",
    f"urdf/{NAME}.joints.json",
}  # fmt: skip


@pytest.fixture(scope="module")
def claimed(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return arm.shaped_arm(tmp_path_factory.mktemp("shaped") / "out")


@pytest.fixture(scope="module")
def package(claimed: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("packages") / "ours"
    assert run(["export", str(claimed), "--to", "ros2-package", "-o", str(folder)]) == 0
    return folder


def files_in(folder: Path) -> dict[str, bytes]:
    return {
        path.relative_to(folder).as_posix(): path.read_bytes()
        for path in folder.rglob("*") if path.is_file()
    }  # fmt: skip


def settings(package: Path, name: str) -> Any:
    return yaml.safe_load((package / "config" / f"{name}.yaml").read_text(encoding="utf-8"))


def urdf_of(package: Path) -> ET.Element:
    return ET.parse(package / "urdf" / f"{NAME}.urdf").getroot()


def srdf_of(package: Path) -> ET.Element:
    return ET.parse(package / "config" / f"{NAME}.srdf").getroot()


# --- the package ---------------------------------------------------------------------------------


def test_the_files_of_a_package(package: Path) -> None:
    assert files_in(package).keys() == FILES


def test_the_manifest_is_one_that_ros_takes(package: Path) -> None:
    warnings: list[str] = []
    found: Package = parse_package(str(package), warnings=warnings)
    found.validate(warnings)
    assert warnings == []
    assert (found.package_format, found.name, found.version) == (3, NAME, "0.1.0")
    assert {each.name for each in found.exec_depends} == {
        "robot_state_publisher", "joint_state_publisher_gui", "rviz2", "xacro",
    }  # fmt: skip
    assert [each.name for each in found.buildtool_depends] == ["ament_cmake"]
    assert found.get_build_type() == "ament_cmake"


def test_what_cmake_installs_is_there(package: Path) -> None:
    text = (package / "CMakeLists.txt").read_text(encoding="utf-8")
    (folders,) = re.findall(r"install\(DIRECTORY ([\w ]+)\n", text)
    there = {path.name for path in package.iterdir() if path.is_dir()}
    assert set(folders.split()) == there
    assert f"project({NAME})" in text


def test_same_design_same_bytes(claimed: Path, package: Path, tmp_path: Path) -> None:
    for seed in ("1", "2"):
        folder = tmp_path / seed
        ran = srgc_process(
            ["export", claimed, "--to", "ros2-package", "-o", folder], tmp_path,
            PYTHONHASHSEED=seed,
        )  # fmt: skip
        ran.communicate()
        assert files_in(folder) == files_in(package)


# --- the robot -----------------------------------------------------------------------------------


def test_the_parser_of_ros_takes_the_robot(package: Path) -> None:
    program = Path(sys.executable).parent / "check_urdf"
    ran = subprocess.run(
        [program, package / "urdf" / f"{NAME}.urdf"], capture_output=True, text=True, check=False
    )
    assert ran.returncode == 0, ran.stdout + ran.stderr
    shown = [line.strip() for line in ran.stdout.splitlines()[2:]]
    assert shown == [
        "root Link: B_0 has 1 child(ren)", "child(1):  Z_1_link", "child(1):  Y_2_link",
        "child(1):  P_3_link", "child(1):  E_4",
    ]  # fmt: skip


def test_meshes_are_where_the_robot_says(package: Path) -> None:
    names = {mesh.attrib["filename"] for mesh in urdf_of(package).iter("mesh")}
    assert names == {f"package://{NAME}/meshes/hull_1.stl"}
    assert (package / "meshes" / "hull_1.stl").is_file()


def test_mujoco_moves_the_robot_as_the_hand_does(package: Path) -> None:
    text = (package / "urdf" / f"{NAME}.urdf").read_text(encoding="utf-8")
    meshes = {path.name: path.read_bytes() for path in (package / "meshes").iterdir()}
    kept = text.replace("<robot ", '<robot xmlns:m="m" ', 1).replace(
        "</robot>", '<mujoco><compiler fusestatic="false"/></mujoco></robot>'
    )
    model = mujoco.MjModel.from_xml_string(kept, assets=meshes)
    data, rng = mujoco.MjData(model), np.random.default_rng(5)
    assert [model.joint(i).name for i in range(model.njnt)] == list(arm.JOINTS)
    for _ in range(20):
        data.qpos[:] = rng.uniform((-2, -2, 0), (2, 2, 0.3))
        mujoco.mj_kinematics(model, data)
        np.testing.assert_allclose(data.body("E_4").xpos, arm.place(data.qpos), atol=1e-12)


def wound(angle: float) -> tuple[float, float]:
    return np.cos(angle), np.sin(angle)


@pytest.mark.slow
def test_pinocchio_moves_the_robot_as_the_hand_does(package: Path, tmp_path: Path) -> None:
    """It finds the meshes, too, where packages are in folders of their names."""
    import pinocchio

    shutil.copytree(package, tmp_path / NAME)
    path = str(tmp_path / NAME / "urdf" / f"{NAME}.urdf")
    model = pinocchio.buildModelFromUrdf(path)
    data, rng = model.createData(), np.random.default_rng(6)
    assert list(model.names)[1:] == list(arm.JOINTS)
    for _ in range(20):
        q = rng.uniform((-2, -2, 0), (2, 2, 0.3))
        # Of a joint without a range it has cosine and sine.
        pinocchio.framesForwardKinematics(model, data, np.array([q[0], *wound(q[1]), q[2]]))
        found = data.oMf[model.getFrameId("E_4")].translation
        np.testing.assert_allclose(found, arm.place(q), atol=1e-12)
    shapes = pinocchio.buildGeomFromUrdf(
        model, path, pinocchio.GeometryType.COLLISION, package_dirs=[str(tmp_path)]
    ).geometryObjects
    assert len(shapes) == 7  # a capsule is three
    assert sum(bool(shape.meshPath) and Path(shape.meshPath).is_file() for shape in shapes) == 1


def canonical(element: ET.Element) -> str:
    return ET.canonicalize(ET.tostring(element), strip_text=True)


def test_xacro_expands_to_the_robot(package: Path) -> None:
    path = str(package / "urdf" / f"{NAME}.urdf.xacro")
    plain = ET.fromstring(xacro.process_file(path).toxml())
    assert canonical(plain) == canonical(urdf_of(package))
    driven = ET.fromstring(xacro.process_file(path, mappings={"ros2_control": "true"}).toxml())
    (control,) = driven.findall("ros2_control")
    assert [each.attrib["name"] for each in control.findall("joint")] == list(arm.JOINTS)
    starts = [float(str(each.text)) for each in control.iter("param")]
    assert starts == [0.3, -0.4, 0.1]
    driven.remove(control)
    assert canonical(driven) == canonical(urdf_of(package))


def test_the_limits_of_the_urdf_are_true(package: Path) -> None:
    limits = {
        joint.attrib["name"]: joint.find("limit") for joint in urdf_of(package).findall("joint")
    }
    for name, bounds, rate, effort in zip(
        arm.JOINTS, arm.RANGES, arm.RATES, arm.EFFORTS, strict=True
    ):
        limit = limits[name]
        assert limit is not None
        assert float(limit.attrib["velocity"]) == (1e9 if rate is None else rate)
        assert float(limit.attrib["effort"]) == effort
        assert ("lower" in limit.attrib) == (bounds is not None)
        if bounds is not None:
            assert (float(limit.attrib["lower"]), float(limit.attrib["upper"])) == bounds


# --- MoveIt --------------------------------------------------------------------------------------


def test_the_names_of_an_srdf_are_those_of_the_urdf(package: Path) -> None:
    urdf, srdf = urdf_of(package), srdf_of(package)
    assert srdf.attrib["name"] == urdf.attrib["name"]
    links = {link.attrib["name"] for link in urdf.findall("link")}
    child = {j.find("child").attrib["link"]: j for j in urdf.findall("joint")}  # type: ignore[union-attr]
    (chain,) = srdf.iter("chain")
    found, link = [], chain.attrib["tip_link"]
    while link != chain.attrib["base_link"]:
        found.append(child[link].attrib["name"])
        link = child[link].find("parent").attrib["link"]  # type: ignore[union-attr]
    assert [name for name in reversed(found) if not name.endswith("_fixed")] == list(arm.JOINTS)
    groups = {group.attrib["name"] for group in srdf.findall("group")}
    (hand,) = srdf.findall("end_effector")
    assert {hand.attrib["group"], hand.attrib["parent_group"]} == groups == {"arm", "hand"}
    assert hand.attrib["parent_link"] == "P_3_link"
    named = {each.attrib["link1"] for each in srdf.iter("disable_collisions")}
    named |= {each.attrib["link2"] for each in srdf.iter("disable_collisions")}
    named |= {link.attrib["name"] for link in srdf.iter("link")}
    assert named <= links
    (state,) = srdf.findall("group_state")
    assert [j.attrib["name"] for j in state] == list(arm.JOINTS)
    assert [float(j.attrib["value"]) for j in state] == [0.3, -0.4, 0.1]


def test_what_may_touch_is_what_the_task_exempts(package: Path) -> None:
    pairs = {
        (each.attrib["link1"], each.attrib["link2"]): each.attrib["reason"]
        for each in srdf_of(package).findall("disable_collisions")
    }
    assert pairs == arm.TOUCHING


def test_a_task_that_does_not_ask_exempts_neighbours_alone(tmp_path: Path) -> None:
    text = replaced(arm.SPEC, "  avoid self with body, margin 5 mm, except B P;\n", "")
    folder = arm.shaped_arm(tmp_path / "out", text)
    assert run(["export", str(folder), "--to", "ros2-package", "-o", str(tmp_path / "p")]) == 0
    pairs = {
        (each.attrib["link1"], each.attrib["link2"])
        for each in srdf_of(tmp_path / "p").findall("disable_collisions")
    }
    assert pairs == arm.TOUCHING.keys() - {("B_0", "P_3_link")}


def test_the_limits_of_moveit_are_true(package: Path) -> None:
    limits = settings(package, "joint_limits")["joint_limits"]
    assert list(limits) == list(arm.JOINTS)
    for name, bounds, rate, accel, effort in zip(
        arm.JOINTS, arm.RANGES, arm.RATES, arm.ACCELERATIONS, arm.EFFORTS, strict=True
    ):
        entry = limits[name]
        for kind, value in (("velocity", rate), ("acceleration", accel), ("effort", effort)):
            assert entry[f"has_{kind}_limits"] is (value is not None)
            assert entry.get(f"max_{kind}") == value
        assert entry["has_position_limits"] is (bounds is not None)
        found = (entry.get("min_position"), entry.get("max_position"))
        assert found == (bounds or (None, None))


def test_controllers_are_about_the_joints_of_the_robot(package: Path) -> None:
    moved = [
        joint.attrib["name"] for joint in urdf_of(package).findall("joint")
        if joint.attrib["type"] != "fixed"
    ]  # fmt: skip
    assert moved == list(arm.JOINTS)
    manager = settings(package, "moveit_controllers")["moveit_simple_controller_manager"]
    (name,) = manager["controller_names"]
    assert manager[name]["joints"] == moved
    controllers = settings(package, "ros2_controllers")
    assert name in controllers["controller_manager"]["ros__parameters"]
    assert controllers[name]["ros__parameters"]["joints"] == moved
    assert settings(package, "kinematics").keys() == {"arm"}
    assert settings(package, "joint_names") == {"controller_joint_names": moved}
    assert settings(package, "trajectory")["joint_names"] == moved


def test_several_hands_are_several_groups(tmp_path: Path) -> None:
    folder, package = CASES["branches"].folder(tmp_path / "out"), tmp_path / "package"
    assert run(["export", str(folder), "--to", "ros2-package", "-o", str(package)]) == 0
    (path,) = (package / "config").glob("*.srdf")
    chains = [
        (group.attrib["name"], group.find("chain").attrib["tip_link"])  # type: ignore[union-attr]
        for group in ET.parse(path).getroot().findall("group") if group.find("chain") is not None
    ]  # fmt: skip
    assert chains == [("arm_1", "EN_14"), ("arm_2", "EN_21")]
    assert settings(package, "kinematics").keys() == {"arm_1", "arm_2"}


# --- what shows it -------------------------------------------------------------------------------


def test_the_launch_file_names_what_there_is(
    package: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Run with stand-ins for the modules of ROS, which only keep what they are given."""

    class Kept:
        def __init__(self, *arguments: Any, **named: Any) -> None:
            self.arguments, self.named = arguments, named

    modules = {
        "launch": ["LaunchDescription"],
        "launch.substitutions": ["Command", "PathJoinSubstitution"],
        "launch_ros": [], "launch_ros.actions": ["Node"],
        "launch_ros.parameter_descriptions": ["ParameterValue"],
        "launch_ros.substitutions": ["FindPackageShare"],
    }  # fmt: skip
    for name, members in modules.items():
        module = types.ModuleType(name)
        for member in members:
            setattr(module, member, type(member, (Kept,), {}))
        monkeypatch.setitem(sys.modules, name, module)
    text = (package / "launch" / "display.launch.py").read_text(encoding="utf-8")
    assert f"ros2 launch {NAME} display.launch.py" in str(ast.get_docstring(ast.parse(text)))
    names: dict[str, Any] = {}
    exec(compile(text, "display.launch.py", "exec"), names)
    (nodes,) = names["generate_launch_description"]().arguments
    assert [(node.named["package"], node.named["executable"]) for node in nodes] == [
        ("robot_state_publisher",) * 2, ("joint_state_publisher_gui",) * 2, ("rviz2",) * 2,
    ]  # fmt: skip
    command = nodes[0].named["parameters"][0]["robot_description"].arguments[0]
    assert command.arguments[0][0] == "xacro "
    for place in (command.arguments[0][1], nodes[2].named["arguments"][1]):
        share, *parts = place.arguments[0]
        assert share.arguments == (NAME,)
        assert package.joinpath(*parts).is_file()


def test_the_window_shows_the_robot(package: Path) -> None:
    window = yaml.safe_load((package / "rviz" / "display.rviz").read_text(encoding="utf-8"))
    manager = window["Visualization Manager"]
    assert manager["Global Options"]["Fixed Frame"] == "B_0"
    classes = [each["Class"] for each in manager["Displays"]]
    assert "rviz_default_plugins/RobotModel" in classes


# --- what is refused, and what is told -----------------------------------------------------------


def test_a_package_is_a_folder(srgc: Export, claimed: Path, tmp_path: Path) -> None:
    ran = srgc("export", claimed, "--to", "ros2-package")
    assert (ran.status, ran.out) == (2, "")
    assert "name a folder with -o" in ran.err
    (tmp_path / "file").write_text("x", encoding="utf-8")
    ran = srgc("export", claimed, "--to", "ros2-package", "-o", tmp_path / "file")
    assert (ran.status, ran.out) == (2, "")
    ran = srgc("export", claimed, "--to", "ros2-package", "-o", claimed / "spec")
    assert (ran.status, ran.out) == (2, "")
    assert "is one of the results" in ran.err


def test_what_urdf_cannot_hold_is_refused(srgc: Export, tmp_path: Path) -> None:
    lamina = "solid(frame: f, mass: 1 kg, com: (0.1, 0, 0) m,\n      inertia: (0.002, 0.006, 0.006,"
    assert lamina in arm.SPEC
    text = arm.SPEC.replace("inertia: (0.002, 0.006, 0.006,", "inertia: (0.002, 0.006, 0.0601,")
    folder = arm.shaped_arm(tmp_path / "out", text)
    ran = srgc("export", folder, "--to", "ros2-package", "-o", tmp_path / "package")
    assert (ran.status, ran.out) == (2, "")
    assert "no body has such an inertia" in ran.err
    assert not (tmp_path / "package").exists()


def test_what_another_robot_left_is_told(srgc: Export, claimed: Path, tmp_path: Path) -> None:
    package = tmp_path / "package"
    assert srgc("export", claimed, "--to", "ros2-package", "-o", package).status == 0
    other = claim_found(tmp_path / "turner", TURNER, "B eps JO eps L eps EN", ["1.5"])
    ran = srgc("export", other, "--to", "ros2-package", "-o", package)
    assert ran.status == 0
    told = re.findall(r"note: (\S+) is of an earlier export", ran.err)
    assert {Path(path).name for path in told} == {
        f"{NAME}.urdf", f"{NAME}.urdf.xacro", f"{NAME}.srdf", f"{NAME}.joints.json", "hull_1.stl",
    }  # fmt: skip
