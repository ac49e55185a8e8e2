"""The command ``fmt``."""

from __future__ import annotations

from functools import partial
from pathlib import Path

import click

from srgc.cli.arguments import FILES_OR_STDIN, DocumentedCommand
from srgc.faults import FOUND, INTERNAL, INTERRUPTED, REFUSED, SPEC_ERRORS, USAGE, UsageFault

PRECEDENCE = (INTERNAL, USAGE, SPEC_ERRORS, INTERRUPTED, REFUSED, FOUND)
"""With several files, the command ends with the first of these statuses that any file has."""


@click.command(
    cls=DocumentedCommand,
    examples=["srgc fmt --check specs/planar_arm.srg", "srgc fmt --diff specs/two_arm.srg"],
    statuses={
        0: "done, or nothing to do",
        1: "with --check: a file is not in canonical form",
        5: "a file has syntax errors and stays unchanged",
    },
    read_on="docs/reference/language.md",
)
@FILES_OR_STDIN
@click.option(
    "--check", "only_check", is_flag=True, help="Write nothing; exit with 1 if a file would change."
)
@click.option("--diff", "as_diff", is_flag=True, help="Write nothing; print what would change.")
def fmt(files: tuple[Path, ...], only_check: bool, as_diff: bool) -> int:  # noqa: FBT001
    """Write specs in canonical form, in place.

    The meaning of the text and its comments stay the same.  `-` reads standard input and writes to
    standard output.
    """
    from srgc.cli.fault_report import guarded
    from srgc.formatting.canonical_form import FormatRun
    from srgc.interruption import as_exception
    from srgc.terminal import out_colours

    if Path("-") in files and len(files) > 1:
        raise UsageFault("`-` is not formatted together with files")
    formats = FormatRun(only_check, as_diff, out_colours())
    statuses = []
    with as_exception():
        for path in files:
            statuses.append(guarded(partial(formats.one, path)))
            if statuses[-1] == INTERRUPTED:
                break
        click.echo(formats.summary(), nl=False)
    return min(statuses, key=PRECEDENCE.index)
