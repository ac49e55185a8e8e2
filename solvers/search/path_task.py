"""The control problem of a path, messages about it, and the design that it may lead to."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from fractions import Fraction

import numpy as np

from compiler.discretisation.numeric_robot import NumericRobot
from compiler.robots.parameter_values import ParameterValue
from compiler.robots.robot import RobotModel
from compiler.tasks.carrying import carried_on_samples
from compiler.tasks.sampled_formula import sampled
from compiler.tasks.specification import path_formulas
from compiler.tasks.word_formula import SampledFormula, every
from compiler.words.derivation import Derivation
from compiler.workspaces.abstraction import Abstraction
from grammar_lang import ir
from grammar_lang.ir.formula_parts import asked_poses
from solvers.parameters.parameter_search import parameter_space
from solvers.planner import EffectorPath, Exhausted
from solvers.search.configuration_search import Configuration
from solvers.trajectory.control import shortfall
from solvers.trajectory.path_following import SUBSTEPS, PathProblem
from solvers.trajectory.task_size import least_margin
from solvers.verifier.claims.claimed_inputs import input_margins
from solvers.verifier.claims.further_claims import (
    ControllerClaim,
    LoopClaim,
    exact_law,
    exact_loop,
)
from solvers.verifier.proofs.checked_condition import CheckedCondition
from solvers.verifier.proofs.effort_bounds import Margin
from solvers.verifier.proofs.trajectory_proof import Motion

# --------------------------------------------------------------------------------------------------
# From a task and a cell path to the control problem that the search of parameters evaluates.


@dataclass(frozen=True, slots=True)
class PathTask:
    """A robot in a task; ``formula`` is the task's formulas on the samples.

    ``loop`` is the sample at which the loop of an unending motion begins.  ``solver`` is the solver
    of the convex steps, by its name in cvxpy; None for the built-in one.
    """

    program: ir.Program
    task: ir.Task
    numeric: NumericRobot
    formula: SampledFormula | None
    seed: int
    solver: str | None = None
    loop: int | None = None

    def path_problem(
        self, cells: Abstraction, recorded: int, leader: int, path: tuple[int, ...]
    ) -> PathProblem:
        """The path problem of ``leader`` at the first margin; effector ``recorded`` reaches."""
        return PathProblem(
            self.numeric,
            self.program.workspaces[self.task.workspace],
            self.task,
            cells,
            leader,
            path,
            least_margin(self.program.workspaces[self.task.workspace], self.task),
            self.seed,
            substeps=stable_parts(self.numeric, float(self.task.step), SUBSTEPS),
            recorded=recorded,
            formula=self.on_samples(recorded),
            loop=self.loop,
            solver=self.solver,
        )

    def on_samples(self, recorded: int) -> SampledFormula | None:
        """The formula on the samples if effector ``recorded`` reaches; None if there is none."""
        staying = path_formulas(self.task, recorded)[len(self.task.satisfy) :]
        parts = [sampled(formula, self.task.step, self.task.steps) for formula in staying]
        parts += carried_on_samples(self.task)
        if not parts:
            return self.formula
        return every(parts if self.formula is None else [self.formula, *parts])

    def along(
        self, cells: Abstraction, recorded: int, leader: int, names: Sequence[Sequence[str]]
    ) -> PathProblem | None:
        """The path problem of the path of a design, with the entries of the design.

        ``names`` are the cells of every effector by sample.  None if those of the leader are not a
        path.
        """
        paths = [entered(cells, effector, each) for effector, each in enumerate(names)]
        own = paths[leader]
        if own is None or own.entries is None:
            return None
        others = tuple(path for path in paths if path is not None and path is not own)
        path_problem = self.path_problem(cells, recorded, leader, own.cells)
        return replace(
            path_problem, timing=own.entries, others=() if path_problem.formula is None else others
        )


def entered(cells: Abstraction, effector: int, names: Sequence[str]) -> EffectorPath | None:
    """The path of an effector whose cell at every sample is given; None if it is not a path."""
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
# The number of parts of a step that the explicit method of the search needs to be stable.
#
# The classical Runge-Kutta method damps a mode of rate lambda only while h |lambda| < 2.78 (Hairer
# & Wanner, *Solving Ordinary Differential Equations II*, section IV.2).


STABLE = 2.0
SAMPLES = 8
MOST = 256


def stable_parts(numeric: NumericRobot, dt: float, least: int) -> int:
    """The number of parts of a step of ``dt`` seconds: ``least``, or more if there are fast modes.

    The modes are those of the robot linearised at random poses.
    """
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


def nearest_text(
    path_problem: PathProblem, found: Configuration, sample: int, names: Sequence[str]
) -> str:
    """A description of where the most robust motion along the cells ``names`` gets stuck.

    ``sample`` is the first sample that it does not reach.
    """
    task = path_problem.task
    if sample > task.steps or found.outcome.robustness >= 0:
        problem = path_problem.problem(found.entries, released=True)
        lacks = shortfall(problem, found.outcome, posed=bool(asked_poses(task)))
        what = f"the motion found {lacks}"
    else:
        what = stuck_text(sample, task)
    return f"; nearest, through {' > '.join(names)}, {what}"


def exhausted_text(ended: Exhausted, task: ir.Task) -> str:
    """Why there is no plan, in words."""
    if ended.blocked or ended.plans:
        return "no path is left"
    return (
        f"planning: {ended.why.value}; the task has {task.steps + 1} samples, "
        "and a step has one change of cell at most"
    )


def stuck_text(sample: int, task: ir.Task) -> str:
    """A description of where a motion gets stuck; ``sample`` is the first it does not reach."""
    what = "cannot go on at" if sample < task.steps else "does not get there by"
    return f"the motion {what} {float(sample * task.step):.4g} s"


# --- A proved robot with its motion, from which certificates, tables and pictures are made --------


@dataclass(frozen=True, slots=True)
class Design:
    """A robot in exact decimals, with its trajectory in floats for tables and pictures.

    ``effector`` starts and reaches, ``leader`` followed the cell path; ``path`` names cells of
    ``abstraction``.  ``conditions`` are the results of the proof.  ``held_at_start`` and
    ``held_at_end``: whether the drives seem to hold the robot where its motion begins, and at its
    target; None if it need not be at rest there, or certainly stays.
    """

    derivation: Derivation
    model: RobotModel
    parameters: tuple[ParameterValue, ...]
    effector: int
    leader: int
    start: tuple[str, ...]
    inputs: tuple[tuple[str, ...], ...]
    path: tuple[tuple[str, ...], ...]
    configuration: Configuration
    abstraction: Abstraction
    conditions: tuple[CheckedCondition, ...] = ()
    controller: ControllerClaim | None = None
    loop: LoopClaim | None = None
    held_at_start: bool | None = None
    held_at_end: bool | None = None

    @property
    def robustness(self) -> float:
        """Rho of the motion."""
        return self.configuration.outcome.robustness


def motion_of(design: Design) -> Motion:
    """The exact numbers of a design."""
    return Motion(
        design.parameters,
        tuple(Fraction(value) for value in design.start),
        tuple(tuple(Fraction(value) for value in row) for row in design.inputs),
        design.effector,
        design.path,
        None if design.controller is None else exact_law(design.controller),
        None if design.loop is None else exact_loop(design.loop),
    )


def stated_inputs(design: Design) -> list[tuple[Fraction, ...]]:
    """The inputs of a design as stated: exact, one row (m,) per step."""
    return [tuple(Fraction(text) for text in row) for row in design.inputs]


def design_margins(design: Design, task: ir.Task) -> list[Margin]:
    """The margins between a design's planned inputs and their bounds."""
    inputs = None if design.controller is not None else stated_inputs(design)
    return input_margins(design.model, task, inputs, design.conditions)


def robustness_share(design: Design, task: ir.Task) -> float | None:
    """The least of these margins relative to its maximum; None if no input has any range."""
    counted = [each for each in design_margins(design, task) if each.widest > 0]
    return min((each.least / each.widest for each in counted), default=None)
