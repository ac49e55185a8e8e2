"""Export the designs of a mission to other tools, with a folder for each task."""

from __future__ import annotations

from pathlib import Path

from srgc.exports.design_export import FILE_NAMES, FOLDERS, SCENES
from srgc.exports.written_export import WrittenExport, prepared_export
from srgc.exports.written_files import write_files
from srgc.faults import UsageFault
from srgc.results.folder_writer import FolderOutput, folder_output
from srgc.results.mission_folder import mission_folder
from srgc.results.no_robot import no_robot


def written_mission_export(
    folder: Path, form: str, output: Path | None, *, efforts: bool = True
) -> WrittenExport:
    """Export the designs of a mission, each into a folder with the name of its task.

    Args:
        folder: a folder that ``synth --mission`` or ``evolve`` has written, with the verdict found.
        form: a format for single designs.
        output: the folder for these folders; it is created with its parents.
        efforts: whether a ROS 2 message has efforts.

    Raises:
        UsageFault: there are no robots, no folder is given, or the format cannot represent a robot;
            then nothing is written.
        NoAnswer: ``controller``: a tube does not reach the end of the motion.
    """
    mission = mission_folder(folder)
    if not mission.robots:
        raise no_robot(folder, mission.verdict)
    if output is None:
        raise UsageFault("a mission has a design for each task: name a folder for them with -o")
    folder_output(folder, output)
    files: list[tuple[FolderOutput, bytes]] = []
    notes: dict[str, None] = {}
    for task in mission.mission.tasks:
        place = output / task
        target = place if form in FOLDERS else place / {**FILE_NAMES, **SCENES}[form]
        own = prepared_export(mission.of_task(task), form, target, efforts=efforts)
        files += own.files
        notes |= dict.fromkeys(f"{task}: {note}" for note in own.notes)
    write_files(files)
    return WrittenExport(tuple(file.path for file, _ in files), None, tuple(notes))
