"""The command that prints the equations of motion of one robot: ``model``."""

from __future__ import annotations

from pathlib import Path
from typing import Literal

import click

from srgc.cli.arguments import FILE, GRAMMAR, OUTPUT, DocumentedCommand
from srgc.cli.completions import complete_name, complete_word


@click.command(
    cls=DocumentedCommand,
    examples=[
        'srgc model specs/planar_arm.srg --word "B eps JO eps L eps JO eps L eps EN"',
        'srgc model specs/planar_arm.srg --word "B eps JO eps L eps EN" --format latex',
    ],
    read_on="docs/reference/models.md",
)
@FILE
@click.option(
    "--word",
    metavar='"SYM ..."',
    required=True,
    shell_complete=complete_word,
    help="The word of the robot.",
)
@GRAMMAR
@click.option(
    "--task",
    shell_complete=complete_name,
    help="Take grammar, workspace, gravity and effort bounds from this task.",
)
@click.option(
    "--workspace",
    shell_complete=complete_name,
    help="The workspace, if the file has planar and spatial ones.",
)
@click.option("--derivation", type=click.IntRange(1), help="The number of the derivation.")
@click.option(
    "--format",
    "form",
    type=click.Choice(["text", "latex", "smt2"]),
    default="text",
    show_default=True,
    help="For people, or as terms for SMT solvers.",
)
@click.option(
    "--whole", is_flag=True, help="Also print the equations of more than 8 degrees of freedom."
)
@OUTPUT
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
    """Print the equations of motion of a robot: coordinates, parameters, M, c, g, effectors.

    The equations are M(q) q'' + c(q, q') + g(q) = u, with the parameters of the modules as symbols.
    """
    from srgc.chosen_robot import RobotRequest
    from srgc.paths import write_output
    from srgc.session import program_of
    from srgc.text_reports.model_report import model_report

    program = program_of(file)
    request = RobotRequest(tuple(word.split()), grammar, task, workspace, derivation)
    report = model_report(program, request, form, whole=whole)
    for remark in report.remarks:
        click.echo(f"note: {remark}", err=True)
    if output is None or output == Path("-"):
        click.echo(report.text, nl=False)
        return 0
    write_output(output, report.text)
    return 0
