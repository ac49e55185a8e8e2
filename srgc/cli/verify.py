"""The command ``verify``."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

import click

from srgc.cli.arguments import FOLDER, QUIET, DocumentedCommand, PathOf
from srgc.cli.completions import complete_file
from srgc.faults import INTERNAL, REFUSED, UNEXPECTED, UNKNOWN, UsageFault

if TYPE_CHECKING:
    from solvers.verdict import Claimed
    from solvers.verifier.proofs.scene import Begin, Each, Watch
    from solvers.verifier.report import Report


@click.command(
    cls=DocumentedCommand,
    examples=[
        "srgc verify out/demo",
        "srgc verify out/demo --spec specs/planar_arm.srg --json",
        "srgc verify out/demo --task PickAndPlace --expect found",
    ],
    statuses={
        0: "the result is valid",
        1: "it is refuted",
        4: "undecided or not checked, or there is nothing to verify",
        6: "it is about another task or verdict than `--task` and `--expect` say",
    },
    reads_spec=False,
    read_on="docs/explanation/trust.md and docs/explanation/guarantees.md",
)
@FOLDER
@click.option(
    "--spec",
    type=PathOf(path_type=Path),
    shell_complete=complete_file,
    help="Also check that the result is about this file.",
)
@click.option("--task", metavar="NAME", help="The task that the result has to be about.")
@click.option("--mission", metavar="NAME", help="The mission that the result has to be about.")
@click.option(
    "--expect",
    type=click.Choice(["found", "impossible"]),
    help="The verdict that the result has to have.",
)
@click.option(
    "--trust",
    metavar="NAMES",
    help="Run these SMT solvers (e.g. z3,cvc5) and believe unsat if all say so.",
)
@click.option(
    "--jobs",
    type=click.IntRange(1),
    default=1,
    show_default=True,
    help="The number of processes that check independent parts.",
)
@QUIET
@click.option("--json", "as_json", is_flag=True, help="Print the answer as JSON.")
def verify(
    folder: Path,
    spec: Path | None,
    task: str | None,
    mission: str | None,
    expect: Claimed | None,
    trust: str | None,
    jobs: int,
    quiet: bool,  # noqa: FBT001
    as_json: bool,  # noqa: FBT001
) -> int:
    """Check a result independently of the search that made it.

    This proves every condition of the certificate again, with its margin, from the copy of the spec
    in FOLDER.  It loads no solver and no part of the search.  With --task and --expect, it does not
    judge a certificate about anything else, and the status is 6.  The report is the same, whatever
    --jobs is.
    """
    from solvers.verdict import MISSION
    from solvers.verifier.proofs.scene import Watch
    from solvers.verifier.verification import Expected, Outcome, verify_directory
    from srgc.paths import no_folder
    from srgc.results.progress_display import progress
    from srgc.text_reports.verification_report import verification_json, verification_text

    if not folder.is_dir():
        raise no_folder(folder)
    if spec is not None and not spec.is_file():
        raise UsageFault(f"{spec} is not a file")
    if trust is not None:
        from srgc.search_options import named_smt_solvers

        named_smt_solvers(trust)
    with (
        _beside(jobs) as (each, begin),
        progress(f"verify {folder}", quiet=quiet, unit="parts", plain=False) as display,
    ):
        watch = Watch(part=display.part, each=each, begin=begin)
        of_mission = mission is not None or (folder / MISSION).is_file()
        if of_mission:
            report, text = _mission(folder, spec, trust, watch, (mission, task, expect), as_json)
        else:
            report = verify_directory(folder, spec, trust, watch, Expected(task, expect))
            text = verification_json(report) if as_json else verification_text(report)
    if not as_json:
        from srgc.results.lost_file import next_after
        from srgc.terminal import with_verdict
        from srgc.text_reports.next_step import WHY, WHY_MISSION
        from srgc.text_reports.verification_report import after_verification

        text = with_verdict(text, report.outcome.value)
        why = WHY_MISSION if of_mission else WHY
        text = f"{text}\n{after_verification(report, str(folder), why, next_after(folder))}"
    click.echo(text)
    statuses = {
        Outcome.VALID: 0, Outcome.REFUTED: REFUSED, Outcome.UNEXPECTED: UNEXPECTED,
        Outcome.DISAGREEMENT: INTERNAL,
    }  # fmt: skip
    return statuses.get(report.outcome, UNKNOWN)


def _mission(
    folder: Path,
    spec: Path | None,
    trust: str | None,
    watch: Watch,
    expected: tuple[str | None, str | None, Claimed | None],
    as_json: bool,  # noqa: FBT001
) -> tuple[Report, str]:
    """Verify a mission; return the report and the text to print."""
    from solvers.verifier.missions.mission_check import verify_mission
    from srgc.text_reports.mission_report import mission_check_json, mission_check_text

    mission, task, expect = expected
    if task is not None:
        raise UsageFault(
            f"{folder} is about a mission: name the folder of a task in it, or no task"
        )
    report = verify_mission(folder, spec, trust, watch, mission, expect)
    print_as = mission_check_json if as_json else mission_check_text
    return report.report, print_as(report)


@contextmanager
def _beside(jobs: int) -> Iterator[tuple[Each, Begin]]:
    """Functions that check independent parts; only with several jobs are processes used."""
    from solvers.verifier.proofs.scene import in_turn, when_asked

    if jobs == 1:
        yield in_turn, when_asked
        return
    from srgc.search_options import workers_for

    with workers_for(jobs) as workers:
        yield workers.map, lambda function, job: workers.begin(function, job).result
