"""The cells that an effector can be in, for sampled parameters and poses of a robot.

This yields the cells to start in, the cells within reach, and those in which a robot that cannot
move stands as its task asks.  Sampling can miss cells: this guides a search and proves nothing.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from itertools import combinations, permutations

import numpy as np
from numpy.typing import NDArray

from compiler.arrays import Array
from compiler.discretisation.numeric_robot import NumericRobot
from compiler.tasks.monitor import AtomKey, Monitored, Piece, key
from compiler.tasks.specification import PlannedEffector, PlanningProblem
from compiler.tasks.word_formula import (
    Literal,
    SampledFormula,
    every,
    nodes,
    some,
    throughout,
)
from compiler.workspaces.abstraction import Abstraction
from compiler.workspaces.polytope import Polytope, polytope_of
from grammar_lang import ir
from grammar_lang.ir.formula_parts import atoms
from solvers.parameters.parameter_search import parameter_space
from solvers.search.configuration_search import Configuration
from solvers.trajectory.control_problem import ControlOutcome, Ending, input_margin
from solvers.trajectory.inverse_kinematics import sampled_box, solve_positions
from solvers.trajectory.pose_dwells import in_poses
from solvers.trajectory.task_limits import input_groups, motion_limits, resting_inputs, state_limits
from solvers.trajectory.trajectory import Trajectory

START_SAMPLES = 64
"""Parameter vectors drawn for the cells to start in."""
REACH_LOG2 = 3
POSES = 512
"""For the cells within reach: 2**``REACH_LOG2`` parameter vectors, with this many poses each."""
PAIRED = 4096
"""For the cells of two effectors at once: poses for each of these parameter vectors."""
FEW = 50
"""With fewer poses that have an effector in some cells, nothing is said of other effectors."""
CHUNK = 1 << 22
"""The most products of points and rows held at a time."""
POSES_OF_BODIES = 4
ON_BODY = 1e-9
"""An effector is on a body if within this many metres of it in ``POSES_OF_BODIES`` poses."""
STANDING_LOG2 = 9
KEPT = 4
"""The best of 2**``STANDING_LOG2`` parameters of a motionless robot that are kept."""


def start_cells(
    abstraction: Abstraction, task: ir.Task, numeric: NumericRobot
) -> dict[int, tuple[int, ...]] | None:
    """Maps each effector to the cells it may start in if a start pose is given; else None.

    They depend on the parameters, which are sampled.
    """
    if isinstance(task.start, ir.StartIn):
        return None
    values = motion_limits(numeric.graph.model, task).start_values
    space, rng = parameter_space(numeric.graph.model), np.random.default_rng(0)
    found: dict[int, set[int]] = {e: set() for e in range(len(numeric.graph.model.effectors))}
    for theta in space.uniform(rng, START_SAMPLES):
        if values is not None:
            points = numeric.places(values[None, :], theta)[0]
            for effector, cells in found.items():
                cell = abstraction.locate(points[effector])
                if cell is not None:
                    cells.add(cell)
    return {effector: tuple(sorted(cells)) for effector, cells in found.items()}


def reachable_cells(
    numeric: NumericRobot, abstraction: Abstraction, effector: int, seed: int
) -> NDArray[np.bool_]:
    """For each cell, whether a pose with the effector (from 0) in it was found, shape (cells,)."""
    space, cells = parameter_space(numeric.graph.model), _Stacked(abstraction)
    found = np.zeros(len(abstraction.cells), dtype=bool)
    rng = np.random.default_rng(seed)
    limits = state_limits(numeric.graph.model)[:, 0]
    reach = np.max(np.abs(cells.centres), initial=1.0)
    lower, upper = sampled_box(numeric, (limits[:, 0], limits[:, 1]), float(reach))
    for theta in space.samples(REACH_LOG2, seed):
        q = rng.uniform(lower, upper, size=(POSES, numeric.n))
        points = numeric.places(q, theta)[:, effector]
        found |= cells.hit(points)
        missing = np.flatnonzero(~found)
        if not len(missing):
            break
        targets = cells.centres[missing]
        nearest = [int(np.argmin(np.sum((points - target) ** 2, axis=1))) for target in targets]
        limited = limits[:, 0], limits[:, 1]
        ends, _ = solve_positions(numeric, q[nearest], theta, effector, targets, limited)
        found |= cells.hit(numeric.places(ends, theta)[:, effector])
    return found


def within_reach(
    problem: PlanningProblem, numeric: NumericRobot, abstraction: Abstraction, seed: int
) -> PlanningProblem:
    """The problem without the cells for which no pose of the effector is found."""
    planned = []
    for one in problem.effectors:
        found = reachable_cells(numeric, abstraction, one.effector, seed)
        planned.append(_closed(one, np.flatnonzero(~found).tolist()))
    return replace(problem, effectors=tuple(planned))


def together(
    problem: PlanningProblem, numeric: NumericRobot, abstraction: Abstraction, seed: int
) -> PlanningProblem:
    """The problem of several effectors with what follows from their being on one robot.

    Each starts and ends in or next to a cell where it was found while the others do; and two are
    never at once in regions, named in the formula, where they were not found like that.
    """
    if len(problem.effectors) < 2:
        return problem
    found = _together(problem, numeric, abstraction, seed)
    planned = {one.effector: one for one in problem.effectors}
    for one, other in found:
        here, there = planned[one], planned[other]
        start = found[one, other].seen(here.start, there.start)
        end = there.end if here.end is None else found[one, other].seen(here.end, there.end)
        planned[other] = replace(there, start=start, end=end)
    if problem.formula is None:
        return replace(problem, effectors=tuple(planned.values()))
    apart = _never_at_once(problem, problem.formula, found)
    formula = every([problem.formula, *apart]) if apart else problem.formula
    return replace(problem, effectors=tuple(planned.values()), formula=formula)


@dataclass(frozen=True, slots=True)
class _Together:
    """Cells of two effectors at once: how often the first was in each, (cells,), and ``beside``.

    ``beside`` (cells, cells) says whether the second was found in or next to the cell of the column
    while the first was in the cell of the row.
    """

    often: NDArray[np.int64]
    beside: NDArray[np.bool_]

    def seen(self, given: Sequence[int], cells: Sequence[int] | None) -> tuple[int, ...]:
        """The cells (None: all) of the second one while the first is in one of those given.

        All of them if there are none, or too few samples.
        """
        candidates = tuple(range(len(self.often)) if cells is None else cells)
        if self.often[list(given)].sum() < FEW:
            return candidates
        with_it = np.any(self.beside[list(given)], axis=0)
        return tuple(cell for cell in candidates if with_it[cell]) or candidates

    def excludes(self, rows: Sequence[int], columns: Sequence[int]) -> bool:
        """Whether the first was often in some cells, and never with the second near others."""
        return self.often[rows].sum() >= FEW and not self.beside[np.ix_(rows, columns)].any()


def _together(
    problem: PlanningProblem, numeric: NumericRobot, abstraction: Abstraction, seed: int
) -> dict[tuple[int, int], _Together]:
    """The cells of each two effectors, in either order, at once in random poses."""
    cells, count = _Stacked(abstraction), len(abstraction.cells)
    near = np.eye(count, dtype=np.float32)
    for cell, beside in enumerate(abstraction.neighbours):
        near[cell, list(beside)] = 1.0
    rng, limits = np.random.default_rng(seed), state_limits(numeric.graph.model)[:, 0]
    reach = float(np.max(np.abs(cells.centres), initial=1.0))
    lower, upper = sampled_box(numeric, (limits[:, 0], limits[:, 1]), reach)
    poses = [
        numeric.places(rng.uniform(lower, upper, size=(PAIRED, numeric.n)), theta)
        for theta in parameter_space(numeric.graph.model).samples(REACH_LOG2, seed)
    ]
    # Products of numbers are much faster than those of truth values.
    inside = {
        one.effector: cells.inside(np.concatenate([each[:, one.effector] for each in poses]))
        .astype(np.float32)
        for one in problem.effectors
    }  # fmt: skip
    return {
        (one, other): _Together(
            inside[one].sum(axis=0).astype(np.int64),
            inside[one].T @ np.minimum(inside[other] @ near, 1.0) > 0,
        )
        for one, other in permutations(inside, 2)
    }


def _never_at_once(
    problem: PlanningProblem,
    formula: SampledFormula,
    found: Mapping[tuple[int, int], _Together],
) -> list[SampledFormula]:
    """That two effectors are not in two regions of the formula at once, where it was not seen."""
    asked = {(n.effector - 1, n.region) for n in nodes(formula) if isinstance(n, Literal)}
    cells = {
        region: [cell for cell, known in enumerate(problem.propositions) if region in known]
        for _, region in asked
    }
    away = list[SampledFormula]()
    for (one, first), (other, second) in combinations(sorted(asked), 2):
        if one == other:
            continue
        ways = (one, other, first, second), (other, one, second, first)
        if all(found[a, b].excludes(cells[here], cells[there]) for a, b, here, there in ways):
            places = (first, one), (second, other)
            outside = (Literal(name, each + 1, positive=False) for name, each in places)
            away.append(throughout(some(outside), 0, None))
    return away


def clear_of_bodies(
    problem: PlanningProblem, numeric: NumericRobot, abstraction: Abstraction, task: ir.Task
) -> PlanningProblem:
    """The problem without the cells that bodies avoid, for effectors that are part of a body."""
    avoided = [name for avoid in task.avoid if avoid.subject == "body" for name in avoid.regions]
    if not avoided:
        return problem
    closed, on_body = abstraction.within(avoided), effectors_on_bodies(numeric)
    planned = (
        _closed(one, closed) if one.effector in on_body else one for one in problem.effectors
    )
    return replace(problem, effectors=tuple(planned))


def _closed(planned: PlannedEffector, cells: Iterable[int]) -> PlannedEffector:
    """An effector with further forbidden cells."""
    return replace(planned, forbidden=tuple(sorted({*planned.forbidden, *cells})))


def effectors_on_bodies(numeric: NumericRobot) -> frozenset[int]:
    """The effectors (from 0) that lie on a point or a rod of some body, in random poses."""
    model, n = numeric.graph.model, numeric.n
    count, rng = len(model.effectors), np.random.default_rng(0)
    found = set(range(count))
    for theta in parameter_space(model).uniform(rng, 2):
        points = numeric.positions(rng.uniform(-1.0, 1.0, (POSES_OF_BODIES, n)), theta)
        near = []
        for hull in (each for each in numeric.spanning.hulls if len(each) <= 2):
            start, end = points[:, count + hull[0]], points[:, count + hull[-1]]
            way, off = end - start, points[:, :count] - start[:, None]
            square = np.maximum(np.sum(way**2, axis=1), 1e-300)
            along = np.clip(np.einsum("ked,kd->ke", off, way) / square[:, None], 0.0, 1.0)
            gap = np.linalg.norm(off - along[..., None] * way[:, None], axis=2)
            near.append(np.max(gap, axis=0) <= ON_BODY)
        if near:
            found &= set(np.flatnonzero(np.any(near, axis=0)).tolist())
        else:
            found = set()
    return frozenset(found)


class _Stacked:
    """The rows of all cells, (M, d) and (M,), the start of each cell's rows, and the centres."""

    def __init__(self, abstraction: Abstraction) -> None:
        shapes = [cell.polytope for cell in abstraction.cells]
        self.normals = np.concatenate([shape.A for shape in shapes])
        self.offsets = np.concatenate([shape.b for shape in shapes])
        self.starts = np.cumsum([0, *(len(shape.b) for shape in shapes[:-1])])
        self.centres: Array = np.array([[float(x) for x in shape.centre] for shape in shapes])

    def hit(self, points: Array) -> NDArray[np.bool_]:
        """For each cell, whether one of the points (K, d) lies inside."""
        hit: NDArray[np.bool_] = np.any(self.inside(points), axis=0)
        return hit

    def inside(self, points: Array) -> NDArray[np.bool_]:
        """Whether each of the points (K, d) lies in each cell, shape (K, cells)."""
        found = np.zeros((len(points), len(self.starts)), dtype=bool)
        size = max(1, CHUNK // len(self.offsets))
        for first in range(0, len(points), size):
            excess = points[first : first + size] @ self.normals.T - self.offsets
            worst = np.maximum.reduceat(excess, self.starts, axis=1)
            found[first : first + size] = worst < 0
        return found


def standing_configurations(
    numeric: NumericRobot,
    workspace: ir.Workspace,
    task: ir.Task,
    abstraction: Abstraction,
    effector: int,
    seed: int,
) -> list[tuple[int, Configuration]]:
    """Cells and motionless configurations that satisfy the regions of a task most clearly.

    The parameters are sampled: a configuration may exist even if none is found.

    Raises:
        ValueError: if the robot has degrees of freedom.
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
    for theta in parameter_space(model).samples(STANDING_LOG2, seed):
        points = numeric.positions(np.zeros((1, 0)), theta)[0]
        depths = [_depth(shapes[name], points[point]) for point, name in bound]
        gap = min([*depths, _worth(numeric, shapes, task, points)])
        cell = abstraction.locate(points[effector])
        if gap > 0 and cell is not None:
            found.append((gap, cell, theta))
    found.sort(key=lambda item: -item[0])
    return [(cell, _motionless(numeric, task, theta)) for _, cell, theta in found[:KEPT]]


def _depth(polytope: Polytope, point: Array) -> float:
    """The distance in metres from a point to the nearest facet of a region; negative outside."""
    return float(np.min(polytope.b - polytope.A @ point, initial=np.inf))


def _atoms(task: ir.Task) -> tuple[ir.Atom, ...]:
    return atoms(*(clause.formula for clause in task.demanded))


def _worth(
    numeric: NumericRobot, shapes: Mapping[str, Polytope], task: ir.Task, points: Array
) -> float:
    """The robustness, in metres, of all formulas for effectors at rest at points (n, d).

    It is not positive if a formula is violated.
    """
    end = task.step * task.steps
    trace: dict[AtomKey, list[Piece]] = {}
    for atom in _atoms(task):
        depth, effector = _depth(shapes[atom.region], points[atom.effector - 1]), atom.effector - 1
        if not in_poses(numeric, atom.poses, effector, points[None])[0]:
            depth = -float("inf")
        trace[key(atom)] = [Piece(Fraction(0), end, depth, -depth)]
    formulas = (Monitored(clause.formula, end, task.step) for clause in task.demanded)
    return min((formula.robustness(trace) or 0.0 for formula in formulas), default=float("inf"))


def _motionless(numeric: NumericRobot, task: ir.Task, theta: Array) -> Configuration:
    k = task.steps
    groups = input_groups(numeric.graph.model, task)
    inputs = resting_inputs(groups, k, numeric.m)
    # It stands in one place, where it both picks loads up and puts them down.
    inputs[:, numeric.m - len(task.carries) :] = 1.0
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
        ending=Ending.MOTIONLESS,
    )
    return Configuration(outcome, (0,), ())
