"""The command ``export``."""

from __future__ import annotations

from os.path import realpath
from pathlib import Path

import click

from srgc.session import UsageFault


@click.command()
@click.argument("folder", type=click.Path(path_type=Path))
@click.option(
    "--to",
    "form",
    required=True,
    type=click.Choice(["urdf", "mjcf"]),
    help="The format: URDF (ROS) or MJCF (MuJoCo).",
)
@click.option(
    "-o",
    "output",
    type=click.Path(path_type=Path, allow_dash=True),
    help="Write here, not to stdout (`-`).",
)
def export(folder: Path, form: str, output: Path | None) -> int:
    """Write the robot of a result folder for a simulator.

    The folder is one that `srgc synth` has written with the verdict found.
    """
    from srgc.exports.design_export import export_text, left_out
    from srgc.results.found_design import found_design

    if output is not None and _is_result(output, folder):
        raise UsageFault(f"{output} is one of the results; write the export elsewhere")
    design = found_design(folder)
    text = export_text(design, form)
    for remark in left_out(design):
        click.echo(f"note: {remark}", err=True)
    if output is None or output == Path("-"):
        click.echo(text.encode(), nl=False)
        return 0
    try:
        output.write_bytes(text.encode())
    except OSError as error:
        raise UsageFault(f"{output}: {error.strerror}") from None
    return 0


def _is_result(output: Path, folder: Path) -> bool:
    """Whether a path, links followed, is where ``synth`` writes in its folder."""
    from srgc.results.result_folder import OWN_FILES, OWN_FOLDERS

    top, target = Path(realpath(folder)), Path(realpath(output))
    if top not in target.parents:
        return False
    return target.relative_to(top).parts[0] in (*OWN_FILES, *OWN_FOLDERS)
