"""The control problem of a robot, a task and a cell path: timing, seeds and half-planes."""

from __future__ import annotations

from bisect import bisect_right
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from compiler.arrays import Array
from compiler.discretisation.numeric_robot import NumericRobot
from compiler.robots.robot import RobotModel
from compiler.tasks.carrying import carried_samples, load_inputs
from compiler.tasks.word_formula import Obligation, SampledFormula, Word, holds, obligations
from compiler.workspaces.abstraction import Abstraction
from grammar_lang import ir
from solvers.trajectory.body_clearance import body_clearance
from solvers.trajectory.control import WORST, synthesise_control
from solvers.trajectory.control_problem import (
    EXCESS,
    FULL,
    ControlOutcome,
    ControlProblem,
    IterationBudget,
)
from solvers.trajectory.convex_set import convex_set
from solvers.trajectory.convex_step import step_maker
from solvers.trajectory.corridor import Corridor, MotionConstraints
from solvers.trajectory.disturbance_spread import DisturbanceSpread, disturbance_spread
from solvers.trajectory.feedback import closed_spread, input_scales, spread_cost
from solvers.trajectory.inverse_kinematics import branches, sampled_box
from solvers.trajectory.joint_seeds import joint_seeds, stops_of
from solvers.trajectory.joint_ways import ClearSpace
from solvers.trajectory.mobility import joint_errors
from solvers.trajectory.path_timing import (
    Entries,
    in_order,
    polyline,
    rests_of,
    smooth_timing,
    timing_of,
    word_of,
)
from solvers.trajectory.position_plan import ASTRAY, PositionPlan
from solvers.trajectory.round_set import LEAST_SLACK, RoundSet, round_sets, turning
from solvers.trajectory.seed_motions import body_seeds
from solvers.trajectory.task_limits import (
    NARROW,
    InputGroup,
    MotionLimits,
    acceleration_limits,
    input_groups,
    motion_limits,
    resting_at,
    resting_inputs,
)
from solvers.trajectory.task_size import least_margin, length_unit
from solvers.trajectory.trajectory import Trajectory

if TYPE_CHECKING:
    from solvers.planner import EffectorPath

SUBSTEPS = 2
ABSORBED = 0.05
"""The share of the margin by which the control synthesis may exceed it."""
LIMIT_MARGIN = 1e-3
"""The distance kept from joint and rate limits, in rad or m (/s), so that proofs succeed."""
OVERSHOOT = 4.0
"""Widening the position margin widens that distance by this factor: motions overshoot."""


