r"""A Gaussian process with squared-exponential kernel, one length scale per axis, and noise.

C. E. Rasmussen and C. K. I. Williams, "Gaussian Processes for Machine Learning" (2006), Algorithm
2.1 and Eqn. 2.30; mean 0, and

.. math:: k(x, x') = a \exp\bigl(-\tfrac12 \sum_j (x_j - x'_j)^2 / l_j^2\bigr).

The length scales l and the ratio r of noise to amplitude are fitted by maximum likelihood: a grid
of equal length scales, then a compass search in the logarithms from the best of it.  The amplitude
with the greatest likelihood for given l and r has a closed form.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from compiler.arrays import Array

LENGTHS = (0.05, 3.0)
"""Bounds of the length scales, in units of the cube."""
NOISES = (1e-6, 0.3)
"""Bounds of the ratio of the variance of the noise to the amplitude."""
GRID = (7, 4)
"""So many length scales and ratios are tried first."""
STEP = 0.5
LAST_STEP = 0.01
"""Steps of the compass search, in natural logarithms: the first, and the one that ends it."""
DEFAULT = (0.3, 1e-4)
"""Length scale and ratio where all values are equal and nothing can be fitted."""


@dataclass(frozen=True, slots=True)
class GaussianProcess:
    """The process given values at points: ``inverse`` is that of the Cholesky factor (m, m)."""

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
    """The process with those variances (noise is one, too), given values (m,) at points (m, p)."""
    kernel = amplitude * correlation(points, points, lengths) + noise * np.eye(len(points))
    inverse = np.linalg.inv(np.linalg.cholesky(kernel))
    weights = inverse.T @ (inverse @ values)
    return GaussianProcess(points, lengths, amplitude, noise, inverse, weights)


def correlation(a: Array, b: Array, lengths: Array) -> Array:
    """The kernel with amplitude 1 between points (m, p) and (k, p): shape (m, k)."""
    gaps = (a[:, None, :] - b[None, :, :]) / lengths
    return np.asarray(np.exp(-0.5 * np.sum(gaps**2, axis=2)))


def fitted(points: Array, values: Array) -> GaussianProcess:
    """The process whose length scales, amplitude and noise make the values the most likely."""
    if not np.any(values):
        lengths, ratio = np.full(points.shape[1], DEFAULT[0]), DEFAULT[1]
        return conditioned(points, values, lengths, 1.0, ratio)
    squares = (points[:, None, :] - points[None, :, :]) ** 2
    logs = _compass(squares, values)
    lengths, ratio = np.exp(logs[:-1]), float(np.exp(logs[-1]))
    amplitude = float(_profile(squares, values, logs[None])[1][0])
    return conditioned(points, values, lengths, amplitude, ratio * amplitude)


def log_likelihood(points: Array, values: Array, process: GaussianProcess) -> float:
    """The logarithm of the density of values (m,) under a process given them."""
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
        # Also once and twice as far as the last time, for ridges that no axis runs along.
        moves = np.concatenate([step * compass, [along, 2 * along]])
        around = np.clip(best + moves, lower, upper)
        worth = _profile(squares, values, around)[0]
        gains = np.maximum(worth - record, 0.0)
        if np.max(gains) <= 1e-9:
            step, along = step / 2, np.zeros(p + 1)
            continue
        # All moves that help at once, where that helps more.
        joint = np.clip(best + (gains / np.max(gains)) @ moves, lower, upper)
        (together,) = _profile(squares, values, joint[None])[0]
        top = int(np.argmax(worth))
        after = joint if together > worth[top] else around[top]
        record, along, best = float(max(together, worth[top])), after - best, after
    return np.asarray(best)
