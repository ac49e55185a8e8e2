"""Into how many parts a step must be divided for the explicit method of the search to be stable.

The classical Runge-Kutta method damps a mode of rate lambda only while h |lambda| < 2.78 (Hairer &
Wanner, *Solving Ordinary Differential Equations II*, section IV.2).
"""

from __future__ import annotations

import numpy as np

from compiler.discretisation.numeric_robot import NumericRobot
from solvers.parameters.parameter_space import parameter_space

STABLE = 2.0
SAMPLES = 8
MOST = 256


def stable_parts(numeric: NumericRobot, dt: float, least: int) -> int:
    """At least ``least`` parts, more where the linearised robot has fast modes at random poses."""
    n, size = numeric.n, numeric.size
    rng = np.random.default_rng(0)
    x = np.zeros((SAMPLES, size))
    x[:, :n] = rng.uniform(-1, 1, (SAMPLES, n))
    rates = [0.0]
    for theta in parameter_space(numeric.graph.model).uniform(rng, 2):
        with np.errstate(all="ignore"):
            _, jacobian = numeric.acceleration(x, np.zeros((SAMPLES, numeric.m)), theta)
        slope = np.zeros((SAMPLES, size, size))
        slope[:, :n, n : 2 * n] = np.eye(n)
        slope[:, n:] = jacobian[:, :, :size]
        finite = slope[np.isfinite(slope).all(axis=(1, 2))]
        rates.append(float(np.max(np.abs(np.linalg.eigvals(finite)), initial=0.0)))
    return int(min(MOST, max(least, np.ceil(dt * max(rates) / STABLE))))
