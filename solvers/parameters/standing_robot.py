"""Robots without a degree of freedom: they do a task if they stand where they should."""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction

import numpy as np

from compiler.arrays import Array
from compiler.discretisation.numeric_robot import NumericRobot
from compiler.geometry.abstraction import Abstraction
from compiler.geometry.polytope import Polytope, polytope_of
from compiler.specifications.monitor import AtomKey, key
from compiler.specifications.subformulas import atoms
from compiler.specifications.trace_robustness import Monitored, Piece
from grammar_lang import ir
from solvers.motions.control_problem import ControlOutcome, input_margin
from solvers.motions.task_limits import input_groups, resting_inputs
from solvers.motions.trajectory import Trajectory
from solvers.parameters.configuration_search import Configuration
from solvers.parameters.parameter_space import parameter_space

SAMPLES_LOG2 = 9
KEPT = 4


def standing_configurations(
    numeric: NumericRobot,
    workspace: ir.Workspace,
    task: ir.Task,
    abstraction: Abstraction,
    effector: int,
    seed: int,
) -> list[tuple[int, Configuration]]:
    """Cells and motionless configurations that meet the regions of a task most clearly, or none.

    The parameters are samples: what is not found may still exist.
    """
    model = numeric.graph.model
    if model.dofs:
        raise ValueError("the robot has degrees of freedom")
    bound: list[tuple[int, str]] = []
    if task.reach is not None:
        bound.append((effector, task.reach.region))
    if isinstance(task.start, ir.StartIn):
        named = task.start.effector
        bound.append((effector if named is None else named - 1, task.start.region))
    names = {name for _, name in bound} | {atom.region for atom in _atoms(task)}
    shapes = {
        region.name: polytope_of(region.shape, workspace.dimension)
        for region in workspace.regions
        if region.name in names
    }
    found = []
    for theta in parameter_space(model).samples(SAMPLES_LOG2, seed):
        points = numeric.points(np.zeros((1, 0)), theta).value[0]
        depths = [_depth(shapes[name], points[point]) for point, name in bound]
        gap = min([*depths, _worth(shapes, task, points)])
        cell = abstraction.locate(points[effector])
        if gap > 0 and cell is not None:
            found.append((gap, cell, theta))
    found.sort(key=lambda item: -item[0])
    return [(cell, _motionless(numeric, task, theta)) for _, cell, theta in found[:KEPT]]


def _depth(polytope: Polytope, point: Array) -> float:
    """The distance in metres from a point to the nearest facet of a region; negative outside."""
    return float(np.min(polytope.b - polytope.A @ point, initial=np.inf))


def _atoms(task: ir.Task) -> tuple[ir.Atom, ...]:
    return atoms(*(clause.formula for clause in task.satisfy))


def _worth(shapes: Mapping[str, Polytope], task: ir.Task, points: Array) -> float:
    """By how much effectors at rest at some points, shape (n, d), satisfy all formulas, in metres.

    Not positive where they do not.
    """
    end = task.step * task.steps
    trace: dict[AtomKey, list[Piece]] = {}
    for atom in _atoms(task):
        depth = _depth(shapes[atom.region], points[atom.effector - 1])
        trace[key(atom)] = [Piece(Fraction(0), end, depth, -depth)]
    formulas = (Monitored(clause.formula, end, task.step) for clause in task.satisfy)
    return min((formula.robustness(trace) or 0.0 for formula in formulas), default=float("inf"))


def _motionless(numeric: NumericRobot, task: ir.Task, theta: Array) -> Configuration:
    k = task.steps
    groups = input_groups(numeric.graph.model, task)
    inputs = resting_inputs(groups, k, numeric.m)
    still = Trajectory(np.zeros((k + 1, numeric.size)), inputs, theta)
    margin = input_margin(groups, still.u)
    outcome = ControlOutcome(
        still,
        feasible=True,
        robustness=margin,
        effort_peak=0.0,
        fictitious=np.zeros(k),
        excess=0.0,
        iterations=0,
        status="motionless",
    )
    return Configuration(outcome, (0,), 1, ())
