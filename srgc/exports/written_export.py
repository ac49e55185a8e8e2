"""Write the export of a result folder to the place that the user names."""

from __future__ import annotations

import glob
from collections.abc import Collection, Iterator
from dataclasses import dataclass
from pathlib import Path

from srgc.exports.design_export import (
    FILE_NAMES,
    FOLDER_FILES,
    FOLDERS,
    ROBOTS,
    SCENES,
    export_bytes,
    export_folder,
    left_out_of,
    mjcf_files,
    scene_file,
    urdf_files,
)
from srgc.exports.exported_robot import exported_robot, remarks
from srgc.exports.hull_files import UNSAID as NO_MESHES
from srgc.exports.hull_files import hull_files
from srgc.exports.joint_file import UNSAID, joints_json
from srgc.exports.visual_meshes import UNSAID as NO_VISUALS
from srgc.exports.written_files import write_files
from srgc.faults import UsageFault
from srgc.joint_format import SUFFIX
from srgc.results.folder_writer import FolderOutput, folder_output
from srgc.results.found_design import FoundDesign, found_design


@dataclass(frozen=True, slots=True)
class WrittenExport:
    """The files written, or the content if no file was named; and notes for the reader."""

    files: tuple[Path, ...]
    content: bytes | None
    notes: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class PreparedExport:
    """The files to write, or the content if no file was named; and notes for the reader."""

    files: tuple[tuple[FolderOutput, bytes], ...]
    content: bytes | None
    notes: tuple[str, ...]


def written_export(
    folder: Path, form: str, output: Path | None, *, efforts: bool = True
) -> WrittenExport:
    """Export a result folder.

    Args:
        folder: a folder that ``synth`` has written, with the verdict found.
        form: one of the ``FORMS`` or ``FOLDERS``.
        output: the file to write, or for ``FOLDERS`` the folder; missing folders are created.  If
            None, nothing is written.  Files such as ``arm.joints.json`` and ``arm.hull_1.stl`` may
            be written next to ``arm.urdf``.
        efforts: whether a ROS 2 message has efforts.

    Raises:
        UsageFault: there is no robot, the format cannot represent it, the output is one of the
            results or cannot be written, or a folder is required and none is named; then nothing is
            written.
        NoAnswer: ``controller``: the tube does not reach the end of the motion.
    """
    prepared = prepared_export(folder, form, output, efforts=efforts)
    write_files(prepared.files)
    paths = tuple(file.path for file, _ in prepared.files)
    return WrittenExport(paths, prepared.content, prepared.notes)


def prepared_export(
    folder: Path, form: str, output: Path | None, *, efforts: bool = True
) -> PreparedExport:
    """The files of an export, which ``write_files`` writes; see :func:`written_export`."""
    if form in FOLDERS:
        return _prepared_folder(folder, form, output)
    target = None if output is None else folder_output(folder, output)
    design = found_design(folder)
    if form in SCENES:
        content, unsaid = scene_file(design, form)
        return _one_file(target, content, (*remarks(design), *unsaid))
    if target is None or form not in ROBOTS:
        content = export_bytes(design, form, efforts=efforts)
        left = _left_to_files(design, form) if target is None and form in ROBOTS else ()
        return _one_file(target, content, (*remarks(design), *left))
    path = target.path
    files_of = urdf_files if form == "urdf" else mjcf_files
    (_, robot), *beside = files_of(design, path.stem).items()
    others = [(folder_output(folder, path.parent / name), content) for name, content in beside]
    written = {file.path for file, _ in others}
    earlier = _earlier(path.parent, path.stem, written) if form == "urdf" else ()
    notes = (*remarks(design), *left_out_of(design, form), *earlier)
    return PreparedExport(((target, robot), *others), None, notes)


def _one_file(
    target: FolderOutput | None, content: bytes, notes: tuple[str, ...]
) -> PreparedExport:
    if target is None:
        return PreparedExport((), content, notes)
    return PreparedExport(((target, content),), None, notes)


def _left_to_files(design: FoundDesign, form: str) -> tuple[str, ...]:
    """Notes on what a URDF or MJCF without further files does not include."""
    robot = exported_robot(design)
    seen = (NO_VISUALS,) if robot.visuals else ()
    if form != "urdf":
        return seen
    joints = (UNSAID,) if joints_json(robot) else ()
    return (*joints, NO_MESHES, *seen) if hull_files(robot) else (*joints, *seen)


def _earlier(folder: Path, stem: str, written: Collection[Path]) -> Iterator[str]:
    """Notes on files next to a URDF that belong to an earlier one."""
    meshes = [path for kind in ("hull_*.stl", "visual_*.*")
              for path in sorted(folder.glob(f"{glob.escape(stem)}.{kind}"))]  # fmt: skip
    for path in (folder / f"{stem}{SUFFIX}", *meshes):
        if path not in written and path.exists():
            yield _of_an_earlier_export(path)


def _strays(package: Path, written: Collection[Path]) -> Iterator[str]:
    """Notes on robots and meshes in a package that do not belong to this export."""
    kinds = ("urdf/*.urdf", "urdf/*.urdf.xacro", f"urdf/*{SUFFIX}", "config/*.srdf", "meshes/*.stl")
    for path in (path for kind in kinds for path in sorted(package.glob(kind))):
        if path not in written:
            yield _of_an_earlier_export(path)


def _of_an_earlier_export(path: Path) -> str:
    return f"{path} is of an earlier export: remove it"


def _prepared_folder(folder: Path, form: str, output: Path | None) -> PreparedExport:
    if output is None:
        raise UsageFault(f"--to {form} writes several files; name a folder with -o")
    for name in FOLDER_FILES[form]:
        folder_output(folder, output / name)
    made = export_folder(folder, form)
    files = [
        (folder_output(folder, output / name), made.files[name]) for name in sorted(made.files)
    ]
    # Otherwise files of another design, such as its gains, would be taken for this one's.
    other = sorted({*FOLDER_FILES[form]} - made.files.keys())
    left = [name for name in other if (output / name).exists()]
    paths = {output / name for name in (*made.files, *other)}
    hulls = _earlier(output, Path(FILE_NAMES["urdf"]).stem, paths) if form == "all" else ()
    strays = _strays(output, paths) if form == "ros2-package" else ()
    notes = (*made.notes, *(_of_an_earlier_export(output / name) for name in left), *hulls, *strays)
    return PreparedExport(tuple(files), None, notes)
