"""The command line: arguments, output and exit statuses, nothing else.

Exit statuses: 0, 1, 3 and 4 as each command says; 2 usage, 5 the spec has errors, 70 internal
error, 130 interrupted.  Heavy libraries are imported in the command that needs them.
"""

from __future__ import annotations

import errno
import json
import os
import sys
from collections.abc import Callable
from functools import partial
from pathlib import Path

import click

from compiler.languages.budget import BudgetExceededError
from grammar_lang.findings.render import records, to_text
from srgc.commands.arguments import FILE, GRAMMAR
from srgc.commands.export import export
from srgc.commands.landscape import landscape
from srgc.commands.language import accepts, compare, language, words
from srgc.commands.model import model
from srgc.commands.synth import synth
from srgc.commands.why import why
from srgc.exit_status import (
    FOUND,
    INTERNAL,
    INTERRUPTED,
    REFUSED,
    SPEC_ERRORS,
    UNKNOWN,
    USAGE,
    VERDICT_STATUS,
)
from srgc.output_file import write_output
from srgc.session import (
    Checked,
    NoAnswer,
    SpecErrors,
    UsageFault,
    check_file,
    chosen,
    program_of,
    refuse_unsupported,
)
from srgc.text_reports.check_summary import summary

PRECEDENCE = (INTERNAL, USAGE, SPEC_ERRORS, INTERRUPTED, REFUSED, FOUND)
"""Of the statuses of several files the first of these is that of the command."""
MOST_FINDINGS = 200
"""So many findings about a file are printed for people, and all of them as JSON."""


@click.group(context_settings={"help_option_names": ["-h", "--help"]})
@click.version_option(package_name="srgc")
def cli() -> None:
    """Compile modular-robot grammars to robots that are proved to do their task."""


def _show(checked: Checked, *, stderr: bool) -> None:
    """Print diagnostics, in colour on a terminal only."""
    stream = sys.stderr if stderr else sys.stdout
    colour = stream.isatty() and "NO_COLOR" not in os.environ
    text = to_text(checked.diagnostics, checked.sources, colour=colour, most=MOST_FINDINGS)
    click.echo(text, err=stderr, nl=False)


@cli.command()
@click.argument("files", nargs=-1, required=True, type=click.Path(path_type=Path))
@click.option("--json", "as_json", is_flag=True, help="Print the findings as a JSON list.")
def check(files: tuple[Path, ...], as_json: bool) -> int:  # noqa: FBT001
    """Parse, resolve, type and check files.  Exit 0 without errors, else 1."""
    results = [check_file(path) for path in files]
    if as_json:
        items = [entry for r in results for entry in records(r.diagnostics, r.sources)]
        click.echo(json.dumps(items, indent=1, ensure_ascii=False))
    else:
        for result in results:
            _show(result, stderr=False)
        click.echo(summary(results))
    return 0 if all(result.program is not None for result in results) else 1


@cli.command()
@click.argument("files", nargs=-1, required=True, type=click.Path(path_type=Path, allow_dash=True))
@click.option("--check", "only_check", is_flag=True, help="Write nothing; exit 1 if it would.")
@click.option("--diff", "as_diff", is_flag=True, help="Write nothing; print what would change.")
def fmt(files: tuple[Path, ...], only_check: bool, as_diff: bool) -> int:  # noqa: FBT001
    """Write files in canonical form, comments kept.  `-` is standard input, to standard output.

    A file with syntax errors is left as it is: exit 5.
    """
    from srgc.formatting.format_run import FormatRun

    if Path("-") in files and len(files) > 1:
        raise UsageFault("`-` is not formatted together with files")
    colour = sys.stdout.isatty() and "NO_COLOR" not in os.environ
    formats = FormatRun(only_check, as_diff, colour)
    statuses = []
    for path in files:
        statuses.append(_guarded(partial(formats.one, path)))
        if statuses[-1] == INTERRUPTED:
            break
    click.echo(formats.summary(), nl=False)
    return min(statuses, key=PRECEDENCE.index)


@cli.command()
@click.argument("codes", nargs=-1)
def explain(codes: tuple[str, ...]) -> int:
    """Say what a code of a finding means, with an example.  Without one, list all codes."""
    from srgc.text_reports.explanation import explanation, list_of_codes

    colour = sys.stdout.isatty() and "NO_COLOR" not in os.environ
    click.echo(explanation(codes, colour=colour) if codes else list_of_codes(), nl=False)
    return 0


for _command in (words, accepts, language, compare, model, export, synth, landscape, why):
    cli.add_command(_command)


