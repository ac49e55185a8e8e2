r"""Acquisition rules for Bayesian optimisation over a finite set of candidates.

GP-ACB (Eqn. 8 of the paper, with correction 4.12) and GP-UCB (Srinivas et al. 2010), both with

.. math:: \beta_t = 2 \ln\bigl(|D| \pi^2 t^2 / (6 \delta)\bigr), \qquad \delta = e^{-3}.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TypeAlias

import numpy as np

from compiler.arrays import Array

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


def gp_ucb(mean: Array, deviation: Array, t: int) -> Array:
    """The rule m + sqrt(beta) sigma."""
    return np.asarray(mean + np.sqrt(exploration(len(mean), t)) * deviation)
