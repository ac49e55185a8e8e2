"""Whether the claimed inputs keep their bounds, and whether the stated peak and margins are true.

For an open loop this is exact arithmetic on the decimals of the inputs; for a closed loop it uses
the proof of the motion. Nothing is integrated here.
"""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from math import inf, isqrt
from pathlib import Path
from typing import Any

from compiler.expressions.exact_numbers import exact_decimal
from compiler.robots.robot import RobotModel
from compiler.robots.state_and_input import InputBound, input_bounds, unbounded_kinds
from grammar_lang import ir
from solvers.verifier.claims.certificate import FoundClaim, exact
from solvers.verifier.claims.spec_copy import bounded_bytes
from solvers.verifier.proofs.checked_condition import CheckedCondition
from solvers.verifier.proofs.effort_bounds import (
    Margin,
    bound_name,
    planned_efforts,
    planned_margins,
    planned_ranges,
)
from solvers.verifier.proofs.trajectory_proof import Motion
from solvers.verifier.proofs.tube_checks import Status
from solvers.verifier.report import Outcome, Refused

NOT_A_DECIMAL = Fraction(1, 10**9)
"""The tolerance for a stated value where the true one is not a finite decimal."""
CLOSELY = 1e-9
"""The tolerance, relative to 1, between a stated number and the proved one: balls depend on library
versions."""


SHARE, BY_UNIT = "robustness_share", "robustness_by_unit"
"""Fields of ``design.json``."""


def check_efforts(
    claim: FoundClaim, model: RobotModel, motion: Motion, task: ir.Task
) -> list[CheckedCondition]:
    """Check exactly that every input is within its bound, and that peak and robustness are true.

    Raises:
        Refused: the task leaves an effort unbounded, or the claim misstates its peak or robustness.
    """
    _all_bounded(model, task)
    conditions = list[CheckedCondition]()
    for bound, held in held_bounds(model, task, motion.inputs):
        time = float(held.step * task.step)
        status = Status.HOLDS if held.holds else Status.FAILS
        margin = float(held.margin)
        conditions.append(
            CheckedCondition(bound_name(bound), status, margin, bound.unit, time, exact=True)
        )
    if all(condition.status is Status.HOLDS for condition in conditions):
        peak, rho, all_exact = stated_efforts(model, task, motion.inputs)
        for name, true in (("effort_peak", peak), ("robustness", rho)):
            stated = getattr(claim, name)
            if not _states(exact(stated), true, exactly=all_exact):
                raise Refused(f"`{name}` is {float(true):.17g}, not {stated}")
    return conditions


def _all_bounded(model: RobotModel, task: ir.Task) -> None:
    free = unbounded_kinds(model, task)
    if free:
        raise Refused(f"the task bounds no effort of {' and '.join(free)} joints")


def stated_efforts(
    model: RobotModel, task: ir.Task, inputs: Sequence[Sequence[Fraction]]
) -> tuple[Fraction, Fraction, bool]:
    """The largest effort and the least margin of inputs, and whether both are exact.

    Margins of different units are compared by their numbers.
    """
    held = held_bounds(model, task, inputs)
    peaks = [each.largest for bound, each in held if bound.effort]
    margins = [each.margin for _, each in held]
    all_exact = all(each.exact for _, each in held)
    return max([Fraction(0), *peaks]), min(margins, default=Fraction(0)), all_exact


def check_planned_efforts(
    claim: FoundClaim, model: RobotModel, task: ir.Task, conditions: Sequence[CheckedCondition]
) -> None:
    """Check the claimed peak and robustness against the proved planned motion of a closed loop.

    Raises:
        Refused: one of them is wrong, or (undecided) the bounds of the proof leave it open; or the
            task leaves a free input without a bound.
    """
    _all_bounded(model, task)
    names = "effort_peak", "robustness"
    proved, ranges = (
        planned_efforts(model, task, conditions),
        planned_ranges(model, task, conditions),
    )
    for name, bound, (least, most) in zip(names, proved, ranges, strict=True):
        stated = float(exact(getattr(claim, name)))
        close = CLOSELY * max(1.0, abs(bound))
        if abs(stated - bound) <= close:
            continue
        if not least - close <= stated <= most + close:
            raise Refused(f"`{name}` is {bound:.17g}, not {stated:.17g}")
        raise Refused(
            f"`{name}` is between {least:.17g} and {most:.17g}, which does not show {stated:.17g}",
            Outcome.UNDECIDED,
        )


@dataclass(frozen=True, slots=True)
class Held:
    """How inputs keep a bound: the least margin and its step, and the largest size.

    ``exact`` says that both values are exact, not roots that were rounded up.
    """

    holds: bool
    margin: Fraction
    step: int
    largest: Fraction
    exact: bool = True


