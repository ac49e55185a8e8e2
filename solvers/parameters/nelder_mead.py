r"""The simplex method of Nelder and Mead (1965) in the unit cube, with restarts.

The coefficients for p axes are those of Gao and Han ("Implementing the Nelder-Mead simplex
algorithm with adaptive parameters", 2012), p at least 2:

.. math:: \rho = 1, \quad \chi = 1 + 2/p, \quad \gamma = 3/4 - 1/(2p), \quad \sigma = 1 - 1/p.

Steps that leave the cube end at its boundary.  A simplex that has become small or flat is
abandoned; the next one is as large as the first, about a new random point.
"""

from __future__ import annotations

from collections.abc import Generator
from dataclasses import dataclass, field

import numpy as np

from compiler.arrays import Array
from solvers.parameters.parameter_search import Record

EDGE = 0.25
"""The initial edge length of a simplex, in units of the cube, pointing inwards."""
SMALL = 1e-3
"""A simplex is abandoned if all vertices are this close to its best one."""
FLAT = 1e-9
"""A simplex is also abandoned if its values differ by no more, relative to the largest."""

Steps = Generator[list[Array], list[float], None]
"""Yields points and is sent their values."""


@dataclass(slots=True)
class NelderMead:
    """Starts at the best initial point; proposes single points, except for new simplices."""

    seed: int
    small: float = SMALL
    _steps: Steps | None = None
    _queue: list[Array] = field(default_factory=list[Array])
    _waiting: int = 0
    _values: list[float] = field(default_factory=list[float])

    def propose(self, count: int, record: Record) -> list[Array]:
        """The next points (p,) of the simplex method in the cube."""
        if self._steps is None:
            best = record.best()
            self._steps = self._search(record.points[best], record.values[best])
            self._expect(next(self._steps))
        taken, self._queue = self._queue[:count], self._queue[count:]
        return taken

    def learn(self, point: Array, value: float) -> None:
        """Store the value of a point (p,); continue once all values of a step are known."""
        self._values.append(value)
        if self._steps is not None and len(self._values) == self._waiting:
            self._expect(self._steps.send(self._values))

    def _expect(self, points: list[Array]) -> None:
        self._queue, self._waiting, self._values = list(points), len(points), []

    def _search(self, point: Array, value: float | None) -> Steps:
        """Run simplices from one start after another."""
        rng = np.random.default_rng(self.seed)
        while True:
            if value is None:
                (value,) = yield [point]
            yield from _descent(point, value, self.small)
            point, value = rng.uniform(size=point.shape), None


def _descent(start: Array, value: float, small: float) -> Steps:
    """One simplex until it is small or flat; ``values`` (p + 1,) are kept in descending order."""
    p = len(start)
    edges = EDGE * np.diag(np.where(start <= 0.5, 1.0, -1.0))
    simplex = np.concatenate([start[None], start + edges])
    values = np.array([value, *(yield list(simplex[1:]))])
    # With one axis the formulas would shrink the simplex to a point.
    axes = max(p, 2)
    grow, shorten, shrink = 1 + 2 / axes, 0.75 - 1 / (2 * axes), 1 - 1 / axes
    while True:
        order = np.argsort(-values, kind="stable")
        simplex, values = simplex[order], values[order]
        flat = values[0] - values[-1] <= FLAT * np.max(np.abs(values))
        if flat or np.max(np.abs(simplex - simplex[0]), initial=0.0) <= small:
            return
        centre = simplex[:-1].mean(axis=0)
        away = centre - simplex[-1]
        point = _inside(centre + away)
        (found,) = yield [point]
        if found > values[0]:
            farther = _inside(centre + grow * away)
            (other,) = yield [farther]
            if other > found:
                point, found = farther, other
        elif found <= values[-2]:
            outside = found > values[-1]
            point = _inside(centre + (shorten if outside else -shorten) * away)
            least = found if outside else values[-1]
            (found,) = yield [point]
            if found < least or (found == least and not outside):
                simplex[1:] = simplex[0] + shrink * (simplex[1:] - simplex[0])
                values[1:] = yield list(simplex[1:])
                continue
        simplex[-1], values[-1] = point, found


def _inside(point: Array) -> Array:
    return np.clip(point, 0.0, 1.0)
