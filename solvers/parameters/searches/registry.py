"""The parameter searches by name."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType
from typing import Protocol

from solvers.parameters.searches.acquisition import gp_acb, gp_ucb
from solvers.parameters.searches.bayesian_search import BayesianSearch
from solvers.parameters.searches.cube import Cube
from solvers.parameters.searches.nelder_mead import NelderMead
from solvers.parameters.searches.parameter_search import Method, ParameterSearch
from solvers.parameters.searches.particle_swarm import PARTICLES, ParticleSwarm
from solvers.parameters.searches.random_search import RandomSearch
from solvers.parameters.searches.simulated_annealing import SimulatedAnnealing

DESIGN = 8
"""Initial points of a Gaussian process."""


class SearchFactory(Protocol):
    """Makes a search of a cube; ``initial`` points fill it evenly before the method begins."""

    def __call__(self, cube: Cube, seed: int, initial: int | None = None) -> ParameterSearch:
        """The search; without ``initial``, the method's own number."""
        ...


class _Maker(Protocol):
    def __call__(self, seed: int) -> Method: ...


def _factory(method: _Maker, usual: int) -> SearchFactory:
    def make(cube: Cube, seed: int, initial: int | None = None) -> ParameterSearch:
        return ParameterSearch(cube, seed, usual if initial is None else initial, method(seed))

    return make


SEARCHES: Mapping[str, SearchFactory] = MappingProxyType(
    {
        "gp-acb": _factory(lambda seed: BayesianSearch(seed, gp_acb), DESIGN),
        "gp-ucb": _factory(lambda seed: BayesianSearch(seed, gp_ucb), DESIGN),
        "nelder-mead": _factory(NelderMead, 1),
        "particle-swarm": _factory(ParticleSwarm, PARTICLES),
        "simulated-annealing": _factory(SimulatedAnnealing, 1),
        "random": _factory(RandomSearch, 1),
    }
)

DEFAULT = "gp-acb"
