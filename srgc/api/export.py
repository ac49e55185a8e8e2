"""A robot and its motion for simulators and other programs."""

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
    """The robot of a result or its motion in another format, as ``srgc export`` writes it.

    Args:
        result: one with the verdict found, or its folder; of a mission every design is written.
        to: the robot as "urdf" or "mjcf"; its motion as "csv", "json", "ros2" or "npz"; both, with
            the regions, as a picture, "gltf" or "svg", or a log, "mcap"; a folder for "mujoco",
            with a script that replays the motion, for the "controller" in C and Python, or with
            a "ros2-package"; a folder with "all" files but "gltf", "svg", "mcap" and those of
            the package.
        path: the file or the folder to write; of a mission a folder, which gets one for each task.
        efforts: whether the points of "ros2" have efforts, which older controllers refuse.

    Returns:
        The files that were written; without a path the content, text, or bytes of "npz", "gltf"
        and "mcap".

    Raises:
        SrgcError: there is no robot, it has no such form, or the path cannot be written.
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
