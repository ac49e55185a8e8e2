"""The size of a task: its unit of length, and the initial margin of its motions.

The thresholds of the search are made for robots of about a metre; for others they are scaled.
"""

from __future__ import annotations

from math import floor, log10

import numpy as np

from grammar_lang import ir
from grammar_lang.ir.constants import to_float
from grammar_lang.ir.formula_parts import asked_poses, atoms
from solvers.trajectory.convex_set import ConvexSet, region_set

LEAST_MARGIN = 2e-4
"""The initial position margin of a search, for tasks of about a metre (m)."""
DISTURBED_MARGIN = 2e-3
"""The initial margin if many motions are proved at once: widening it costs another long proof."""
SHARE = 0.1
"""The margin is at most this share of the least radius of a region or pose to be reached."""
SMALLEST = 1e-6
"""The margin is at least this, in units of length."""
ROUNDED = 0.1
"""Sizes slightly below a power of ten count as that power."""


def length_unit(workspace: ir.Workspace) -> float:
    """The power of ten (m) below half the diagonal of the bounds."""
    bounds = region_set(workspace.bounds.shape, workspace.dimension)
    half = float(np.linalg.norm(np.ptp(bounds.vertices, axis=0))) / 2
    return 10.0 ** floor(log10(half) + ROUNDED)


def least_margin(workspace: ir.Workspace, task: ir.Task) -> float:
    """The initial position margin (m) of a search."""
    unit = length_unit(workspace)
    names = {atom.region for clause in task.demanded for atom in atoms(clause.formula)}
    names |= {task.start.region} if isinstance(task.start, ir.StartIn) else set()
    names |= set() if task.reach is None else {task.reach.region}
    sets = [region_set(workspace.region(name).shape, workspace.dimension) for name in names]
    narrow = [_radius(each) for each in sets]
    narrow += [unit * to_float(pose.within) for pose in asked_poses(task)]
    least = SHARE * min(narrow, default=np.inf)
    several = task.repeat or task.robust is not None
    most = DISTURBED_MARGIN if several else LEAST_MARGIN
    return float(np.clip(least, SMALLEST * unit, most * unit))


def _radius(region: ConvexSet) -> float:
    """The distance (m) from the mean of the corners to the nearest facet."""
    middle = region.vertices.mean(axis=0)
    return float(np.min(region.offsets - region.normals @ middle))
