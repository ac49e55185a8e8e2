"""Plans of different homotopy kinds: ways that pass obstacles on different sides.

Source: in the plane, the h-signature (Bhattacharya, Kumar & Likhachev, *Search-based path planning
with homotopy class constraints*, AAAI 2010): a ray points upwards from a point in every obstacle.
A path is assigned the word of the rays that it crosses, with their signs, in which adjacent
inverses cancel.  In space, a single obstacle does not divide paths into classes.  There the kind is
how a path winds about the obstacles: the words of its projections along each axis.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise
from typing import TypeAlias

import numpy as np

from compiler.arrays import Array
from compiler.tasks.specification import PlanningProblem
from compiler.workspaces.abstraction import Abstraction
from compiler.workspaces.polytope import polytope_of
from grammar_lang import ir
from solvers.planner import CounterExample, Plan, Planner
from solvers.trajectory.path_timing import polyline
from solvers.verdict import Holds

Kind: TypeAlias = tuple[tuple[int, ...], ...]
"""One word per effector and projection: obstacle i (from 1), negative if passed leftwards."""
MOST_DETOURS = 12
"""The number of cells of a plan that are left out in turn to find other plans."""


def other_kinds(
    problem: PlanningProblem,
    plan: Plan,
    cells: Abstraction,
    obstacles: Array,
    known: Sequence[CounterExample] = (),
) -> list[Plan]:
    """Plans of other kinds than a plan, one of each, in ascending order of changes of cell.

    They are found by leaving out one cell of the plan in turn.

    Args:
        problem: the planning problem.
        plan: one of its plans.
        cells: the cells.
        obstacles: a point in every obstacle, shape (obstacles, dimension).
        known: counterexamples, which exclude plans.
    """
    found = {kind_of(plan, cells, obstacles): plan}
    first = max(plan.paths, key=lambda path: len(path.cells))
    inner = list(dict.fromkeys(first.cells[1:-1]))
    chosen = np.unique(np.linspace(0, len(inner) - 1, MOST_DETOURS).round().astype(int))
    for cell in (inner[index] for index in chosen.tolist()) if len(obstacles) and inner else ():
        planner = Planner(without_cell(problem, first.effector, cell))
        for counterexample in known:
            planner.block(counterexample)
        answer = planner.next_plan()
        if isinstance(answer, Holds):
            found.setdefault(kind_of(answer.witness, cells, obstacles), answer.witness)
    return sorted(list(found.values())[1:], key=lambda each: each.changes)


def without_cell(problem: PlanningProblem, effector: int, cell: int) -> PlanningProblem:
    """The problem in which an effector (from 0) may not enter a cell."""
    planned = (
        replace(one, forbidden=tuple(sorted({*one.forbidden, cell})))
        if one.effector == effector
        else one
        for one in problem.effectors
    )
    return replace(problem, effectors=tuple(planned))


def obstacle_points(workspace: ir.Workspace, task: ir.Task) -> Array:
    """A point of the workspace in every region that the task avoids, shape (k, dimension)."""
    names = dict.fromkeys(name for avoid in task.avoid for name in avoid.regions)
    bounds = polytope_of(workspace.bounds.shape, workspace.dimension)
    shapes = (polytope_of(workspace.region(name).shape, workspace.dimension) for name in names)
    inside = (bounds.intersection(shape) for shape in shapes)
    centres = [[float(x) for x in part.centre] for part in inside if not part.is_empty]
    return np.array(centres, dtype=float).reshape(len(centres), workspace.dimension)


def kind_of(plan: Plan, cells: Abstraction, obstacles: Array) -> Kind:
    """The kind of a plan: the words of its effectors' lines about obstacles, points (k, d)."""
    found = list[tuple[int, ...]]()
    for path in plan.paths:
        line = polyline(cells, path.cells).points
        dimension = line.shape[1]
        planes = [(0, 1)] if dimension == 2 else [(0, 1), (0, 2), (1, 2)]
        found += [crossings(line[:, plane], obstacles[:, plane]) for plane in planes]
    return tuple(found)


def crossings(line: Array, points: Array) -> tuple[int, ...]:
    """The reduced word of the upward rays from points (k, 2) that a line (m, 2) crosses."""
    word = list[int]()
    for start, end in pairwise(line):
        run = end[0] - start[0]
        between = (np.minimum(start[0], end[0]) <= points[:, 0]) & (
            points[:, 0] < np.maximum(start[0], end[0])
        )
        crossed = np.flatnonzero(between)
        along = (points[crossed, 0] - start[0]) / run if len(crossed) else np.zeros(0)
        above = start[1] + along * (end[1] - start[1]) > points[crossed, 1]
        for index in np.argsort(along[above], kind="stable").tolist():
            letter = (int(crossed[above][index]) + 1) * (1 if run > 0 else -1)
            if word and word[-1] == -letter:
                word.pop()
            else:
                word.append(letter)
    return tuple(word)
