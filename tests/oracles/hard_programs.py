"""A convex program that keeps any interior-point method busy for minutes."""

from __future__ import annotations

import numpy as np
from scipy.sparse import csc_matrix

from solvers.backends.conic import ConvexProgram

ROWS, ENTRIES = 6000, 6


def hard_program() -> ConvexProgram:
    """A random pattern of 6 entries a row, whose factors are nearly dense: 6000^3 operations each.

    With 1,500 unknowns instead of 6,000, PIQP takes 3.6 s, and 64 times that here.
    """
    rng = np.random.default_rng(0)
    size = ROWS * ENTRIES
    entries = np.repeat(np.arange(ROWS), ENTRIES), rng.integers(0, ROWS, size)
    one = np.ones(ROWS)
    return ConvexProgram(
        one, rng.normal(size=ROWS), csc_matrix((0, ROWS)), np.zeros(0),
        csc_matrix((rng.normal(size=size), entries), shape=(ROWS, ROWS)), one, -one, one,
    )  # fmt: skip
