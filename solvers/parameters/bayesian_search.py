"""GP-ACB: a Gaussian process model of the robustness, and the parameters that it proposes next."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache
from typing import TypeAlias

import numpy as np

from compiler.arrays import Array
from solvers.parameters.parameter_search import Cube, Halton, Record

# --- A Gaussian process with squared-exponential kernel, one length scale per axis, and noise -----
#
# C. E. Rasmussen and C. K. I. Williams, "Gaussian Processes for Machine Learning" (2006), Algorithm
# 2.1 and Eqn. 2.30; mean 0, and
#
# .. math:: k(x, x') = a \exp\bigl(-\tfrac12 \sum_j (x_j - x'_j)^2 / l_j^2\bigr).
#
# The length scales l and the ratio r of noise to amplitude are fitted by maximum likelihood: a grid
# of equal length scales, then a compass search in the logarithms from the best grid point.  The
# amplitude with the greatest likelihood for given l and r has a closed form.
#
# Low values are compressed, then all are standardised, before they are given to the process.  A
# value of 0 or more is a robustness, a negative value is minus a violation.  At the boundary of
# the feasible set the values jump, and violations can be huge; a process that has to explain these
# cannot resolve the differences at the top.  So, with m the median of the feasible values (of all
# values if none is feasible) and s the distance of the largest value from it, a value v below m
# becomes
#
# .. math:: m - s \bigl(\tfrac12 (1 - e^{-2l}) + \tfrac1{10} \ln(1 + l)\bigr), \qquad l = (m - v)/s.
#
# This is strictly monotone, so that violations still lead towards the feasible set, and it is
# independent of units.  It was chosen by experiment, see
# docs/decisions/0030-parameter-searches.md.


LENGTHS = (0.05, 3.0)
"""Bounds of the length scales, in units of the cube."""
NOISES = (1e-6, 0.3)
"""Bounds of the ratio of the variance of the noise to the amplitude."""
GRID = (7, 4)
"""The numbers of length scales and ratios that are tried first."""
STEP = 0.5
LAST_STEP = 0.01
"""Steps of the compass search, in natural logarithms: the first, and the one that ends it."""
DEFAULT = (0.3, 1e-4)
"""Length scale and ratio if all values are equal and nothing can be fitted."""

BEND = 0.5
TAIL = 0.1
LARGEST = 1e150
"""Values are clipped to this size, so that no sum of squares overflows."""


@dataclass(frozen=True, slots=True)
class GaussianProcess:
    """The process given values at points (m, p) of the cube.

    ``lengths`` (p,) are the length scales, ``amplitude`` and ``noise`` are variances, ``inverse``
    (m, m) is the inverse of the Cholesky factor, ``weights`` (m,) are the inverse covariance times
    the values (Rasmussen & Williams 2006, Algorithm 2.1).
    """

    points: Array
    lengths: Array
    amplitude: float
    noise: float
    inverse: Array
    weights: Array

    def posterior(self, queries: Array) -> tuple[Array, Array]:
        """Mean and standard deviation (c,) of the function, without noise, at queries (c, p)."""
        across = self.amplitude * correlation(queries, self.points, self.lengths)
        explained = np.sum((across @ self.inverse.T) ** 2, axis=1)
        deviation = np.sqrt(np.maximum(self.amplitude - explained, 0.0))
        return np.asarray(across @ self.weights), np.asarray(deviation)


def conditioned(
    points: Array, values: Array, lengths: Array, amplitude: float, noise: float
) -> GaussianProcess:
    """The process with these variances (noise is one too), given values (m,) at points (m, p)."""
    kernel = amplitude * correlation(points, points, lengths) + noise * np.eye(len(points))
    inverse = np.linalg.inv(np.linalg.cholesky(kernel))
    weights = inverse.T @ (inverse @ values)
    return GaussianProcess(points, lengths, amplitude, noise, inverse, weights)


def correlation(a: Array, b: Array, lengths: Array) -> Array:
    """The squared-exponential kernel with amplitude 1 between points (m, p) and (k, p): (m, k)."""
    gaps = (a[:, None, :] - b[None, :, :]) / lengths
    return np.asarray(np.exp(-0.5 * np.sum(gaps**2, axis=2)))


def fitted(points: Array, values: Array) -> GaussianProcess:
    """The process of greatest likelihood for values (m,) at points (m, p) of the cube.

    Length scales, amplitude and noise are fitted; the values are standardised.
    """
    if not np.any(values):
        lengths, ratio = np.full(points.shape[1], DEFAULT[0]), DEFAULT[1]
        return conditioned(points, values, lengths, 1.0, ratio)
    squares = (points[:, None, :] - points[None, :, :]) ** 2
    logs = _compass(squares, values)
    lengths, ratio = np.exp(logs[:-1]), float(np.exp(logs[-1]))
    amplitude = float(_profile(squares, values, logs[None])[1][0])
    return conditioned(points, values, lengths, amplitude, ratio * amplitude)


def log_likelihood(points: Array, values: Array, process: GaussianProcess) -> float:
    """The log-density of values (m,) under a process conditioned on them."""
    half_determinant = -np.sum(np.log(np.diag(process.inverse)))
    return float(
        -0.5 * values @ process.weights - half_determinant - 0.5 * len(points) * np.log(2 * np.pi)
    )


def _profile(squares: Array, values: Array, logs: Array) -> tuple[Array, Array]:
    """Likelihoods and best amplitudes (g,) for logarithms (g, p + 1) of l and r."""
    m = len(values)
    scaled = squares.reshape(m * m, -1) @ (-0.5 * np.exp(-2 * logs[:, :-1])).T
    kernels = np.exp(scaled.T.reshape(len(logs), m, m))
    kernels[:, np.arange(m), np.arange(m)] += np.exp(logs[:, -1:])
    factors = np.linalg.cholesky(kernels)
    whitened = np.linalg.solve(factors, np.broadcast_to(values[:, None], (len(logs), m, 1)))[..., 0]
    amplitudes = np.mean(whitened**2, axis=1)
    diagonals = factors[:, np.arange(m), np.arange(m)]
    determinants = 2 * np.sum(np.log(diagonals), axis=1)
    return -0.5 * (m * np.log(amplitudes) + determinants + m * (1 + np.log(2 * np.pi))), amplitudes


def _compass(squares: Array, values: Array) -> Array:
    """The logarithms (p + 1,) of length scales and ratio with the greatest likelihood."""
    p = squares.shape[2]
    lower = np.log([*[LENGTHS[0]] * p, NOISES[0]])
    upper = np.log([*[LENGTHS[1]] * p, NOISES[1]])
    lengths = np.linspace(lower[0], upper[0], GRID[0])
    ratios = np.linspace(lower[-1], upper[-1], GRID[1])
    grid = np.array([[*[length] * p, ratio] for length in lengths for ratio in ratios])
    worth = _profile(squares, values, grid)[0]
    best, record, step = grid[int(np.argmax(worth))], float(np.max(worth)), STEP
    compass = np.concatenate([np.eye(p + 1), -np.eye(p + 1)])
    along = np.zeros(p + 1)
    while step > LAST_STEP:
        # Also try the last move, once and twice as far, for ridges not along an axis.
        moves = np.concatenate([step * compass, [along, 2 * along]])
        around = np.clip(best + moves, lower, upper)
        worth = _profile(squares, values, around)[0]
        gains = np.maximum(worth - record, 0.0)
        if np.max(gains) <= 1e-9:
            step, along = step / 2, np.zeros(p + 1)
            continue
        # All improving moves are combined if that improves more.
        joint = np.clip(best + (gains / np.max(gains)) @ moves, lower, upper)
        (together,) = _profile(squares, values, joint[None])[0]
        top = int(np.argmax(worth))
        after = joint if together > worth[top] else around[top]
        record, along, best = float(max(together, worth[top])), after - best, after
    return np.asarray(best)


def compressed(values: Array) -> Array:
    """The values (m,), with those below the median of the feasible ones compressed."""
    values = np.clip(values, -LARGEST, LARGEST)
    feasible = values[values >= 0]
    middle = float(np.median(feasible if len(feasible) else values))
    spread = float(np.max(values)) - middle
    if spread <= 0:
        spread = float(np.median(np.abs(values - middle)))
    if spread <= 0:
        return values
    loss = np.maximum(middle - values, 0.0) / spread
    bent = BEND * -np.expm1(-loss / BEND) + TAIL * np.log1p(loss)
    return np.where(loss > 0, middle - spread * bent, values)


def standardised(values: Array) -> Array:
    """The compressed values (m,) with mean 0 and deviation 1; 0 if all are equal."""
    level = compressed(values)
    largest = float(np.max(np.abs(level)))
    level = level / (largest if largest > 0 else 1.0)
    level = level - level.mean()
    deviation = float(level.std())
    # If all values are equal, the deviation is only rounding error.
    return level / deviation if deviation > 1e-12 else np.zeros_like(level)


# --------------------------------------------------------------------------------------------------
# Bayesian optimisation: a Gaussian process of the values, and a rule for the next points.
#
# The rule is GP-ACB (Eqn. 8 of the paper, with correction 4.12) over a finite set of candidates:
#
# .. math:: m + \sqrt{\eta \beta_t}\, \sigma, \qquad
#     \beta_t = 2 \ln\bigl(|D| \pi^2 t^2 / (6 \delta)\bigr), \qquad \delta = e^{-3}.
#
# Several points at once: the mean is kept and the deviation is computed as if the pending points
# had been evaluated (T. Desautels, A. Krause, J. W. Burdick, "Parallelizing
# exploration-exploitation tradeoffs in Gaussian process bandit optimization", 2014).


DESIGN = 8
"""The default number of initial points."""
EVERYWHERE = 512
"""The number of candidates that fill the cube."""
NEARBY = 64
"""The number of candidates about the best point, for each of the ranges."""
RANGES = (0.1, 0.03, 0.01, 0.003)
"""Standard deviations of candidates about the best point, in units of the cube."""


DELTA = float(np.exp(-3.0))

Acquisition: TypeAlias = Callable[[Array, Array, int], Array]
"""Maps mean (c,), standard deviation (c,) and step t (from 1) to the values (c,) to maximise."""


def exploration(candidates: int, t: int) -> float:
    """beta_t for ``candidates`` candidates at step ``t`` (from 1)."""
    return 2 * float(np.log(candidates * np.pi**2 * t**2 / (6 * DELTA)))


def gp_acb(mean: Array, deviation: Array, t: int) -> Array:
    """The rule m + sqrt(eta beta) sigma (GP-ACB, Eqn. 8), (c,), for mean and deviation (c,).

    ``t`` counts the steps from 1; eta is the mean scaled to [0, 1], or 1 if the mean is constant.
    """
    spread = float(mean.max() - mean.min())
    eta = (mean - mean.min()) / spread if spread > 0 else np.ones_like(mean)
    return np.asarray(mean + np.sqrt(eta * exploration(len(mean), t)) * deviation)


@dataclass(frozen=True, slots=True)
class BayesianSearch:
    """Proposes the candidates with the largest values of the rule.

    No candidate is ever discarded on a confidence bound (GP-ACB has none, correction 4.12).
    """

    seed: int
    acquisition: Acquisition = gp_acb

    def propose(self, count: int, record: Record) -> list[Array]:
        """The best candidates (p,) that are neither known nor pending, one after the other."""
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
        """Nothing is stored of a point (p,) beyond the record of the search."""

    def _candidates(self, record: Record) -> Array:
        """Distinct points of the cube (c, p), neither known nor pending."""
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
    """Points that fill the cube (c, p); all of its points if there are few."""
    if cube.size is not None and cube.size <= EVERYWHERE:
        levels = [level or 1 for level in cube.levels]
        numbers = np.indices(levels).reshape(cube.dimension, -1).T
        return np.asarray((numbers + 0.5) / np.array(levels))
    return cube.nearest(Halton(cube.dimension, seed).points(0, EVERYWHERE))


def _as_if_seen(process: GaussianProcess, values: Array, others: list[Array]) -> GaussianProcess:
    """The process as if its own mean had also been observed at other points."""
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
