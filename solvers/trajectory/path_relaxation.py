"""A path problem without some of the constraints on the effector that follows the path."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from compiler.arrays import Array
from solvers.trajectory.control_problem import ControlOutcome, ControlProblem, IterationBudget
from solvers.trajectory.convex_set import convex_set
from solvers.trajectory.path_following import PathProblem
from solvers.trajectory.path_timing import Entries, visit_times
from solvers.trajectory.trajectory import Trajectory

RADIUS = 0.5


@dataclass(frozen=True, slots=True)
class PathRelaxation:
    """Motions that visit some cells of a path, each at one sample, as ``visits`` says by place.

    The start and target regions of the task, the bounds of the workspace, and the limits of joints,
    rates and efforts always bind; separations bind only if ``apart``.
    """

    path_problem: PathProblem
    visits: Mapping[int, int]
    apart: bool

    def problem(self, entries: Entries) -> ControlProblem:
        """The control problem; ``entries`` are the samples at which the path enters its cells."""
        path_problem = self.path_problem
        whole = path_problem.plan(entries)
        plan = replace(
            whole,
            dwells=path_problem.constraints.relaxed(self.visits),
            separations=whole.separations if self.apart else (),
        )
        return replace(path_problem.problem(entries), rows_of=plan.rows)

    def outcome(
        self,
        start: Trajectory,
        entries: Entries,
        box: tuple[Array, Array] | None,
        budget: IterationBudget,
    ) -> ControlOutcome:
        """Control synthesis from a seed; ``box`` bounds the parameters (p,), or is None."""
        return self.path_problem.solved(self.problem(entries), start, box, budget, RADIUS)


def straight_visits(path_problem: PathProblem, places: Sequence[int]) -> dict[int, int]:
    """The samples at which a straight way through the cells visits places (from 0)."""
    cells, steps = path_problem.cells, path_problem.task.steps
    return visit_times(path_problem.abstraction, cells, places, steps)


def nearest_visits(
    path_problem: PathProblem, places: Sequence[int], motion: Trajectory
) -> dict[int, int]:
    """The samples at which a motion comes nearest to the cells at places (from 0), in order."""
    numeric, steps = path_problem.numeric, path_problem.task.steps
    with np.errstate(all="ignore"):
        points = numeric.places(motion.x[:, : numeric.n], motion.theta)
    at, found, first = points[:, path_problem.effector], dict[int, int](), 0
    ends = {0: 0, len(path_problem.cells) - 1: steps}
    for place in places:
        cell = convex_set(path_problem.abstraction.cells[path_problem.cells[place]].polytope)
        with np.errstate(all="ignore"):
            beyond = np.max(at[first:] @ cell.normals.T - cell.offsets, axis=1)
        found[place] = ends.get(place, first + int(np.argmin(beyond)))
        first = min(found[place] + 1, steps)
    return found
