"""Find a motion that violates a condition not proved for all disturbed motions.

Candidates come from simulations in floats (``worst_disturbance.py``). That a motion violates the
task is proved as for any motion: in balls, from the exact start, under the exact law.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from contextlib import suppress
from dataclasses import replace

from compiler.expressions.evaluators.balls import ball, working_precision
from solvers.verifier.proofs.checked_condition import CheckedCondition
from solvers.verifier.proofs.effort_bounds import effort_conditions
from solvers.verifier.proofs.enclosure import Accuracy
from solvers.verifier.proofs.scene import Motion, Scene, Watch
from solvers.verifier.proofs.single_disturbance import (
    DisturbedMotion,
    error_sizes,
    undisturbed,
    unrolled,
)
from solvers.verifier.proofs.tube_checks import Status
from solvers.verifier.proofs.tube_proof import driven_robot, follow
from solvers.verifier.proofs.worst_disturbance import harmful
from solvers.verifier.proofs.zonotope import InitialSet

FLOAT_BITS = 53


def with_violation(
    scene: Scene,
    motion: Motion,
    conditions: tuple[CheckedCondition, ...],
    proved: Collection[str],
    accuracies: Sequence[Accuracy],
    watch: Watch,
) -> tuple[CheckedCondition, ...]:
    """The conditions, with the violation by one motion if one is found.

    Args:
        scene: the scene of the motion.
        motion: the planned motion; all motions that result from disturbances have to do the task.
        conditions: the known conditions; none of them fails.
        proved: the names of those that are proved of all disturbed motions.
        accuracies: tried in order while no violation is shown.
        watch: receives progress; an exception from it ends the search.
    """
    if not scene.model.dofs:
        return conditions
    whole, sizes = unrolled(motion), error_sizes(scene)
    none = undisturbed(sizes, len(whole.inputs))
    # The commands of an open loop are exact and have been checked.
    skipped = set(proved)
    if motion.law is None:
        skipped |= {each.name for each in effort_conditions(scene.model, scene.task, [])}
    motions = list[DisturbedMotion]()
    # Undefined values near a motion are no reason to judge it.
    with working_precision(FLOAT_BITS), suppress(ArithmeticError, ValueError):
        for each in harmful(
            scene, whole, sizes, none, lambda name: name not in skipped, watch.tick
        ):
            motions.append(each)
    for each in motions:
        for accuracy in accuracies:
            watch.tick()
            with working_precision(accuracy.bits):
                found = conditions_of(scene, each, accuracy, watch)
            failed = [item for item in found if item.status is Status.FAILS]
            if failed:
                still = each.motion == whole and all(factor == 1 for factor in each.masses)
                return _with(conditions, failed, "the planned" if still else "a disturbed")
    return conditions


def conditions_of(
    scene: Scene, of: DisturbedMotion, accuracy: Accuracy, watch: Watch
) -> list[CheckedCondition]:
    """The conditions on one motion, as far as its tube reaches, in the working precision."""
    robot = driven_robot(scene, of.motion, factors=of.masses)
    followed = follow(robot, InitialSet(robot.state), None, accuracy, Watch(watch.tick))
    found = followed.so_far() if followed.ended else followed.conditions()
    commanded = [
        [(u - ball(b)) / ball(f) for u, b, f in zip(*row, strict=True)]
        for row in zip(followed.commanded, of.added, of.factor, strict=False)
    ]
    return found + effort_conditions(scene.model, scene.task, commanded)


def _with(
    conditions: Sequence[CheckedCondition], failed: Sequence[CheckedCondition], which: str
) -> tuple[CheckedCondition, ...]:
    """The conditions, with failing ones in place of open ones of the same name."""
    told = {
        each.name: replace(each, why=f"{each.name}: violated by {which} motion") for each in failed
    }
    known = {each.name for each in conditions}
    replaced = [told.get(each.name, each) for each in conditions]
    return (*replaced, *(each for name, each in told.items() if name not in known))
