"""The command ``explain``."""

from __future__ import annotations

import click

from srgc.cli.arguments import DocumentedCommand
from srgc.cli.completions import complete_code


@click.command(
    cls=DocumentedCommand,
    examples=["srgc explain SRG0301", "srgc explain"],
    reads_spec=False,
    read_on="docs/reference/codes.md",
)
@click.argument("codes", nargs=-1, metavar="[CODE]...", shell_complete=complete_code)
def explain(codes: tuple[str, ...]) -> int:
    """Explain the code of a diagnostic, with an example.  Without CODE, list all codes.

    `SRG0301`, `srg0301` and `301` are the same code.
    """
    from srgc.terminal import out_colours
    from srgc.text_reports.findings_text import explanation, list_of_codes

    text = explanation(codes, colour=out_colours()) if codes else list_of_codes()
    click.echo(text, nl=False)
    return 0
