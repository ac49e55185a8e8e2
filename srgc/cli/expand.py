"""The command ``expand``."""

from __future__ import annotations

from pathlib import Path

import click

from srgc.cli.arguments import FILE, OUTPUT, DocumentedCommand


@click.command(
    cls=DocumentedCommand,
    examples=[
        "srgc expand specs/serial_kit.srg",
        "srgc expand specs/serial_kit.srg -o out/kit.srg",
    ],
    read_on="docs/how-to/kit.md",
)
@FILE
@OUTPUT
def expand(file: Path, output: Path | None) -> int:
    """Print a spec in which productions and semantics replace its grammars from ports.

    Included files with such grammars are inserted.  Everything else stays as written, relative to
    the same folder.
    """
    from srgc.paths import write_output
    from srgc.session import expansion_of

    if output is None or output == Path("-"):
        click.echo(expansion_of(file), nl=False)
    else:
        write_output(output, expansion_of(file, output))
    return 0
