"""Whether the inputs of a claim keep their bounds, and whether what it says of them is true.

Exact arithmetic on the decimals of the claim; nothing is integrated.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from math import isqrt

from compiler.expressions.exact_numbers import exact_decimal
from compiler.robots.input_bounds import InputBound, input_bounds, unbounded_kinds
from compiler.robots.robot import RobotModel
from grammar_lang import ir
from solvers.verifier.claims.certificate import FoundClaim, exact
from solvers.verifier.proofs.checked_condition import CheckedCondition
from solvers.verifier.proofs.trajectory_proof import Motion
from solvers.verifier.proofs.tube_checks import Status
from solvers.verifier.report import Refused

NOT_A_DECIMAL = Fraction(1, 10**9)
"""How closely a claim must state a value that no finite decimal states."""


def check_efforts(
    claim: FoundClaim, model: RobotModel, motion: Motion, task: ir.Task
) -> list[CheckedCondition]:
    """Every input is within its bound, exactly; the claimed peak and robustness are true."""
    peak, margins, findings = Fraction(0), list[Fraction](), list[CheckedCondition]()
    all_exact = True
    free = unbounded_kinds(model, task)
    if free:
        raise Refused(f"the task bounds no effort of {' and '.join(free)} joints")
    for bound in input_bounds(model, task):
        held = _held(bound, motion)
        time = float(held.step * task.step)
        all_exact = all_exact and held.exact
        status = Status.HOLDS if held.holds else Status.FAILS
        name = f"effort ({bound.unit})" if bound.effort else bound.name
        findings.append(
            CheckedCondition(name, status, float(held.margin), bound.unit, time, exact=True)
        )
        peak = max(peak, held.largest) if bound.effort else peak
        margins.append(held.margin)
    true_values = {"effort_peak": peak, "robustness": min(margins, default=Fraction(0))}
    if all(finding.status is Status.HOLDS for finding in findings):
        for name, true in true_values.items():
            stated = exact(getattr(claim, name))
            if not _states(stated, true, exactly=all_exact):
                raise Refused(f"`{name}` is {float(true):.17g}, not {float(stated):.17g}")
    return findings


@dataclass(frozen=True, slots=True)
class _Held:
    """How inputs keep a bound: the least margin, at which step, and the largest size.

    ``exact`` says that both are exact, not roots rounded up.
    """

    holds: bool
    margin: Fraction
    step: int
    largest: Fraction
    exact: bool = True


def _held(bound: InputBound, motion: Motion) -> _Held:
    """The inputs of a motion against one bound."""
    if bound.norm2:
        squares = [sum((row[i] ** 2 for i in bound.inputs), Fraction(0)) for row in motion.inputs]
        square = max(squares)
        root = square_root(square)
        holds, margin = square <= bound.upper**2, bound.upper - root
        return _Held(holds, margin, squares.index(square), root, root**2 == square)
    margins = [bound.margin(row) for row in motion.inputs]
    least = min(margins)
    largest = max(abs(row[i]) for row in motion.inputs for i in bound.inputs)
    return _Held(least >= 0, least, margins.index(least), largest)


def _states(stated: Fraction, true: Fraction, *, exactly: bool) -> bool:
    """Whether a decimal states a value: exactly if the value is a decimal, else closely."""
    try:
        exact_decimal(true)
    except ValueError:
        exactly = False
    return stated == true if exactly else abs(stated - true) <= NOT_A_DECIMAL


def square_root(value: Fraction) -> Fraction:
    """The square root, exact where rational, else rounded up far below any margin."""
    scale = 10**60
    return Fraction(
        _isqrt_up(value.numerator * value.denominator * scale**2), value.denominator * scale
    )


def _isqrt_up(value: int) -> int:
    root = isqrt(value)
    return root if root * root == value else root + 1
