"""A robot, a task and a cell path made into a control problem: timing, seeds and half-planes."""

from __future__ import annotations

from dataclasses import dataclass, replace
from fractions import Fraction

import numpy as np

from compiler.discretisation.float_reading import Array, FloatReading, scalar_floats
from compiler.geometry.abstraction import Abstraction
from compiler.geometry.polytope import Polytope, polytope_of
from compiler.robots.robot import Body, RobotModel, RodBody
from grammar_lang import ir
from solvers.control import FULL, WORST, ControlOutcome, ControlProblem, Effort, synthesise_control
from solvers.convex_step import Trajectory
from solvers.inverse_kinematics import branches
from solvers.motion_limits import MotionLimits
from solvers.position_rows import ConvexSet, Dwell, PositionPlan, Separation
from solvers.task_limits import (
    input_groups,
    motion_limits,
    parameter_bounds,
    resting_inputs,
    state_limits,
)

SUBSTEPS = 2
MOST_SUBSTEPS = 32
INTEGRATION_SHARE = 0.2
"""The part of the margins that the error of the discretisation may use up."""
FAR = Fraction(1000)
LIMIT_MARGIN = 1e-3
"""Joint and rate limits are kept at this distance, in rad or m (/s), for the proof to pass."""
LEAST_MARGIN = 2e-3
"""The position margin in metres that a search begins with."""
OVERSHOOT = 4.0
"""A wider position margin widens that distance so much faster: motions overshoot within steps."""
WITHIN = 4
"""How often limits are looked at within a step once a motion is there."""
BEYOND = 1.25
"""How much farther a limit is moved than motions went beyond it."""


