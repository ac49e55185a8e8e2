"""The demands of `carry` on the samples of a motion, and the samples at which loads are present."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from fractions import Fraction

import numpy as np

from compiler.arrays import Array
from compiler.tasks.word_formula import (
    Literal,
    Obligation,
    SampledFormula,
    eventually,
    every,
)
from grammar_lang import ir

# --- For a search ---------------------------------------------------------------------------------


def carried_on_samples(task: ir.Task) -> list[SampledFormula]:
    """For each load: the effector is in one region at a sample, and in the other at a later one."""
    return [_carried(number, carry) for number, carry in enumerate(task.carries)]


def _carried(number: int, carry: ir.Carry) -> SampledFormula:
    effector = carry.effector or 1
    taken = Literal(carry.source, effector, positive=True, transfer=(number, True))
    put_down = Literal(carry.target, effector, positive=True, transfer=(number, False))
    return eventually(every([taken, eventually(put_down, 1, None)]), 0, None)


def carried_samples(obligations: Iterable[Obligation], count: int) -> list[tuple[int, int]]:
    """For each of ``count`` loads the samples at which a plan picks it up and puts it down.

    A load that the plan does not mention is never present: (0, 0).
    """
    found = [[0, 0] for _ in range(count)]
    for each in obligations:
        if each.transfer is not None:
            load, taken = each.transfer
            found[load][0 if taken else 1] = each.first
    return [(first, last) for first, last in found]


def load_inputs(samples: Sequence[tuple[int, int]], steps: int) -> Array:
    """The inputs that say which loads are present, 1 or 0 for each step, (steps, loads)."""
    step = np.arange(steps)
    columns = [(step >= first) & (step < last) for first, last in samples]
    return np.array(columns, dtype=float).reshape(len(columns), steps).T


# --- For a given motion ---------------------------------------------------------------------------


def transfer_of(column: Sequence[Fraction]) -> tuple[int, int] | None:
    """The samples at which the load with these input values (k,) is picked up and put down.

    None unless the input is 1 in consecutive steps and 0 in all others.
    """
    there = [step for step, value in enumerate(column) if value == 1]
    if not there or any(value not in (0, 1) for value in column):
        return None
    first, last = there[0], there[-1] + 1
    return (first, last) if len(there) == last - first else None
