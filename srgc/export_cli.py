"""The command ``export``."""

from __future__ import annotations

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
@click.option("-o", "output", type=click.Path(path_type=Path), help="Write here, not to stdout.")
def export(folder: Path, form: str, output: Path | None) -> int:
    """Write the robot of a result folder for a simulator.

    The folder is one that `srgc synth` has written with the verdict found.
    """
    from srgc.design_export import export_text, left_out
    from srgc.found_design import found_design

    design = found_design(folder)
    text = export_text(design, form)
    for remark in left_out(design.model):
        click.echo(f"note: {remark}", err=True)
    if output is None:
        click.echo(text, nl=False)
        return 0
    try:
        output.write_bytes(text.encode())
    except OSError as error:
        raise UsageFault(f"{output}: {error.strerror}") from None
    return 0
