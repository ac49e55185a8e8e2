"""A thin adapter to scikit-learn's Gaussian process: standardised outputs, fixed random state."""

from __future__ import annotations

import warnings

import numpy as np
from sklearn.exceptions import ConvergenceWarning
from sklearn.gaussian_process import GaussianProcessRegressor
from sklearn.gaussian_process.kernels import RBF, WhiteKernel

from compiler.discretisation.float_reading import Array

JITTER = 1e-8


def posterior(known: Array, values: Array, queries: Array) -> tuple[Array, Array]:
    """Mean and standard deviation at queries (c, p) given values (m,) at points (m, p).

    A squared-exponential kernel with its length scale fitted by maximum likelihood; points are in
    the unit cube, outputs are standardised, so both results are in standard units.
    """
    spread = float(values.std())
    outputs = (values - values.mean()) / (spread if spread > 0 else 1.0)
    kernel = RBF(0.3, (0.05, 3.0)) + WhiteKernel(1e-4, (1e-6, 1e-1))
    process = GaussianProcessRegressor(kernel, alpha=JITTER, random_state=0)
    with warnings.catch_warnings():
        # A length scale at its bound is an answer here, not a fault.
        warnings.simplefilter("ignore", ConvergenceWarning)
        process.fit(known, outputs)
        mean, deviation = process.predict(queries, return_std=True)
    return np.asarray(mean), np.asarray(deviation)
