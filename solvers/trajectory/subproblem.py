"""The convex subproblem of one step: its specification, the layout of its unknowns, its result."""

from __future__ import annotations

from dataclasses import dataclass
from math import log10
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from compiler.arrays import Array
from solvers.trajectory.task_limits import InputGroup, MotionLimits, effort_scale
from solvers.trajectory.trajectory import Trajectory

# --- The specification of a convex step and its result --------------------------------------------


LEAST = 0.1
"""Parameters smaller than this move as if they were of this size, in SI."""


@dataclass(frozen=True, slots=True)
class Weights:
    """Penalties of the convex step: per unit of effort (V), per metre (sigma), on squares.

    Squares of inputs are in units of the largest margin; ``regular`` applies to every other unknown
    and regularises the program.  ``rates`` is the price of the squares of all rates, in SI, and
    ``mobility`` that of the linearised phi at every sample.  ``parameters`` (p,) are the prices of
    the parameters, in SI; empty if they have none.
    """

    fictitious: float = 20.0
    position: float = 2000.0
    quadratic: float = 1e-4
    regular: float = 1e-9
    rates: float = 0.0
    mobility: float = 0.0
    parameters: tuple[float, ...] = ()


@dataclass(frozen=True, slots=True)
class TrustRegion:
    """The region in which a linearisation is trusted.

    ``radius`` bounds the moves of coordinates (rad or m) and the relative moves of parameters;
    ``proximal`` is the price of their squares.
    """

    radius: float
    proximal: float = 0.0


@dataclass(frozen=True, slots=True)
class SubproblemSpec:
    """The data that the convex steps of an iteration have in common.

    With ``epsilon`` every step has its own slack under C.6; ``unit`` is the unit of length (m).
    """

    limits: MotionLimits
    groups: tuple[InputGroup, ...]
    theta_box: tuple[Array, Array] | None
    weights: Weights
    epsilon: float | None = None
    unit: float = 1.0

    @property
    def scale(self) -> float:
        """The unit of effort."""
        return effort_scale(self.groups)

    @property
    def sizes(self) -> tuple[float, float]:
        """The unit of length, and the power of 1000 by which efforts are scaled in programs."""
        return self.unit, 1000.0 ** round(log10(self.scale) / 3)


@dataclass(frozen=True, slots=True)
class StepResult:
    """The optimum of a convex step.

    ``fictitious`` (k, N) are the fictitious inputs and ``largest_fictitious`` is V; these and the
    ``margin`` are in units of effort, ``position_slack`` is sigma in metres.
    """

    trajectory: Trajectory
    fictitious: Array
    largest_fictitious: float
    position_slack: float
    margin: float


# --------------------------------------------------------------------------------------------------
# The layout of a convex step's unknowns in one vector z: motion, parameters, scalars, slacks.


Indices: TypeAlias = NDArray[np.int64]


@dataclass(frozen=True, slots=True)
class StepLayout:
    """``n`` coordinates, states of ``width`` entries, ``m`` inputs, ``k`` steps, ``p`` parameters.

    ``fictitious`` says whether there are fictitious inputs v and their bound V; ``slacks``, whether
    each step has its own slack g.
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
        """V, the bound on the fictitious inputs; valid only if there are any."""
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
