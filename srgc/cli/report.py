"""The command that writes a result folder as one HTML page: ``report``."""

from __future__ import annotations

import os
from pathlib import Path

import click

from srgc.cli.arguments import FOLDER, QUIET, DocumentedCommand, PathOf
from srgc.faults import UsageFault

NAME = "report.html"


@click.command(
    cls=DocumentedCommand,
    examples=["srgc report out/demo", "srgc report out/demo --no-verify -o arm.html"],
    reads_spec=False,
    read_on="docs/how-to/report.md",
)
@FOLDER
@QUIET
@click.option(
    "-o",
    "--output",
    type=PathOf(path_type=Path, dir_okay=False),
    help=f"Write the page here.  Default: FOLDER/{NAME}.",
)
@click.option(
    "--no-verify", is_flag=True, help="Do not check the certificate again; the page says so."
)
def report(folder: Path, quiet: bool, output: Path | None, no_verify: bool) -> int:  # noqa: FBT001
    """Write a result folder as one self-contained HTML page.

    FOLDER is one that `srgc synth` has written, with any verdict.  The command checks the
    certificate again, and the page states the outcome.
    """
    from solvers.execution.one_thread import ONE_THREAD

    os.environ.update(ONE_THREAD)  # before numpy is loaded
    target = folder / NAME if output is None else output
    if target.suffix.lower() not in (".html", ".htm"):
        raise UsageFault(f"{target}: a report is a page; let the name end in .html")
    from srgc.results.folder_writer import folder_output

    page_file = folder_output(folder, target, {NAME})
    from solvers.verifier.proofs.scene import Watch
    from srgc.report.page import report_page
    from srgc.results.progress_display import progress

    with progress("report", quiet=quiet, unit="parts", plain=False) as display:
        page = report_page(folder, verify=not no_verify, watch=Watch(part=display.part))
    page_file.write(page)
    click.echo(f"report: {target}")
    return 0
