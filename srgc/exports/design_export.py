"""A design in the formats of other tools: as one file, or as a folder of files."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from importlib.resources import files
from pathlib import Path

from srgc.exports.controller_files import CONTROLLER_FILES, C, controller_files
from srgc.exports.exported_motion import ExportedMotion, exported_motion
from srgc.exports.exported_robot import ExportedRobot, exported_robot, left_out, remarks
from srgc.exports.joint_file import SUFFIX, UNSAID, joints_json
from srgc.exports.mjcf import mjcf_text
from srgc.exports.motion_formats import (
    gain_table,
    joint_trajectory,
    torque_table,
    trajectory_arrays,
    trajectory_json,
    trajectory_table,
)
from srgc.exports.urdf import urdf_text
from srgc.faults import NoAnswer, UsageFault
from srgc.results.folder_writer import folder_output
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
JOINTS = f"robot{SUFFIX}"
TORQUES, GAINS, SCRIPT = "torques.csv", "gains.csv", "replay.py"
FORMS = (*ROBOTS, *MOTIONS)
FOLDERS = ("mujoco", "controller", "all")
BINARY = ("npz",)
REPLAYED = (FILE_NAMES["mjcf"], FILE_NAMES["csv"], TORQUES, GAINS, SCRIPT)
FOLDER_FILES = {
    "mujoco": REPLAYED,
    "controller": CONTROLLER_FILES,
    "all": tuple(dict.fromkeys((*FILE_NAMES.values(), JOINTS, *CONTROLLER_FILES, *REPLAYED))),
}


@dataclass(frozen=True, slots=True)
class ExportFolder:
    """Files by their names, and what is not among them, for a reader."""

    files: Mapping[str, bytes]
    notes: tuple[str, ...]


def export_bytes(design: FoundDesign, form: str, *, efforts: bool = True) -> bytes:
    """A design in one of the ``FORMS``.

    Args:
        design: the design.
        form: the format.
        efforts: whether a ROS 2 message has efforts.

    Raises:
        UsageFault: the format cannot hold it.
    """
    if form in ROBOTS:
        return _robot_text(design, ROBOTS[form]).encode()
    motion = exported_motion(design)
    if form == "ros2":
        return joint_trajectory(motion, efforts=efforts).encode()
    return _encoded(MOTIONS[form](motion))


def export_folder(folder: Path, form: str) -> ExportFolder:
    """The design of a result folder as one of the ``FOLDERS``.

    That is what MuJoCo replays, its controller, or everything.

    Raises:
        UsageFault: ``mujoco``: the robot cannot be replayed there; ``controller``: it has no
            inputs, or a proof that does not allow for rounding.
        NoAnswer: ``controller``: the tube does not get to the end of the motion.
    """
    design = found_design(folder)
    if form == "mujoco":
        return ExportFolder(_replayed(design, exported_motion(design)), ())
    if form == "controller":
        return ExportFolder(*controller_files(folder, design))
    motion = exported_motion(design)
    found = {FILE_NAMES[name]: _encoded(write(motion)) for name, write in MOTIONS.items()}
    notes = list(remarks(design))
    for name in ROBOTS:
        try:
            found[FILE_NAMES[name]] = _robot_text(design, ROBOTS[name]).encode()
        except UsageFault as fault:
            notes.append(f"no {FILE_NAMES[name]}: {fault}")
    if FILE_NAMES["urdf"] in found and (joints := _robot_text(design, joints_json)):
        found[JOINTS] = joints.encode()
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


def mujoco_text(design: FoundDesign, factors: Sequence[float] = ()) -> str:
    """The MJCF of a robot that moves as planned if the torques of the plan are held.

    Masses and moments of inertia of each body are times its factor, default 1.

    Raises:
        UsageFault: the format cannot hold the robot or its dynamics.
    """
    others = left_out(design)
    if others is not None:
        raise UsageFault(f"MJCF does not hold {others}, so held torques do not move it as planned")
    return _robot_text(design, mjcf_text, factors)


def _replayed(design: FoundDesign, motion: ExportedMotion) -> dict[str, bytes]:
    robot = mujoco_text(design).encode()
    gains = gain_table(motion)
    fed_back = {} if gains is None else {GAINS: gains.encode()}
    return fed_back | {
        FILE_NAMES["mjcf"]: robot,
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


# --- The export of a result folder, written where its user wants it -------------------------------


@dataclass(frozen=True, slots=True)
class WrittenExport:
    """The files that were written, or the content where none was named; notes for a reader."""

    files: tuple[Path, ...]
    content: bytes | None
    notes: tuple[str, ...]


def written_export(
    folder: Path, form: str, output: Path | None, *, efforts: bool = True
) -> WrittenExport:
    """Export a result folder.

    Args:
        folder: one that ``synth`` has written, with the verdict found.
        form: one of the ``FORMS`` or ``FOLDERS``.
        output: the file to write, or for ``FOLDERS`` the folder, which is made; None: nothing is
            written. Beside ``arm.urdf`` there may be ``arm.joints.json``.
        efforts: whether a ROS 2 message has efforts.

    Raises:
        UsageFault: there is no robot, the format cannot hold it, the output is one of the results
            or cannot be written, or a folder is due and none is named.
        NoAnswer: ``controller``: the tube does not get to the end of the motion.
    """
    if form in FOLDERS:
        return _written_folder(folder, form, output)
    if output is None:
        design = found_design(folder)
        content = export_bytes(design, form, efforts=efforts)
        unsaid = (UNSAID,) if form == "urdf" and _robot_text(design, joints_json) else ()
        return WrittenExport((), content, (*remarks(design), *unsaid))
    paths = (output, output.parent / f"{output.stem}{SUFFIX}") if form == "urdf" else (output,)
    files = [folder_output(folder, path) for path in paths]
    design = found_design(folder)
    contents = [export_bytes(design, form, efforts=efforts)]
    if form == "urdf" and (joints := _robot_text(design, joints_json)):
        contents.append(joints.encode())
    for file, content in zip(files, contents, strict=False):
        file.write(content)
    left = [path for path in paths[len(contents) :] if path.exists()]
    notes = (*remarks(design), *map(_of_an_earlier_export, left))
    return WrittenExport(paths[: len(contents)], None, notes)


def _of_an_earlier_export(path: Path) -> str:
    return f"{path} is of an earlier export: remove it"


def _written_folder(folder: Path, form: str, output: Path | None) -> WrittenExport:
    if output is None:
        raise UsageFault(f"--to {form} writes several files; name a folder with -o")
    files = {name: folder_output(folder, output / name) for name in FOLDER_FILES[form]}
    made = export_folder(folder, form)
    if any(files[name].name is None for name in made.files):
        try:
            output.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise UsageFault(f"{output}: {error.strerror}") from None
    for name, content in made.files.items():
        files[name].write(content)
    # Gains or single precision of another design, say, would be taken for this one's.
    other = sorted({*FOLDER_FILES[form]} - made.files.keys())
    left = [name for name in other if (output / name).exists()]
    notes = (*made.notes, *(_of_an_earlier_export(output / name) for name in left))
    return WrittenExport(tuple(output / name for name in sorted(made.files)), None, notes)
