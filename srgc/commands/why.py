"""The command that explains a verdict without a design: ``why``."""

from __future__ import annotations

import os
import sys
import time
from pathlib import Path

import click

from srgc.commands.arguments import limit_of_time


@click.command()
@click.argument("folder", type=click.Path(path_type=Path))
@click.option("--json", "as_json", is_flag=True, help="Print the explanation as JSON; no progress.")
@limit_of_time("Seconds; what is known by then is printed.")
@click.option("--no-runs", is_flag=True, help="Only the conflicts; suggest no changes.")
def why(folder: Path, as_json: bool, time_limit: float | None, no_runs: bool) -> int:  # noqa: FBT001
    """Say which lines of a spec conflict, and what would make its task possible.

    FOLDER is one that `srgc synth` has written with the verdict impossible or unknown.  Every
    suggestion was found and proved by a run of its own.  Exit 0.
    """
    from solvers.execution.one_thread import ONE_THREAD

    os.environ.update(ONE_THREAD)  # while numpy is not loaded yet
    from solvers.explanation.explanation import Asked, explain
    from solvers.explanation.run import MOST_RUNS
    from solvers.progress import Conduct
    from srgc.results.why_folder import tried_folder
    from srgc.text_reports.why_report import why_json, why_text

    tried = tried_folder(folder)
    if tried.tried is None:
        click.echo("verdict: found\nThere is nothing to explain: `srgc verify` checks the design.")
        return 0
    started = time.monotonic()

    def out_of_time() -> bool:
        return time_limit is not None and time.monotonic() - started > time_limit

    def tell(text: str) -> None:
        if not as_json:
            click.echo(text, err=True)

    conduct = Conduct(
        seed=tried.seed, search=tried.search, solver=tried.solver, out_of_time=out_of_time
    )
    found = explain(tried.posed, tried.tried, Asked(conduct, 0 if no_runs else MOST_RUNS, tell))
    colour = sys.stdout.isatty() and "NO_COLOR" not in os.environ
    click.echo(why_json(found) if as_json else why_text(found, colour=colour), nl=False)
    return 0
