"""The clearance between a robot, in given poses, and the regions that it must avoid."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from compiler.arrays import Array
from compiler.discretisation.numeric_robot import NumericRobot
from compiler.expressions.evaluators.floats import scalar_floats
from compiler.robots.robot import Collider, RodBody, Shape
from compiler.time_limits.time_limit import check_time
from grammar_lang import ir
from solvers.parameters.parameter_search import parameter_space
from solvers.trajectory.convex_set import ConvexSet, point_set, region_set
from solvers.trajectory.position_plan import Dwell, Separation
from solvers.trajectory.separating_planes import Obstacles, separating_planes

ENOUGH = 0.5
"""Metres: clearances are capped at this."""


@dataclass(frozen=True)
class BodyClearance:
    """The constraints that hold at every instant, evaluated on many poses at once."""

    separations: tuple[Separation, ...]
    dwells: tuple[Dwell, ...]

    @cached_property
    def _moving(self) -> tuple[MovingHull, ...]:
        """The separations grouped by moving hull."""
        found = dict[tuple[int, ...], list[Separation]]()
        for separation in self.separations:
            found.setdefault(separation.points, []).append(separation)
        return tuple(MovingHull(points, tuple(each)) for points, each in found.items())

    def of(self, positions: Array, enough: float = ENOUGH) -> Array:
        """The least clearance (K,) of positions (K, m, d), in metres, capped at ``enough``.

        It is negative if a constraint is violated: the violation along the best separating
        direction.
        """
        return self._least(positions, enough, -np.inf)

    def exceeds(self, positions: Array, margin: float) -> NDArray[np.bool_]:
        """Whether positions (K, m, d) have a clearance of at least ``margin`` metres, (K,)."""
        return self._least(positions, margin, margin) >= margin

    def _least(self, positions: Array, enough: float, least: float) -> Array:
        """The clearance (K,), capped at ``enough``; only an upper bound where below ``least``."""
        found = np.full(len(positions), enough)
        for dwell in self.dwells:
            values = positions[:, dwell.point] @ dwell.region.normals.T
            found = np.minimum(found, np.min(dwell.region.offsets - values, axis=1))
        for hull, box in zip(self._moving, self._boxes(positions), strict=True):
            apart = hull.box_gaps(*box)
            for index in np.flatnonzero(np.any(apart < found[:, None], axis=0)).tolist():
                check_time()
                separation, obstacle = hull.separations[index], hull.obstacles[index]
                near = np.flatnonzero((apart[:, index] < found) & (found >= least))
                moving = positions[near][:, hull.places]
                closer = _facet_gap(moving, separation) < found[near]
                near, moving = near[closer], moving[closer]
                if len(near):
                    normal, support = separating_planes(moving, obstacle)
                    nearest = np.min(np.einsum("kd,kwd->kw", normal, moving), axis=1)
                    found[near] = np.minimum(found[near], nearest - support - separation.distance)
        return found

    @cached_property
    def _alike(self) -> tuple[tuple[list[int], NDArray[np.int64]], ...]:
        """The hulls grouped by number of points: their indices, and the points (n, w) of each."""
        found = dict[int, list[int]]()
        for number, hull in enumerate(self._moving):
            found.setdefault(len(hull.points), []).append(number)
        return tuple(
            (numbers, np.array([self._moving[number].points for number in numbers]))
            for numbers in found.values()
        )

    def _boxes(self, positions: Array) -> list[tuple[Array, Array]]:
        """The lower and upper corners (K, d) of the bounding boxes of all hulls.

        They are computed point by point over all hulls of equal size, with few operations on long
        arrays.
        """
        found: list[tuple[Array, Array]] = [(positions[:, 0], positions[:, 0])] * len(self._moving)
        for numbers, points in self._alike:
            least, most = positions[:, points[:, 0]], positions[:, points[:, 0]]
            for column in points.T[1:]:
                further = positions[:, column]
                np.minimum(least, further, out=least)
                np.maximum(most, further, out=most)
            for place, number in enumerate(numbers):
                found[number] = least[:, place], most[:, place]
        return found


@dataclass(frozen=True)
class MovingHull:
    """Points whose convex hull keeps its distance from the obstacles of ``separations``."""

    points: tuple[int, ...]
    separations: tuple[Separation, ...]

    @cached_property
    def places(self) -> slice | list[int]:
        """The points as an index; a slice, which avoids copies, if they are consecutive."""
        first, last = self.points[0], self.points[-1]
        together = self.points == tuple(range(first, last + 1))
        return slice(first, last + 1) if together else list(self.points)

    @cached_property
    def obstacles(self) -> tuple[Obstacles, ...]:
        """The obstacle of each separation."""
        return tuple(Obstacles((separation.obstacle,)) for separation in self.separations)

    @cached_property
    def _boxes(self) -> tuple[Array, Array, Array]:
        """The boxes of the obstacles, (O, d) each, and the required distances (O,)."""
        boxes = [separation.obstacle.box for separation in self.separations]
        distances = np.array([separation.distance for separation in self.separations])
        return np.array([box[0] for box in boxes]), np.array([box[1] for box in boxes]), distances

    def box_gaps(self, least: Array, most: Array) -> Array:
        """Lower bounds (K, O) on the gaps between obstacles and boxes with these corners (K, d)."""
        lower, upper, distances = self._boxes
        found = np.full((len(least), len(lower)), -np.inf)
        for axis in range(least.shape[1]):
            np.maximum(found, lower[:, axis] - most[:, axis, None], out=found)
            np.maximum(found, least[:, axis, None] - upper[:, axis], out=found)
        return found - distances


def body_clearance(avoidances: Avoidances) -> BodyClearance:
    """The constraints of a task, including those of its bounds."""
    bounds = avoidances.bounds
    effectors = range(len(avoidances.numeric.graph.model.effectors))
    dwells = [Dwell(effector, 0, 0, bounds) for effector in effectors]
    dwells += avoidances.bodies_within_bounds(0)
    return BodyClearance(tuple(avoidances.separations()), tuple(dwells))


def _facet_gap(moving: Array, separation: Separation) -> Array:
    """A lower bound (K,) on the gaps, from the facets of the obstacle."""
    obstacle = separation.obstacle
    ahead = np.min(moving @ obstacle.normals.T, axis=1) - obstacle.offsets
    return np.asarray(np.max(ahead, axis=1) - separation.distance)


# --------------------------------------------------------------------------------------------------
# The constraints of a task on effectors and bodies that hold at every instant.


@dataclass(frozen=True, slots=True)
class Avoidances:
    """The constraints of a task that hold at all times; effectors come first among points."""

    numeric: NumericRobot
    workspace: ir.Workspace
    task: ir.Task

    def region(self, name: str) -> ConvexSet:
        """A region of the workspace."""
        return region_set(self.workspace.region(name).shape, self.workspace.dimension)

    @property
    def bounds(self) -> ConvexSet:
        """The bounds of the workspace."""
        return region_set(self.workspace.bounds.shape, self.workspace.dimension)

    def separations(self) -> Iterator[Separation]:
        """The separations that the ``avoid`` clauses require."""
        model = self.numeric.graph.model
        count = len(model.effectors)
        for avoid in self.task.avoid:
            for name in avoid.regions:
                obstacle = self.region(name)
                distance = float(avoid.margin)
                if avoid.subject == "effector":
                    yield from (Separation((e,), obstacle, distance) for e in range(count))
                    continue
                for each, hull in zip(model.colliders, self.numeric.spanning.hulls, strict=True):
                    reach = distance + self._thickness(each)
                    yield Separation(tuple(count + i for i in hull), obstacle, reach)
        if self.task.avoid_self is not None:
            yield from self._apart_from_each_other(float(self.task.avoid_self.margin))

    def _apart_from_each_other(self, margin: float) -> Iterator[Separation]:
        """Separations that keep the differences of the points of two bodies away from zero."""
        model, gaps = self.numeric.graph.model, self.numeric.spanning.gaps
        count, zero = len(model.effectors), point_set(np.zeros(model.dimension))
        for pair, gap in zip(model.apart, gaps, strict=True):
            reach = margin + sum(self._thickness(model.colliders[body]) for body in pair)
            yield Separation(tuple(count + i for i in gap), zero, reach)

    def bodies_within_bounds(self, last: int) -> Iterator[Dwell]:
        """The dwells that ``bounds with body`` requires, from sample 0 to sample ``last``."""
        if not self.task.bounds_body:
            return
        graph, bounds = self.numeric.graph, self.bounds
        for each, hull in zip(graph.model.colliders, self.numeric.spanning.hulls, strict=True):
            within = replace(bounds, offsets=bounds.offsets - self._thickness(each))
            for i in hull:
                yield Dwell(len(graph.model.effectors) + i, 0, last, within)

    def _thickness(self, collider: Collider) -> float:
        """A bound on the radius of a collider, for the search only; the proof uses exact radii."""
        if not isinstance(collider, RodBody | Shape) or collider.radius is None:
            return 0.0
        model = self.numeric.graph.model
        space = parameter_space(model)
        values = (scalar_floats(model.scalars, corner) for corner in (space.lower, space.upper))
        return max(abs(each[collider.radius]) for each in values)
