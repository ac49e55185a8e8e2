"""What `carry` asks of the samples of a motion, and at which of them loads are there."""

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
    """Per load: the effector is in the one region at a sample, and in the other at a later one."""
    return [_carried(number, carry) for number, carry in enumerate(task.carries)]


def _carried(number: int, carry: ir.Carry) -> SampledFormula:
    effector = carry.effector or 1
    taken = Literal(carry.source, effector, positive=True, transfer=(number, True))
    put_down = Literal(carry.target, effector, positive=True, transfer=(number, False))
    return eventually(every([taken, eventually(put_down, 1, None)]), 0, None)


def carried_samples(obligations: Iterable[Obligation], count: int) -> list[tuple[int, int]]:
    """Per load of ``count`` the samples at which a plan takes it up and puts it down.

    A load that a plan says nothing of is there at no step: (0, 0).
    """
    found = [[0, 0] for _ in range(count)]
    for each in obligations:
        if each.transfer is not None:
            load, taken = each.transfer
            found[load][0 if taken else 1] = each.first
    return [(first, last) for first, last in found]


def load_inputs(samples: Sequence[tuple[int, int]], steps: int) -> Array:
    """The inputs that say which loads are there, 1 or 0, step by step, (steps, loads)."""
    step = np.arange(steps)
    columns = [(step >= first) & (step < last) for first, last in samples]
    return np.array(columns, dtype=float).reshape(len(columns), steps).T


# --- Of a motion that is given --------------------------------------------------------------------


def transfer_of(column: Sequence[Fraction]) -> tuple[int, int] | None:
    """The samples at which a load is taken up and put down whose input has these values (k,).

    None where the input is not 1 in some steps that follow each other, and else 0.
    """
    there = [step for step, value in enumerate(column) if value == 1]
    if not there or any(value not in (0, 1) for value in column):
        return None
    first, last = there[0], there[-1] + 1
    return (first, last) if len(there) == last - first else None
