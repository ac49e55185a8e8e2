"""The proof that a robot does its task under all disturbances that the task names.

One tube holds the motions from every start within the radii, under all inputs that differ from the
stated ones at any instant by no more than the allowed part. If the motion goes on for ever, another
tube holds all motions that begin a round in the set of the loop.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from fractions import Fraction

from flint import arb

from compiler.expressions.evaluators.balls import ball, working_precision
from compiler.tasks.specification import disturbance_radii, input_errors, uncertain_masses
from grammar_lang import ir
from solvers.verifier.proofs.carried_loads import transfer_names
from solvers.verifier.proofs.checked_condition import NO_MARGIN, CheckedCondition
from solvers.verifier.proofs.control_law import InputError
from solvers.verifier.proofs.effort_bounds import effort_conditions
from solvers.verifier.proofs.enclosure import Accuracy
from solvers.verifier.proofs.end_conditions import end_names
from solvers.verifier.proofs.endless_conditions import unless_open
from solvers.verifier.proofs.scene import Motion, Scene, Watch
from solvers.verifier.proofs.tube_checks import Status
from solvers.verifier.proofs.tube_proof import (
    driven_robot,
    follow,
)
from solvers.verifier.proofs.zonotope import InitialSet


@dataclass(frozen=True, slots=True)
class DisturbedFindings:
    """The conditions on all disturbed motions; ``ended`` is the time at which a tube ends early."""

    told: tuple[CheckedCondition, ...]
    ended: float | None

    def about(
        self, task: ir.Task, planned: Sequence[CheckedCondition]
    ) -> tuple[CheckedCondition, ...]:
        """The conditions on the planned motion, replaced by those on all disturbed motions.

        If the tube ends early, conditions that have to hold until the end are undecided.
        """
        told = self.told if self.ended is None else _cut_short(task, planned, self.told, self.ended)
        # Two conditions may have the same name; then all of them are replaced together.
        names = {each.name for each in told}
        return (*(each for each in planned if each.name not in names), *told)


@dataclass(frozen=True, slots=True)
class DisturbedMotions:
    """The question about all disturbed motions; when sent to another process, it has no watch."""

    scene: Scene
    motion: Motion
    accuracy: Accuracy
    watch: Watch

    def __reduce__(self) -> tuple[object, ...]:
        """Pickle without the watch, except for its ``brief`` flag."""
        return _unwatched, (self.scene, self.motion, self.accuracy, self.watch.brief)


def _unwatched(scene: Scene, motion: Motion, accuracy: Accuracy, brief: bool) -> DisturbedMotions:  # noqa: FBT001
    return DisturbedMotions(scene, motion, accuracy, Watch(brief=brief))


def disturbed_findings(asked: DisturbedMotions) -> DisturbedFindings:
    """The conditions that a tube proves of all disturbed motions, as far as it reaches.

    Raises:
        UndefinedValueError: the equations of motion have no value anywhere.
    """
    scene, motion = asked.scene, asked.motion
    with working_precision(asked.accuracy.bits):
        robot = driven_robot(scene, motion, disturbed=True)
        initial = disturbed_start(scene, robot.state)
        followed = follow(robot, initial, input_error(scene), asked.accuracy, asked.watch)
        found = followed.so_far() if followed.ended else followed.conditions()
        if motion.law is not None:
            found += effort_conditions(scene.model, scene.task, followed.commanded)
    if motion.loop is not None:
        found = unless_open(found)
    told = tuple(_told(each) for each in found)
    return DisturbedFindings(told, followed.time if followed.ended else None)


def _cut_short(
    task: ir.Task,
    planned: Sequence[CheckedCondition],
    told: Sequence[CheckedCondition],
    time: float,
) -> tuple[CheckedCondition, ...]:
    """The conditions if a tube ends early; ``told`` are those that it shows until then."""
    ended = CheckedCondition(
        "disturbed motions", Status.UNDECIDED, -NO_MARGIN, "", time,
        why="the enclosure of the disturbed motions ends",
    )  # fmt: skip
    known = [each for each in told if each.status is not Status.HOLDS]
    about = {each.name for each in told} | end_names(task) | transfer_names(task)
    rest = [
        replace(ended, name=each.name, margin=NO_MARGIN, unit=each.unit)
        for each in planned
        if (each.name in about or each.clause is not None)
        and each.name not in {item.name for item in known}
    ]
    return (*known, ended, *rest)


def _told(condition: CheckedCondition) -> CheckedCondition:
    """A condition on all disturbed motions; if undecided, with the reason for that."""
    if condition.status is not Status.UNDECIDED or condition.why:
        return condition
    why = f"the enclosure of the disturbed motions outgrows the margin of `{condition.name}`"
    return replace(condition, why=why)


def input_error(scene: Scene) -> InputError | None:
    """How far inputs may be from the commanded ones; None if they do not differ."""
    parts, most = input_errors(scene.task, scene.model)
    if not any(parts) and not any(most):
        return None
    return InputError(tuple(map(ball, parts)), tuple(map(ball, most)))


def disturbed_start(scene: Scene, state: Sequence[arb]) -> InitialSet:
    """The set of states in which a robot may start, in the graph's coordinates.

    The task's radii are about the joints' coordinates and rates, q = D y; the graph's coordinates
    are y. The factors of uncertain masses are the last entries.
    """
    radii = disturbance_radii(scene.task, scene.model)
    n, columns = len(scene.model.dofs), list[list[Fraction]]()
    moved = [number for number, radius in enumerate(radii) if radius]
    for number in moved:
        unit = [Fraction(int(i == number % n)) for i in range(n)]
        column = scene.graph.coordinates.solved_for(unit)
        none = [Fraction(0)] * n
        whole = [*column, *none] if number < n else [*none, *column]
        columns.append([*whole, *[Fraction(0)] * (len(state) - 2 * n)])
    lengths = [radii[number] for number in moved]
    masses = uncertain_masses(scene.task, scene.model)
    for number, item in enumerate(masses, len(state) - len(masses)):
        columns.append([Fraction(int(i == number)) for i in range(len(state))])
        lengths.append(item.part)
    rows = tuple(tuple(ball(column[i]) for column in columns) for i in range(len(state)))
    return InitialSet(tuple(state), rows, tuple(ball(length) for length in lengths))
