"""One step from the robot of a result to another task: ``evolve``."""

from __future__ import annotations

from collections.abc import Sequence
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING

from srgc.api.mission_result import MissionResult, mission_in
from srgc.api.program import Specification, program_of
from srgc.api.search_arguments import is_quiet, place_of, refuse_numbers
from srgc.api.spoken_faults import spoken
from srgc.session import chosen, refuse_cycles
from srgc.time_limit import TimeLimit

if TYPE_CHECKING:
    from srgc.results.rebuilding import Price


@spoken
def evolve(
    result: str | PathLike[str],
    program: Specification,
    task: str | None = None,
    *,
    output: str | PathLike[str] | None = None,
    add: Price = 1,
    remove: Price = 1,
    change: Price = 0,
    free: str | Sequence[str] = (),
    changes: Price | None = None,
    seed: int = 0,
    jobs: int | None = None,
    time_limit: float | None = None,
    force: bool = False,
    progress: bool | None = None,
) -> MissionResult:
    """Rebuild the robot of a result for another task, with as few changes as can be.

    Prices are whole numbers, fractions, decimals, doubles, or texts, as "1/3".

    Args:
        result: what ``synthesize``, ``open_result`` or ``evolve`` gives, or its folder; of a
            mission its last robot is rebuilt.
        program: the specification of the task, or the path of its file, with the modules of the
            robot.
        task: which one; may be left out where there is one.
        output: where the results are written, as by ``srgc evolve -o``.  By default a temporary
            folder, which lasts as long as the result; ``MissionResult.save`` keeps it.
        add: the price of a module that is added.
        remove: that of a module that is removed.
        change: that of a free parameter that changes.
        free: the parameters that kept modules may change, as "L.length", one or several.
        changes: what all changes may cost together.
        seed: of everything that is drawn; the same seed gives the same result.
        jobs: how many processes search, one by default; the result is the same.
        time_limit: seconds, after which the verdict is unknown unless a robot was proved by then.
        force: replace the results of another synthesis in the folder.
        progress: say how far the search is; by default in notebooks alone.

    Returns:
        The result, with the results that led to it; not verified yet: its ``verify`` does that.

    Raises:
        SrgcError: the result has no robot (its ``code`` is SRG0735), the specification lacks a
            module or a task, a price is none, or the folder holds something else.
    """
    limit, program = TimeLimit(time_limit), program_of(program)
    chosen_task = chosen(program.ir.tasks, task, "task")
    refuse_cycles(program.ir, program.ir.grammars[chosen_task.grammar])
    refuse_numbers(seed, 1 if jobs is None else jobs, time_limit)
    from srgc.results.evolution import refuse_inside, step_from
    from srgc.results.mission_run import run_mission
    from srgc.results.rebuilding import asked_rebuilding
    from srgc.results.synthesis_run import SynthesisOptions

    named = (free,) if isinstance(free, str) else tuple(free)
    asked = asked_rebuilding(
        program.ir, add=add, remove=remove, change=change, free=named, changes=changes
    )
    place, keeper = place_of(output)
    refuse_inside(place, Path(result))
    step = step_from(Path(result), program.ir, chosen_task, asked)
    quiet = is_quiet(progress)
    options = SynthesisOptions(place, seed, jobs or 1, limit, force, quiet)
    run_mission(Path(program.name), program.ir, asked.mission(chosen_task), options, step)
    return mission_in(place, keeper)
