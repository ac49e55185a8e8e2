"""Where the unknowns of a convex step live in one vector z: motion, parameters, scalars, slacks."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

Indices: TypeAlias = NDArray[np.int64]


@dataclass(frozen=True, slots=True)
class StepLayout:
    """``n`` coordinates, states of ``width`` entries, ``m`` inputs, ``k`` steps, ``p`` parameters.

    ``fictitious`` says whether there are fictitious inputs v and their bound V; ``slacks``, whether
    each step has a slack g of its own.
    """

    n: int
    width: int
    m: int
    k: int
    p: int
    fictitious: bool
    slacks: bool

    @property
    def x(self) -> Indices:
        """States, (k + 1, width)."""
        return np.arange((self.k + 1) * self.width).reshape(self.k + 1, self.width)

    @property
    def u(self) -> Indices:
        """Inputs, (k, m)."""
        return self._after_x + np.arange(self.k * self.m).reshape(self.k, self.m)

    @property
    def v(self) -> Indices:
        """Fictitious inputs, (k, width), or (0, width)."""
        rows = self.k if self.fictitious else 0
        return self._after_u + np.arange(rows * self.width).reshape(rows, self.width)

    @property
    def theta(self) -> Indices:
        """Parameters that are unknowns, (p,)."""
        return self._after_v + np.arange(self.p)

    @property
    def sigma(self) -> int:
        """The position slack in metres."""
        return self._after_v + self.p

    @property
    def rho(self) -> int:
        """The margin of the inputs."""
        return self._after_v + self.p + 1

    @property
    def largest(self) -> int:
        """V, the bound of the fictitious inputs; only where there are any."""
        return self._after_v + self.p + 2

    @property
    def g(self) -> Indices:
        """One slack per step, (k,) or (0,)."""
        rows = self.k if self.slacks else 0
        return self._after_v + self.p + 2 + int(self.fictitious) + np.arange(rows)

    @property
    def size(self) -> int:
        """The number of unknowns."""
        slacks = self.k if self.slacks else 0
        return self._after_v + self.p + 2 + int(self.fictitious) + slacks

    @property
    def _after_x(self) -> int:
        return (self.k + 1) * self.width

    @property
    def _after_u(self) -> int:
        return self._after_x + self.k * self.m

    @property
    def _after_v(self) -> int:
        return self._after_u + (self.k * self.width if self.fictitious else 0)
