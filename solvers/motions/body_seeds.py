"""Which motions to begin with where a task binds the whole body: clear ones first.

Half-planes between bodies and obstacles are chosen about the seed, so that one that passes an
obstacle on the wrong side leads nowhere.
"""

from __future__ import annotations

import numpy as np

from compiler.arrays import Array
from solvers.motions.corridor import Corridor
from solvers.motions.joint_timing import timed
from solvers.motions.path_timing import Entries

TOUCHING = -0.02
"""Metres of clearance down to which a seed counts as clear: the convex programs mend the rest."""
WAYS = 2
"""Motions that are taken from a roadmap."""
HOPELESS = 2
"""Seeds that are kept, of those that collide, where none is clear."""


def body_seeds(
    corridor: Corridor, tracked: list[Array], entries: Entries, count: int, seed: int
) -> list[Array]:
    """Motions (k + 1, n) to begin with, the most hopeful first, at most ``count`` that are clear.

    ``tracked`` are motions that try to follow the path of the effector, at least one.  Those that
    do and are clear are kept; where there is none, and for redundant arms, a roadmap is searched.
    Where that finds nothing either, those are kept that collide the least.
    """
    clearances = [float(np.min(corridor.clearance.of(corridor.positions(q)))) for q in tracked]
    follow = [corridor.follows(q) for q in tracked]
    order = sorted(range(len(tracked)), key=lambda i: (not follow[i], -clearances[i]))
    clear = [tracked[i] for i in order if follow[i] and clearances[i] > TOUCHING][:count]
    wanted = min(count - len(clear), WAYS)
    redundant = corridor.numeric.n > corridor.numeric.d
    if wanted and (redundant or not clear):
        clear += roadmap_motions(corridor, tracked[0], entries, wanted, seed)
    return clear or [tracked[i] for i in order[:HOPELESS]]


def roadmap_motions(
    corridor: Corridor, like: Array, entries: Entries, count: int, seed: int
) -> list[Array]:
    """Motions (k + 1, n) along ways of a roadmap, the shortest way first.

    ``like`` is a motion of as many samples; its first pose is kept where the coordinates cannot
    start elsewhere.
    """
    from solvers.motions.roadmap import joint_paths

    first = like[0] if corridor.start_is_given else None
    paths = joint_paths(corridor, first, count, seed)
    return [timed(corridor, path, entries, len(like) - 1) for path in paths]
