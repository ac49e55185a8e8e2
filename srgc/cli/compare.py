"""The command that compares the words of two grammars, or results: ``compare``."""

from __future__ import annotations

import os
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import click

from srgc.cli.arguments import QUIET, DocumentedCommand, PathOf
from srgc.cli.completions import complete_file, complete_folder, complete_name
from srgc.faults import UsageFault

if TYPE_CHECKING:
    from click.shell_completion import CompletionItem


def _first(
    context: click.Context, parameter: click.Parameter, incomplete: str
) -> list[CompletionItem]:
    """Complete specs and result folders."""
    files = complete_file(context, parameter, incomplete)
    folders = complete_folder(context, parameter, incomplete)
    known = [each for each in (*files, *folders) if each.type == "plain"]
    return known or files


def _others(
    context: click.Context, parameter: click.Parameter, incomplete: str
) -> list[CompletionItem]:
    """Complete grammars of the file, or further folders if the first argument is a folder."""
    first = context.params.get("file")
    if isinstance(first, Path) and first.is_dir():
        return complete_folder(context, parameter, incomplete)
    return complete_name(context, parameter, incomplete)


@click.command(
    cls=DocumentedCommand,
    examples=[
        "srgc compare specs/planar_arm.srg PlanarArm PlanarArm",
        "srgc compare out/demo out/impossible",
        "srgc compare out/demo out/demo --json",
    ],
    statuses={
        0: "the same words; or the results were compared",
        1: "different words",
        4: "the comparison would take too long",
    },
    read_on="docs/how-to/words.md; of results, docs/how-to/objectives.md",
)
@click.argument("file", type=PathOf(path_type=Path), shell_complete=_first, metavar="FILE|FOLDER")
@click.argument("others", nargs=-1, shell_complete=_others, metavar="GRAMMAR GRAMMAR|FOLDER...")
@click.option("--max-length", type=click.IntRange(0), default=20, show_default=True)
@click.option("--json", "as_json", is_flag=True, help="For results: print the table as JSON.")
@QUIET
def compare(
    file: Path,
    others: tuple[str, ...],
    max_length: int,
    as_json: bool,  # noqa: FBT001
    quiet: bool,  # noqa: FBT001
) -> int:
    """Compare the words of two grammars of a file, or two or more results.

    Two regular families are compared completely, others up to --max-length.

    Results appear side by side.  Each FOLDER is one that `srgc synth` has written, with any
    verdict.  Designs are compared by the objectives that all their tasks share; without such
    objectives, by modules, mass and effort.  This command verifies nothing.
    """
    if file.is_dir() and not others:
        raise UsageFault(f"a result is compared with others: name another folder beside {file}")
    if file.is_dir():
        return _results((file, *map(Path, others)), as_json=as_json)
    if len(others) != 2:
        raise UsageFault("two grammars of a file are compared: name both, and no others")
    if as_json:
        raise UsageFault("--json is about results: the words of grammars are not printed so")
    return _grammars(file, others, max_length, quiet=quiet)


def _grammars(file: Path, names: Sequence[str], max_length: int, *, quiet: bool) -> int:
    from srgc.results.progress_display import progress
    from srgc.session import chosen, program_of
    from srgc.text_reports.language_report import comparison_text

    program = program_of(file)
    families = [chosen(program.grammars, name, "grammar") for name in names]
    with progress("compare", quiet=quiet, plain=False):
        same, text = comparison_text(program, families[0], families[1], max_length)
    click.echo(text)
    return 0 if same else 1


def _results(folders: Sequence[Path], *, as_json: bool) -> int:
    from solvers.execution.one_thread import ONE_THREAD
    from srgc.paths import refuse_impossible

    for folder in folders:
        refuse_impossible(folder)
    os.environ.update(ONE_THREAD)  # before numpy is loaded
    from srgc.comparisons.side_by_side import side_by_side
    from srgc.comparisons.side_by_side_text import side_by_side_json, side_by_side_text

    found = side_by_side(folders)
    click.echo(side_by_side_json(found) if as_json else side_by_side_text(found), nl=not as_json)
    return 0
