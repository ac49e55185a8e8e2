"""The proof that a robot does its task whatever the disturbances that the task names.

One tube holds the motions from every start within the radii, under all inputs that differ at any
instant from what is stated by no more than their part.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from fractions import Fraction

from flint import arb

from compiler.expressions.evaluators.balls import ball, working_precision
from compiler.tasks.disturbance_radii import disturbance_radii
from grammar_lang import ir
from solvers.verifier.proofs.counterexample import counterexample
from solvers.verifier.proofs.enclosure import Accuracy
from solvers.verifier.proofs.finding import NO_MARGIN, Finding, decisive
from solvers.verifier.proofs.initial_set import InitialSet
from solvers.verifier.proofs.scene import Motion, Scene
from solvers.verifier.proofs.tube_checks import Status
from solvers.verifier.proofs.tube_proof import driven_robot, follow
from solvers.verifier.proofs.watch import Watch


def disturbed_findings(
    scene: Scene,
    motion: Motion,
    planned: Sequence[Finding],
    accuracy: Accuracy,
    watch: Watch,
) -> tuple[Finding, ...]:
    """The findings on the planned motion, replaced by those on all disturbed ones.

    Where the tube ends early, what has to hold until the end is not decided.
    """
    robust = scene.task.robust or ir.Robust()
    with working_precision(accuracy.bits):
        robot = driven_robot(scene, motion)
        initial = disturbed_start(scene, robot.state)
        part = ball(robust.effort) if robust.effort else None
        followed = follow(robot, initial, part, accuracy, watch)
        found = followed.so_far() if followed.ended else followed.findings()
    told = [_told(each) for each in found]
    if followed.ended:
        told = _cut_short(scene, planned, told, followed.time)
    # Two conditions may have the same name: all of either kind go together.
    names = {each.name for each in told}
    return (*(each for each in planned if each.name not in names), *told)


def _cut_short(
    scene: Scene, planned: Sequence[Finding], told: Sequence[Finding], time: float
) -> list[Finding]:
    """What is not proved by a tube that ends early; ``told`` is what it shows up to there."""
    ended = Finding(
        "disturbed motions", Status.UNDECIDED, -NO_MARGIN, "", time,
        why="the enclosure of the disturbed motions ends",
    )  # fmt: skip
    known = [each for each in told if each.status is not Status.HOLDS]
    about = {each.name for each in told} | {_target(scene), "rest at the end"}
    rest = [
        replace(ended, name=each.name, margin=NO_MARGIN, unit=each.unit)
        for each in planned
        if (each.name in about or each.clause is not None)
        and each.name not in {item.name for item in known}
    ]
    return [*known, ended, *rest]


def _target(scene: Scene) -> str | None:
    reach = scene.task.reach
    return None if reach is None else f"target {reach.region}"


def with_counterexample(
    scene: Scene,
    motion: Motion,
    findings: tuple[Finding, ...],
    accuracy: Accuracy,
    watch: Watch,
) -> tuple[Finding, ...]:
    """The findings, with a violation by a disturbed motion where one is found of what is open."""
    worst = decisive(findings)
    if worst is None or worst.status is Status.FAILS:
        return findings
    target = _target(scene)
    for each in findings:
        # What has no margin is open because the tube ends, not because it is nearly violated.
        lost = each.status is Status.UNDECIDED and each.margin < NO_MARGIN
        if lost or each.name == target:
            found = counterexample(
                scene,
                motion,
                each.name,
                disturbance_radii(scene.task, scene.model),
                accuracy,
                watch,
            )
            if found is not None:
                return tuple(found if item is each else item for item in findings)
    return findings


def _told(finding: Finding) -> Finding:
    """A finding on all disturbed motions, with the reason where they are too many to prove it."""
    if finding.status is not Status.UNDECIDED:
        return finding
    why = f"the enclosure of the disturbed motions outgrows the margin of `{finding.name}`"
    return replace(finding, why=why)


def disturbed_start(scene: Scene, state: Sequence[arb]) -> InitialSet:
    """The states in which a robot may be at first, in the graph's coordinates.

    The task's radii are about the joints' coordinates and rates, q = D y; the graph's are y.
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
    rows = tuple(tuple(ball(column[i]) for column in columns) for i in range(len(state)))
    centre = tuple(state)
    return InitialSet(centre, rows, tuple(ball(radii[number]) for number in moved))
