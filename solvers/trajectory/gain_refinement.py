"""Refine the gains of the regulator so that they leave a smaller tube.

The regulator assumes that the whole state is measured.  What it would feed back of the modules' own
states, which nobody measures, is dropped, and the remaining gains are no longer optimal.  Changes
are piecewise linear in time.  The method is that of Broyden, Fletcher, Goldfarb and Shanno with
bounds (L-BFGS-B), with finite differences for derivatives.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from compiler.arrays import Array

NODES = 6
"""The number of instants between which changes are linear."""
DIFFERENCE = 1e-3
REFINEMENTS = 6
MOST_CHANGE = 1.0
"""The largest change of a gain, in units of its root mean square."""


def hats(samples: int, nodes: int) -> Array:
    """The piecewise linear functions (nodes, samples) that are 1 at a node and 0 at others."""
    places = np.linspace(0.0, 1.0, min(nodes, samples))
    times = np.linspace(0.0, 1.0, samples)
    return np.array([np.interp(times, places, row) for row in np.eye(len(places))])


def refined_gains(
    gains: Array, measured: int, cost: Callable[[Array], float], start: Array | None = None
) -> tuple[Array, Array]:
    """Gains (k, m, N) that cost no more, and the change (c,) that leads to them.

    Args:
        gains: the initial gains; all but the first ``measured`` columns stay.
        measured: the number of entries of the state that are fed back.
        cost: the cost of gains; infinite or NaN if they are useless.
        start: an initial change, used if it costs less than none.
    """
    from scipy.optimize import minimize

    sizes = np.sqrt((gains[:, :, :measured] ** 2).mean(axis=0))
    shapes = hats(len(gains), NODES)

    def changed(change: Array) -> Array:
        found = gains.copy()
        nodes = change.reshape(len(shapes), *sizes.shape)
        found[:, :, :measured] += np.einsum("nk,nij->kij", shapes, nodes) * sizes
        return found

    def with_slope(change: Array) -> tuple[float, Array]:
        base = cost(changed(change))
        slope = np.empty_like(change)
        for place in range(len(change)):
            moved = change.copy()
            moved[place] += DIFFERENCE
            slope[place] = (cost(changed(moved)) - base) / DIFFERENCE
        return base / first, np.nan_to_num(slope / first)

    none = np.zeros(len(shapes) * sizes.size)
    first = cost(gains)
    if not (np.isfinite(first) and first > 0):
        return gains, none
    begin = none if start is None or not cost(changed(start)) < first else start
    bounds = [(-MOST_CHANGE, MOST_CHANGE)] * len(begin)
    limits = {"maxiter": REFINEMENTS, "maxfun": 3 * REFINEMENTS}
    answer = minimize(with_slope, begin, jac=True, method="L-BFGS-B", bounds=bounds, options=limits)
    found = changed(answer.x)
    return (found, answer.x) if cost(found) < first else (gains, none)
