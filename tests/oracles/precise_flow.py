"""The motion of a chain of uniform rods at 40 digits: extrapolation on the hand-written formula.

Gragg's modified midpoint rule with 2, 4, 6, ... substeps, extrapolated in h^2 (Bulirsch and Stoer;
Hairer, Norsett & Wanner, *Solving Ordinary Differential Equations I*, II.9).
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TypeAlias

import mpmath as mp

Vector: TypeAlias = list[mp.mpf]
DIGITS = 40
COLUMNS = 13


def chain_slope(state: Vector, u: Vector, lengths: Vector, pull: Sequence[mp.mpf]) -> Vector:
    """Rates and accelerations of n rods of unit density, in relative angles."""
    n = len(u)
    phi = [mp.fsum(state[: i + 1]) for i in range(n)]
    rate = [mp.fsum(state[n : n + i + 1]) for i in range(n)]
    right = []
    matrix = mp.matrix(n)
    for i in range(n):
        beyond = mp.fsum(lengths[i + 1 :])
        moment = lengths[i] * (lengths[i] / 2 + beyond)
        # The torque on absolute angle i is u_i - u_(i+1).
        total = u[i] - (u[i + 1] if i + 1 < n else 0)
        total += moment * (pull[1] * mp.cos(phi[i]) - pull[0] * mp.sin(phi[i]))
        for j in range(n):
            last = max(i, j)
            c = lengths[i] * lengths[j] * mp.fsum(lengths[last + 1 :])
            c += lengths[i] ** 3 / 3 if i == j else lengths[last] * lengths[i] * lengths[j] / 2
            matrix[i, j] = c * mp.cos(phi[i] - phi[j])
            total -= c * mp.sin(phi[i] - phi[j]) * rate[j] ** 2
        right.append(total)
    absolute = list(mp.lu_solve(matrix, mp.matrix(right)))
    relative = [absolute[0], *(absolute[i] - absolute[i - 1] for i in range(1, n))]
    return [*state[n:], *relative]


def chain_flow(
    state: Vector, u: Vector, lengths: Vector, pull: Sequence[mp.mpf], time: mp.mpf
) -> Vector:
    """The state after a time of at most about 0.2 s, u held."""

    def slope(x: Vector) -> Vector:
        return chain_slope(x, u, lengths, pull)

    def along(x: Vector, d: Vector, h: mp.mpf) -> Vector:
        return [a + h * b for a, b in zip(x, d, strict=True)]

    first = slope(state)
    table: list[Vector] = []
    for column in range(COLUMNS):
        steps = 2 * (column + 1)
        h = time / steps
        before, current = state, along(state, first, h)
        for _ in range(steps - 1):
            before, current = current, along(before, slope(current), 2 * h)
        row = current
        row = [(a + b + h * c) / 2 for a, b, c in zip(current, before, slope(current), strict=True)]
        fresh = [row]
        for k in range(column):
            ratio = mp.mpf(steps) / (2 * (column - k))
            row = [a + (a - b) / (ratio**2 - 1) for a, b in zip(fresh[k], table[k], strict=True)]
            fresh.append(row)
        table = fresh
    return table[-1]
