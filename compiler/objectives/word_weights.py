"""The least amount that each symbol of a word adds to an objective that is a sum over modules.

This needs only fractions, so specifications are checked without any other arithmetic.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from fractions import Fraction
from typing import TypeAlias

from grammar_lang import ir

Weights: TypeAlias = Mapping[str, Fraction]
"""Maps names of symbols to weights; symbols not named weigh nothing."""


def weights_of_modules(
    program: ir.Program,
    objective: ir.Objective,
    least: Callable[[ir.Interval | ir.Choices], Fraction],
) -> Weights | None:
    """The least that each module adds to an objective; None if it is not a sum over modules.

    Args:
        program: the program.
        objective: the objective.
        least: a lower bound of the values of a parameter.
    """
    if objective.kind == "modules":
        return dict.fromkeys(program.modules, Fraction(1))
    if objective.kind != "sum":
        return None
    weights = dict[str, Fraction]()
    for name, amount in objective.amounts:
        parameters = program.modules[name].parameters
        weights[name] = (
            amount
            if amount is not None
            else least(next(each.domain for each in parameters if each.name == objective.attribute))
        )
    return weights
