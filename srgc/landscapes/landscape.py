"""Rho over one or two parameters of a robot that was found (the paper's Figure 4).

The robot keeps its structure, its cell path and the steps at which cells are entered; its other
parameters stay as designed.  Each value is computed as in the search, with the margin that a search
begins with and the timing free, from the search's seeds along the path and from the design's
motion.
"""

from __future__ import annotations

import csv
import io
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from itertools import islice, product
from pathlib import Path

import numpy as np

from compiler.arrays import Array
from compiler.discretisation.numeric_robot import NumericRobot
from compiler.dynamics.equations_of_motion import robot_graph
from compiler.expressions.exact_numbers import decimal
from compiler.robots.state_and_input import input_bounds
from compiler.tasks.obstacle_pieces import expanded
from solvers.execution.workers import Workers
from solvers.search.configuration_search import Sample
from solvers.search.evaluation import Evaluator, SolveRequest
from solvers.search.path_task import PathTask
from solvers.search.round_task import round_tasks
from solvers.trajectory.control_problem import ControlOutcome, input_margin
from solvers.trajectory.path_following import PathProblem
from solvers.trajectory.task_limits import effort_scale, input_groups
from solvers.trajectory.trajectory import Trajectory
from solvers.verifier.claims.certificate import exact
from srgc.landscapes.landscape_request import Axis, Mark
from srgc.results.design_file import last_samples
from srgc.results.found_design import FoundDesign, FoundRecord
from srgc.session import UsageFault
from srgc.text_reports.synthesis_report import amount


@dataclass(frozen=True, slots=True)
class Landscape:
    """The evaluations of a landscape.

    ``grid`` is in the order of the axes, the last axis fastest; ``marked`` are the evaluations at
    the marks; ``samples`` are those of the search; ``design`` is the design with its rho.
    """

    axes: tuple[Axis, ...]
    grid: tuple[Sample, ...]
    marks: tuple[Mark, ...]
    marked: tuple[Sample, ...]
    samples: tuple[Sample, ...]
    design: Sample

    def at(self, sample: Sample) -> tuple[float, ...]:
        """The coordinates of a sample on the axes."""
        return tuple(float(sample.theta[axis.place]) for axis in self.axes)

    @property
    def best(self) -> Sample:
        """The sample of the grid with the largest rho."""
        return max(self.grid, key=lambda sample: sample.robustness)


def landscape(
    found: FoundDesign,
    record: FoundRecord,
    folder: Path,
    axes: tuple[Axis, ...],
    marks: tuple[Mark, ...],
    workers: Workers,
    told: Callable[[int, int], None],
) -> Landscape:
    """Evaluate a grid over the axes, and the marks.

    ``told`` is called with the number of points evaluated so far and the total.

    Raises:
        UsageFault: the design has no path to follow, or its table of evaluations cannot be read.
    """
    names = [parameter.label for parameter in found.model.parameters]
    try:
        searched = last_samples(folder / "evaluations.csv", record.structure, names)
    except (OSError, ValueError) as error:
        raise UsageFault(str(error)) from None
    path_problem = path_problem_of(found, record)
    motion = motion_of(found, path_problem)
    points = [*product(*(axis.values for axis in axes)), *(mark.values for mark in marks)]
    seeds = [_seeds(path_problem, motion, _moved(found.theta, axes, point)) for point in points]
    outcomes = Evaluator(path_problem, workers).solutions(
        [SolveRequest(seed, released=True) for each in seeds for seed in each]
    )
    samples = []
    for each in seeds:
        samples.append(_best(each, islice(outcomes, len(each))))
        told(len(samples), len(seeds))
    count = len(points) - len(marks)
    design = Sample(found.theta, _own(found, record, motion), feasible=True)
    return Landscape(axes, tuple(samples[:count]), marks, tuple(samples[count:]), searched, design)


def _own(found: FoundDesign, record: FoundRecord, motion: Trajectory) -> float:
    """The rho of the design, in the measure of the grid.

    If bounds differ, a search takes the least share of a bound times the largest bound.
    """
    groups = input_groups(found.model, found.task)
    if len({group.widest_margin for group in groups}) < 2:
        return record.robustness
    return input_margin(groups, motion.u)


def path_problem_of(found: FoundDesign, record: FoundRecord) -> PathProblem:
    """The control problem of a design's path.

    Raises:
        UsageFault: the design has none.
    """
    if not found.model.dofs:
        raise UsageFault("the robot cannot move: it has no motion whose robustness could vary")
    program, task = expanded(found.program, found.task)
    numeric = NumericRobot(robot_graph(found.model, task.gravity))
    effector, path = found.claim.effector, found.claim.path
    loop = None if found.claim.loop is None else found.claim.loop.first
    shapes = [part for part in round_tasks(task, effector) if part.loop == loop]
    if not shapes:
        raise UsageFault("the loop of the design is none that a search would look for")
    searched = shapes[0]
    place = PathTask(
        program, searched.task, numeric, searched.formula, record.seed, loop=searched.loop
    )
    path_problem = place.along(record.cells, effector, record.leader, path)
    if path_problem is None:
        raise UsageFault(f"the cells of effector {record.leader + 1} in the design are no path")
    return path_problem


