"""Which seeds are worth a control synthesis: those that break the path not much more than others.

A tracked seed leaves the path where the inverse kinematics has no pose for it; one that does so by
far, while another hardly does, would only take time.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from solvers.motions.control_problem import ControlProblem
from solvers.motions.trajectory import Trajectory

NEAR = 0.1
"""Metres by which a seed may leave the path in any case."""
FARTHER = 2.0
"""Or so many times what the best seed leaves it by."""


def hopeful(problem: ControlProblem, seeds: Sequence[Trajectory]) -> list[Trajectory]:
    """The seeds that are worth trying, in their order; one at least where there is one."""
    gaps = [_excess(problem, seed) for seed in seeds]
    most = max(NEAR, FARTHER * min(gaps, default=0.0))
    return [seed for seed, gap in zip(seeds, gaps, strict=True) if gap <= most]


def _excess(problem: ControlProblem, seed: Trajectory) -> float:
    """By how much a seed breaks the half-planes of a problem at most, metres."""
    points = problem.numeric.points(seed.x[:, : problem.numeric.n], seed.theta)
    if not np.isfinite(points.value).all():
        return float("inf")
    return float(np.max(problem.rows_of(points.value).excess(points), initial=0.0))
