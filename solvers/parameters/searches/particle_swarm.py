r"""Particle swarm with the constriction factor of Clerc and Kennedy (2002), best of all known.

.. math::
    v \gets \chi (v + \varphi r_1 (b - x) + \varphi r_2 (g - x)), \qquad x \gets x + v,

with chi = 0.7298 and phi = 2.05; b is the best point of the particle, g that of the swarm.  A
particle that would leave the cube stops at its boundary, and that component of its velocity is
lost (the "standard" of Bratton and Kennedy 2007).
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from compiler.arrays import Array
from solvers.parameters.searches.parameter_search import Record

PULL = 2.05
CONSTRICTION = 2 / (2 * PULL - 2 + np.sqrt((2 * PULL) ** 2 - 8 * PULL))
PARTICLES = 10


@dataclass(slots=True)
class ParticleSwarm:
    """The initial points are the swarm; a generation is asked for at once, as far as wanted."""

    seed: int
    _places: Array = field(default_factory=lambda: np.zeros((0, 0)))
    _speeds: Array = field(default_factory=lambda: np.zeros((0, 0)))
    _bests: Array = field(default_factory=lambda: np.zeros((0, 0)))
    _worth: Array = field(default_factory=lambda: np.zeros(0))
    _asked: int = 0
    _told: int = 0
    _rng: np.random.Generator = field(init=False)

    def __post_init__(self) -> None:
        self._rng = np.random.default_rng(self.seed)

    def propose(self, count: int, record: Record) -> list[Array]:
        """The next particles of the generation."""
        if not len(self._places):
            self._begin(record)
        if self._told == len(self._worth):
            self._move()
        taken = self._places[self._asked : self._asked + count]
        self._asked += len(taken)
        return list(taken.copy())

    def learn(self, point: Array, value: float) -> None:
        """A particle remembers its best point."""
        if value > self._worth[self._told]:
            self._bests[self._told], self._worth[self._told] = point, value
        self._told += 1

    def _begin(self, record: Record) -> None:
        """Half the way to a random point is the first velocity (Clerc 2006)."""
        places, worth = np.array(record.points), np.array(record.values)
        # In an order of their own, since values may have come in any.
        order = np.lexsort(places.T) if places.shape[1] else np.arange(len(places))
        self._places, self._worth = places[order], worth[order]
        self._bests = self._places.copy()
        self._speeds = (self._rng.uniform(size=self._places.shape) - self._places) / 2
        self._told = len(self._worth)

    def _move(self) -> None:
        """A new generation."""
        places, shape = self._places, self._places.shape
        leader = self._bests[int(np.argmax(self._worth))]
        own, common = PULL * self._rng.uniform(size=(2, *shape))
        pulls = own * (self._bests - places) + common * (leader - places)
        self._speeds = CONSTRICTION * (self._speeds + pulls)
        moved = places + self._speeds
        self._places = np.clip(moved, 0.0, 1.0)
        self._speeds[moved != self._places] = 0.0
        self._asked = self._told = 0
