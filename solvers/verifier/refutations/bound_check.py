"""Check a bound: no robot can do the task with input bounds that are tighter by a given share.

The task is tightened here, exactly, and the evidence is that of an impossibility of the tightened
task. A design whose inputs kept more than this share from their bounds would do that task.
"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from compiler.tasks.tightened import tightened
from grammar_lang import ir
from solvers.verifier.claims.bound_claims import BoundClaim, bound_text
from solvers.verifier.claims.certificate import FoundClaim, ImpossibleClaim, exact
from solvers.verifier.proofs.checked_condition import NO_MARGIN, CheckedCondition
from solvers.verifier.proofs.scene import Watch
from solvers.verifier.proofs.tube_checks import Status
from solvers.verifier.refutations.impossibility_check import check_impossible
from solvers.verifier.report import Refused


def bound_condition(
    folder: Path,
    claim: FoundClaim,
    bound: BoundClaim,
    program: ir.Program,
    task: ir.Task,
    watch: Watch,
) -> CheckedCondition:
    """Check the bound and return the condition that it states.

    A claim may limit the modules of a task that does not; the condition is then about that number.

    Args:
        folder: the result folder, with the coverings.
        claim: the claim that the bound belongs to.
        bound: the bound.
        program: the program, without maps.
        task: its task, without maps.
        watch: receives the number of structures that are done.

    Raises:
        Refused: the evidence does not prove the bound.
    """
    asked = task if task.modules is not None else replace(task, modules=bound.modules)
    narrow, due = tightened(program, asked, exact(bound.share))
    impossible = ImpossibleClaim(
        claim.task, claim.spec, claim.spec_sha256, bound.modules, bound.structures, None,
        bound.lemmas,
    )  # fmt: skip
    found = check_impossible(folder, impossible, narrow, due, (), watch)
    text = bound_text(bound)
    if isinstance(found, str):
        raise Refused(f"it is not proved that {text}: {found}")
    if not found.complete:
        raise Refused(f"it is not proved that {text}: a bound has no scripts as evidence")
    return CheckedCondition(text, Status.HOLDS, NO_MARGIN, "")
