"""The control problem of a path, its tightening after a failed proof, and what becomes of it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from fractions import Fraction

import numpy as np

from compiler.discretisation.numeric_robot import NumericRobot
from compiler.robots.parameter_values import ParameterValue
from compiler.robots.robot import RobotModel
from compiler.tasks.sampled_formula import sampled
from compiler.tasks.specification import path_formulas
from compiler.tasks.word_formula import SampledFormula, every
from compiler.words.derivation import Derivation
from compiler.workspaces.abstraction import Abstraction
from grammar_lang import ir
from solvers.parameters.parameter_search import parameter_space
from solvers.planner import CounterExample, EffectorPath, Exhausted
from solvers.search.configuration_search import Configuration
from solvers.trajectory.control import shortfall
from solvers.trajectory.disturbance_spread import DisturbanceSpread
from solvers.trajectory.fine_motion import BEYOND
from solvers.trajectory.path_following import SUBSTEPS, PathProblem
from solvers.trajectory.round_set import LEAST_SLACK
from solvers.trajectory.task_size import LEAST_MARGIN, least_margin
from solvers.verifier.claims.further_claims import (
    ControllerClaim,
    LoopClaim,
    exact_law,
    exact_loop,
)
from solvers.verifier.proofs.checked_condition import CheckedCondition
from solvers.verifier.proofs.endless_conditions import CLOSED, ENTERED
from solvers.verifier.proofs.trajectory_proof import Motion
from solvers.verifier.proofs.tube_checks import Status

# --------------------------------------------------------------------------------------------------
# From a task and a cell path to the control problem that the search of parameters evaluates.


@dataclass(frozen=True, slots=True)
class PathTask:
    """A robot in a task; ``formula`` is what the task's formulas ask of the samples.

    ``loop`` is the sample at which the loop of a motion begins that goes on for ever.  ``solver``
    is that of the convex steps, by its name in cvxpy; None: our own.
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
        """The path problem of a path of ``leader`` at the first margin; ``recorded`` reaches."""
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
        """What a motion in which that effector reaches has to satisfy at the samples."""
        staying = path_formulas(self.task, recorded)[len(self.task.satisfy) :]
        if not staying:
            return self.formula
        parts = [sampled(formula, self.task.step, self.task.steps) for formula in staying]
        return every(parts if self.formula is None else [self.formula, *parts])

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
            path_problem, timing=own.entries, others=() if path_problem.formula is None else others
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
    """At least ``least`` parts of a step of ``dt`` seconds, more where there are fast modes.

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


# --- What a motion is asked to keep free, and how that grows where a proof did not go through -----


WIDENINGS = (1.0, 2.5, 7.5, 20.0, 50.0)
"""How many times as wide as at first margins get."""
LEAST_GROWTH = 0.4
"""By at least this part of itself grows what is left for disturbed motions."""
MOST_SPREADS = 20.0
MOST_SLACK = 100.0
"""The set of a loop is not larger than estimated by more than this part."""
WIDEST = 1.0
"""Metres; no disturbances are worth more tightening."""


@dataclass(frozen=True, slots=True)
class ConstraintTightening:
    """A margin, the same everywhere, and the number of spreads of disturbed motions.

    The margin is the ``least`` one (m), ``widened`` so many times.  Spreads grow with time, and so
    does the tightening; a tube of all disturbed motions is wider than their spread to first order.
    ``slack`` is the part by which the set of a loop is larger than its estimate.
    """

    least: float = LEAST_MARGIN
    widened: int = 0
    spreads: float = 1.0
    slack: float = LEAST_SLACK

    @property
    def is_last(self) -> bool:
        """Whether no wider margin is left."""
        return self.widened == len(WIDENINGS) - 1

    @property
    def margin(self) -> float:
        """The margin in metres."""
        return self.least * WIDENINGS[self.widened]

    def wider(
        self, lacking: float, spread: DisturbanceSpread | None, beyond: float = 0.0
    ) -> ConstraintTightening | None:
        """The tightening to try next; None: no more is worth it.

        Args:
            lacking: what a proof has lacked of ``spread``, as a part of it; 0: something else.
            spread: the tightening that disturbed motions were given; None without disturbances.
            beyond: by what part of it a round leaves the set of its loop; 0: it does not.
        """
        if beyond > 0:
            slack = (1 + self.slack) * (1 + max(LEAST_GROWTH, BEYOND * beyond)) - 1
            return replace(self, slack=slack) if slack <= MOST_SLACK else None
        if spread is None or lacking <= 0:
            return None if self.is_last else replace(self, widened=self.widened + 1)
        growth = 1 + max(LEAST_GROWTH, BEYOND * lacking)
        if growth * self.spreads > MOST_SPREADS or growth * spread.widest > WIDEST:
            return None
        return replace(self, spreads=growth * self.spreads)


def no_margin_text(spread: DisturbanceSpread) -> str:
    """Why a path ends at which no motion leaves disturbed motions the clearance they need."""
    return (
        "no motion was found that leaves disturbed ones the clearance they need, "
        f"{spread.widest:.2g} m at the widest"
    )


def nearest_text(
    path_problem: PathProblem, found: Configuration, sample: int, names: Sequence[str]
) -> str:
    """Where the most robust motion along the cells ``names`` cannot go on, in words.

    ``sample`` is the first that it does not get to.
    """
    task = path_problem.task
    if sample > task.steps or found.outcome.robustness >= 0:
        lacks = shortfall(path_problem.problem(found.entries), found.outcome)
        what = f"the motion found {lacks}"
    else:
        what = stuck_text(sample, task)
    return f"; nearest, through {' > '.join(names)}, {what}"


def exhausted_text(ended: Exhausted, best: float, task: ir.Task) -> str:
    """Why there is no plan, in words; ``best`` is the best robustness of those before."""
    if ended.blocked:
        count = len(ended.blocked)
        return f"no path is left after {count} counterexamples; best robustness {best:.4g}"
    if ended.plans:
        return f"no path is left; best robustness {best:.4g}"
    return (
        f"planning: {ended.why.value}; the task has {task.steps + 1} samples, "
        "and a step has one change of cell at most"
    )


def stuck_text(sample: int, task: ir.Task) -> str:
    """Where a motion cannot go on, in words: ``sample`` is the first that it does not get to."""
    what = "cannot go on at" if sample < task.steps else "does not get there by"
    return f"the motion {what} {float(sample * task.step):.4g} s"


def missing_margin(conditions: Sequence[CheckedCondition], spread: DisturbanceSpread) -> float:
    """By what part an enclosure of all disturbed motions is wider than the tightening given.

    It is infinite where the enclosure ends.  What the disturbances do not move lacks none of this
    tightening, but a wider margin.
    """
    states = float(np.max(spread.states, initial=0.0))
    inputs = float(np.max(spread.inputs, initial=0.0))
    most = {"m": spread.widest, "N*m": inputs, "N": inputs, "SI": spread.final}
    lacking = [0.0]
    for condition in conditions:
        if condition.name in (ENTERED, CLOSED):
            continue
        if condition.status is not Status.HOLDS and condition.margin < 0:
            width = most.get(condition.unit, states)
            if width > 0:
                lacking.append(-condition.margin / width)
            elif np.isinf(condition.margin):
                lacking.append(np.inf)
    return max(lacking)


def beyond_loop(conditions: Sequence[CheckedCondition]) -> float:
    """By what part of it motions leave the set of their loop; 0 where they do not, or it is open.

    They are only known to do so where the tube is complete.
    """
    closing = [each for each in conditions if each.name in (ENTERED, CLOSED)]
    return max((-each.margin for each in closing if each.status is not Status.HOLDS), default=0.0)


# --- A proved robot with its motion: what certificates, tables and pictures are made of -----------


@dataclass(frozen=True, slots=True)
class Design:
    """A robot: exact decimals, with the trajectory in floats for tables and pictures.

    ``effector`` starts and reaches, ``leader`` is the one that followed a cell path; ``path`` names
    cells of ``abstraction``.  ``conditions`` are what the proof has shown.
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


@dataclass(frozen=True, slots=True)
class Attempt:
    """What became of a plan: a proved design, or the best robustness and what to exclude.

    Of an ``unstable`` motion its inputs alone do not keep the robot near; ``noisy`` says that
    errors of measurements alone are more than a motion bears.
    """

    design: Design | None
    robustness: float
    excluded: CounterExample | None = None
    unstable: bool = False
    noisy: bool = False
