r"""Bayesian optimisation: a Gaussian process of the values, and a rule for where to look next.

The rule is GP-ACB (Eqn. 8 of the paper, with correction 4.12) over a finite set of candidates:

.. math:: m + \sqrt{\eta \beta_t}\, \sigma, \qquad
    \beta_t = 2 \ln\bigl(|D| \pi^2 t^2 / (6 \delta)\bigr), \qquad \delta = e^{-3}.

Several points at once: the mean is kept and the deviation is computed as if the points waited for
had been seen (T. Desautels, A. Krause, J. W. Burdick, "Parallelizing exploration-exploitation
tradeoffs in Gaussian process bandit optimization", 2014).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache
from typing import TypeAlias

import numpy as np

from compiler.arrays import Array
from solvers.parameters.gaussian_process import (
    GaussianProcess,
    conditioned,
    fitted,
    standardised,
)
from solvers.parameters.parameter_search import Record
from solvers.parameters.parameter_space import Cube, Halton

DESIGN = 8
"""Initial points, unless told otherwise."""
EVERYWHERE = 512
"""Candidates that fill the cube."""
NEARBY = 64
"""Candidates about the best point, for each of the ranges."""
RANGES = (0.1, 0.03, 0.01, 0.003)
"""Standard deviations of candidates about the best point, in units of the cube."""


DELTA = float(np.exp(-3.0))

Acquisition: TypeAlias = Callable[[Array, Array, int], Array]
"""Mean (c,), standard deviation (c,) and step t from 1 to the values (c,) to be maximised."""


def exploration(candidates: int, t: int) -> float:
    """beta_t for ``candidates`` candidates at step ``t`` (from 1)."""
    return 2 * float(np.log(candidates * np.pi**2 * t**2 / (6 * DELTA)))


def gp_acb(mean: Array, deviation: Array, t: int) -> Array:
    """The rule m + sqrt(eta beta) sigma; eta is the mean scaled to [0, 1], 1 where it is flat."""
    spread = float(mean.max() - mean.min())
    eta = (mean - mean.min()) / spread if spread > 0 else np.ones_like(mean)
    return np.asarray(mean + np.sqrt(eta * exploration(len(mean), t)) * deviation)


@dataclass(frozen=True, slots=True)
class BayesianSearch:
    """Asks for the candidates that the rule likes best.

    No candidate is ever discarded on a confidence bound (GP-ACB has none, correction 4.12).
    """

    seed: int
    acquisition: Acquisition = gp_acb

    def propose(self, count: int, record: Record) -> list[Array]:
        """The best candidates that are neither known nor waited for, one after the other."""
        known, values = np.array(record.points), standardised(np.array(record.values))
        process = fitted(known, values)
        waited = list(record.pending)
        candidates = self._candidates(record)
        mean, _ = process.posterior(candidates)
        new: list[Array] = []
        while len(new) < count and len(candidates):
            seen = _as_if_seen(process, values, [*waited, *new])
            deviation = seen.posterior(candidates)[1]
            worth = self.acquisition(mean, deviation, len(seen.points))
            top = int(np.argmax(worth))
            new.append(candidates[top])
            candidates, mean = np.delete(candidates, top, axis=0), np.delete(mean, top)
        return new

    def learn(self, point: Array, value: float) -> None:
        """Nothing beyond what is on record."""

    def _candidates(self, record: Record) -> Array:
        """Distinct points of the cube (c, p), neither known nor waited for."""
        taken = [*record.points, *record.pending]
        rng = np.random.default_rng([self.seed, len(taken)])
        best, p = record.points[record.best()], record.cube.dimension
        spread = np.repeat(RANGES, NEARBY)[:, None]
        near = best + spread * rng.normal(size=(len(spread), p))
        points = np.concatenate([_everywhere(record.cube, self.seed), record.cube.nearest(near)])
        keys = {point.tobytes() for point in taken}
        kept = []
        for index, point in enumerate(points):
            key = point.tobytes()
            if key not in keys:
                keys.add(key)
                kept.append(index)
        return np.asarray(points[kept])


@lru_cache(maxsize=8)
def _everywhere(cube: Cube, seed: int) -> Array:
    """Points that fill the cube (c, p); all of it where they are so few."""
    if cube.size is not None and cube.size <= EVERYWHERE:
        levels = [level or 1 for level in cube.levels]
        numbers = np.indices(levels).reshape(cube.dimension, -1).T
        return np.asarray((numbers + 0.5) / np.array(levels))
    return cube.nearest(Halton(cube.dimension, seed).points(0, EVERYWHERE))


def _as_if_seen(process: GaussianProcess, values: Array, others: list[Array]) -> GaussianProcess:
    """The process as if its own mean had been observed at other points, too."""
    if not others:
        return process
    points = np.array(others)
    expected = process.posterior(points)[0]
    return conditioned(
        np.concatenate([process.points, points]),
        np.concatenate([values, expected]),
        process.lengths,
        process.amplitude,
        process.noise,
    )
