"""From a task and a cell path to the control problem that the search of parameters evaluates."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from compiler.discretisation.numeric_robot import NumericRobot
from compiler.tasks.word_formula import SampledFormula
from compiler.workspaces.abstraction import Abstraction
from grammar_lang import ir
from solvers.parameters.parameter_space import parameter_space
from solvers.planner import EffectorPath
from solvers.trajectory.path_following import LEAST_MARGIN, SUBSTEPS, PathProblem


@dataclass(frozen=True, slots=True)
class PathTask:
    """A robot in a task; ``formula`` is what the task's formulas ask of the samples.

    ``solver`` is that of the convex steps, by its name in cvxpy; None: our own.
    """

    program: ir.Program
    task: ir.Task
    numeric: NumericRobot
    formula: SampledFormula | None
    seed: int
    solver: str | None = None

    def path_problem(
        self, cells: Abstraction, recorded: int, leader: int, path: tuple[int, ...]
    ) -> PathProblem:
        """The path problem of a path of ``leader`` at the first margin; ``recorded`` reaches."""
        return PathProblem(
            self.numeric,
            self.program.workspaces[self.task.workspace],
            self.task,
            cells,
            leader,
            path,
            LEAST_MARGIN,
            self.seed,
            substeps=stable_parts(self.numeric, float(self.task.step), SUBSTEPS),
            recorded=recorded,
            formula=self.formula,
            solver=self.solver,
        )

    def along(
        self, cells: Abstraction, recorded: int, leader: int, names: Sequence[Sequence[str]]
    ) -> PathProblem | None:
        """The path problem of the path of a design, entered as the design enters it.

        None where what ``names``, the cells of every effector by sample, says of the leader is no
        path.
        """
        paths = [entered(cells, effector, each) for effector, each in enumerate(names)]
        own = paths[leader]
        if own is None or own.entries is None:
            return None
        others = tuple(path for path in paths if path is not None and path is not own)
        path_problem = self.path_problem(cells, recorded, leader, own.cells)
        return replace(
            path_problem, timing=own.entries, others=() if self.formula is None else others
        )


def entered(cells: Abstraction, effector: int, names: Sequence[str]) -> EffectorPath | None:
    """The path of an effector whose cell at every sample is given; None where it is none."""
    known = {cell.name: index for index, cell in enumerate(cells.cells)}
    path, entries = list[int](), list[int]()
    for sample, name in enumerate(names):
        cell = known.get(name)
        if cell is None:
            return None
        if path and path[-1] == cell:
            continue
        if path and cell not in cells.neighbours[path[-1]]:
            return None
        path.append(cell)
        entries.append(sample)
    return EffectorPath(effector, tuple(path), tuple(entries)) if path else None


# --------------------------------------------------------------------------------------------------
# Into how many parts a step must be divided for the explicit method of the search to be stable.
#
# The classical Runge-Kutta method damps a mode of rate lambda only while h |lambda| < 2.78 (Hairer
# & Wanner, *Solving Ordinary Differential Equations II*, section IV.2).


STABLE = 2.0
SAMPLES = 8
MOST = 256


def stable_parts(numeric: NumericRobot, dt: float, least: int) -> int:
    """At least ``least`` parts, more where the linearised robot has fast modes at random poses."""
    n, size = numeric.n, numeric.size
    rng = np.random.default_rng(0)
    x = np.zeros((SAMPLES, size))
    x[:, :n] = rng.uniform(-1, 1, (SAMPLES, n))
    rates = [0.0]
    for theta in parameter_space(numeric.graph.model).uniform(rng, 2):
        with np.errstate(all="ignore"):
            _, jacobian = numeric.acceleration(x, np.zeros((SAMPLES, numeric.m)), theta)
        slope = np.zeros((SAMPLES, size, size))
        slope[:, :n, n : 2 * n] = np.eye(n)
        slope[:, n:] = jacobian[:, :, :size]
        finite = slope[np.isfinite(slope).all(axis=(1, 2))]
        rates.append(float(np.max(np.abs(np.linalg.eigvals(finite)), initial=0.0)))
    return int(min(MOST, max(least, np.ceil(dt * max(rates) / STABLE))))
