"""What is asked of a motion that goes on for ever, once the tube of prefix and loop is complete."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from fractions import Fraction
from typing import TYPE_CHECKING

from grammar_lang import ir
from solvers.verifier.proofs.checked_condition import CheckedCondition
from solvers.verifier.proofs.deviation_flow import Zonotope
from solvers.verifier.proofs.loop_set import LoopSet
from solvers.verifier.proofs.tube_checks import Status

if TYPE_CHECKING:
    from solvers.verifier.proofs.tube_proof import Followed

ENTERED, CLOSED = "entry into the loop", "return of the loop"
"""The conditions that the prefix ends, and that a round ends, in the set of the loop."""


def reached_some_time(reach: ir.Reach, effector: int) -> ir.Formula:
    """What `reach` asks of a motion without end; the effector's number is from 0."""
    window = ir.Window(Fraction(0), None)
    return ir.Eventually(ir.Atom(reach.region, effector + 1), window)


def endless_conditions(
    followed: Followed, at_all_times: Sequence[CheckedCondition]
) -> list[CheckedCondition]:
    """All that a tube shows of a prefix and of one round from all states of the loop's set.

    Args:
        followed: the tube, which is complete.
        at_all_times: what it shows of the conditions on every instant.

    Raises:
        ValueError: the motion ends.
    """
    robot = followed.robot
    task, loop = robot.scene.task, robot.loop
    if loop is None:
        raise ValueError("the motion ends")
    prefix, once = followed.reached
    closing = [
        _within(loop, prefix, ENTERED, float(task.step * loop.first)),
        _within(loop, once, CLOSED, float(task.step * task.steps)),
    ]
    asked = list(at_all_times)
    if task.reach is not None:
        formula = reached_some_time(task.reach, robot.motion.effector)
        verdict = followed.formulas.verdict(formula)
        asked.append(
            CheckedCondition(
                f"target {task.reach.region}", verdict.status, verdict.robustness, "m",
                verdict.time, verdict.place, loose=verdict.loose,
            )
        )  # fmt: skip
    return [*closing, *asked, *(followed.satisfied(*each) for each in enumerate(task.satisfy))]


def unless_open(conditions: Sequence[CheckedCondition]) -> list[CheckedCondition]:
    """The conditions; where the loop is not known to close, none of them is violated for certain.

    The tube of a round may hold no motion at all then.
    """
    closing = [each for each in conditions if each.name in (ENTERED, CLOSED)]
    if len(closing) == 2 and all(each.status is Status.HOLDS for each in closing):
        return list(conditions)
    return [
        replace(each, status=Status.UNDECIDED) if each.status is Status.FAILS else each
        for each in conditions
    ]


def _within(loop: LoopSet, states: Zonotope, name: str, time: float) -> CheckedCondition:
    """Whether a set of states is within that of the loop; the margin is a part of its size."""
    farthest = loop.farthest(states)
    margin = float((1 - farthest).lower())
    if bool(farthest <= 1):
        return CheckedCondition(name, Status.HOLDS, max(margin, 0.0), "", time)
    why = f"{name}: the motions are not enclosed by the set of the loop"
    return CheckedCondition(name, Status.UNDECIDED, min(margin, 0.0), "", time, why=why)
