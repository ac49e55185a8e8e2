"""The equations of motion linearised along a path, and linear systems with the mass matrix."""

from __future__ import annotations

from dataclasses import dataclass

from flint import arb, arb_mat

Coefficients = list[arb]


@dataclass(frozen=True, slots=True)
class Linearisation:
    """Series of N and R in time: N(t) de_w/dt = R(t) e for small deviations e of the state.

    N = diag(M, 1), shape (n + r, n + r), and R, shape (n + r, 2n + r), one matrix per power.
    """

    inertia: list[arb_mat]
    slopes: list[arb_mat]


class InertiaMatrix:
    """Solves systems with an interval matrix, preconditioned by the inverse of its midpoint."""

    def __init__(self, matrix: arb_mat) -> None:
        self._inverse = matrix.mid().inv().mid()
        self._near_identity = self._inverse * matrix

    def solve(self, right: arb_mat) -> arb_mat:
        """An enclosure of all solutions; ZeroDivisionError if the matrix may be singular."""
        return self._near_identity.solve(self._inverse * right, algorithm="lu")
