"""The command ``view``."""

from __future__ import annotations

from pathlib import Path

import click

from srgc.cli.arguments import DocumentedCommand, PathOf
from srgc.cli.completions import complete_folder


@click.command(
    cls=DocumentedCommand,
    examples=[
        "srgc view out/demo",
        "srgc view out/demo --port 8090 --no-browser --no-tube",
    ],
    reads_spec=False,
    read_on="docs/how-to/view.md",
)
@click.argument(
    "folders",
    nargs=-1,
    required=True,
    type=PathOf(path_type=Path),
    shell_complete=complete_folder,
    metavar="FOLDER...",
)
@click.option(
    "--port",
    type=click.IntRange(1, 65535),
    help="Serve on this port; default: the first free port from 8080 on.",
)
@click.option("--no-browser", is_flag=True, help="Only print the address.")
@click.option("--no-tube", is_flag=True, help="Omit the tube, which takes as long as a proof.")
def view(folders: tuple[Path, ...], port: int | None, no_browser: bool, no_tube: bool) -> int:  # noqa: FBT001
    """View one or more designs in 3D, on a live page.

    Each FOLDER is one that `srgc synth` has written with the verdict found; for a mission, the page
    shows all designs.  It has a time slider, the regions, and the certified tube.  The command
    serves only this computer, until you press Ctrl-C.  It needs `pip install "srgc[view]"`.
    """
    from srgc.view.serving import refuse_without_viewer, serve, viewer_server
    from srgc.view.shown_designs import shown_designs

    refuse_without_viewer(port)
    shown = shown_designs(folders, tubes=not no_tube)
    for note in shown.notes:
        click.echo(f"note: {note}", err=True)
    serve(shown, viewer_server(port), lambda address: _tell(address, browser=not no_browser))
    return 0


def _tell(address: str, *, browser: bool) -> None:
    click.echo(f"{address}  (Ctrl-C ends it)")
    if browser:
        import webbrowser

        webbrowser.open(address)