@dataclass(frozen=True, slots=True)
class Follower:
    """An effector of a robot that has to follow a path of cells, and what else binds the robot.

    ``effector`` starts (unless the task names another) and reaches.  ``insets`` narrows the limits
    of joints and rates further, shape (n, 2, 2): motions were seen to pass them within steps.
    """

    reading: FloatReading
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

    @property
    def model(self) -> RobotModel:
        """The robot."""
        return self.reading.graph.model

    @property
    def start_effector(self) -> int:
        """The effector that starts in the start region."""
        start = self.task.start
        named = start.effector if isinstance(start, ir.StartIn) else None
        return self.effector if named is None else named - 1

    @property
    def limit_margin(self) -> float:
        """The distance kept from joint and rate limits, in rad or m (/s)."""
        return LIMIT_MARGIN + OVERSHOOT * max(0.0, self.margin - LEAST_MARGIN)

    @property
    def limits(self) -> MotionLimits:
        """The limits of the motion, narrowed so that the proof passes."""
        insets = 0.0 if self.insets is None else self.insets
        return motion_limits(self.model, self.task, self.limit_margin + insets)

    @property
    def starts_in_its_cell(self) -> bool:
        """Whether the task asks where the reaching effector starts."""
        own = self.start_effector == self.effector
        return own and isinstance(self.task.start, ir.StartIn)

    # --- timing ---------------------------------------------------------------------------------

    def polyline(self) -> Array:
        """Centre of the first cell, centres of the facets passed, centre of the last cell."""
        cells = self.abstraction.cells
        points = [_centre(cells[self.cells[0]].polytope)]
        for before, after in zip(self.cells, self.cells[1:], strict=False):
            points.append(self.abstraction.facet_centre(before, after))
        points.append(_centre(cells[self.cells[-1]].polytope))
        return np.array(points)

    def waypoints(self) -> tuple[Array, tuple[int, ...]]:
        """Positions (k + 1, d) along the polyline with smooth timing, and each cell's entry step.

        The timing is the minimum-jerk profile from rest to rest.
        """
        points = self.polyline()
        k = self.task.steps
        lengths = np.linalg.norm(np.diff(points, axis=0), axis=1)
        along = np.concatenate([[0.0], np.cumsum(lengths)])
        t = np.linspace(0.0, 1.0, k + 1)
        s = (10 * t**3 - 15 * t**4 + 6 * t**5) * along[-1]
        place = np.stack(
            [np.interp(s, along, points[:, axis]) for axis in range(points.shape[1])], axis=1
        )
        entries = np.searchsorted(s, along[1:-1] + 1e-12)
        # Every cell holds one sample at least, in order.
        steps = [0]
        for number, entry in enumerate(entries):
            rest = len(entries) - 1 - number
            steps.append(int(min(max(entry, steps[-1] + 1), k - rest)))
        return place, tuple(steps)

    # --- constraints ----------------------------------------------------------------------------

    def plan(self, entries: tuple[int, ...] | None) -> PositionPlan:
        """All half-planes for given entry steps; without, only the two ends bind to cells."""
        k = self.task.steps
        dwells = []
        bounds = _convex(polytope_of(self.workspace.bounds.shape, self.workspace.dimension))
        stays = [(self.cells[0], 0, 0)] if self.starts_in_its_cell else []
        stays.append((self.cells[-1], k, k))
        if entries is not None:
            ends = [*(entry - 1 for entry in entries[1:]), k]
            stays = list(zip(self.cells, entries, ends, strict=True))
        for cell, first, last in stays:
            region = _convex(self.abstraction.cells[cell].polytope)
            dwells.append(Dwell(self.effector, first, last, region))
        count = len(self.model.effectors)
        inside = [e for e in range(count) if entries is None or e != self.effector]
        dwells += [Dwell(point, 0, k, bounds) for point in inside]
        if self.task.bounds_body:
            for body, hull in zip(self.model.bodies, self.reading.graph.hulls, strict=True):
                within = replace(bounds, offsets=bounds.offsets - self._thickness(body))
                dwells += [Dwell(count + i, 0, k, within) for i in hull]
        if isinstance(self.task.start, ir.StartIn) and self.start_effector != self.effector:
            region = _convex(self._region(self.task.start.region))
            dwells.append(Dwell(self.start_effector, 0, 0, region))
        anchors = self.waypoints()[0]
        return PositionPlan(
            k,
            tuple(dwells),
            tuple(self._separations()),
            self.margin,
            None if entries is None else self.effector,
            anchors,
        )

    def _region(self, name: str) -> Polytope:
        return polytope_of(self.workspace.region(name).shape, self.workspace.dimension)

    def _separations(self) -> list[Separation]:
        found = []
        count = len(self.model.effectors)
        for avoid in self.task.avoid:
            for name in avoid.regions:
                obstacle = _convex(self._region(name))
                distance = float(avoid.margin)
                if avoid.subject == "effector":
                    found += [Separation((e,), obstacle, distance) for e in range(count)]
                    continue
                for body, hull in zip(self.model.bodies, self.reading.graph.hulls, strict=True):
                    reach = distance + self._thickness(body)
                    found.append(Separation(tuple(count + i for i in hull), obstacle, reach))
        return found

    def _thickness(self, body: Body) -> float:
        """A bound on the radius of a body: search only, the proof reads each one exactly."""
        if not isinstance(body, RodBody) or body.radius is None:
            return 0.0
        upper = np.array([bounds[1] for bounds in parameter_bounds(self.model)])
        values = scalar_floats(self.model.scalars, upper)
        radii = [b.radius for b in self.model.bodies if isinstance(b, RodBody)]
        return max(abs(values[r]) for r in radii if r is not None)

    def problem(self, entries: tuple[int, ...] | None) -> ControlProblem:
        """The control problem for given entry steps, or with all cells but the ends released."""
        task = self.task
        limits = self.limits
        groups = input_groups(self.model, task)
        plan = self.plan(entries)
        return ControlProblem(
            self.reading, float(task.step), self.substeps, limits, groups, plan.rows
        )

    # --- seeds and solutions --------------------------------------------------------------------

    def seeds(self, theta: Array) -> list[Trajectory]:
        """One seed trajectory per branch of the inverse kinematics at the start."""
        place, _ = self.waypoints()
        limits = self.limits
        box = (limits.lower, limits.upper)
        if limits.start_values is not None:
            first = limits.start_values[None, :]
        else:
            first = branches(
                self.reading, theta, self.effector, place[0], box, self.seed, self.branch_count
            )
        dt = float(self.task.step)
        u = resting_inputs(input_groups(self.model, self.task), self.task.steps, self.reading.m)
        found = []
        for start in first:
            q = self.reading.track(start, theta, self.effector, place, box)
            v = np.gradient(q, dt, axis=0)
            v[0] = 0.0
            own = np.tile(limits.own_start, (len(q), 1))
            found.append(Trajectory(np.concatenate([q, v, own], axis=1), u, theta))
        return found

    def solve(
        self,
        start: Trajectory,
        entries: tuple[int, ...] | None = None,
        box: tuple[Array, Array] | None = None,
        effort: Effort = FULL,
        radius: float = 0.5,
    ) -> ControlOutcome:
        """Control synthesis from a seed; with ``box`` the parameters are unknowns too."""
        if entries is None:
            entries = self.waypoints()[1]
        return self._solve(self.problem(entries), start, box, effort, radius)

    def released(
        self, start: Trajectory, box: tuple[Array, Array] | None, effort: Effort, radius: float
    ) -> ControlOutcome:
        """The same with the cells between the two ends released; obstacles bind as before."""
        return self._solve(self.problem(None), start, box, effort, radius)

    def _solve(
        self,
        problem: ControlProblem,
        start: Trajectory,
        box: tuple[Array, Array] | None,
        effort: Effort,
        radius: float,
    ) -> ControlOutcome:
        # Trial motions may diverge; what is not finite counts as infeasible.
        with np.errstate(all="ignore"):
            outcome = synthesise_control(problem, start, box, effort, radius)
        if np.isfinite(outcome.robustness):
            return outcome
        worst = -WORST * problem.scale
        return replace(outcome, feasible=False, robustness=worst, trajectory=start)

    def with_margin(self, margin: float) -> Follower:
        """The same task with another margin."""
        return replace(self, margin=margin)

    def refined(self, trajectory: Trajectory) -> Follower:
        """The same task with as many substeps as a motion needs to be integrated accurately.

        Doubling them once more moves no point and no coordinate by more than a share of its margin.
        """
        reading, n, dt = self.reading, self.reading.n, float(self.task.step)
        substeps, theta, u = self.substeps, trajectory.theta, trajectory.u
        share = INTEGRATION_SHARE * np.array([self.margin, self.limit_margin])
        with np.errstate(all="ignore"):
            x = reading.simulate(trajectory.x[0], u, theta, dt, substeps)
            while substeps < MOST_SUBSTEPS:
                finer = reading.simulate(trajectory.x[0], u, theta, dt, 2 * substeps)
                points = (reading.points(states[:, :n], theta).value for states in (x, finer))
                gaps = np.array([_largest_gap(*points), _largest_gap(x, finer)])
                if bool(np.all(gaps <= share)):
                    break
                substeps, x = 2 * substeps, finer
        return replace(self, substeps=substeps)

    def narrowed(self, trajectory: Trajectory) -> Follower | None:
        """The same task with the limits narrowed that a motion passes within its steps, or None."""
        reading, n = self.reading, self.reading.n
        u = np.repeat(trajectory.u, WITHIN, axis=0)
        dt, theta = float(self.task.step) / WITHIN, trajectory.theta
        with np.errstate(all="ignore"):
            x = reading.simulate(trajectory.x[0], u, theta, dt, max(1, self.substeps // WITHIN))
        states = x[:, : 2 * n].reshape(len(x), 2, n).transpose(2, 1, 0)
        limits = state_limits(self.model)
        below = limits[:, :, 0] - np.min(states, axis=2)
        above = np.max(states, axis=2) - limits[:, :, 1]
        beyond = np.stack([below, above], axis=2) + LIMIT_MARGIN / 2
        if not bool(np.any(beyond > 0)):
            return None
        before = 0.0 if self.insets is None else self.insets
        return replace(self, insets=before + np.maximum(0.0, BEYOND * beyond))

    def visited(self, trajectory: Trajectory) -> tuple[tuple[int, ...], tuple[int, ...]] | None:
        """The cells a trajectory visits and when it enters them, if that is a path of the task."""
        positions = self.reading.points(trajectory.x[:, : self.reading.n], trajectory.theta).value
        avoided = {
            name
            for avoid in self.task.avoid
            if avoid.subject == "effector"
            for name in avoid.regions
        }
        cells: list[int] = []
        entries: list[int] = []
        for sample, point in enumerate(positions[:, self.effector]):
            cell = self.abstraction.locate(point)
            if cell is None or self.abstraction.cells[cell].propositions & avoided:
                return None
            if not cells or cells[-1] != cell:
                if cells and cell not in self.abstraction.neighbours[cells[-1]]:
                    return None
                cells.append(cell)
                entries.append(sample)
        starts = cells[0] == self.cells[0] or not self.starts_in_its_cell
        ends = cells[-1] == self.cells[-1]
        return (tuple(cells), tuple(entries)) if starts and ends else None

    def cell_names(self, trajectory: Trajectory, entries: tuple[int, ...]) -> list[list[str]]:
        """The cell of every effector at every sample."""
        cells = self.abstraction.cells
        positions = self.reading.points(trajectory.x[:, : self.reading.n], trajectory.theta).value
        ends = [*entries[1:], self.task.steps + 1]
        own = [
            cells[cell].name
            for cell, first, last in zip(self.cells, entries, ends, strict=True)
            for _ in range(first, last)
        ]
        names = []
        for effector in range(len(self.model.effectors)):
            if effector == self.effector:
                names.append(own)
                continue
            located = [self.abstraction.locate(point) for point in positions[:, effector]]
            names.append(["free" if i is None else cells[i].name for i in located])
        return names


def _largest_gap(before: Array, after: Array) -> float:
    return float(np.max(np.abs(after - before), initial=0.0))


def _centre(polytope: Polytope) -> Array:
    return np.array([float(x) for x in polytope.centre])


def _convex(polytope: Polytope) -> ConvexSet:
    """A polytope in floats; an unbounded one is cut far away."""
    if not polytope.is_bounded:
        d = polytope.dimension
        rows = [
            ir.HalfSpace(tuple(Fraction(sign * (i == j)) for j in range(d)), FAR)
            for i in range(d)
            for sign in (-1, 1)
        ]
        polytope = polytope.intersection(Polytope(tuple(rows)))
    vertices = np.array([[float(x) for x in vertex] for vertex in polytope.vertices])
    return ConvexSet(polytope.A, polytope.b, vertices)
