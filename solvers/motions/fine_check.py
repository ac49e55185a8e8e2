"""A look at a motion between its samples, in floats, before a proof is tried.

A motion that seems to break a formula there is worth a wider margin at once.
"""

from __future__ import annotations

from fractions import Fraction

import numpy as np

from compiler.arrays import Array
from compiler.tasks.formula_parts import atoms
from compiler.tasks.sampled_formula import sampled
from compiler.tasks.word_formula import holds
from compiler.workspaces.polytope import polytope_of
from solvers.motions.path_following import Follower
from solvers.motions.trajectory import Trajectory

PARTS = 8
"""A step is looked at so many times."""


def seems_to_satisfy(follower: Follower, trajectory: Trajectory) -> bool:
    """Whether the places of the effectors, ``PARTS`` times a step, satisfy the formulas."""
    formulas = [clause.formula for clause in follower.task.satisfy]
    if not formulas:
        return True
    task, workspace, numeric = follower.task, follower.workspace, follower.numeric
    u = np.repeat(trajectory.u, PARTS, axis=0)
    dt = float(task.step) / PARTS
    with np.errstate(all="ignore"):
        states = numeric.simulate(trajectory.x[0], u, trajectory.theta, dt, follower.substeps)
        places = numeric.points(states[:, : numeric.n], trajectory.theta).value
    word: list[dict[int, frozenset[str]]] = [{} for _ in states]
    named = {(atom.region, atom.effector) for atom in atoms(*formulas)}
    for effector in sorted({number for _, number in named}):
        inside: dict[str, Array] = {}
        for region in sorted(region for region, number in named if number == effector):
            shape = polytope_of(workspace.region(region).shape, workspace.dimension)
            inside[region] = np.all(places[:, effector - 1] @ shape.A.T <= shape.b, axis=1)
        for sample, letter in enumerate(word):
            letter[effector] = frozenset(name for name, flags in inside.items() if flags[sample])
    step = task.step / Fraction(PARTS)
    return all(holds(sampled(f, step, task.steps * PARTS), word) for f in formulas)
