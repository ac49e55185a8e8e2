"""Write a ROS 2 package of a robot: description, meshes, a launch file for RViz, and its motion.

Sources: REP 149 (package.xml format 3), docs.ros.org (ament_cmake, launch), wiki.ros.org/xacro.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from itertools import count

from srgc.exports.exported_motion import ExportedMotion
from srgc.exports.exported_robot import ExportedRobot
from srgc.exports.hull_files import hull_files
from srgc.exports.joint_file import joints_json
from srgc.exports.motion_formats import joint_trajectory
from srgc.exports.ros.moveit import moveit_files
from srgc.exports.ros.package_name import package_name
from srgc.exports.ros.ros_yaml import yaml_text
from srgc.exports.ros.show_robot import display_launch, display_rviz
from srgc.exports.ros.srdf import planning_groups
from srgc.exports.urdf import urdf_text
from srgc.exports.visual_meshes import visual_files, visual_names
from srgc.exports.xml_lines import XmlLines
from srgc.joint_format import SUFFIX
from srgc.version import VERSION

FOLDERS = ("config", "launch", "meshes", "rviz", "urdf")
DEPENDS = ("joint_state_publisher_gui", "robot_state_publisher", "rviz2", "xacro")
XACRO = "http://www.ros.org/wiki/xacro"


def ros_package(robot: ExportedRobot, motion: ExportedMotion) -> dict[str, bytes]:
    """The files of a package by their paths in its folder.

    Raises:
        ValueError: URDF cannot represent the robot.
        UsageFault: a JointTrajectory cannot represent the motion.
    """
    name = package_name(robot.name)
    meshes = hull_files(robot)
    places = dict(zip(meshes, _mesh_names(), strict=False))
    visuals = {
        digest: f"meshes/{file.removeprefix('.')}"
        for digest, file in visual_names(robot.visuals, "").items()
    }
    urdf = urdf_text(
        robot,
        {hull: f"package://{name}/{place}" for hull, place in places.items()},
        {digest: f"package://{name}/{place}" for digest, place in visuals.items()},
    )
    joints = [motor.name for motor in robot.motors()]
    texts = {
        "package.xml": _manifest(name, robot.remarks),
        "CMakeLists.txt": _cmake(name, has_meshes=bool(meshes or visuals)),
        f"urdf/{name}.urdf": urdf,
        f"urdf/{name}.urdf.xacro": _xacro(name, robot, urdf),
        "launch/display.launch.py": display_launch(name),
        "rviz/display.rviz": display_rviz(robot.names.links[0]),
        "config/joint_names.yaml": yaml_text({"controller_joint_names": joints}),
        "config/trajectory.yaml": joint_trajectory(motion),
        **moveit_files(name, robot, planning_groups(robot)),
    }
    if drives := joints_json(robot):
        texts[f"urdf/{name}{SUFFIX}"] = drives
    found = {path: text.encode() for path, text in texts.items()}
    found |= {places[hull]: content for hull, content in meshes.items()}
    return found | visual_files(robot.visuals, visuals)


def _mesh_names() -> Iterator[str]:
    return (f"meshes/hull_{number}.stl" for number in count(1))


def _manifest(name: str, remarks: Sequence[str]) -> str:
    xml = XmlLines()
    xml.open("package", format="3")
    xml.text("name", name)
    xml.text("version", VERSION)
    xml.text("description", "; ".join(remarks))
    # A package needs both; its owner has to fill them in.
    xml.text("maintainer", "the owner of the robot", email="owner@example.com")
    xml.text("license", "TODO")
    xml.text("buildtool_depend", "ament_cmake")
    for each in DEPENDS:
        xml.text("exec_depend", each)
    xml.open("export")
    xml.text("build_type", "ament_cmake")
    xml.close()
    xml.close()
    return xml.document()


def _cmake(name: str, *, has_meshes: bool) -> str:
    folders = " ".join(each for each in FOLDERS if has_meshes or each != "meshes")
    return (
        "cmake_minimum_required(VERSION 3.8)\n"
        f"project({name})\n\n"
        "find_package(ament_cmake REQUIRED)\n\n"
        f"install(DIRECTORY {folders}\n"
        "  DESTINATION share/${PROJECT_NAME})\n\n"
        "ament_package()\n"
    )


def _xacro(name: str, robot: ExportedRobot, urdf: str) -> str:
    """The robot as xacro; ``ros2_control:=true`` adds simulated drives for controllers."""
    lines = urdf.splitlines()
    first = next(number for number, line in enumerate(lines) if line.startswith("<robot "))
    inner = "\n".join(lines[first + 1 : -1])
    xml = XmlLines()
    xml.open("robot", name=robot.name, **{"xmlns:xacro": XACRO})
    xml.element("xacro:arg", name="ros2_control", default="false")
    # Escape text that xacro would take for an expression: a dollar sign before a bracket.
    xml.lines.append(inner.replace("${", "$${").replace("$(", "$$("))
    xml.open("xacro:if", value="$(arg ros2_control)")
    _control(xml, name, robot)
    xml.close()
    xml.close()
    return xml.document()


def _control(xml: XmlLines, name: str, robot: ExportedRobot) -> None:
    """Write ideal drives for ros2_control that follow every command, for trials."""
    start: Mapping[int, float] = dict(enumerate(robot.start))
    xml.open("ros2_control", name=f"{name}_system", type="system")
    xml.open("hardware")
    xml.text("plugin", "mock_components/GenericSystem")
    xml.close()
    for motor in robot.motors():
        xml.open("joint", name=motor.name)
        xml.element("command_interface", name="position")
        xml.open("state_interface", name="position")
        xml.text("param", repr(start.get(motor.joint.dof, 0.0)), name="initial_value")
        xml.close()
        xml.element("state_interface", name="velocity")
        xml.close()
    xml.close()
