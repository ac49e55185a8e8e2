"""The command that puts result folders side by side: ``tabulate``."""

from __future__ import annotations

import os
from pathlib import Path

import click

from srgc.cli.arguments import DocumentedCommand, PathOf
from srgc.cli.completions import complete_folder
from srgc.faults import UsageFault


@click.command(
    cls=DocumentedCommand,
    examples=["srgc tabulate out/demo out/impossible", "srgc tabulate out/demo out/demo --json"],
    reads_spec=False,
    read_on="docs/how-to/objectives.md",
)
@click.argument(
    "folders",
    nargs=-1,
    required=True,
    type=PathOf(path_type=Path),
    shell_complete=complete_folder,
    metavar="FOLDER FOLDER...",
)
@click.option("--json", "as_json", is_flag=True, help="Print the table as JSON.")
def tabulate(folders: tuple[Path, ...], as_json: bool) -> int:  # noqa: FBT001
    """Put results side by side, and say which design is better.

    Each FOLDER is one that `srgc synth` has written, with any verdict.  Designs are compared by the
    objectives that all their tasks ask for, else by modules, mass and effort.  Nothing is verified.
    """
    if len(folders) < 2:
        raise UsageFault("there is one folder: two at least are put side by side")
    from solvers.execution.one_thread import ONE_THREAD

    os.environ.update(ONE_THREAD)  # while numpy is not loaded yet
    from srgc.comparisons.side_by_side import side_by_side
    from srgc.comparisons.side_by_side_text import side_by_side_json, side_by_side_text

    found = side_by_side(folders)
    click.echo(side_by_side_json(found) if as_json else side_by_side_text(found), nl=not as_json)
    return 0
