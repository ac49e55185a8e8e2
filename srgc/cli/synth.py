"""The command that searches for a robot: ``synth``."""

from __future__ import annotations

import os
from pathlib import Path

import click

from srgc.cli.arguments import (
    FILE,
    QUIET,
    TASK,
    VERBOSE,
    DocumentedCommand,
    PathOf,
    limit_of_time,
)
from srgc.cli.completions import complete_name
from srgc.faults import VERDICT_STATUS, UsageFault
from srgc.time_limit import TimeLimit


@click.command(
    cls=DocumentedCommand,
    examples=[
        "srgc synth specs/planar_arm.srg -o out/demo",
        "srgc verify out/demo",
        "srgc synth specs/nested.srg -o out/nested --seed 1 --time-limit 60 --quiet",
    ],
    statuses={0: "found", 3: "impossible", 4: "unknown, or the time limit was reached"},
    read_on="docs/reference/results.md; of an impossible task, `srgc why`",
)
@FILE
@TASK
@click.option(
    "--mission",
    shell_complete=complete_name,
    help="Solve all tasks of this mission instead of one task.",
)
@click.option(
    "-o", "--output", type=PathOf(path_type=Path), help="The result folder.  Default: out/TASK."
)
@click.option("--seed", type=click.IntRange(0), default=0, show_default=True)
@click.option(
    "--jobs",
    type=click.IntRange(1),
    help="The number of processes; default 1, at most one per processor.",
)
@click.option("--cluster", metavar="ADDRESS", help="Search on the workers of this Dask scheduler.")
@limit_of_time("Seconds.")
@click.option("--cells", type=click.IntRange(1), help="Begin with at least this many cells.")
@click.option(
    "--all", "every", is_flag=True, help="Continue after the first design, and compare all designs."
)
@click.option(
    "--pareto",
    is_flag=True,
    help="Like --all, but keep only the designs that no other design dominates.",
)
@click.option(
    "--gap",
    metavar="PERCENT",
    help="Continue until it is proved that no robot is more robust by more than this, e.g. 5 %.",
)
@click.option(
    "--paths",
    type=click.IntRange(1),
    help="Paths to try for a structure, and half as many after a cell is cut; default 6.",
)
@click.option(
    "--evaluations",
    type=click.IntRange(1),
    help="Evaluations in each search of parameters; default 12.",
)
@click.option(
    "--solver", metavar="NAME", help="For convex programs: own (default) or one of cvxpy."
)
@click.option("--search", metavar="NAME", help="For parameters: gp-acb (default) or nelder-mead.")
@click.option(
    "--smt",
    metavar="NAMES",
    help="SMT solvers for refutations, such as cvc5 or z3,cvc5; they must agree.",
)
@click.option(
    "--no-lemmas", is_flag=True, help="Refute every structure separately, with its own evidence."
)
@QUIET
@VERBOSE
@click.option("--json", "as_json", is_flag=True, help="Print design.json and show no progress.")
@click.option("--force", is_flag=True, help="Replace the results of another file or seed.")
def synth(
    file: Path,
    task: str | None,
    mission: str | None,
    output: Path | None,
    seed: int,
    jobs: int | None,
    cluster: str | None,
    time_limit: float | None,
    cells: int | None,
    every: bool,  # noqa: FBT001
    pareto: bool,  # noqa: FBT001
    gap: str | None,
    paths: int | None,
    evaluations: int | None,
    solver: str | None,
    search: str | None,
    smt: str | None,
    no_lemmas: bool,  # noqa: FBT001
    quiet: bool,  # noqa: FBT001
    verbose: bool,  # noqa: FBT001
    as_json: bool,  # noqa: FBT001
    force: bool,  # noqa: FBT001
) -> int:
    """Find a robot and prove it, or prove that there is none.

    The verdict and all evidence go to a folder, which `srgc verify` checks.  The same file and seed
    give the same bytes, whatever --jobs is.  The folder contains the first design as soon as it is
    proved, and more robust ones replace it.  The same command resumes a run that was interrupted or
    that reached the time limit.  After you edit the spec, the same command starts again and keeps
    the previous results as FOLDER.1, FOLDER.2 and so on.  For a task with `minimize`, the design is
    the best one by its objectives, and --all and --pareto compare designs by them; for other tasks,
    they compare modules, length and robustness.

    With --mission, one robot does all tasks of a mission, or robots are rebuilt between the tasks
    with the fewest changes.
    """
    limit = TimeLimit(time_limit)
    if jobs is not None and cluster is not None:
        raise UsageFault("--jobs does not go with --cluster, which has its own workers")
    if gap is not None and (every or pareto):
        option = "--pareto" if pareto else "--all"
        raise UsageFault(
            f"{option} does not go with --gap, which keeps the most robust design alone"
        )
    from solvers.execution.one_thread import ONE_THREAD
    from srgc.session import chosen, program_of, refuse_cycles

    os.environ.update(ONE_THREAD)  # before numpy is loaded
    program = program_of(file)
    if mission is not None:
        from srgc.cli.mission import synth_mission

        refused = {
            "--task": task, "--cells": cells, "--all": every or None, "--pareto": pareto or None,
            "--gap": gap,
        }  # fmt: skip
        return synth_mission(
            file, program, mission, output, refused, as_json=as_json, verbose=verbose,
            seed=seed, jobs=jobs or 1, time_limit=limit, force=force, quiet=as_json or quiet,
            cluster=cluster, solver=solver, search=search, paths=paths,
            evaluations=evaluations, lemmas=not no_lemmas, smt=smt,
        )  # fmt: skip
    missions = ", ".join(program.missions)
    or_else = f", or one of the missions {missions} with --mission" if missions else ""
    chosen_task = chosen(program.tasks, task, "task", or_else)
    refuse_cycles(program, program.grammars[chosen_task.grammar])
    from srgc.results.synthesis_run import SynthesisOptions, run_synthesis
    from srgc.search_options import asked_gap, named_search, named_smt_solvers, named_solver
    from srgc.terminal import with_verdict
    from srgc.text_reports.solver_words import without_solver_words
    from srgc.text_reports.synthesis_report import change_of, synthesis_text

    named_smt_solvers(smt)
    folder = output or Path("out") / chosen_task.name
    options = SynthesisOptions(
        folder, seed, jobs or 1, limit, force, as_json or quiet, cells, cluster,
        every or pareto, named_solver(solver), named_search(search), paths, evaluations,
        not no_lemmas, smt, asked_gap(gap, chosen_task), pareto,
    )  # fmt: skip
    result = run_synthesis(file, program, chosen_task, options)
    table = ""
    if result.designs and options.every:
        from srgc.results.pareto_table import pareto_table, pareto_text

        table = pareto_text(pareto_table(result, program, chosen_task, front_only=pareto))
    if as_json:
        click.echo((folder / "design.json").read_text(encoding="utf-8"), nl=False)
    else:
        change = change_of(program, chosen_task, result.design)
        text = synthesis_text(result, chosen_task, str(folder), table, change)
        shown = text if verbose else without_solver_words(text)
        click.echo(with_verdict(shown, result.verdict))
        if result.verdict == "impossible":
            from solvers.explanation.posed_task import PosedTask
            from solvers.run_context import RunContext
            from srgc.text_reports.why_report import ending

            posed = PosedTask(program, chosen_task)
            with limit.holds():
                last = ending(result, posed, RunContext(seed), str(folder))
            click.echo(last)
    return VERDICT_STATUS[result.verdict]