@cli.command()
@FILE
@click.option(
    "--of",
    "what",
    required=True,
    type=click.Choice(["sra", "fra", "dfa", "dpda", "words", "grammar", "robot", "workspace"]),
    help="What to draw.",
)
@GRAMMAR
@click.option("--workspace", help="The workspace, where the file has several.")
@click.option("--task", help="Take grammar and workspace from this task.")
@click.option(
    "--depth",
    type=click.IntRange(1),
    help="Of words: the most modules; by default 3, beside a run those of its word.",
)
@click.option("--highlight", metavar='"SYM ..."', help="Colour the run of this accepted word.")
@click.option(
    "--near/--whole",
    default=None,
    help="Only the run and what is one transition away from it (of words the default), or all.",
)
@click.option("--word", metavar='"SYM ..."', help="Of a robot: its word.")
@click.option("--derivation", type=click.IntRange(1), help="Of a robot: which, in order.")
@click.option("--cells", type=click.IntRange(1), help="Of a workspace: split it into so many.")
@click.option(
    "-o",
    "output",
    type=click.Path(path_type=Path, allow_dash=True),
    help="Write here, not to stdout (`-`).",
)
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

    A file that ends in .svg, .png or .pdf is drawn by Graphviz.
    """
    from compiler.views.dot import to_dot
    from srgc.graphs.graph_file import write_graph
    from srgc.graphs.graph_request import GraphRequest, drawing_of

    program = program_of(file)
    if task is not None:
        named = chosen(program.tasks, task, "task")
        grammar, workspace = grammar or named.grammar, workspace or named.workspace
    run_of = None if highlight is None else tuple(highlight.split())
    robot = None if word is None else tuple(word.split())
    request = GraphRequest(what, grammar, workspace, depth, run_of, near, robot, derivation, cells)
    drawing = drawing_of(program, request)
    for remark in drawing.remarks:
        click.echo(f"note: {remark}", err=True)
    text = to_dot(drawing.picture)
    if output is None or output == Path("-"):
        click.echo(text, nl=False)
    else:
        for line in write_graph(text, output).splitlines():
            click.echo(f"note: Graphviz: {line}", err=True)
    return 0


@cli.command()
@FILE
@click.option("--task", help="The task, where the file has several.")
@click.option("--cells", type=click.IntRange(1), help="Begin with at least so many cells.")
@click.option(
    "--dump",
    type=click.Choice(["dimacs", "smt2"]),
    help="Print the problem, not a solution: satisfiable if and only if there is one.",
)
@click.option(
    "-o",
    "--output",
    type=click.Path(path_type=Path, dir_okay=False),
    help="Draw cells, adjacency and path here, as SVG; with --dump, write that here.",
)
def plan(
    file: Path, task: str | None, cells: int | None, dump: str | None, output: Path | None
) -> int:
    """Print the cells that effectors go through, with the fewest changes.

    Exit 0 found, 3 none, 4 unknown; 0 with `--dump`.
    """
    from srgc.text_reports.plan_report import dump_text, plan_report

    if output is not None and dump is None and output.suffix.lower() != ".svg":
        raise UsageFault(f"{output}: a plan is drawn as SVG; let the name end in .svg")
    program = program_of(file)
    chosen_task = chosen(program.tasks, task, "task")
    refuse_unsupported(program, chosen_task)
    if dump is not None:
        text = dump_text(program, chosen_task, dump, cells)
        if output is None:
            click.echo(text, nl=False)
        else:
            write_output(output, text)
        return FOUND
    report = plan_report(program, chosen_task, cells)
    if output is not None:
        write_output(output, report.picture(f"{file.name}, task {chosen_task.name}"))
    click.echo(report.text)
    if chosen_task.robust is not None:
        click.echo("note: a plan is not about motions: `robust` is left out", err=True)
    return VERDICT_STATUS[report.verdict]


@cli.command()
@click.argument("folder", type=click.Path(path_type=Path))
@click.option("--spec", type=click.Path(path_type=Path), help="Also: it is about this file.")
@click.option("--trust", type=click.Choice(["z3"]), help="Run z3 again and believe its unsat.")
@click.option("--json", "as_json", is_flag=True, help="Print the answer as JSON.")
def verify(folder: Path, spec: Path | None, trust: str | None, as_json: bool) -> int:  # noqa: FBT001
    """Check a result independently.  Exit 0 valid, 1 refuted, 4 undecided."""
    from solvers.verifier.verification import Outcome, verify_directory
    from srgc.text_reports.verification_report import verification_json, verification_text

    if not folder.is_dir():
        raise UsageFault(f"{folder} is not a folder")
    if spec is not None and not spec.is_file():
        raise UsageFault(f"{spec} is not a file")
    report = verify_directory(folder, spec, trust)
    click.echo(verification_json(report) if as_json else verification_text(report))
    return {Outcome.VALID: 0, Outcome.REFUTED: REFUSED}.get(report.outcome, UNKNOWN)


def run(arguments: list[str] | None = None) -> int:
    """Run a command line and give its exit status; no exception leaves this function."""

    def command() -> int:
        status = cli.main(arguments, prog_name="srgc", standalone_mode=False)
        return status if isinstance(status, int) else 0

    return _guarded(command)


def _guarded(action: Callable[[], int]) -> int:
    """The status of an action; whatever it raises is reported and has a status, too."""
    try:
        return action()
    except UsageFault as fault:
        click.echo(f"error: {fault}", err=True)
        return USAGE
    except SpecErrors as errors:
        _show(errors.checked, stderr=True)
        return SPEC_ERRORS
    except (BudgetExceededError, NoAnswer) as error:
        click.echo(f"unknown: {error}", err=True)
        return UNKNOWN
    except click.exceptions.NoArgsIsHelpError as error:
        click.echo(error.format_message(), err=True)
        return USAGE
    except click.ClickException as error:
        error.show()
        return USAGE
    except (click.Abort, KeyboardInterrupt):
        click.echo("interrupted", err=True)
        return INTERRUPTED
    except (BrokenPipeError, SystemExit):
        # The reader has gone (click turns that into an exit of its own): no more can be said.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 0
    except Exception as error:  # the last line of defence: no traceback reaches a user
        return _internal(error)


def _internal(error: Exception) -> int:
    """Report a fault of srgc itself, or of a device that takes no more, in one message."""
    if isinstance(error, OSError) and error.errno in (errno.ENOSPC, errno.EDQUOT, errno.EIO):
        click.echo(f"error: the output cannot be written: {error.strerror}", err=True)
        return USAGE
    if "SRGC_TRACEBACK" in os.environ:
        raise error
    kind = type(error).__name__
    click.echo(
        f"internal error: {kind}: {error}\n"
        "this is a fault of srgc, not of your file; SRGC_TRACEBACK=1 shows where it is",
        err=True,
    )
    return INTERNAL


def main() -> None:
    """The entry point of the ``srgc`` command."""
    sys.exit(run())
