"""The cells that the effectors of a robot visit along a motion."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from solvers.trajectory.path_timing import Entries
from solvers.trajectory.trajectory import Trajectory

if TYPE_CHECKING:
    from solvers.trajectory.path_following import PathProblem


def visited_cells(
    path_problem: PathProblem, trajectory: Trajectory
) -> tuple[tuple[int, ...], Entries] | None:
    """The cells a trajectory visits and their entries; None unless this is a path of the task."""
    numeric = path_problem.numeric
    positions = numeric.places(trajectory.x[:, : numeric.n], trajectory.theta)
    avoided = {
        name
        for avoid in path_problem.task.avoid
        if avoid.subject == "effector"
        for name in avoid.regions
    }
    cells: list[int] = []
    entries: list[int] = []
    for sample, point in enumerate(positions[:, path_problem.effector]):
        cell = path_problem.abstraction.locate(point)
        if cell is None or path_problem.abstraction.cells[cell].propositions & avoided:
            return None
        if not cells or cells[-1] != cell:
            if cells and cell not in path_problem.abstraction.neighbours[cells[-1]]:
                return None
            cells.append(cell)
            entries.append(sample)
    fixed, given = path_problem.constraints, path_problem.cells
    starts = cells[0] == given[0] or not fixed.starts_in_its_cell
    free_end = path_problem.loop is None and not fixed.ends_in_its_cell
    if not starts or not (cells[-1] == given[-1] or free_end):
        return None
    found = tuple(cells), tuple(entries)
    return found if path_problem.along(*found).allows(found[1]) else None


def depth_in_cells(path_problem: PathProblem, trajectory: Trajectory) -> float:
    """The least depth of the leader inside the cells that it is in at the samples, in metres."""
    numeric, cells = path_problem.numeric, path_problem.abstraction.cells
    positions = numeric.places(trajectory.x[:, : numeric.n], trajectory.theta)
    least = np.inf
    for point in positions[:, path_problem.effector]:
        cell = path_problem.abstraction.locate(point)
        if cell is not None:
            polytope = cells[cell].polytope
            rows = np.linalg.norm(polytope.A, axis=1)
            least = min(least, float(np.min((polytope.b - polytope.A @ point) / rows)))
    return least


def cell_names(
    path_problem: PathProblem, trajectory: Trajectory, entries: Entries
) -> list[list[str]]:
    """The cell of every effector at every sample.

    For the leader it is the cell to which it is bound, if it is bound to any.
    """
    cells = path_problem.abstraction.cells
    numeric = path_problem.numeric
    positions = numeric.places(trajectory.x[:, : numeric.n], trajectory.theta)
    ends = [*entries[1:], path_problem.task.steps + 1]
    own = [
        cells[cell].name
        for cell, first, last in zip(path_problem.cells, entries, ends, strict=True)
        for _ in range(first, last)
    ]
    names = []
    for effector in range(len(path_problem.model.effectors)):
        if effector == path_problem.effector and path_problem.bound:
            names.append(own)
            continue
        located = [path_problem.abstraction.locate(point) for point in positions[:, effector]]
        names.append(["free" if i is None else cells[i].name for i in located])
    return names
