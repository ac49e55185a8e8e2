"""Export a design in the formats of other tools, as one file or as a folder."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from importlib.resources import files
from itertools import count
from pathlib import Path

from srgc.exports.controller_files import CONTROLLER_FILES, C, controller_files
from srgc.exports.exported_motion import ExportedMotion, exported_motion
from srgc.exports.exported_robot import (
    ExportedRobot,
    body_factors,
    exported_robot,
    left_out,
    load_states,
    remarks,
)
from srgc.exports.hull_files import hull_files
from srgc.exports.joint_file import joints_json
from srgc.exports.mjcf import mjcf_text
from srgc.exports.motion_formats import (
    gain_table,
    joint_trajectory,
    torque_table,
    trajectory_arrays,
    trajectory_json,
    trajectory_table,
)
from srgc.exports.motion_picture import motion_picture
from srgc.exports.ros.ros_package import ros_package
from srgc.exports.scenes.design_scene import design_scene
from srgc.exports.scenes.gltf import gltf_bytes
from srgc.exports.scenes.mcap_log import mcap_log
from srgc.exports.urdf import urdf_text
from srgc.exports.visual_meshes import mujoco_reads, unread_by_mujoco, visual_files, visual_names
from srgc.faults import NoAnswer, UsageFault
from srgc.joint_format import SUFFIX
from srgc.results.found_design import FoundDesign, found_design

ROBOTS: Mapping[str, Callable[[ExportedRobot], str]] = {"urdf": urdf_text, "mjcf": mjcf_text}
MOTIONS: Mapping[str, Callable[[ExportedMotion], str | bytes]] = {
    "csv": trajectory_table,
    "json": trajectory_json,
    "ros2": joint_trajectory,
    "npz": trajectory_arrays,
}
FILE_NAMES = {
    "urdf": "robot.urdf",
    "mjcf": "robot.xml",
    "csv": "trajectory.csv",
    "json": "trajectory.json",
    "ros2": "trajectory.yaml",
    "npz": "trajectory.npz",
}
SCENES = {"gltf": "robot.glb", "mcap": "run.mcap", "svg": "motion.svg"}
"""Formats that show the robot moving among regions; ``all`` does not include them."""
FREQUENCY = 30
"""The least number of instants per second in scenes."""
JOINTS = f"robot{SUFFIX}"
TORQUES, GAINS, SCRIPT = "torques.csv", "gains.csv", "replay.py"
FORMS = (*ROBOTS, *MOTIONS, *SCENES)
FOLDERS = ("mujoco", "controller", "ros2-package", "all")
BINARY = ("npz", "gltf", "mcap")
REPLAYED = (FILE_NAMES["mjcf"], FILE_NAMES["csv"], TORQUES, GAINS, SCRIPT)
FOLDER_FILES = {
    "mujoco": REPLAYED,
    "controller": CONTROLLER_FILES,
    "ros2-package": (),
    "all": tuple(dict.fromkeys((*FILE_NAMES.values(), JOINTS, *CONTROLLER_FILES, *REPLAYED))),
}


@dataclass(frozen=True, slots=True)
class ExportFolder:
    """Files by their names, and notes on what they do not include."""

    files: Mapping[str, bytes]
    notes: tuple[str, ...]


def export_bytes(design: FoundDesign, form: str, *, efforts: bool = True) -> bytes:
    """A design in one of the ``FORMS``.

    Args:
        design: the design.
        form: the format.
        efforts: whether a ROS 2 message has efforts.

    Raises:
        UsageFault: the format cannot represent the design.
    """
    if form in ROBOTS:
        return _robot_text(design, ROBOTS[form]).encode()
    if form in SCENES:
        return scene_file(design, form)[0]
    motion = exported_motion(design)
    if form == "ros2":
        return joint_trajectory(motion, efforts=efforts).encode()
    return _encoded(MOTIONS[form](motion))


def export_folder(folder: Path, form: str) -> ExportFolder:
    """The design of a result folder as one of the ``FOLDERS``.

    These are a replay in MuJoCo, the controller, a ROS 2 package, or everything.

    Raises:
        UsageFault: ``mujoco``: MuJoCo cannot replay the robot; ``controller``: the robot has no
            inputs, or its proof does not allow for rounding.
        NoAnswer: ``controller``: the tube does not reach the end of the motion.
    """
    design = found_design(folder)
    if form == "mujoco":
        files = _replayed(design, exported_motion(design))
        return ExportFolder(files, left_out_of(design, "mjcf"))
    if form == "controller":
        return ExportFolder(*controller_files(folder, design))
    if form == "ros2-package":
        return ExportFolder(_package(design), remarks(design))
    motion = exported_motion(design)
    found = {FILE_NAMES[name]: _encoded(write(motion)) for name, write in MOTIONS.items()}
    notes = list(remarks(design))
    for name, files_of in (("urdf", urdf_files), ("mjcf", mjcf_files)):
        try:
            beside = files_of(design, Path(FILE_NAMES[name]).stem)
        except UsageFault as fault:
            notes.append(f"no {FILE_NAMES[name]}: {fault}")
            continue
        found |= beside
        notes += left_out_of(design, name)
    try:
        found |= _replayed(design, motion)
    except UsageFault as fault:
        notes.append(f"no {SCRIPT}: {fault}")
    try:
        files, more = controller_files(folder, design)
        found |= files
        notes += more
    except (UsageFault, NoAnswer) as fault:
        notes.append(f"no {C}: {fault}")
    return ExportFolder(found, tuple(notes))


def scene_file(design: FoundDesign, form: str) -> tuple[bytes, tuple[str, ...]]:
    """A design in one of the ``SCENES``, and notes on what it does not include.

    Raises:
        UsageFault: a number is too large, or a library is missing.
    """
    if form == "svg":
        return motion_picture(design).encode(), ()
    scene = design_scene(design, FREQUENCY, visuals=form == "gltf")
    if form == "gltf":
        return gltf_bytes(scene), scene.notes
    log = mcap_log(scene, exported_motion(design))
    return log.content, log.notes


def _package(design: FoundDesign) -> dict[str, bytes]:
    motion = exported_motion(design)
    try:
        return ros_package(exported_robot(design), motion)
    except ValueError as error:
        raise UsageFault(f"the robot cannot be exported: {error}") from None


def mujoco_text(design: FoundDesign, factors: Sequence[float] = ()) -> str:
    """The MJCF of a robot that moves as planned if the planned torques are applied.

    The mass and the moments of inertia of each body are multiplied by its factor, by default 1.

    Raises:
        UsageFault: MJCF cannot represent the robot or its dynamics.
    """
    _refuse_own(design)
    return _robot_text(design, mjcf_text, factors)


def _refuse_own(design: FoundDesign) -> None:
    others = left_out(design)
    if others is not None:
        raise UsageFault(f"MJCF does not hold {others}, so held torques do not move it as planned")


def _replayed(design: FoundDesign, motion: ExportedMotion) -> dict[str, bytes]:
    _refuse_own(design)
    stem = Path(FILE_NAMES["mjcf"]).stem
    first, *others = (
        mjcf_files(design, stem, body_factors(design, loads)) for loads in load_states(design)
    )
    loaded = (files[FILE_NAMES["mjcf"]] for files in others)
    found = {f"robot_loaded_{number}.xml": text for number, text in enumerate(loaded, 1)}
    gains = gain_table(motion)
    if gains is not None:
        found[GAINS] = gains.encode()
    return found | {
        **first,
        FILE_NAMES["csv"]: trajectory_table(motion).encode(),
        TORQUES: torque_table(motion).encode(),
        SCRIPT: files("srgc.exports").joinpath("stand_alone_replay.py").read_bytes(),
    }


def _robot_text(
    design: FoundDesign, write: Callable[[ExportedRobot], str], factors: Sequence[float] = ()
) -> str:
    try:
        return write(exported_robot(design, factors))
    except ValueError as error:
        raise UsageFault(f"the robot cannot be exported: {error}") from None


def _encoded(content: str | bytes) -> bytes:
    return content.encode() if isinstance(content, str) else content


def urdf_files(design: FoundDesign, stem: str) -> dict[str, bytes]:
    """A URDF, first, and the files that it names; all names begin with ``stem``.

    Raises:
        UsageFault: the robot cannot be exported.
    """
    hulls: dict[tuple[float, ...], bytes] = {}
    seen: dict[str, bytes] = {}

    def text(robot: ExportedRobot) -> str:
        hulls.update(hull_files(robot))
        names = visual_names(robot.visuals, stem)
        seen.update(visual_files(robot.visuals, names))
        return urdf_text(robot, dict(zip(hulls, _hull_names(stem), strict=False)), names)

    found = {f"{stem}.urdf": _robot_text(design, text).encode()}
    if joints := _robot_text(design, joints_json):
        found[f"{stem}{SUFFIX}"] = joints.encode()
    return found | dict(zip(_hull_names(stem), hulls.values(), strict=False)) | seen


def mjcf_files(design: FoundDesign, stem: str, factors: Sequence[float] = ()) -> dict[str, bytes]:
    """An MJCF, first, and the visuals that it names; all names begin with ``stem``.

    The mass and the moments of inertia of each body are multiplied by its factor, by default 1.

    Raises:
        UsageFault: the robot cannot be exported.
    """
    seen: dict[str, bytes] = {}

    def text(robot: ExportedRobot) -> str:
        names = visual_names(robot.visuals, stem)
        read = [visual for visual in robot.visuals if mujoco_reads(visual.file)]
        seen.update(visual_files(read, names))
        return mjcf_text(robot, names)

    return {f"{stem}.xml": _robot_text(design, text, factors).encode()} | seen


def left_out_of(design: FoundDesign, form: str) -> tuple[str, ...]:
    """Notes on the visuals that the export of a robot with its files does not show."""
    if form != "mjcf":
        return ()
    return tuple(unread_by_mujoco(exported_robot(design).visuals))


def _hull_names(stem: str) -> Iterator[str]:
    return (f"{stem}.hull_{number}.stl" for number in count(1))