def held_bounds(
    model: RobotModel, task: ir.Task, inputs: Sequence[Sequence[Fraction]]
) -> list[tuple[InputBound, Held]]:
    """Every bound on the inputs of a robot, and how inputs with a row (m,) per step keep it."""
    return [(bound, _held(bound, inputs)) for bound in input_bounds(model, task)]


def _held(bound: InputBound, inputs: Sequence[Sequence[Fraction]]) -> Held:
    if bound.norm2:
        squares = [sum((row[i] ** 2 for i in bound.inputs), Fraction(0)) for row in inputs]
        square = max(squares)
        root = _square_root(square)
        holds, margin = square <= bound.upper**2, bound.upper - root
        return Held(holds, margin, squares.index(square), root, root**2 == square)
    margins = [bound.margin(row) for row in inputs]
    least = min(margins)
    largest = max(abs(row[i]) for row in inputs for i in bound.inputs)
    return Held(least >= 0, least, margins.index(least), largest)


def _states(stated: Fraction, true: Fraction, *, exactly: bool) -> bool:
    """Whether a number states a value: exactly if the value is a decimal, otherwise closely."""
    try:
        exact_decimal(true)
    except ValueError:
        exactly = False
    return stated == true if exactly else abs(stated - true) <= NOT_A_DECIMAL


def _square_root(value: Fraction) -> Fraction:
    """The square root: exact if rational, otherwise rounded up by far less than any margin."""
    scale = 10**60
    return Fraction(
        _isqrt_up(value.numerator * value.denominator * scale**2), value.denominator * scale
    )


def _isqrt_up(value: int) -> int:
    root = isqrt(value)
    return root if root * root == value else root + 1


# --- The robustness in ``design.json``: a share, and a margin per unit of the inputs --------------


def input_margins(
    model: RobotModel,
    task: ir.Task,
    inputs: Sequence[Sequence[Fraction]] | None,
    conditions: Sequence[CheckedCondition],
) -> list[Margin]:
    """The margin of inputs to each bound; for a closed loop (``inputs`` None), the planned one."""
    if inputs is None:
        return planned_margins(model, task, conditions)
    held = held_bounds(model, task, inputs)
    return [Margin(bound, float(each.margin), float(each.margin)) for bound, each in held]


def claimed_margins(
    claim: FoundClaim, model: RobotModel, task: ir.Task, conditions: Sequence[CheckedCondition]
) -> list[Margin]:
    """The margin of the claimed inputs to each bound; ``conditions`` is the proof of the claim."""
    rows = None
    if claim.controller is None:
        rows = [[exact(item) for item in row] for row in claim.inputs]
    return input_margins(model, task, rows, conditions)


def robustness_entry(margins: Sequence[Margin]) -> dict[str, Any]:
    """The least margin as a share of the largest possible one, and the least margin per unit.

    Inputs that can have only one value are left out; if there are no others, the share is None.
    """
    by_unit = dict[str, float]()
    counted = [each for each in margins if each.widest > 0]
    for each in counted:
        unit = each.bound.unit
        by_unit[unit] = min(each.least, by_unit.get(unit, inf))
    share = min((each.least / each.widest for each in counted), default=None)
    listed = [{"unit": unit, "margin": margin} for unit, margin in by_unit.items()]
    return {SHARE: share, BY_UNIT: listed}


def misstated_robustness(folder: Path, margins: Sequence[Margin]) -> str | None:
    """Why the folder's ``design.json`` misstates the share or a margin of the robustness, or None.

    ``design.json``, if there is one, is a JSON object; older ones do not state them.
    """
    path = folder / "design.json"
    design = json.loads(bounded_bytes(path)) if path.is_file() else {}
    if SHARE not in design and BY_UNIT not in design:
        return None
    least = robustness_entry(margins)
    most = robustness_entry([replace(each, least=each.most) for each in margins])
    if _units(design) != _units(least):
        return f"design.json states inputs of other units than there are in `{BY_UNIT}`"
    for stated, low, high in zip(*map(_numbers, (design, least, most)), strict=True):
        if not _between(stated, low, high):
            return f"design.json states a robustness of {stated}, and {low} was proved"
    return None


def _units(design: Mapping[str, Any]) -> list[object]:
    """The units of the margins, in order; anything that is not a list of margins has none."""
    listed = design.get(BY_UNIT)
    if not isinstance(listed, list):
        return [None]
    known = (isinstance(each, dict) and each.keys() == {"unit", "margin"} for each in listed)
    return [each["unit"] if is_one else None for each, is_one in zip(listed, known, strict=True)]


def _numbers(design: Mapping[str, Any]) -> list[Any]:
    """The share, then the margins."""
    return [design.get(SHARE), *(each["margin"] for each in design[BY_UNIT])]


def _between(stated: object, least: float | None, most: float | None) -> bool:
    if stated is None or least is None or most is None:
        return stated is least
    if isinstance(stated, bool) or not isinstance(stated, float | int):
        return False
    close = CLOSELY * max(1.0, abs(least))
    return least - close <= stated <= most + close
