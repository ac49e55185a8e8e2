r"""Lagrange's equations of a cloud of point masses, from their positions alone.

With positions p_i(q), a rigid body being a few points of it with the same mass, com and inertia,

.. math:: T = \tfrac12 \sum_i m_i |J_i \dot q|^2, \quad
    c = \dot M \dot q - \partial_q T, \quad g = -\sum_i m_i J_i^T \gamma .

The Jacobians J_i come from complex steps (exact to rounding), the derivatives of T from central
differences.  No rotation, frame or inertia of the compiler is used.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from compiler.arrays import Array

Positions = Callable[[NDArray[np.complex128]], NDArray[np.complex128]]


@dataclass(frozen=True)
class PointCloud:
    """Masses (N,) and their positions (N, d) as a function of q that takes complex q."""

    masses: Array
    positions: Positions

    def jacobian(self, q: Array) -> Array:
        """Shape (N, d, n)."""
        h = 1e-30
        columns = []
        for j in range(len(q)):
            shifted = q.astype(np.complex128)
            shifted[j] += 1j * h
            columns.append(self.positions(shifted).imag / h)
        return np.stack(columns, axis=-1)

    def mass_matrix(self, q: Array) -> Array:
        jacobian = self.jacobian(q)
        return np.einsum("i,idn,idm->nm", self.masses, jacobian, jacobian)

    def kinetic(self, q: Array, v: Array) -> float:
        return float(v @ self.mass_matrix(q) @ v / 2)

    def coriolis(self, q: Array, v: Array, h: float = 1e-4) -> Array:
        def once(h: float) -> Array:
            rate = (self.mass_matrix(q + h * v) - self.mass_matrix(q - h * v)) / (2 * h)
            gradient = [
                (self.kinetic(q + h * e, v) - self.kinetic(q - h * e, v)) / (2 * h)
                for e in np.eye(len(q))
            ]
            return np.asarray(rate @ v - np.array(gradient))

        return np.asarray((4 * once(h / 2) - once(h)) / 3)

    def gravity(self, q: Array, pull: Sequence[float]) -> Array:
        weights = np.asarray(pull)
        jacobian = self.jacobian(q)[:, : len(weights)]
        return np.asarray(-np.einsum("i,idn,d->n", self.masses, jacobian, weights))


def rod_points(
    base: NDArray[np.complex128], tip: NDArray[np.complex128]
) -> list[NDArray[np.complex128]]:
    """The two Gauss points of a rod, half its mass each: exact for what is quadratic along it."""
    offset = 0.5 / np.sqrt(3.0)
    return [base + (tip - base) * s for s in (0.5 - offset, 0.5 + offset)]
