r"""Counterexamples: the shortest prefix of a path that already cannot be followed (ZEROPREFIX).

Problem 4 of the paper's appendix on the linearised robot: slacks g_i = max(s_i, 0) of the
fictitious inputs are minimised with

.. math:: \epsilon \sum_{l<i} g_l \le g_i \qquad (C.6)

which moves them to the end of the path, so that the zeros at the beginning are the part that can
be followed.  This holds for one sampled parameter: it prunes the search and proves nothing.
"""

from __future__ import annotations

import numpy as np

from compiler.arrays import Array
from solvers.backends.conic import NotSolved
from solvers.trajectory.control_problem import ControlOutcome, measured
from solvers.trajectory.path_following import PathProblem
from solvers.trajectory.subproblem import SubproblemSpec, TrustRegion, Weights

THRESHOLD = 1e-3
RADIUS = 0.5


def infeasible_sample(
    path_problem: PathProblem, outcome: ControlOutcome, entries: tuple[int, ...]
) -> int | None:
    """The first sample that an infeasible outcome cannot reach; None if it is not known.

    It is k + 1 if all samples can be reached: something else then prevents the motion.
    """
    slacks = _slacks(path_problem, outcome, entries)
    return None if slacks is None else zero_prefix(slacks, THRESHOLD) + 1


def infeasible_prefix(sample: int | None, entries: tuple[int, ...]) -> int:
    """The number of cells, from the start, that are entered up to a sample.

    It is the number of all cells of the path if the sample is not known.
    """
    if sample is None:
        return len(entries)
    return int(np.searchsorted(np.array(entries), sample, side="right"))


def zero_prefix(slacks: Array, threshold: float) -> int:
    """ZEROPREFIX: the least m whose partial sum g_0 + ... + g_m exceeds the threshold, else k.

    ``slacks`` are g_0 ... g_(k - 1), shape (k,).
    """
    above = np.flatnonzero(np.cumsum(slacks) > threshold)
    return int(above[0]) if len(above) else len(slacks)


def _slacks(
    path_problem: PathProblem, outcome: ControlOutcome, entries: tuple[int, ...]
) -> Array | None:
    """The slacks (k,) of Problem 4 about an infeasible outcome."""
    problem = path_problem.problem(entries)
    about = measured(problem, outcome.trajectory)
    if about is None:
        return None
    epsilon = float(path_problem.task.slack)
    prices = Weights(position=Weights().position / problem.unit)
    question = SubproblemSpec(problem.limits, problem.groups, None, prices, epsilon, problem.unit)
    result = problem.steps(question).solve(about.model, about.rows, TrustRegion(RADIUS))
    if isinstance(result, NotSolved):
        return None
    return np.asarray(np.max(np.abs(result.fictitious), axis=1, initial=0.0))
