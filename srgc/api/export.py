"""Export a robot and its motion to simulators and other programs."""

from __future__ import annotations

from os import PathLike
from pathlib import Path
from typing import Literal, TypeAlias, overload

from srgc.api.spoken_faults import spoken
from srgc.faults import UsageFault

Text: TypeAlias = Literal["urdf", "mjcf", "csv", "json", "ros2", "svg"]
Binary: TypeAlias = Literal["npz", "gltf", "mcap"]
Form: TypeAlias = Literal[
    "urdf", "mjcf", "csv", "json", "ros2", "npz", "gltf", "mcap", "svg", "mujoco",
    "controller", "ros2-package", "all",
]  # fmt: skip


@overload
def export(result: str | PathLike[str], to: Text, *, efforts: bool = True) -> str: ...
@overload
def export(result: str | PathLike[str], to: Binary) -> bytes: ...
@overload
def export(
    result: str | PathLike[str], to: Form, path: str | PathLike[str], *, efforts: bool = True
) -> tuple[Path, ...]: ...
@spoken
def export(
    result: str | PathLike[str],
    to: Form,
    path: str | PathLike[str] | None = None,
    *,
    efforts: bool = True,
) -> str | bytes | tuple[Path, ...]:
    """Export the robot of a result or its motion to another format, as ``srgc export`` does.

    Args:
        result: a result with the verdict found, or its folder; all designs of a mission are
            exported.
        to: the format.  The robot: "urdf" or "mjcf".  Its motion: "csv", "json", "ros2" or "npz".
            Robot, motion and regions: a picture, "gltf" or "svg", or a log, "mcap".  A folder:
            "mujoco" with a script that replays the motion, "controller" in C and Python,
            "ros2-package", or "all", which has all files but "gltf", "svg", "mcap" and the package.
        path: the file or folder to write; for a mission, a folder that gets one for each task.
        efforts: whether the points of "ros2" have efforts; older controllers refuse them.

    Returns:
        The written files.  Without ``path``, the content: bytes for "npz", "gltf" and "mcap", text
        for other formats.

    Raises:
        SrgcError: there is no robot, the format cannot represent it, or the path cannot be written.
    """
    from srgc.exports.design_export import BINARY, FOLDERS, FORMS
    from srgc.exports.mission_export import written_mission_export
    from srgc.exports.written_export import written_export
    from srgc.results.mission_refusal import is_mission_folder

    if to not in (*FORMS, *FOLDERS):
        raise UsageFault(f"there is no format `{to}`: there are {', '.join((*FORMS, *FOLDERS))}")
    if path is None and to in FOLDERS:
        raise UsageFault(f"{to} is a folder: give its `path`")
    if not efforts and to != "ros2":
        raise UsageFault("`efforts` goes with ros2 alone")
    file = None if path is None else Path(path)
    write = written_mission_export if is_mission_folder(Path(result)) else written_export
    written = write(Path(result), to, file, efforts=efforts)
    if written.content is None:
        return written.files
    return written.content if to in BINARY else written.content.decode()
