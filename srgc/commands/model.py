"""The command about the equations of motion of one robot: ``model``."""

from __future__ import annotations

from pathlib import Path
from typing import Literal

import click

from srgc.commands.arguments import FILE, GRAMMAR
from srgc.output_file import write_output
from srgc.session import program_of


@click.command()
@FILE
@click.option("--word", metavar='"SYM ..."', required=True, help="The word of the robot.")
@GRAMMAR
@click.option("--task", help="Take grammar, workspace, gravity and effort bounds from this task.")
@click.option("--workspace", help="The workspace, where the file has some of both dimensions.")
@click.option("--derivation", type=click.IntRange(1), help="Which derivation, in order.")
@click.option(
    "--format",
    "form",
    type=click.Choice(["text", "latex", "smt2"]),
    default="text",
    show_default=True,
    help="For people, or as terms for SMT solvers.",
)
@click.option("--whole", is_flag=True, help="Equations of more than 8 degrees of freedom, too.")
@click.option(
    "-o",
    "output",
    type=click.Path(path_type=Path, allow_dash=True),
    help="Write here, not to stdout (`-`).",
)
def model(
    file: Path,
    word: str,
    grammar: str | None,
    task: str | None,
    workspace: str | None,
    derivation: int | None,
    form: Literal["text", "latex", "smt2"],
    output: Path | None,
    whole: bool,  # noqa: FBT001
) -> int:
    """Print the equations of motion of a robot: coordinates, parameters, M, c, g, effectors."""
    program = program_of(file)
    from srgc.text_reports.model_report import ModelRequest, model_report

    symbols = tuple(word.split())
    request = ModelRequest(symbols, grammar, task, workspace, derivation, form, whole)
    report = model_report(program, request)
    for remark in report.remarks:
        click.echo(f"note: {remark}", err=True)
    if output is None or output == Path("-"):
        click.echo(report.text, nl=False)
        return 0
    write_output(output, report.text)
    return 0
