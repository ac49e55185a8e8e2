"""A search of parameters, evaluation by evaluation, and how two methods compare over seeds."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from compiler.arrays import Array
from solvers.parameters.parameter_search import ParameterSearch

CLAIM = (0.30, 0.40)
"""The paper: so many fewer evaluations than Nelder-Mead's, as a part."""
RESAMPLES, INTERVAL = 10_000, (2.5, 97.5)
"""A saving's interval: percentiles of a bootstrap over seeds, which both methods share."""


def searched(
    search: ParameterSearch,
    value: Callable[[Array], float],
    budget: int,
    noise: Callable[[], float] = lambda: 0.0,
) -> tuple[list[Array], list[float]]:
    """The points (p,) of the cube that a search asks for one by one, and their values.

    The search is told the values with ``noise``; those that are returned have none.
    """
    points, values = list[Array](), list[float]()
    while len(values) < budget:
        (point,) = search.ask(1)
        points.append(point)
        values.append(value(point))
        search.tell(point, values[-1] + noise())
    return points, values


def evaluations_to(target: float, best: Array) -> int:
    """The number of evaluations until ``best`` so far (n,) reaches a value; n + 1: it does not."""
    reached = np.flatnonzero(best >= target)
    return int(reached[0]) + 1 if len(reached) else len(best) + 1


@dataclass(frozen=True)
class Saving:
    """By which part a mean number of evaluations is smaller; the same of each resample."""

    part: float
    resampled: Array

    @property
    def interval(self) -> tuple[float, float]:
        """The 95 % interval of the part."""
        low, high = np.percentile(self.resampled, INTERVAL)
        return float(low), float(high)

    @property
    def text(self) -> str:
        """In per cent, with the interval."""
        low, high = (100 * end for end in self.interval)
        return f"{100 * self.part:.0f} ({low:.0f} to {high:.0f})"


def saving(ours: Sequence[int], theirs: Sequence[int]) -> Saving:
    """The saving of evaluations, by seeds that both have in common."""
    both = np.array([ours, theirs], dtype=np.float64)
    drawn = np.random.default_rng(0).integers(0, both.shape[1], (RESAMPLES, both.shape[1]))
    means = both[:, drawn].mean(axis=2)
    return Saving(1 - float(both[0].mean() / both[1].mean()), 1 - means[0] / means[1])


def mean_saving(savings: Sequence[Saving]) -> Saving:
    """The mean of savings, resample by resample."""
    parts = [each.part for each in savings]
    return Saving(float(np.mean(parts)), np.mean([each.resampled for each in savings], axis=0))
