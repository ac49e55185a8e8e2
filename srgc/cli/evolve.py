"""The command that rebuilds a robot for another task: ``evolve``."""

from __future__ import annotations

import os
from pathlib import Path

import click

from srgc.cli.arguments import (
    FILE,
    FOLDER,
    QUIET,
    TASK,
    VERBOSE,
    DocumentedCommand,
    PathOf,
    limit_of_time,
)
from srgc.time_limit import TimeLimit


@click.command(
    cls=DocumentedCommand,
    examples=[
        "srgc synth specs/changing_scene.srg --task Monday -o out/monday",
        "srgc evolve out/monday specs/changing_scene.srg --task Tuesday -o out/tuesday",
        "srgc verify out/tuesday",
    ],
    statuses={
        0: "found",
        3: "impossible within the changes that are allowed",
        4: "unknown, or the time limit was reached",
    },
    read_on="docs/how-to/rebuild-robots.md",
)
@FOLDER
@FILE
@TASK
@click.option(
    "-o", "--output", type=PathOf(path_type=Path), help="The result folder.  Default: out/TASK."
)
@click.option("--add", metavar="PRICE", default="1", help="Of adding a module; default 1.")
@click.option("--remove", metavar="PRICE", default="1", help="Of removing a module; default 1.")
@click.option(
    "--change", metavar="PRICE", default="0", help="Of changing a free parameter; default 0."
)
@click.option(
    "--free", metavar="M.P", multiple=True, help="A parameter that kept modules may change."
)
@click.option("--changes", metavar="MOST", help="The limit on the total cost of all changes.")
@click.option("--seed", type=click.IntRange(0), default=0, show_default=True)
@click.option(
    "--jobs",
    type=click.IntRange(1),
    help="The number of processes; default 1, at most one per processor.",
)
@limit_of_time("Seconds.")
@QUIET
@VERBOSE
@click.option("--json", "as_json", is_flag=True, help="Print design.json and show no progress.")
@click.option("--force", is_flag=True, help="Replace the results of another file or seed.")
def evolve(
    folder: Path,
    file: Path,
    task: str | None,
    output: Path | None,
    add: str,
    remove: str,
    change: str,
    free: tuple[str, ...],
    changes: str | None,
    seed: int,
    jobs: int | None,
    time_limit: float | None,
    quiet: bool,  # noqa: FBT001
    verbose: bool,  # noqa: FBT001
    as_json: bool,  # noqa: FBT001
    force: bool,  # noqa: FBT001
) -> int:
    """Rebuild the robot of a result for another task, with as few changes as possible.

    FOLDER contains a robot that was found: for a task, by a mission (its last robot), or by an
    earlier evolution.  Kept modules keep the values of their parameters, except for free ones.  The
    result contains the history of the robot, and can evolve again.
    """
    limit = TimeLimit(time_limit)
    from solvers.execution.one_thread import ONE_THREAD
    from srgc.session import chosen, program_of, refuse_cycles

    os.environ.update(ONE_THREAD)  # before numpy is loaded
    program = program_of(file)
    chosen_task = chosen(program.tasks, task, "task")
    refuse_cycles(program, program.grammars[chosen_task.grammar])
    from srgc.cli.mission import told
    from srgc.results.evolution import refuse_inside, step_from
    from srgc.results.rebuilding import asked_rebuilding
    from srgc.results.synthesis_run import SynthesisOptions
    from srgc.text_reports.mission_report import difference_text

    asked = asked_rebuilding(
        program, add=add, remove=remove, change=change, free=free, changes=changes
    )
    place = output or Path("out") / chosen_task.name
    refuse_inside(place, folder)
    step = step_from(folder, program, chosen_task, asked)
    options = SynthesisOptions(place, seed, jobs or 1, limit, force, as_json or quiet)
    notes = [difference_text(each, str(folder), str(file)) for each in step.differs]
    mission = asked.mission(chosen_task)
    return told(
        file, program, mission, options, step, as_json=as_json, verbose=verbose, notes=notes
    )
