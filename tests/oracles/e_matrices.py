r"""The paper's E-matrix form of Example 3: point masses L_i at the tips, absolute angles.

.. math:: M = E_2^T E_2, \quad C = E_2^T E_1 + \dot E_2^T E_2 + E_2^T \dot E_2 - E_1^T E_2, \quad
    K = \dot E_2^T E_1 + E_2^T \dot E_1 - E_1^T E_1, \quad
    F = \dot E_2^T E_0 + E_2^T \dot E_0 - E_1^T E_0

where a product of two of them is the sum over the tips n of L_n [E_nk]^T [E_nl], and E_0, E_1, E_2
are the velocity of a tip, and what perturbed angles and rates add to it.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from compiler.arrays import Array


@dataclass(frozen=True)
class EMatrices:
    """Links of given lengths at angles with rates and accelerations, each (n,).

    ``printed`` keeps the first row of E_2 as it is printed: ``L2 cos q02`` instead of
    ``-L2 sin q02`` (row 4.4 of the errata).
    """

    lengths: Array
    angles: Array
    rates: Array
    accelerations: Array
    printed: bool = False

    def _tips(self, entries: Array) -> Array:
        """Columns (2, n) for one vector per link, to (tips, 2, n): a link moves the tips after."""
        n = len(self.lengths)
        return np.tril(np.ones((n, n)))[:, None, :] * entries[None, :, :]

    def _e2(self) -> Array:
        entries = self.lengths * np.array([-np.sin(self.angles), np.cos(self.angles)])
        if self.printed:
            entries[0, 1] = self.lengths[1] * np.cos(self.angles[1])
        return self._tips(entries)

    def _e2_rate(self) -> Array:
        entries = np.array([-np.cos(self.angles), -np.sin(self.angles)])
        if self.printed:
            entries[0, 1] = -np.sin(self.angles[1])
        return self._tips(self.lengths * self.rates * entries)

    def _e1(self) -> Array:
        unit = np.array([-np.cos(self.angles), -np.sin(self.angles)])
        return self._tips(self.lengths * self.rates * unit)

    def _e1_rate(self) -> Array:
        unit = np.array([-np.cos(self.angles), -np.sin(self.angles)])
        turned = np.array([np.sin(self.angles), -np.cos(self.angles)])
        entries = self.accelerations * unit + self.rates**2 * turned
        return self._tips(self.lengths * entries)

    def _e0(self) -> Array:
        unit = np.array([-np.sin(self.angles), np.cos(self.angles)])
        return self._tips(self.lengths * self.rates * unit).sum(axis=2, keepdims=True)

    def _e0_rate(self) -> Array:
        unit = np.array([-np.sin(self.angles), np.cos(self.angles)])
        turned = np.array([-np.cos(self.angles), -np.sin(self.angles)])
        entries = self.accelerations * unit + self.rates**2 * turned
        return self._tips(self.lengths * entries).sum(axis=2, keepdims=True)

    def _product(self, left: Array, right: Array) -> Array:
        return np.asarray(np.einsum("t,tdi,tdj->ij", self.lengths, left, right))

    def mass(self) -> Array:
        return self._product(self._e2(), self._e2())

    def damping(self) -> Array:
        e1, e2, rate = self._e1(), self._e2(), self._e2_rate()
        found = self._product(e2, e1) + self._product(rate, e2)
        return np.asarray(found + self._product(e2, rate) - self._product(e1, e2))

    def stiffness(self) -> Array:
        e1 = self._e1()
        found = self._product(self._e2_rate(), e1) + self._product(self._e2(), self._e1_rate())
        return np.asarray(found - self._product(e1, e1))

    def bias(self) -> Array:
        e0 = self._e0()
        found = self._product(self._e2_rate(), e0) + self._product(self._e2(), self._e0_rate())
        return np.asarray(found - self._product(self._e1(), e0))[:, 0]
