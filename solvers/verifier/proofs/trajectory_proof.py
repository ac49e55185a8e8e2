"""The proof that a claimed robot, with its start and inputs, does its task at every instant.

Everything is recomputed from the spec: the robot from its derivation, its equations of motion, the
cells. Positions of all points are enclosed along a validated tube; if the task names disturbances,
also along a second tube that holds all disturbed motions.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from flint import arb

from compiler.expressions.evaluators.balls import working_precision
from compiler.expressions.tape import UndefinedValueError
from compiler.tasks.specification import missing_effector
from compiler.workspaces.abstraction import Abstraction
from solvers.verifier.proofs.carried_loads import load_conditions
from solvers.verifier.proofs.checked_condition import NO_MARGIN, CheckedCondition, decisive, inside
from solvers.verifier.proofs.disturbed_proof import DisturbedMotions, disturbed_findings
from solvers.verifier.proofs.effort_bounds import PLANNED, effort_conditions
from solvers.verifier.proofs.enclosure import Accuracy
from solvers.verifier.proofs.scene import UNWATCHED, Motion, Scene, Watch, scene_of
from solvers.verifier.proofs.start_check import positive_mass, start_conditions, unphysical
from solvers.verifier.proofs.tube_checks import Status
from solvers.verifier.proofs.tube_proof import driven_robot, follow
from solvers.verifier.proofs.violating_motion import with_violation
from solvers.verifier.proofs.zonotope import InitialSet

__all__ = ["ACCURACIES", "Motion", "Scene", "prove_motion", "scene_of"]

ACCURACIES = (Accuracy(10, 96, 1e-10), Accuracy(14, 128, 1e-15), Accuracy(20, 192, 1e-24))
ENDED = "enclosure of the motion"
"""The condition that is open if a tube ends before the motion does."""


def prove_motion(
    scene: Scene,
    motion: Motion,
    watch: Watch = UNWATCHED,
    *,
    refute: bool = False,
) -> tuple[CheckedCondition, ...]:
    """All conditions on a motion, at the first accuracy that decides them all, with close margins.

    If the task names disturbances, whatever is proved of the planned motion is then proved of all
    disturbed motions, and the conditions are about those; the start and the path of cells remain
    about the planned motion. The same holds if motions go on for ever: first the planned motion up
    to the end of the first round, then all rounds of all motions. With ``refute``, a motion is
    looked for that violates a condition that was not proved. An exception from the ``watch`` ends
    the proof.
    """
    missing = missing_effector(scene.task, len(scene.model.effectors))
    if missing is not None:
        return (CheckedCondition(f"effector {missing} of the task", Status.FAILS, 0.0, ""),)
    try:
        several = scene.task.robust is not None or scene.task.repeat
        disturbed = None
        if several:
            asked = DisturbedMotions(scene, motion, ACCURACIES[0], watch)
            disturbed = watch.begin(disturbed_findings, asked)
        planned = _planned(scene, motion, watch)
        found, proved = planned, frozenset[str]()
        if disturbed is not None and decisive(planned) is None:
            found = disturbed().about(scene.task, planned)
            proved = frozenset(each.name for each in found if each.status is Status.HOLDS)
        elif motion.law is None:
            return planned
        worst = decisive(found)
        if not refute or worst is None or worst.status is Status.FAILS:
            return found
        return with_violation(scene, motion, found, proved, ACCURACIES[:2], watch)
    except UndefinedValueError as error:
        return (CheckedCondition(f"equations of motion: {error}", Status.FAILS, 0.0, ""),)


def _planned(scene: Scene, motion: Motion, watch: Watch) -> tuple[CheckedCondition, ...]:
    """The conditions on the planned motion; if none decides, those of the farthest tube."""
    decided: tuple[CheckedCondition, ...] | None = None
    farthest: tuple[CheckedCondition, ...] = ()
    # With a controller the set stays as small as it was: more digits would not get farther.
    once = motion.law is not None or watch.roughly
    for accuracy in ACCURACIES[:1] if once else ACCURACIES:
        with working_precision(accuracy.bits):
            conditions = _conditions(scene, motion, accuracy, watch)
        if any(condition.status is Status.UNDECIDED for condition in conditions):
            farthest = max(conditions, farthest, key=_end)
            continue
        decided = conditions
        # A violation is final: only margins of conditions that hold justify another run.
        failed = any(condition.status is Status.FAILS for condition in conditions)
        if failed or not any(condition.loose for condition in conditions):
            break
    return farthest if decided is None else decided


def _end(conditions: tuple[CheckedCondition, ...]) -> float:
    """The time that a tube reaches; infinite for a complete one."""
    if not conditions:
        return -NO_MARGIN
    return next((f.time or 0.0 for f in conditions if f.name == ENDED), NO_MARGIN)


def _conditions(
    scene: Scene, motion: Motion, accuracy: Accuracy, watch: Watch
) -> tuple[CheckedCondition, ...]:
    robot = driven_robot(scene, motion)
    found = [positive_mass(scene.graph, robot.state, robot.tail)]
    found += [*unphysical(scene.model, robot.tail), *load_conditions(scene, motion)]
    tips = robot.point_map.positions(robot.state)
    found += start_conditions(scene, motion, robot.state, robot.tail, tips)
    if any(condition.status is Status.FAILS for condition in found):
        return tuple(found)
    followed = follow(robot, InitialSet(robot.state), None, accuracy, watch)
    if followed.ended:
        # A violation before the tube ends is final, whatever comes after.
        failed = [each for each in followed.so_far() if each.status is Status.FAILS]
        why = f"the {ENDED} ends"
        ended = CheckedCondition(ENDED, Status.UNDECIDED, NO_MARGIN, "", followed.time, why=why)
        return (*found, *(failed or [ended]))
    path = cell_path(scene.abstraction, float(scene.task.step), motion.path, followed.positions())
    if motion.law is not None:
        several = scene.task.robust is not None or scene.task.repeat
        prefix = PLANNED if several else ""
        found += effort_conditions(scene.model, scene.task, followed.commanded, prefix)
    return (*found, *followed.conditions(), path)


# --- Check that effectors are in their claimed cells at the samples -------------------------------


def cell_path(
    cells: Abstraction,
    dt: float,
    path: Sequence[Sequence[str]],
    positions: Sequence[Sequence[Sequence[arb]]],
) -> CheckedCondition:
    """Check that every effector is in its cell at every sample.

    Between samples, the motion itself is checked, without cells.

    Args:
        cells: the cells of the workspace.
        dt: the time between samples, s.
        path: for each effector, the name of its cell at every sample.
        positions: for each sample and effector, its position, m.
    """
    worst = CheckedCondition("cell path", Status.HOLDS, NO_MARGIN, "m")
    for effector, names in enumerate(path):
        for sample, name in enumerate(names):
            where = f"cell path: effector {effector + 1} at sample {sample}"
            try:
                index = cells.index(name)
            except KeyError:
                return CheckedCondition(
                    f"{where}: no cell `{name}`", Status.FAILS, 0.0, "m", sample * dt
                )
            polytope = cells.cells[index].polytope
            condition = inside("cell path", polytope, positions[sample][effector], sample * dt)
            if condition.status is Status.FAILS:
                return replace(condition, name=f"{where} is not in `{name}`")
            worst = min(worst, condition, key=_clear)
    return worst


def _clear(condition: CheckedCondition) -> tuple[bool, float]:
    """A sort key: undecided conditions come before those that hold, small margins before large."""
    return condition.status is Status.HOLDS, condition.margin
