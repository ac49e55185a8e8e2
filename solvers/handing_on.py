"""The design of a shorter robot handed on to a longer one that extends it (Theorem 1).

It is the start of a search over all parameters of the longer robot, and where that ends below it,
it is kept as it is, at neutral values.  Either design is proved anew for the longer robot, so that
nothing rests on the theorem; where it holds, no robot is reported less robust than one it extends.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from solvers.design import Design
from solvers.inheritance import Inherited
from solvers.motions.path_following import Follower
from solvers.motions.trajectory import Trajectory
from solvers.parameters.configuration_search import Configuration
from solvers.parameters.parameter_space import parameter_space
from solvers.structure_search import StructureSearch

TOLERANCE = 1e-6
"""Robustness, in units of effort, that a design may lack before that of a shorter robot is kept."""


def handed_on(search: StructureSearch, design: Design | None) -> tuple[Design | None, str]:
    """The best of a design and of those that shorter robots lead to; then what is wrong with it.

    The text is empty unless the design is less robust than that of a shorter robot.
    """
    with_design = [each for each in search.inherited if each.design is not None]
    for inherited in with_design:
        design = _better(design, _improved(search, inherited))
        if _robustness(design) < inherited.robustness - TOLERANCE:
            design = _better(design, _kept(search, inherited))
    best = max(with_design, key=lambda each: each.robustness, default=None)
    if best is None or _robustness(design) >= best.robustness - TOLERANCE:
        return design, ""
    return design, (
        f"; less robust than structure {best.number}, whose design could not be handed on"
        f"{search.obstacle}"
    )


def _robustness(design: Design | None) -> float:
    return -np.inf if design is None else design.robustness


def _better(design: Design | None, other: Design | None) -> Design | None:
    """The more robust one; the first of equals."""
    return other if _robustness(other) > _robustness(design) else design


def _improved(search: StructureSearch, inherited: Inherited) -> Design | None:
    """A proved design found from that of a shorter robot, with all parameters free."""
    begun = _begun(search, inherited)
    if begun is None:
        return None
    follower, kept = begun
    space, start = parameter_space(follower.model), kept.outcome.trajectory
    box = None if space.is_point else space.free_box(start.theta)
    outcome = follower.solve(start, kept.entries, box)
    if not outcome.feasible:
        return None
    return search.widened(follower, replace(kept, outcome=outcome)).design


def _kept(search: StructureSearch, inherited: Inherited) -> Design | None:
    """The shorter robot's design as it is, proved for the longer robot."""
    begun = _begun(search, inherited)
    return None if begun is None else search.certified(*begun)


def _begun(search: StructureSearch, inherited: Inherited) -> tuple[Follower, Configuration] | None:
    """The shorter robot's motion as one of the longer, along the same path; None if it is none."""
    design = inherited.design
    if design is None:
        return None
    follower = search.place.along(design.abstraction, design.effector, design.leader, design.path)
    motion = design.configuration.outcome.trajectory
    if follower is None or motion.x.shape[1] != search.numeric.size:
        search.obstacle = "; the two robots do not move alike"
        return None
    trajectory = Trajectory(motion.x, motion.u, np.array(inherited.theta))
    outcome = replace(design.configuration.outcome, trajectory=trajectory)
    return follower, replace(
        design.configuration,
        outcome=outcome,
        entries=follower.waypoints()[1],
        cells=follower.cells,
    )