@dataclass(frozen=True, slots=True)
class PathProblem:
    """An effector of a robot that has to follow a path of cells, and all other constraints.

    ``margin`` is the clearance kept from position constraints, in metres.  ``recorded`` is the
    effector that starts (unless the task names another) and reaches; None means the one that
    follows the path.  ``insets`` (n, 2, 2) narrows limits of joints and rates further, as motions
    exceeded them, in all by at most the share ``narrowing``. A cell trace has to satisfy
    ``formula``; ``others`` are the paths of other effectors in it.  ``timing`` gives the entries of
    cells if smooth timing will not do.  ``spread`` is the tightening for disturbed motions, beyond
    the margins.  With ``feedback`` a controller keeps robots near the motion; with ``refines``, its
    gains are refined.  ``loop`` is the sample at which a loop begins: the motion must end in the
    state and the cell that it has there.  The set of the loop is larger than its estimate by the
    share ``slack``. If not ``bound`` to its cells, the motion is constrained only by those at both
    ends.  ``in_joints`` says that seeds are ways in joint space, which ignore the cells in between.
    ``rates`` and ``mobility`` are the prices of squared rates and of phi (``mobility.py``), as
    means over the samples, in SI. ``solver`` is the solver of the convex steps, by its name in
    cvxpy; None for our own.  ``box`` are bounds (p,) on the parameters, None for their ranges;
    ``prices`` are those of the parameters (p,), in units of the widest margin of inputs.
    """

    numeric: NumericRobot
    workspace: ir.Workspace
    task: ir.Task
    abstraction: Abstraction
    effector: int
    cells: tuple[int, ...]
    margin: float
    seed: int
    branch_count: int = 4
    substeps: int = SUBSTEPS
    insets: Array | None = None
    narrowing: float = NARROW
    recorded: int | None = None
    formula: SampledFormula | None = None
    others: tuple[EffectorPath, ...] = ()
    timing: Entries | None = None
    spread: DisturbanceSpread | None = None
    feedback: bool = False
    refines: bool = False
    loop: int | None = None
    slack: float = LEAST_SLACK
    bound: bool = True
    in_joints: bool = False
    rates: float = 0.0
    mobility: float = 0.0
    solver: str | None = None
    box: tuple[Array, Array] | None = None
    prices: tuple[float, ...] = ()

    @property
    def model(self) -> RobotModel:
        """The robot."""
        return self.numeric.graph.model

    @property
    def unit(self) -> float:
        """The unit of length, in metres."""
        return length_unit(self.workspace)

    @property
    def constraints(self) -> MotionConstraints:
        """The constraints on positions."""
        recorded = self.effector if self.recorded is None else self.recorded
        return MotionConstraints(
            self.numeric, self.workspace, self.task, self.abstraction, self.effector, recorded,
            self.cells,
        )  # fmt: skip

    @property
    def groups(self) -> tuple[InputGroup, ...]:
        """The bounded inputs, narrowed by what feedback may command in addition."""
        groups = input_groups(self.model, self.task)
        if self.spread is None or not self.spread.inputs.any():
            return groups
        return tuple(group.narrowed(self.spread.inputs) for group in groups)

    @property
    def limit_margin(self) -> float:
        """The distance kept from joint and rate limits, in rad or m (/s)."""
        more = max(0.0, self.margin - least_margin(self.workspace, self.task))
        return LIMIT_MARGIN + OVERSHOOT * more / self.unit

    @property
    def limits(self) -> MotionLimits:
        """The limits of the motion, narrowed so that proofs succeed."""
        insets = 0.0 if self.insets is None else self.insets
        tightening = 0.0 if self.spread is None else self.spread.within_steps[..., None]
        final = 0.0 if self.spread is None else self.spread.final
        slack = self.limit_margin + insets + tightening
        found = motion_limits(self.model, self.task, slack, final, self.narrowing)
        more = 0.0 if self.spread is None else self.spread.accelerations
        found = found.narrowed(self.limit_margin, more)
        return found if self.loop is None else replace(found, loop=self.loop)

    # --- timing and formulas --------------------------------------------------------------------

    def waypoints(self) -> tuple[Array, Entries]:
        """Positions (k + 1, d) in m on the path from rest to rest, and each cell's entry step."""
        line, k, entries = polyline(self.abstraction, self.cells), self.task.steps, self.timing
        if entries is None:
            along, entries = smooth_timing(line, k)
        else:
            along = timing_of(line, entries, k, rests_of(self.obligations(entries), self.effector))
        return line.at(along), entries

    def along(self, cells: tuple[int, ...], entries: Entries) -> PathProblem:
        """The same task on another path with known entries."""
        return replace(self, cells=cells, timing=None if self.formula is None else entries)

    def word(self, entries: Entries) -> Word:
        """The propositions of the cells of every effector that has a path, by sample."""
        own = [(self.effector, self.cells, entries)]
        own += [(path.effector, path.cells, path.entries or (0,)) for path in self.others]
        return word_of(self.abstraction, own, self.task.steps)

    def allows(self, entries: Entries) -> bool:
        """Whether these entries are allowed: every cell has samples, and the formula holds."""
        if not in_order(entries, self.task.steps):
            return False
        if self.loop and self.cells[bisect_right(entries, self.loop) - 1] != self.cells[-1]:
            return False
        return self.formula is None or holds(self.formula, self.word(entries))

    def obligations(self, entries: Entries) -> tuple[Obligation, ...]:
        """The obligations of the motion by the formula; empty if it does not hold."""
        formula = self.formula
        return () if formula is None else obligations(formula, self.word(entries)) or ()

    # --- constraints ----------------------------------------------------------------------------

    def plan(self, entries: Entries, *, released: bool = False) -> PositionPlan:
        """All half-planes for given entries; if ``released``, only cells at fixed ends bind."""
        place, needs = self.waypoints()[0], self.obligations(entries)
        constraints, released = self.constraints, released or not self.bound
        return PositionPlan(
            self.task.steps,
            constraints.dwells(None if released else entries, needs, closed=self.loop is not None),
            constraints.separations(needs),
            self.margin,
            None if released else self.effector,
            place,
            None if self.spread is None else self.spread.points,
            ASTRAY * self.unit,
        )

    def problem(self, entries: Entries, *, released: bool = False) -> ControlProblem:
        """The control problem for given entries; if ``released``, only cells at both ends bind."""
        task, spread = self.task, 0.0 if self.spread is None else self.spread.within_steps[:, :, 1]
        samples = carried_samples(self.obligations(entries), len(task.carries))
        limits = resting_at(self.limits, task, samples, spread)
        plan = self.plan(entries, released=released)
        return ControlProblem(
            self.numeric, float(task.step), self.substeps, limits, self.groups, plan.rows,
            step_maker(self.solver), self.rates / (task.steps + 1), self.mobility / task.steps,
            joint_errors(self.numeric, task) if self.mobility else np.zeros(0), self.unit,
            min(EXCESS * self.unit, ABSORBED * self.margin),
            isinstance(task.start, ir.StartIn) and task.start.held,
            load_inputs(samples, task.steps), self.prices,
        )  # fmt: skip

    # --- seeds and solutions --------------------------------------------------------------------

    def seeds(self, theta: Array) -> list[Trajectory]:
        """Seed trajectories for theta (p,), the most promising first.

        There is one per branch of the inverse kinematics at the start.  If the task constrains
        bodies, they are those that are clear, or ways from a roadmap of clear poses.
        """
        limits = self.limits
        ways = self.joint_ways(theta, straight=False) if self.in_joints else []
        if ways:
            return [self._seed(q, theta) for q in ways]
        place, box = self.waypoints()[0], limits.box
        if limits.start_values is not None:
            first = limits.start_values[None, :]
        else:
            first = branches(
                self.numeric, theta, self.effector, place[0], box, self.seed, self.branch_count
            )
        motions = [self.numeric.track(start, theta, self.effector, place, box) for start in first]
        if self.binds_bodies and motions:
            motions = body_seeds(
                self.corridor(theta), motions, self.waypoints()[1], self.branch_count, self.seed
            )
        return [self._seed(q, theta) for q in motions]

    def _seed(self, q: Array, theta: Array) -> Trajectory:
        """The seed trajectory with coordinates (k + 1, n)."""
        v = np.gradient(q, float(self.task.step), axis=0)
        v[0] = 0.0
        own = np.tile(self.limits.own_start, (len(q), 1))
        u = resting_inputs(input_groups(self.model, self.task), self.task.steps, self.numeric.m)
        return Trajectory(np.concatenate([q, v, own], axis=1), u, theta)

    def joint_ways(self, theta: Array, *, straight: bool, to_edges: bool = False) -> list[Array]:
        """Ways (k + 1, n) in joint space through the places that bind points (``joint_seeds``)."""
        corridor, entries, numeric = self.corridor(theta), self.waypoints()[1], self.numeric
        drawn = corridor.drawn(np.random.default_rng(self.seed))
        far = float(np.max(np.abs(drawn.positions)))
        space = ClearSpace(
            numeric, theta, corridor.clearance, sampled_box(numeric, corridor.box, far),
            corridor.levers, far, self.margin,
        )  # fmt: skip
        stops = stops_of(self.plan(entries, released=True).dwells, self.task.steps)
        first = self.limits.start_values
        return joint_seeds(
            space, stops, drawn, first, self.branch_count, self.seed,
            straight=straight, to_edges=to_edges,
        )  # fmt: skip

    @property
    def binds_bodies(self) -> bool:
        """Whether the task constrains bodies."""
        named = any(avoid.subject == "body" for avoid in self.task.avoid)
        return named or self.task.bounds_body or self.task.avoid_self is not None

    def corridor(self, theta: Array) -> Corridor:
        """The constraints on poses along the path, for theta (p,)."""
        limits, avoidances = self.limits, self.constraints.avoidances
        cells = tuple(convex_set(self.abstraction.cells[cell].polytope) for cell in self.cells)
        return Corridor(
            self.numeric, theta, self.effector, cells, body_clearance(avoidances),
            limits.box, self.margin, limits.start_values is not None, self.unit,
        )  # fmt: skip

    def solve(
        self,
        start: Trajectory,
        entries: Entries | None = None,
        box: tuple[Array, Array] | None = None,
        budget: IterationBudget = FULL,
        radius: float = 0.5,
    ) -> ControlOutcome:
        """Control synthesis from a seed; with ``box``, bounds (p,), parameters are unknowns too."""
        problem = self.problem(entries or self.waypoints()[1])
        return self.solved(problem, start, box, budget, radius)

    def released(
        self,
        start: Trajectory,
        entries: Entries,
        box: tuple[Array, Array] | None,
        budget: IterationBudget,
        radius: float,
    ) -> ControlOutcome:
        """Control synthesis as in ``solve``, but without the cells between the ends of the path.

        The sides of ``box`` have the shape (p,).
        """
        return self.solved(self.problem(entries, released=True), start, box, budget, radius)

    def solved(
        self,
        problem: ControlProblem,
        start: Trajectory,
        box: tuple[Array, Array] | None,
        budget: IterationBudget,
        radius: float,
    ) -> ControlOutcome:
        """Control synthesis for a problem of this path; ``box`` are bounds (p,), or None."""
        problem = turning(problem, start)
        # Trial motions may diverge; a value that is not finite counts as infeasible.
        with np.errstate(all="ignore"):
            outcome = synthesise_control(problem, start, box, budget, radius)
        if np.isfinite(outcome.robustness):
            return outcome
        worst = -WORST * problem.scale
        return replace(outcome, feasible=False, robustness=worst, trajectory=start)

    def with_margin(self, margin: float) -> PathProblem:
        """The same task with another margin."""
        return replace(self, margin=margin)

    def spreading(self, trajectory: Trajectory, factor: float) -> PathProblem:
        """The same task, tightened by ``factor`` times the spread of the disturbed motions."""
        if self.feedback:
            found = self.controlled(trajectory)[1]
        else:
            start = None if self.loop is None else self.round_set(trajectory, None)
            found = self._spread(trajectory, None, start)
        return self if found is None else replace(self, spread=found.scaled(factor))

    def round_set(self, trajectory: Trajectory, gains: Array | None) -> RoundSet | None:
        """The set of states in which rounds of the loop begin, or None if none is found.

        Of several sets, it is the one from which motions with ``gains`` (k, m, N) spread least.

        Raises:
            ValueError: if the motion has no loop.
        """
        if self.loop is None:
            raise ValueError("the motion ends")
        still = np.zeros((len(trajectory.u), self.numeric.m, self.numeric.size))
        feedback = still if gains is None else gains
        found = round_sets(
            self.numeric, self.task, trajectory, feedback, self.loop, self.substeps, self.slack
        )
        if len(found) == 1:
            return found[0]
        return min(found, key=lambda one: self._cost(trajectory, gains, one), default=None)

    def _spread(
        self, trajectory: Trajectory, gains: Array | None, start: RoundSet | None
    ) -> DisturbanceSpread:
        loop = None if self.loop is None or start is None else (self.loop, start.generators)
        with np.errstate(all="ignore"):
            dt, x, u = float(self.task.step), trajectory.x[:-1], trajectory.u
            steps = self.numeric.step(x, u, trajectory.theta, dt, self.substeps)
            return disturbance_spread(self.numeric, self.task, trajectory, steps, gains, None, loop)

    def _cost(self, trajectory: Trajectory, gains: Array | None, start: RoundSet | None) -> float:
        """The average spread of disturbed motions, more if much is commanded against it."""
        spread = self._spread(trajectory, gains, start)
        scales = input_scales(input_groups(self.model, self.task), self.numeric.m)
        return spread_cost(spread, scales, acceleration_limits(self.model))

    def gains(self, trajectory: Trajectory) -> Array:
        """The gains (k, m, N) of feedback about a trajectory."""
        return self.controlled(trajectory)[0]

    def controlled(self, trajectory: Trajectory) -> tuple[Array, DisturbanceSpread | None]:
        """The gains (k, m, N) about a trajectory, and the spread of disturbed motions with them."""
        groups = input_groups(self.model, self.task)
        return closed_spread(
            self.numeric, self.task, trajectory, groups, self.substeps, self.loop, self.slack,
            refine=self.refines,
        )  # fmt: skip
