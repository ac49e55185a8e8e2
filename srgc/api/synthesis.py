"""The search for a robot and its proof."""

from __future__ import annotations

from os import PathLike
from pathlib import Path

from srgc.api.program import Program
from srgc.api.result import Result, TemporaryFolder, opened
from srgc.api.spoken_faults import spoken
from srgc.faults import UsageFault
from srgc.session import chosen, refuse_cycles, refuse_unsupported
from srgc.time_limit import TimeLimit


@spoken
def synthesize(
    program: Program,
    task: str | None = None,
    folder: str | PathLike[str] | None = None,
    *,
    seed: int = 0,
    jobs: int = 1,
    time_limit: float | None = None,
    cells: int | None = None,
    every: bool = False,
    solver: str | None = None,
    search: str | None = None,
    force: bool = False,
) -> Result:
    """Search a task for a robot that is proved to do it, or for a proof that there is none.

    Args:
        program: the specification.
        task: which one; may be left out where there is one.
        folder: where the results are written, as by ``srgc synth -o``; a search that was
            interrupted goes on from there.  By default a temporary folder, which lasts as long as
            the result; ``Result.save`` keeps it.
        seed: of everything that is drawn; the same seed gives the same result.
        jobs: how many processes search; the result is the same.
        time_limit: seconds, after which the verdict is unknown unless a robot was proved by then.
        cells: begin with at least so many cells.
        every: go on after the first robot, and compare all of them.
        solver: of convex programs; our own by default, or one of cvxpy's.
        search: of parameters; gp-acb by default.
        force: replace the results of another synthesis in the folder.

    Returns:
        The result, not verified yet: ``Result.verify`` does that.

    Raises:
        SrgcError: there is no such task, it has a clause that is not supported, or the folder
            holds something else.
    """
    limit = TimeLimit(time_limit)
    chosen_task = chosen(program.ir.tasks, task, "task")
    refuse_cycles(program.ir, program.ir.grammars[chosen_task.grammar])
    refuse_unsupported(program.ir, chosen_task)
    _refuse_numbers(seed, jobs, cells, time_limit)
    from srgc.results.synthesis_run import SynthesisOptions, run_synthesis
    from srgc.search_options import named_search, named_solver

    keeper = TemporaryFolder.made() if folder is None else None
    place = Path(folder) if folder is not None else keeper.path if keeper is not None else Path()
    options = SynthesisOptions(
        place, seed, jobs, limit, force, quiet=True, cells=cells, every=every,
        solver=named_solver(solver), search=named_search(search),
    )  # fmt: skip
    run_synthesis(Path(program.name), program.ir, chosen_task, options)
    return opened(place, keeper)


def _refuse_numbers(seed: int, jobs: int, cells: int | None, time_limit: float | None) -> None:
    if seed < 0:
        raise UsageFault("`seed` is not negative")
    if jobs < 1 or (cells is not None and cells < 1):
        raise UsageFault("`jobs` and `cells` count from 1")
    if time_limit is not None and not time_limit > 0:
        raise UsageFault("`time_limit` is a positive number of seconds")
