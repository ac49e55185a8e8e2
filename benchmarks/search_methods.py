r"""The searches that GP-ACB is compared with, and all that are compared, by name.

**GP-UCB** (Srinivas et al. 2010): the rule of GP-ACB with eta = 1 everywhere.

**Particle swarm** with the constriction factor of Clerc and Kennedy (2002), best of all known.

.. math::
    v \gets \chi (v + \varphi r_1 (b - x) + \varphi r_2 (g - x)), \qquad x \gets x + v,

with chi = 0.7298 and phi = 2.05; b is the best point of the particle, g that of the swarm.  A
particle that would leave the cube stops at its boundary, and that component of its velocity is
lost (the "standard" of Bratton and Kennedy 2007).

**Simulated annealing** (Kirkpatrick, Gelatt and Vecchi 1983): Gaussian moves, geometric cooling.

A worse point is accepted with probability exp(-loss / (T s)), where s is the median distance of the
values so far from their median, so that the unit of the function does not matter and a few huge
losses neither.  The moves shrink with the temperature and are reflected at the boundary of the
cube; when all is cold, the search is heated again at the best point.

**Random search**: points drawn uniformly; what every other method has to beat.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from types import MappingProxyType

import numpy as np

from compiler.arrays import Array
from solvers.parameters.bayesian_search import DESIGN, BayesianSearch, exploration
from solvers.parameters.nelder_mead import NelderMead
from solvers.parameters.parameter_search import Cube, Method, ParameterSearch, Record

PULL = 2.05
CONSTRICTION = 2 / (2 * PULL - 2 + np.sqrt((2 * PULL) ** 2 - 8 * PULL))
PARTICLES = 10
HOT = 1.0
COOLING = 0.95
COLD = 0.01
STRIDE = 0.3
"""The standard deviation of a move at temperature 1, in units of the cube; it goes as sqrt(T)."""


def gp_ucb(mean: Array, deviation: Array, t: int) -> Array:
    """The rule m + sqrt(beta) sigma."""
    return np.asarray(mean + np.sqrt(exploration(len(mean), t)) * deviation)


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


class RandomSearch:
    """Independent points, uniform in the cube (Bergstra and Bengio 2012)."""

    def __init__(self, seed: int) -> None:
        self._rng = np.random.default_rng(seed)

    def propose(self, count: int, record: Record) -> list[Array]:
        """So many points."""
        return list(self._rng.uniform(size=(count, record.cube.dimension)))

    def learn(self, point: Array, value: float) -> None:
        """Nothing is learnt."""


def _factory(method: Callable[[int], Method], usual: int) -> Callable[..., ParameterSearch]:
    """Makes a search of a cube from a seed; ``usual`` is its number of initial points."""

    def make(cube: Cube, seed: int, initial: int = usual) -> ParameterSearch:
        return ParameterSearch(cube, seed, initial, method(seed))

    return make


COMPARED: Mapping[str, Callable[..., ParameterSearch]] = MappingProxyType(
    {
        "gp-acb": _factory(BayesianSearch, DESIGN),
        "gp-ucb": _factory(lambda seed: BayesianSearch(seed, gp_ucb), DESIGN),
        "nelder-mead": _factory(NelderMead, 1),
        "particle-swarm": _factory(ParticleSwarm, PARTICLES),
        "simulated-annealing": _factory(SimulatedAnnealing, 1),
        "random": _factory(RandomSearch, 1),
    }
)
"""Searches by name."""