def motion_of(found: FoundDesign, path_problem: PathProblem) -> Trajectory:
    """The motion of a design at the sampling instants, by simulation."""
    u = np.array([[float(exact(text)) for text in row] for row in found.claim.inputs])
    u = u.reshape(len(found.claim.inputs), path_problem.numeric.m)
    start = np.concatenate([[float(value) for value in found.start], path_problem.limits.own_start])
    step = float(found.task.step)
    x = path_problem.numeric.simulate(start, u, found.theta, step, path_problem.substeps)
    return Trajectory(x, u, found.theta)


def _seeds(path_problem: PathProblem, motion: Trajectory, theta: Array) -> list[Trajectory]:
    """The seeds of an evaluation: those of the search along the path, and the design's motion."""
    return [*path_problem.seeds(theta), replace(motion, theta=theta)]


def _best(seeds: Sequence[Trajectory], outcomes: Iterable[ControlOutcome]) -> Sample:
    best = max(outcomes, key=lambda outcome: outcome.robustness)
    return Sample(seeds[0].theta, best.robustness, best.feasible)


def _moved(theta: Array, axes: Sequence[Axis], point: Sequence[float]) -> Array:
    moved = theta.copy()
    for axis, value in zip(axes, point, strict=True):
        moved[axis.place] = value
    return moved


def landscape_csv(found: FoundDesign, content: Landscape) -> str:
    """A row per grid point: all parameters in SI units, ``rho``, and ``feasible`` (0 or 1)."""
    buffer = io.StringIO()
    writer = csv.writer(buffer, lineterminator="\n")
    names = [parameter.label for parameter in found.model.parameters]
    writer.writerow([*names, "rho", "feasible"])
    for sample in content.grid:
        theta = [decimal(value) for value in sample.theta]
        writer.writerow([*theta, decimal(sample.robustness), int(sample.feasible)])
    return buffer.getvalue()


# --- in words -------------------------------------------------------------------------------------


def title(found: FoundDesign, content: Landscape) -> str:
    """The title of the picture."""
    held = len(found.model.parameters) - len(content.axes)
    others = f", {held} more as designed" if held else ""
    names = " and ".join(axis.name for axis in content.axes)
    return f"{found.task.name}: {' '.join(found.claim.word)}\nrobustness over {names}{others}"


def landscape_text(found: FoundDesign, content: Landscape) -> str:
    """The grid, its best point, the design and the marks."""
    feasible = sum(1 for sample in content.grid if sample.feasible)
    lines = [f"robot:   {' '.join(found.claim.word)}"]
    lines += [f"over:    {_described(axis)}" for axis in content.axes]
    lines.append(f"grid:    {len(content.grid)} points, {feasible} feasible")
    if feasible:
        best = content.best
        lines.append(f"best:    {_at(content.at(best))}: {_rho(found, best)}")
    design = content.design
    lines.append(f"design:  {_at(content.at(design))}: {_rho(found, design)}")
    for mark, sample in zip(content.marks, content.marked, strict=True):
        value = _rho(found, sample) if sample.feasible else "infeasible"
        lines.append(f"mark:    {mark.label} {_at(mark.values)}: {value}")
    lines.append(f"samples: {len(content.samples)} of the search")
    return "\n".join(lines)


def _rho(found: FoundDesign, sample: Sample) -> str:
    """The rho of a sample: an amount, or the share of the bounds if these differ."""
    groups = input_groups(found.model, found.task)
    if len({group.widest_margin for group in groups}) > 1:
        return f"rho {100 * sample.robustness / effort_scale(groups):.4g} % of the bounds"
    units = {bound.unit for bound in input_bounds(found.model, found.task)}
    return f"rho {amount(sample.robustness, units.pop() if len(units) == 1 else '1')}"


def _described(axis: Axis) -> str:
    """An axis with its values; for a finite set, all of them."""
    unit = "" if axis.unit == "1" else f" {axis.unit}"
    if axis.discrete:
        values = ", ".join(f"{value:g}" for value in axis.values)
        return f"{axis.name} in {{{values}}}{unit}, all its values"
    return f"{axis.name} in [{axis.values[0]:g}, {axis.values[-1]:g}]{unit}"


def _at(values: tuple[float, ...]) -> str:
    return "(" + ", ".join(f"{value:.4g}" for value in values) + ")"
