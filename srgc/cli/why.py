"""The command that explains why there is no design, or no better one: ``why``."""

from __future__ import annotations

import os
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import click

from srgc.cli.arguments import FOLDER, QUIET, VERBOSE, DocumentedCommand, limit_of_time
from srgc.time_limit import TimeLimit

if TYPE_CHECKING:
    from srgc.results.why_folder import TriedFolder


@click.command(
    cls=DocumentedCommand,
    examples=[
        "srgc why out/impossible --no-runs",
        "srgc why out/impossible --time-limit 5 --json",
    ],
    reads_spec=False,
    read_on="docs/how-to/why.md",
)
@FOLDER
@QUIET
@VERBOSE
@click.option(
    "--json", "as_json", is_flag=True, help="Print the explanation as JSON and show no progress."
)
@limit_of_time("Seconds; at the limit, print what is known.")
@click.option("--no-runs", is_flag=True, help="Only find conflicts; suggest no changes.")
def why(
    folder: Path,
    quiet: bool,  # noqa: FBT001
    verbose: bool,  # noqa: FBT001
    as_json: bool,  # noqa: FBT001
    time_limit: float | None,
    no_runs: bool,  # noqa: FBT001
) -> int:
    """Explain which lines of a spec conflict, and what would make its task possible.

    FOLDER is one that `srgc synth` has written with the verdict impossible or unknown.  A separate
    run finds and proves each suggestion.  For a task with `minimize`, the command says what the
    next cheaper robots lack.  For a mission with any verdict, it says what each task refutes, and
    how much the cheapest remaining robots cost.
    """
    limit = TimeLimit(time_limit)
    from solvers.execution.one_thread import ONE_THREAD

    os.environ.update(ONE_THREAD)  # before numpy is loaded
    from solvers.explanation.explanation import Asked, explain
    from solvers.explanation.pairs import MOST_PAIRS
    from solvers.explanation.run import MOST_RUNS
    from srgc.results.mission_refusal import is_mission_folder
    from srgc.results.progress_display import progress
    from srgc.results.why_folder import tried_folder
    from srgc.terminal import out_colours
    from srgc.text_reports.solver_words import without_solver_words
    from srgc.text_reports.why_report import finding_line, why_json, why_text

    if is_mission_folder(folder):
        return _of_mission(folder, quiet=quiet or as_json, as_json=as_json)
    tried = tried_folder(folder)
    if tried.tried is None:
        return _of_found(folder, tried, limit, quiet=quiet, as_json=as_json)
    with limit.holds(), progress("why", quiet=quiet or as_json) as display:
        asked = Asked(
            replace(tried.context(limit.reached), reporter=display),
            0 if no_runs else MOST_RUNS,
            0 if no_runs else MOST_PAIRS,
            display.note,
            lambda each: display.finding(finding_line(each)),
            display.step,
        )
        found = explain(tried.posed, tried.tried, asked)
    text = why_json(found) if as_json else why_text(found, colour=out_colours())
    click.echo(text if as_json or verbose else without_solver_words(text), nl=False)
    return 0


def _of_mission(folder: Path, *, quiet: bool, as_json: bool) -> int:
    """Print which robots each task of a mission rules out, and which remain."""
    from solvers.verifier.proofs.scene import Watch
    from srgc.comparisons.mission_reasons import mission_reasons
    from srgc.comparisons.mission_reasons_text import mission_reasons_json, mission_reasons_text
    from srgc.results.progress_display import progress

    with progress("why", quiet=quiet, unit="parts", plain=False) as display:
        found = mission_reasons(folder, Watch(part=display.part))
    click.echo(mission_reasons_json(found) if as_json else mission_reasons_text(found), nl=False)
    return 0


def _of_found(
    folder: Path, tried: TriedFolder, limit: TimeLimit, *, quiet: bool, as_json: bool
) -> int:
    """Print what the robots lack that would have less of the first objective than the design."""
    from solvers.explanation.explanation import conflicts_of
    from srgc.comparisons.next_cheaper import next_cheaper
    from srgc.comparisons.next_cheaper_text import (
        cheaper_json,
        cheaper_text,
        stated_json,
        stated_text,
    )
    from srgc.results.lost_file import no_certificate
    from srgc.results.progress_display import progress
    from srgc.results.result_folder import json_object
    from srgc.results.stated_objectives import stated_objectives
    from srgc.terminal import out_colours

    if not (folder / "certificate.json").is_file():
        raise no_certificate(folder)
    cheaper = next_cheaper(folder, tried)
    if cheaper is None:
        path = folder / "design.json"
        stated = stated_objectives(json_object(path), path)
        click.echo(stated_json(stated) if as_json else stated_text(stated), nl=False)
        return 0
    with limit.holds(), progress("why", quiet=quiet or as_json) as display:
        refuted = [each.derivation for each in cheaper.refuted if each.lemma is None]
        conflicts, ended = conflicts_of(
            cheaper.posed, refuted, tried.context(limit.reached), display.step
        )
    if as_json:
        text = cheaper_json(cheaper, conflicts, ended)
    else:
        text = cheaper_text(cheaper, conflicts, ended, colour=out_colours())
    click.echo(text, nl=False)
    return 0
