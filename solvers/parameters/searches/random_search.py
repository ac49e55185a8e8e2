"""Random search: points drawn uniformly; what every other method has to beat."""

from __future__ import annotations

import numpy as np

from compiler.arrays import Array
from solvers.parameters.searches.parameter_search import Record


class RandomSearch:
    """Independent points, uniform in the cube (Bergstra and Bengio 2012)."""

    def __init__(self, seed: int) -> None:
        self._rng = np.random.default_rng(seed)

    def propose(self, count: int, record: Record) -> list[Array]:
        """So many points."""
        return list(self._rng.uniform(size=(count, record.cube.dimension)))

    def learn(self, point: Array, value: float) -> None:
        """Nothing is learnt."""
