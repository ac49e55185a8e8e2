"""The conditions on a motion that goes on for ever, given the tube of its prefix and loop."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from fractions import Fraction

from flint import arb

from compiler.expressions.evaluators.balls import below
from grammar_lang import ir
from solvers.verifier.proofs.checked_condition import CheckedCondition
from solvers.verifier.proofs.formula_proof import FormulaProof
from solvers.verifier.proofs.loop_set import LoopSet
from solvers.verifier.proofs.tube_checks import Status
from solvers.verifier.proofs.zonotope import Zonotope

ENTERED, CLOSED = "entry into the loop", "return of the loop"
"""The conditions that the prefix ends, and that a round ends, in the set of the loop."""


def reached_some_time(reach: ir.Reach, effector: int) -> ir.Formula:
    """The formula of `reach` for a motion without end; the effector's number is from 0."""
    window = ir.Window(Fraction(0), None)
    return ir.Eventually(ir.Atom(reach.region, effector + 1, poses=reach.poses), window)


def endless_conditions(
    loop: LoopSet,
    reached: Sequence[Zonotope],
    task: ir.Task,
    effector: int,
    formulas: FormulaProof,
) -> list[CheckedCondition]:
    """The conditions for a complete tube: the loop closes, and the target is reached at some time.

    Args:
        loop: the set in which every round begins.
        reached: the sets of states at the end of the prefix, and of one round from the whole set.
        task: the task.
        effector: the one that reaches, from 0.
        formulas: the known distances to regions along the tube.
    """
    prefix, once = reached
    found = [
        _within(loop.farthest(prefix), ENTERED, float(task.step * loop.first)),
        _within(loop.farthest(once, after=True), CLOSED, float(task.step * task.steps)),
    ]
    if task.reach is not None:
        verdict = formulas.verdict(reached_some_time(task.reach, effector))
        found.append(
            CheckedCondition(
                f"target {task.reach.region}", verdict.status, verdict.robustness, "m",
                verdict.time, verdict.place, loose=verdict.loose,
            )
        )  # fmt: skip
    return found


def unless_open(conditions: Sequence[CheckedCondition]) -> list[CheckedCondition]:
    """The conditions; if the loop is not proved to close, violated ones become undecided.

    In that case the tube of a round may contain no motion at all.
    """
    closing = [each for each in conditions if each.name in (ENTERED, CLOSED)]
    if len(closing) == 2 and all(each.status is Status.HOLDS for each in closing):
        return list(conditions)
    return [
        replace(each, status=Status.UNDECIDED) if each.status is Status.FAILS else each
        for each in conditions
    ]


def _within(farthest: arb, name: str, time: float) -> CheckedCondition:
    """Whether a set of states is within the set of the loop; the margin is relative to its size.

    ``farthest`` bounds the distance from its centre, relative to its size.
    """
    margin = below(1 - farthest)
    if bool(farthest <= 1):
        return CheckedCondition(name, Status.HOLDS, max(margin, 0.0), "", time)
    why = f"{name}: the motions are not enclosed by the set of the loop"
    return CheckedCondition(name, Status.UNDECIDED, min(margin, 0.0), "", time, why=why)
