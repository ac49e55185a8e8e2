"""``evolve``: rebuild the robot of a result for another task."""

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
    """Rebuild the robot of a result for another task, with the cheapest changes.

    Prices are integers, fractions, decimals, floats, or texts such as "1/3".

    Args:
        result: a result of ``synthesize``, ``open_result`` or ``evolve``, or its folder; the last
            robot of a mission is rebuilt.
        program: the specification of the task, or the path of its file; it must have the modules
            of the robot.
        task: the task; may be omitted if there is only one.
        output: the folder for the results, as for ``srgc evolve -o``.  By default a temporary
            folder that exists as long as the result; ``MissionResult.save`` copies it.
        add: the price of adding a module.
        remove: the price of removing a module.
        change: the price of changing a free parameter.
        free: one or more parameters that may change in kept modules, such as "L.length".
        changes: the largest total price of all changes; by default there is no limit.
        seed: the seed of all random numbers; the same seed gives the same result.
        jobs: the number of processes, by default one; it does not change the result.
        time_limit: a limit in seconds.  If no robot is proved by then, the verdict is unknown.
        force: whether to replace the results of another synthesis in the folder.
        progress: whether to show the progress of the search; by default only in notebooks.

    Returns:
        The result, with the results that led to it.  It is not verified yet; call its ``verify``.

    Raises:
        SrgcError: the result has no robot (``code`` is SRG0735), the specification lacks a module
            or a task, a price is invalid, or the folder has other contents.
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
