"""Check that cells separate two places from each other, for every robot."""

from __future__ import annotations

from compiler.tasks.necessary import family_avoidance, stops
from compiler.workspaces.abstraction import Abstraction, PassableCells
from grammar_lang import ir
from solvers.verifier.claims.certificate import SeparationClaim


def misstated_separation(
    program: ir.Program, task: ir.Task, abstraction: Abstraction, claim: SeparationClaim
) -> str | None:
    """Why a claim that two places are separated is refused; None if it is proved.

    Args:
        program: the program.
        task: the task.
        abstraction: the cells of its workspace, without cuts.
        claim: the claim; every cell that touches one of its cells has to be one of them or avoided.
    """
    found = [stop.region for stop in stops(program, task) if stop.effector == claim.effector]
    if {claim.source, claim.target} - set(found):
        return "the task does not bring one effector into both regions of the separation"
    avoided = family_avoidance(program, task, claim.effector)
    if set(claim.avoided) - set(avoided):
        return "the separation names a region that the task does not avoid"
    known = {cell.name: i for i, cell in enumerate(abstraction.cells)}
    if set(claim.cells) - set(known):
        return "the separation names an unknown cell"
    space = PassableCells(abstraction, program.workspaces[task.workspace])
    free, cells = space.free(claim.avoided), frozenset(known[name] for name in claim.cells)
    if not cells <= free:
        return "the separation has an avoided cell"
    if not space.meeting(claim.source) & free <= cells:
        return f"a cell that meets `{claim.source}` is missing from the separation"
    if cells & space.meeting(claim.target):
        return f"a cell of the separation meets `{claim.target}`"
    if any(
        (i in cells) != (j in cells) and i in free and j in free for i, j in abstraction.touches
    ):
        return "a cell that touches one of the separation is missing from it"
    return None
