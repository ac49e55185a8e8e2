"""Find places that no effector can move between, from cells, without a solver.

Nothing is assumed about robots, their number of modules or the horizon.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations

from compiler.tasks.necessary import Stop, family_avoidance, stops
from compiler.workspaces.abstraction import Abstraction, PassableCells, connected
from grammar_lang import ir
from solvers.verifier.claims.certificate import SeparationClaim

TRIALS = 100
"""How often, at most, it is tried to leave out some of the avoided regions."""
NAMED = 5
"""The most regions that a reason names."""


def disconnected(
    program: ir.Program, task: ir.Task, abstraction: Abstraction
) -> SeparationClaim | None:
    """Two places that no effector can move between, as evidence; None if none were found.

    Args:
        program: the program.
        task: the task.
        abstraction: the cells of its workspace from ``abstract``, without cuts.
    """
    cells = PassableCells(abstraction, program.workspaces[task.workspace])
    for one, other in combinations(stops(program, task), 2):
        if one.effector != other.effector or one.region == other.region:
            continue
        avoided = family_avoidance(program, task, one.effector)
        if avoided and cells.cut_off(one.region, other.region, avoided):
            return _claimed(cells, one, other, avoided)
    return None


def _claimed(
    cells: PassableCells, one: Stop, other: Stop, avoided: Sequence[str]
) -> SeparationClaim | None:
    """The evidence, without avoided regions that are not needed."""
    needed = list(_needed(cells, one.region, other.region, avoided))
    free = cells.free(needed)
    reached = connected(cells.meeting(one.region) & free, cells.touching, free)
    names = tuple(cells.abstraction.cells[i].name for i in sorted(reached))
    return SeparationClaim(one.effector, one.region, other.region, tuple(needed), names)


def _needed(
    cells: PassableCells, source: str, target: str, avoided: Sequence[str]
) -> Sequence[str]:
    """Regions that suffice to separate two others, found by leaving out smaller and smaller parts.

    Each of them is needed unless ``TRIALS`` runs out. Compare Zeller & Hildebrandt, *Simplifying
    and isolating failure-inducing input* (2002).
    """
    needed, trials = list(avoided), TRIALS
    size = len(needed)
    while size > 1 and trials > 0:
        size, first = (size + 1) // 2, 0
        while first < len(needed) and trials > 0:
            fewer = needed[:first] + needed[first + size :]
            trials -= 1
            if cells.cut_off(source, target, fewer):
                needed = fewer
            else:
                first += size
    return needed


def separation_text(program: ir.Program, task: ir.Task, claim: SeparationClaim) -> str:
    """The reason of the verdict, in words."""
    roles = {stop.region: stop.role for stop in reversed(stops(program, task))}
    ends = [f"{roles.get(name, 'region')} `{name}`" for name in (claim.source, claim.target)]
    walls = ", ".join(f"`{name}`" for name in claim.avoided[:NAMED])
    rest = len(claim.avoided) - NAMED
    walls += f" and {rest} more" if rest > 0 else ""
    through = f"every way between them leads through {walls}, never entered"
    return (
        f"{ends[0]} and {ends[1]} are cut off from each other: "
        f"{through if walls else 'nothing within the bounds leads from one to the other'}; "
        "this holds for every robot, whatever its size"
    )
