"""Check the claims of a *found* certificate about all robots: a bound, and objectives."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path

from compiler.objectives.values import MotionValues
from compiler.robots.robot import RobotModel
from grammar_lang import ir
from solvers.verifier.claims.certificate import FoundClaim
from solvers.verifier.claims.claimed_inputs import SHARE, robustness_entry
from solvers.verifier.proofs.checked_condition import CheckedCondition
from solvers.verifier.proofs.effort_bounds import Margin
from solvers.verifier.proofs.energy_used import energy_bounds
from solvers.verifier.proofs.scene import Watch
from solvers.verifier.refutations.bound_check import bound_condition
from solvers.verifier.refutations.optimality_check import objective_conditions


def further_conditions(
    folder: Path,
    claim: FoundClaim,
    program: ir.Program,
    task: ir.Task,
    model: RobotModel,
    margins: Sequence[Margin],
    conditions: Sequence[CheckedCondition],
    watch: Watch,
) -> tuple[CheckedCondition, ...]:
    """Check the claims about all robots and return the conditions that they state.

    Args:
        folder: the result folder, with the coverings.
        claim: the claim.
        program: the program, without maps.
        task: its task, without maps.
        model: the robot of the claim.
        margins: the proved margins of its inputs to their bounds.
        conditions: the proof of the robot.
        watch: receives the number of structures that are done.

    Raises:
        Refused: the evidence does not prove a claim.
    """

    def found() -> Iterator[CheckedCondition]:
        if claim.bound is not None:
            yield bound_condition(folder, claim, claim.bound, program, task, watch)
        if claim.objectives is not None:
            motion = MotionValues(
                robustness_entry(margins)[SHARE], claim.steps * task.step, energy_bounds(conditions)
            )
            yield from objective_conditions(
                folder, claim, claim.objectives, program, task, model, motion, watch
            )

    return tuple(found())
