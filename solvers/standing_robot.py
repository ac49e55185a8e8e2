"""Robots without a degree of freedom: they do a task if they stand where it begins and ends."""

from __future__ import annotations

import numpy as np
from scipy.stats.qmc import Sobol

from compiler.discretisation.float_reading import Array, FloatReading
from compiler.geometry.abstraction import Abstraction
from compiler.geometry.polytope import polytope_of
from grammar_lang import ir
from solvers.configuration_search import Configuration
from solvers.control import ControlOutcome, input_margin
from solvers.convex_step import Trajectory
from solvers.parameter_search import parameter_space
from solvers.task_limits import input_groups, resting_inputs

SAMPLES_LOG2 = 9
KEPT = 4


def standing_configurations(
    reading: FloatReading,
    workspace: ir.Workspace,
    task: ir.Task,
    abstraction: Abstraction,
    effector: int,
    seed: int,
) -> list[tuple[int, Configuration]]:
    """Cells and motionless configurations with the effector deepest in start and target, or none.

    The parameters are samples: what is not found may still exist.
    """
    model = reading.graph.model
    if model.dofs:
        raise ValueError("the robot has degrees of freedom")
    bound: list[tuple[int, str]] = [(effector, task.goal.region)]
    if isinstance(task.start, ir.StartIn):
        named = task.start.effector
        bound.append((effector if named is None else named - 1, task.start.region))
    found = []
    for theta in _samples(reading, seed):
        points = reading.points(np.zeros((1, 0)), theta).value[0]
        gap = min(_depth(workspace, name, points[point]) for point, name in bound)
        cell = abstraction.locate(points[effector])
        if gap > 0 and cell is not None:
            found.append((gap, cell, theta))
    found.sort(key=lambda item: -item[0])
    return [(cell, _motionless(reading, task, theta)) for _, cell, theta in found[:KEPT]]


def _samples(reading: FloatReading, seed: int) -> list[Array]:
    space = parameter_space(reading.graph.model)
    if space.is_point:
        return [space.lower]
    cube = Sobol(len(space.lower), seed=seed).random_base2(SAMPLES_LOG2)
    return [space.from_cube(point) for point in cube]


def _depth(workspace: ir.Workspace, name: str, point: Array) -> float:
    """The distance in metres from a point to the nearest facet of a region; negative outside."""
    polytope = polytope_of(workspace.region(name).shape, workspace.dimension)
    return float(np.min(polytope.b - polytope.A @ point))


def _motionless(reading: FloatReading, task: ir.Task, theta: Array) -> Configuration:
    k = task.steps
    groups = input_groups(reading.graph.model, task)
    inputs = resting_inputs(groups, k, reading.m)
    still = Trajectory(np.zeros((k + 1, reading.size)), inputs, theta)
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
