"""The command ``completion``."""

from __future__ import annotations

import click

from srgc.taught_command import TaughtCommand


@click.command(
    cls=TaughtCommand,
    examples=[
        "srgc completion bash",
        "srgc completion zsh",
        "srgc completion fish",
    ],
    reads_spec=False,
    read_on="docs/how-to/command-line.md, which says where each shell looks for it",
)
@click.argument("shell", type=click.Choice(["bash", "zsh", "fish"]))
def completion(shell: str) -> int:
    """Print the script that lets a shell complete commands, options, files and names.

    Beside the names of commands and options: specs, result folders, tasks, grammars, workspaces and
    words of the spec that is named before, and codes of findings.
    """
    from srgc.completion_scripts import SCRIPTS

    click.echo(SCRIPTS[shell], nl=False)
    return 0
