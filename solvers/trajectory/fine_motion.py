"""The motion that inputs cause, integrated far more finely than the search needs."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction

import numpy as np

from compiler.arrays import Array
from compiler.discretisation.numeric_robot import NumericRobot
from compiler.tasks.formula_parts import atoms
from compiler.tasks.sampled_formula import sampled
from compiler.tasks.word_formula import holds
from compiler.time_limits.time_limit import is_late
from compiler.workspaces.polytope import polytope_of
from solvers.trajectory.path_following import PathProblem
from solvers.trajectory.trajectory import Trajectory

AGREEMENT = 1e-10
"""Twice as many steps change no entry of a state by more, in SI."""
SUBSTEPS = 4
MOST_PARTS = 128


def fine_motion(numeric: NumericRobot, trajectory: Trajectory, dt: float) -> Trajectory:
    """The trajectory with its states integrated anew, by the same method in shorter steps.

    ``dt`` is the time between samples in seconds.  For tables and pictures, and whoever compares
    with another simulator; no proof rests on it, so that a limit of time leaves the states as fine
    as they are by then.
    """
    states, parts = trajectory.x, 1
    while parts <= MOST_PARTS and not is_late():
        finer = _sampled(numeric, trajectory, dt, parts)
        change = float(np.max(np.abs(finer - states), initial=0.0))
        states = finer
        if change <= AGREEMENT and parts > 1:
            break
        parts *= 2
    return replace(trajectory, x=states)


def _sampled(numeric: NumericRobot, trajectory: Trajectory, dt: float, parts: int) -> Array:
    """The states at the samples, each step divided into so many parts."""
    u = np.repeat(trajectory.u, parts, axis=0)
    x = numeric.simulate(trajectory.x[0], u, trajectory.theta, dt / parts, SUBSTEPS)
    return x[::parts]


# --- A look at a motion between its samples, in floats, before a proof is tried -------------------
#
# A motion that seems to break a formula there is worth a wider margin at once.


PARTS = 8
"""A step is looked at so many times."""


def seems_to_satisfy(path_problem: PathProblem, trajectory: Trajectory) -> bool:
    """Whether the places of the effectors, ``PARTS`` times a step, satisfy the formulas."""
    formulas = [clause.formula for clause in path_problem.task.satisfy]
    if not formulas:
        return True
    task, workspace, numeric = path_problem.task, path_problem.workspace, path_problem.numeric
    u = np.repeat(trajectory.u, PARTS, axis=0)
    dt = float(task.step) / PARTS
    with np.errstate(all="ignore"):
        states = numeric.simulate(trajectory.x[0], u, trajectory.theta, dt, path_problem.substeps)
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
