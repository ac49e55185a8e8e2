r"""Simulated annealing (Kirkpatrick, Gelatt and Vecchi 1983): Gaussian moves, geometric cooling.

A worse point is accepted with probability exp(-loss / (T s)), where s is the median distance of the
values so far from their median, so that the unit of the function does not matter and a few huge
losses neither.  The moves shrink with the temperature and are reflected at the boundary of the
cube; when all is cold, the search is heated again at the best point.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from compiler.arrays import Array
from solvers.parameters.searches.parameter_search import Record

HOT = 1.0
COOLING = 0.95
COLD = 0.01
STRIDE = 0.3
"""The standard deviation of a move at temperature 1, in units of the cube; it goes as sqrt(T)."""


@dataclass(slots=True)
class _Trial:
    """The luck of a move, drawn when it is proposed."""

    luck: float
    temperature: float


@dataclass(slots=True)
class SimulatedAnnealing:
    """Begins at the best initial point; points asked for at once are all moves from one place."""

    seed: int
    _place: Array | None = None
    _value: float = 0.0
    _best: tuple[Array, float] | None = None
    _temperature: float = HOT
    _trials: list[_Trial] = field(default_factory=list[_Trial])
    _seen: list[float] = field(default_factory=list[float])
    _rng: np.random.Generator = field(init=False)

    def __post_init__(self) -> None:
        self._rng = np.random.default_rng(self.seed)

    def propose(self, count: int, record: Record) -> list[Array]:
        """Moves from the present place."""
        if self._place is None:
            best = record.best()
            self._place, self._value = record.points[best], record.values[best]
            self._best = self._place, self._value
            self._seen = list(record.values)
        return [self._move(self._place) for _ in range(count)]

    def _move(self, place: Array) -> Array:
        if self._temperature < COLD and self._best is not None:
            self._temperature = HOT
            (self._place, self._value), place = self._best, self._best[0]
        stride = STRIDE * np.sqrt(self._temperature)
        moved = place + stride * self._rng.normal(size=place.shape)
        self._trials.append(_Trial(float(self._rng.uniform()), self._temperature))
        self._temperature *= COOLING
        return reflected(moved)

    def learn(self, point: Array, value: float) -> None:
        """Accept a move or not."""
        trial = self._trials.pop(0)
        self._seen.append(value)
        spread = float(np.median(np.abs(np.array(self._seen) - np.median(self._seen))))
        gain = value - self._value
        worth = trial.temperature * spread
        if gain >= 0 or (worth > 0 and trial.luck < np.exp(gain / worth)):
            self._place, self._value = point, value
        if self._best is None or value > self._best[1]:
            self._best = point, value


def reflected(points: Array) -> Array:
    """Points folded back into the unit cube at its faces."""
    folded = np.mod(points, 2.0)
    return np.where(folded > 1.0, 2.0 - folded, folded)
