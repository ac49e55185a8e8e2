"""What searches of parameters are compared on: functions over the unit cube, to be maximised."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from compiler.arrays import Array
from solvers.parameters.parameter_search import Halton

SHARE = 0.95
"""A search is to reach so much of the best known value."""
NOISE = 0.01
"""The deviation of the noise, in units of the best value."""
SHIFT = 0.25
"""The optimum of a test function lies anywhere within so much of the centre of the cube."""
POINTS = 4096


def rastrigin(x: Array) -> Array:
    """Rastrigin (1974) on [-5.12, 5.12]^p, turned round: 0 at the origin; points (..., p)."""
    z = 10.24 * x
    return np.asarray(-np.sum(10 + z**2 - 10 * np.cos(2 * np.pi * z), axis=-1))


def ackley(x: Array) -> Array:
    """Ackley (1987) on [-5, 5]^p, turned round: 0 at the origin; points (..., p)."""
    z = 10 * x
    bowl = 20 * np.exp(-0.2 * np.sqrt(np.mean(z**2, axis=-1)))
    waves = np.exp(np.mean(np.cos(2 * np.pi * z), axis=-1))
    return np.asarray(bowl + waves - 20 - np.e)


@dataclass(frozen=True)
class Objective:
    """A function of the cube with its best known value and the value that a search is to reach.

    A ``function`` of displacements from the optimum, at ``centre``, or the multilinear
    interpolation of a ``table`` over the cube.  ``lift`` is added to a function: its worst value is
    0 then, since what is negative counts as infeasible.
    """

    name: str
    dimension: int
    budget: int
    best: float
    noise: float = 0.0
    function: Callable[[Array], Array] | None = None
    table: Array | None = None
    centre: tuple[float, ...] = ()
    lift: float = 0.0

    @property
    def target(self) -> float:
        """The value that is to be reached."""
        return SHARE * self.best

    def value(self, point: Array) -> float:
        """The value without noise."""
        if self.table is not None:
            return interpolated(self.table, point)
        assert self.function is not None
        return float(self.function(point - np.array(self.centre))) + self.lift

    def of_seed(self, seed: int) -> Objective:
        """The same with its optimum elsewhere; a table stays as it is."""
        if self.function is None:
            return self
        shift = np.random.default_rng([seed, self.dimension]).uniform(-SHIFT, SHIFT, self.dimension)
        return replace(self, centre=tuple(0.5 + shift))


def lifted(name: str, function: Callable[[Array], Array], p: int, budget: int) -> Objective:
    """A noisy test function in p axes."""
    # What is farthest from the optimum, wherever that is.
    points = (1 + 2 * SHIFT) * (Halton(p, 0).points(0, POINTS) - 0.5)
    lift = -float(np.min(function(points)))
    title = f"noisy {name}, {p}-D"
    return Objective(title, p, budget, lift, NOISE * lift, function, None, (0.5,) * p, lift)


def robustness_table(name: str, table: Array, budget: int) -> Objective:
    """The robustness by a table."""
    best = float(np.max(table))
    if best <= 0:
        raise SystemExit(f"{name}: nothing in the table is feasible; make a finer one")
    return Objective(name, table.ndim, budget, best, table=table)


def interpolated(table: Array, point: Array) -> float:
    """The multilinear interpolation of a table (n, ..., n) over the unit cube."""
    for coordinate in point:
        place = coordinate * (len(table) - 1)
        first = min(int(place), len(table) - 2)
        share = place - first
        table = (1 - share) * table[first] + share * table[first + 1]
    return float(table)
