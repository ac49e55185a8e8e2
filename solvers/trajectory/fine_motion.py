"""The motion that inputs produce, integrated more finely than in the search."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction

import numpy as np

from compiler.arrays import Array
from compiler.discretisation.numeric_robot import NumericRobot
from compiler.robots.state_and_input import dry_friction
from compiler.tasks.sampled_formula import sampled
from compiler.tasks.word_formula import holds
from compiler.time_limits.time_limit import is_late
from compiler.workspaces.polytope import polytope_of
from grammar_lang import ir
from grammar_lang.ir.formula_parts import atoms, formula_text, with_atoms
from solvers.trajectory.path_following import LIMIT_MARGIN, PathProblem
from solvers.trajectory.pose_dwells import in_poses
from solvers.trajectory.rubbing_motion import rubbing_motion
from solvers.trajectory.simulated_motion import SimulatedMotion
from solvers.trajectory.task_limits import state_limits
from solvers.trajectory.trajectory import Trajectory

AGREEMENT = 1e-10
"""Integration is fine enough if doubling the steps changes no state entry by more, in SI."""
SUBSTEPS = 4
MOST_PARTS = 128


def fine_motion(numeric: NumericRobot, trajectory: Trajectory, dt: float) -> Trajectory:
    """The trajectory with its states integrated anew, by the same method in shorter steps.

    ``dt`` is the time between samples in seconds.  It serves tables, pictures and comparisons with
    other simulators.  No proof rests on it, so a time limit leaves the states as fine as they are
    by then.  With dry friction it is integrated from event to event.
    """
    if dry_friction(numeric.graph.model):
        return replace(trajectory, x=rubbing_motion(numeric, trajectory, dt))
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
    """The states at the samples, with each step divided into ``parts``."""
    u = np.repeat(trajectory.u, parts, axis=0)
    x = numeric.simulate(trajectory.x[0], u, trajectory.theta, dt / parts, SUBSTEPS)
    return x[::parts]


# --- How finely a search has to integrate, and what a motion violates between its samples ---------
#
# Feedback brings the robot back at every sample, so only the errors of single steps count.  Without
# it errors add up, and an unstable motion amplifies them.


INTEGRATION_SHARE = 0.2
"""The share of the margins that discretisation errors may use up."""
MOST_SUBSTEPS = 32
WITHIN = 4
"""The number of instants per step at which limits are checked for a finished motion."""
BEYOND = 1.25
"""A limit is moved by this multiple of the excess over it."""


def refined(path_problem: PathProblem, trajectory: Trajectory) -> PathProblem:
    """The same task with enough substeps to integrate a motion accurately.

    Doubling them once more moves no point and no coordinate by more than a share of its margin.
    """
    substeps = path_problem.substeps
    share = INTEGRATION_SHARE * np.array([path_problem.margin, path_problem.limit_margin])
    while (
        substeps < MOST_SUBSTEPS and not (_gaps(path_problem, trajectory, substeps) <= share).all()
    ):
        substeps *= 2
    return replace(path_problem, substeps=substeps)


def unstable(path_problem: PathProblem, trajectory: Trajectory) -> bool:
    """Whether the inputs alone do not keep the robot near the motion found for them.

    Integration errors then move it away by more than the margin.
    """
    return not _gaps(path_problem, trajectory, path_problem.substeps)[0] <= path_problem.margin


def growth(path_problem: PathProblem, trajectory: Trajectory) -> float:
    """The largest factor by which a small deviation at a sample grows until the end (SI)."""
    numeric, dt = path_problem.numeric, float(path_problem.task.step)
    with np.errstate(all="ignore"):
        steps = numeric.step(
            trajectory.x[:-1], trajectory.u, trajectory.theta, dt, path_problem.substeps
        ).state
        found, most = np.eye(numeric.size), 1.0
        for step in steps[::-1]:
            # The absolute row sum bounds the effect of deviations of unit size.
            found = found @ step
            most = max(most, float(np.max(np.sum(np.abs(found), axis=1))))
    return most


def _gaps(path_problem: PathProblem, trajectory: Trajectory, substeps: int) -> Array:
    """The change of points (m) and states (SI) if the number of substeps is doubled, (2,)."""
    numeric, n = path_problem.numeric, path_problem.numeric.n
    dt, theta, u = float(path_problem.task.step), trajectory.theta, trajectory.u
    with np.errstate(all="ignore"):
        if path_problem.feedback:
            found = [numeric.step(trajectory.x[:-1], u, theta, dt, c * substeps) for c in (1, 2)]
            pair = [each.value for each in found]
        else:
            first = trajectory.x[0]
            pair = [numeric.simulate(first, u, theta, dt, c * substeps) for c in (1, 2)]
        lasting = numeric.spanning.lasting
        points = [numeric.positions(states[:, :n], theta)[:, lasting] for states in pair]
    return np.array([_largest_gap(*points), _largest_gap(*pair)])


def _largest_gap(before: Array, after: Array) -> float:
    return float(np.max(np.abs(after - before), initial=0.0))


def narrowed(path_problem: PathProblem, trajectory: Trajectory) -> PathProblem | None:
    """The same task with those limits narrowed that a motion exceeds within its steps, or None."""
    n = path_problem.numeric.n
    with np.errstate(all="ignore"):
        x = _within_steps(path_problem, trajectory)
    states = x[:, : 2 * n].reshape(len(x), 2, n).transpose(2, 1, 0)
    limits = state_limits(path_problem.model)
    below = limits[:, :, 0] - np.min(states, axis=2)
    above = np.max(states, axis=2) - limits[:, :, 1]
    beyond = np.stack([below, above], axis=2) + LIMIT_MARGIN / 2
    return inset(path_problem, beyond) if bool(np.any(beyond > 0)) else None


def inset(path_problem: PathProblem, beyond: Array) -> PathProblem:
    """The same task with limits narrowed because motions are ``beyond`` them, in SI.

    Its shape is (n, 2, 2) for the lower and upper ends of ranges and rates, or (n, 2, 1) if both
    ends are alike.  Values below 0 count as 0.
    """
    before = np.zeros((len(beyond), 2, 2)) if path_problem.insets is None else path_problem.insets
    return replace(path_problem, insets=before + np.maximum(0.0, BEYOND * beyond))


def _within_steps(path_problem: PathProblem, trajectory: Trajectory) -> Array:
    """The states (K, N) at ``WITHIN`` instants of every step."""
    numeric, theta, u = path_problem.numeric, trajectory.theta, trajectory.u
    dt, substeps = float(path_problem.task.step), path_problem.substeps
    parts = max(1, substeps // WITHIN)
    if not path_problem.feedback:
        often = np.repeat(u, WITHIN, axis=0)
        return numeric.simulate(trajectory.x[0], often, theta, dt / WITHIN, parts)
    times = [k * dt / WITHIN for k in range(1, WITHIN)]
    found = [numeric.step(trajectory.x[:-1], u, theta, time, substeps).value for time in times]
    return np.concatenate([trajectory.x, *found])


# --- Whether a motion seems to satisfy formulas between its samples, in floats --------------------


def seems_to_satisfy(path_problem: PathProblem, seen: SimulatedMotion) -> bool:
    """Whether effectors satisfy the formulas at the simulated instants of a motion."""
    formulas = [clause.formula for clause in path_problem.task.satisfy]
    if not formulas:
        return True
    task, workspace, numeric = path_problem.task, path_problem.workspace, path_problem.numeric
    with np.errstate(all="ignore"):
        places = numeric.positions(seen.states[:, : numeric.n], seen.theta)
    word: list[dict[int, frozenset[str]]] = [{} for _ in seen.states]
    inside: dict[int, dict[str, Array]] = {}
    for atom in atoms(*formulas):
        shape = polytope_of(workspace.region(atom.region).shape, workspace.dimension)
        there = np.all(places[:, atom.effector - 1] @ shape.A.T <= shape.b, axis=1)
        there &= in_poses(numeric, atom.poses, atom.effector - 1, places)
        inside.setdefault(atom.effector, {})[_plain(atom).region] = there
    for effector, regions in inside.items():
        for instant, letter in enumerate(word):
            letter[effector] = frozenset(name for name, flags in regions.items() if flags[instant])
    step = task.step / Fraction(seen.fine)
    plain = (with_atoms(formula, _plain) for formula in formulas)
    return all(holds(sampled(f, step, task.steps * seen.fine), word) for f in plain)


def _plain(atom: ir.Atom) -> ir.Atom:
    """An atom without poses; if it had some, it gets a region of its own, named after it."""
    if not atom.poses:
        return atom
    return replace(atom, region=formula_text(replace(atom, numbered=False)), poses=())
