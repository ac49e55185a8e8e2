r"""Values as a Gaussian process sees them: those that are low compressed, then standardised.

A value of 0 or more is a robustness, a value below 0 minus a violation.  At the boundary of the
feasible the values jump, and there are huge violations; a process that has to explain these has
little left for the differences at the top.  So, with m the median of the feasible values (of all,
where none is feasible) and s the distance of the largest value from it, a value v below m becomes

.. math:: m - s \bigl(\tfrac12 (1 - e^{-2l}) + \tfrac1{10} \ln(1 + l)\bigr), \qquad l = (m - v)/s.

This is strictly monotone, so that violations still lead to the feasible, and free of units.  It was
chosen by measurement, see docs/decisions/0030-parameter-searches.md.
"""

from __future__ import annotations

import numpy as np

from compiler.arrays import Array

BEND = 0.5
TAIL = 0.1
LARGEST = 1e150
"""Larger values are taken for this, so that no sum of squares overflows."""


def compressed(values: Array) -> Array:
    """The values (m,), those below the middle of the feasible ones compressed."""
    values = np.clip(values, -LARGEST, LARGEST)
    feasible = values[values >= 0]
    middle = float(np.median(feasible if len(feasible) else values))
    spread = float(np.max(values)) - middle
    if spread <= 0:
        spread = float(np.median(np.abs(values - middle)))
    if spread <= 0:
        return values
    loss = np.maximum(middle - values, 0.0) / spread
    bent = BEND * -np.expm1(-loss / BEND) + TAIL * np.log1p(loss)
    return np.where(loss > 0, middle - spread * bent, values)


def standardised(values: Array) -> Array:
    """The compressed values (m,) with mean 0 and deviation 1; 0 where all are equal."""
    level = compressed(values)
    largest = float(np.max(np.abs(level)))
    level = level / (largest if largest > 0 else 1.0)
    level = level - level.mean()
    deviation = float(level.std())
    # Where all values are equal, what is left is rounding.
    return level / deviation if deviation > 1e-12 else np.zeros_like(level)
