"""The robustness of signal temporal logic on dense samples, formula by formula in numpy.

Windows are cut off at the end: of nothing an infimum is +inf and a supremum -inf.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from fractions import Fraction

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view

from compiler.arrays import Array
from compiler.tasks.monitor import AtomKey
from grammar_lang import ir


def robustness(
    formula: ir.Formula, depths: Mapping[AtomKey, Array], rate: Fraction, step: Fraction
) -> Array:
    """The robustness at every sample.

    Args:
        formula: all its times are multiples of 1 / ``rate``.
        depths: the signed distances of the atoms, positive inside.
        rate: samples a second.
        step: how much later ``next`` is, s.
    """

    def of(part: ir.Formula) -> Array:
        return robustness(part, depths, rate, step)

    match formula:
        case ir.Atom(region=region, effector=effector, poses=poses):
            return depths[AtomKey(region, effector, poses)]
        case ir.Not(operand=part):
            return -of(part)
        case ir.And(operands=parts):
            return np.min([of(part) for part in parts], axis=0)
        case ir.Or(operands=parts):
            return np.max([of(part) for part in parts], axis=0)
        case ir.Implies(left=left, right=right):
            return np.maximum(-of(left), of(right))
        case _:
            return _in_time(formula, of, rate, step)


def _in_time(
    formula: ir.Formula, of: Callable[[ir.Formula], Array], rate: Fraction, step: Fraction
) -> Array:
    match formula:
        case ir.Until(left=left, right=right):
            return _until(of(left), of(right))
        case ir.Always(operand=part, window=window):
            return -_highest(-of(part), window, rate)
        case ir.Eventually(operand=part, window=window):
            return _highest(of(part), window, rate)
        case ir.Next(operand=part):
            return _highest(of(part), ir.Window(step, step), rate)
        case ir.Last(operand=part, duration=duration):
            values = of(part)
            first = max(0, len(values) - 1 - int(duration * rate))
            return np.full(len(values), values[first:].min())
        case _:
            raise TypeError(formula)


def _highest(values: Array, window: ir.Window, rate: Fraction) -> Array:
    count = len(values)
    upper = count if window.upper is None else int(window.upper * rate)
    lower = min(int(window.lower * rate), count)
    upper = max(lower, min(upper, count))
    padded = np.concatenate([values, np.full(upper + 1, -np.inf)])[lower:]
    found: Array = sliding_window_view(padded, upper - lower + 1).max(axis=1)[:count]
    return found


def _until(left: Array, right: Array) -> Array:
    found = right.copy()
    for i in range(len(found) - 2, -1, -1):
        found[i] = max(right[i], min(left[i], found[i + 1]))
    return found
