"""The values of designs in the objectives of a task, and which design is the best."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction

from compiler.expressions.exact_numbers import Bounds
from compiler.objectives.least_values import Amount
from compiler.objectives.ordered_structures import Limit
from compiler.objectives.values import MotionValues, value_bounds
from grammar_lang import ir
from solvers.search.path_task import Design, robustness_share
from solvers.verifier.proofs.energy_used import energy_bounds


def design_values(design: Design, amounts: Sequence[Amount], task: ir.Task) -> tuple[Fraction, ...]:
    """The value of a design in each objective, rounded up, in SI units.

    Raises:
        ValueError: if an objective has no finite value.
    """
    return tuple(high for _, high in design_bounds(design, amounts, task))


def design_bounds(design: Design, amounts: Sequence[Amount], task: ir.Task) -> tuple[Bounds, ...]:
    """Rational bounds on the value of a design in each objective, in SI units.

    Raises:
        ValueError: if an objective has no finite value.
    """
    motion = MotionValues(
        robustness_share(design, task), len(design.inputs) * task.step,
        energy_bounds(design.conditions),
    )  # fmt: skip
    found: list[Bounds] = []
    for amount in amounts:
        bounds = value_bounds(
            amount, design.derivation.word, design.model, design.parameters, motion
        )
        if bounds is None:
            raise ValueError(f"{amount.text} has no finite value")
        found.append(bounds)
    return tuple(found)


def limits_of(
    values: Sequence[Sequence[Fraction]], amounts: Sequence[Amount]
) -> tuple[tuple[Limit, ...], int | None]:
    """The limits that designs with these values set on each objective, and the best design.

    Each objective in turn takes the least value among the designs within the limits so far, and
    allows as much more as the objective says.  Ties in the last objective are broken by the first
    objective, then the second, and so on.  The index is None if there are no designs.
    """
    left, limits = list(range(len(values))), list[Limit]()
    if not left:
        return (), None
    for place, amount in enumerate(amounts):
        limit = Limit(amount, min(values[k][place] for k in left))
        limits.append(limit)
        left = [k for k in left if values[k][place] <= limit.most]
    return tuple(limits), min(left, key=lambda k: (*values[k][-1:], *values[k], k))
