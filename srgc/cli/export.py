"""The command ``export``."""

from __future__ import annotations

import sys
from pathlib import Path

import click

from srgc.cli.arguments import FOLDER, DocumentedCommand, PathOf
from srgc.faults import UNKNOWN, UsageFault

FORMS = ("urdf", "mjcf", "csv", "json", "ros2", "npz", "gltf", "mcap", "svg")
FOLDERS = ("mujoco", "controller", "ros2-package", "all")
BINARY = ("npz", "gltf", "mcap")


@click.command(
    cls=DocumentedCommand,
    examples=[
        "srgc export out/demo --to urdf -o arm.urdf",
        "srgc export out/demo --to ros2 -o arm.yaml",
        "srgc export out/demo --to ros2-package -o arm_robot",
        "srgc export out/demo --to gltf -o arm.glb",
        "srgc export out/demo --to svg -o arm.svg",
        "srgc export out/demo --to mujoco -o arm_mujoco",
        "srgc export out/demo --to controller -o arm_controller",
        "srgc export out/demo --to all -o arm_files",
    ],
    statuses={UNKNOWN: "no tube of the closed loop reaches the end of the motion: no controller"},
    reads_spec=False,
    read_on="docs/how-to/export.md",
)
@FOLDER
@click.option(
    "--to",
    "form",
    required=True,
    type=click.Choice([*FORMS, *FOLDERS]),
    metavar="FORM",
    help="The robot: urdf (ROS), mjcf (MuJoCo). Its planned motion: csv, json, ros2 "
    "(JointTrajectory as YAML), npz (NumPy). Both, with regions: gltf (3-D picture that moves), "
    "mcap (log for Foxglove), svg (picture that moves). Folders: mujoco (robot, torques and a "
    "script that replays them), "
    "controller (C, Python, npz), ros2-package (URDF, launch file, MoveIt), all (all files except "
    "those of gltf, mcap, svg and ros2-package).",
)
@click.option(
    "-o",
    "output",
    type=PathOf(path_type=Path, allow_dash=True),
    help="Write here instead of stdout (`-`). A folder for mujoco, controller, ros2-package, all.",
)
@click.option(
    "--no-effort", is_flag=True, help="ros2: omit efforts, which older controllers refuse."
)
def export(folder: Path, form: str, output: Path | None, no_effort: bool) -> int:  # noqa: FBT001
    """Write the robot of a result folder, or its motion, for other tools.

    FOLDER is one that `srgc synth` has written with the verdict found.  This command proves
    nothing, and overwrites none of the results.  For a mission, it writes every design into a
    folder with the name of its task.
    """
    if no_effort and form != "ros2":
        raise UsageFault("--no-effort goes with --to ros2 alone")
    file = None if output == Path("-") else output
    if file is None and form in BINARY and sys.stdout.isatty():
        raise UsageFault(f"{form} is not for a terminal; name a file with -o")
    from srgc.exports.mission_export import written_mission_export
    from srgc.exports.written_export import written_export
    from srgc.results.mission_refusal import is_mission_folder

    write = written_mission_export if is_mission_folder(folder) else written_export
    written = write(folder, form, file, efforts=not no_effort)
    for note in written.notes:
        click.echo(f"note: {note}", err=True)
    if written.content is not None:
        click.echo(written.content, nl=False)
    elif form in FOLDERS or len(written.files) > 1:
        click.echo("".join(f"{path}\n" for path in written.files), nl=False)
    return 0
