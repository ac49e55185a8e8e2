"""The command ``graph``."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from srgc.cli.arguments import FILE, GRAMMAR, OUTPUT, TASK, WORKSPACE, DocumentedCommand
from srgc.cli.completions import complete_word
from srgc.faults import UsageFault

if TYPE_CHECKING:
    from srgc.graphs.graph_request import Drawing


@click.command(
    cls=DocumentedCommand,
    examples=[
        "srgc graph specs/planar_arm.srg --of sra",
        "srgc graph specs/planar_arm.srg --of words --depth 4",
        "srgc graph specs/planar_arm.srg --of workspace -o out/cells.dot",
    ],
    read_on="docs/reference/robot-graphs.md and docs/how-to/words.md",
)
@FILE
@click.option(
    "--of",
    "what",
    required=True,
    type=click.Choice(
        ["sra", "fra", "dfa", "dpda", "words", "grammar", "robot", "workspace", "lemmas"]
    ),
    help="What to draw.",
)
@GRAMMAR
@WORKSPACE
@TASK
@click.option(
    "--depth",
    type=click.IntRange(1),
    help="words: the largest number of modules; default 3, or that of the highlighted word.",
)
@click.option(
    "--highlight",
    metavar='"SYM ..."',
    shell_complete=complete_word,
    help="Colour the run of this accepted word.",
)
@click.option(
    "--near/--whole",
    default=None,
    help="Draw only the run and its neighbours (default for words), or everything.",
)
@click.option("--word", metavar='"SYM ..."', shell_complete=complete_word, help="robot: its word.")
@click.option("--derivation", type=click.IntRange(1), help="robot: the number of the derivation.")
@click.option("--cells", type=click.IntRange(1), help="workspace: split it into this many cells.")
@OUTPUT
def graph(
    file: Path,
    what: str,
    grammar: str | None,
    workspace: str | None,
    task: str | None,
    depth: int | None,
    highlight: str | None,
    near: bool | None,  # noqa: FBT001
    word: str | None,
    derivation: int | None,
    cells: int | None,
    output: Path | None,
) -> int:
    """Draw an automaton, the words, a robot or the cells as DOT.

    FILE is a spec.  For lemmas it is the folder of a result, and the drawing shows the words that
    remain.  If the output ends in .svg, .png or .pdf, Graphviz draws it, if it is installed.
    """
    from srgc.graphs.graph_request import GraphRequest, drawing_of
    from srgc.session import chosen, program_of

    if what == "lemmas":
        _refuse_choices(grammar, workspace, task, depth, highlight, near, word, derivation, cells)
        from srgc.results.left_over import drawing_of_lemmas

        return _shown(drawing_of_lemmas(file), output)
    program = program_of(file)
    if task is not None:
        named = chosen(program.tasks, task, "task")
        grammar, workspace = grammar or named.grammar, workspace or named.workspace
    run_of = None if highlight is None else tuple(highlight.split())
    robot = None if word is None else tuple(word.split())
    request = GraphRequest(what, grammar, workspace, depth, run_of, near, robot, derivation, cells)
    return _shown(drawing_of(program, request), output)


def _refuse_choices(*choices: object) -> None:
    """Refuse all choices with ``--of lemmas``, for which the folder determines everything."""
    if any(choice is not None for choice in choices):
        raise UsageFault("--of lemmas goes with -o alone")


def _shown(drawing: Drawing, output: Path | None) -> int:
    """Print or write a drawing, and print the remarks about it."""
    from compiler.views.dot import to_dot
    from srgc.graphs.graph_request import write_graph

    for remark in drawing.remarks:
        click.echo(f"note: {remark}", err=True)
    text = to_dot(drawing.picture)
    if output is None or output == Path("-"):
        click.echo(text, nl=False)
    else:
        for line in write_graph(text, output).splitlines():
            click.echo(f"note: Graphviz: {line}", err=True)
    return 0
