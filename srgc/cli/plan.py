"""The command ``plan``."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING

import click

from srgc.cli.arguments import FILE, QUIET, TASK, DocumentedCommand, PathOf
from srgc.faults import FOUND, VERDICT_STATUS, UsageFault

if TYPE_CHECKING:
    from srgc.text_reports.plan_report import PlanReport


@click.command(
    cls=DocumentedCommand,
    examples=[
        "srgc plan specs/planar_arm.srg",
        "srgc plan specs/patrol.srg -o out/plan.svg",
        "srgc plan specs/planar_arm.srg --dump dimacs -o out/plan.cnf",
    ],
    statuses={
        0: "a path was found, or the problem was written",
        3: "there is no path",
        4: "unknown",
    },
    read_on="docs/how-to/planning.md",
)
@FILE
@TASK
@click.option("--cells", type=click.IntRange(1), help="Begin with at least this many cells.")
@click.option(
    "--dump",
    type=click.Choice(["dimacs", "smt2"]),
    help="Print the problem instead: it is satisfiable if and only if there is a plan.",
)
@click.option(
    "-o",
    "--output",
    type=PathOf(path_type=Path, dir_okay=False),
    help="Write cells, adjacency and path as SVG here; with --dump, the problem.",
)
@QUIET
def plan(
    file: Path,
    task: str | None,
    cells: int | None,
    dump: str | None,
    output: Path | None,
    quiet: bool,  # noqa: FBT001
) -> int:
    """Print a path of cells for the effectors, with the fewest changes of cell.

    The path is for points.  `srgc synth` finds out whether a robot can follow it.
    """
    if output is not None and dump is None and output.suffix.lower() != ".svg":
        raise UsageFault(f"{output}: a plan is drawn as SVG; let the name end in .svg")
    from srgc.paths import write_output
    from srgc.results.progress_display import progress
    from srgc.session import chosen, program_of
    from srgc.text_reports.plan_report import dump_text, plan_report

    program = program_of(file)
    chosen_task = chosen(program.tasks, task, "task")
    if dump is not None:
        with progress("plan", quiet=quiet, plain=False):
            text = dump_text(program, chosen_task, dump, cells)
        if output is None:
            click.echo(text, nl=False)
        else:
            write_output(output, text)
        return FOUND
    with progress("plan", quiet=quiet, plain=False):
        report = plan_report(program, chosen_task, cells)
    if output is not None:
        write_output(output, report.picture(f"{file.name}, task {chosen_task.name}"))
    _tell(report, file, quiet=quiet)
    if chosen_task.robust is not None and not quiet:
        click.echo("note: a plan is not about motions: `robust` is left out", err=True)
    return VERDICT_STATUS[report.verdict]


def _tell(report: PlanReport, file: Path, *, quiet: bool) -> None:
    """Print a plan: the path on standard output, remarks only if standard error is a terminal."""
    from srgc.terminal import redraws, with_verdict
    from srgc.text_reports.plan_report import after_plan

    shown, text = redraws(sys.stderr) and not quiet, report.text
    if report.verdict != "found":
        text = with_verdict(text, text.partition(":")[0])
    elif shown:
        click.echo(with_verdict("verdict: found", "found", sys.stderr), err=True)
    click.echo(text)
    if shown:
        click.echo(after_plan(report.verdict, str(file)), err=True)
