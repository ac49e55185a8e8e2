"""What binds the positions of a robot that follows a cell path: dwells and separations.

The cells of the path, the bounds, every ``avoid``, and what a formula asks of which samples.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction

import numpy as np

from compiler.discretisation.float_reading import FloatReading, scalar_floats
from compiler.geometry.abstraction import Abstraction
from compiler.geometry.polytope import Polytope, polytope_of
from compiler.robots.robot import Body, RobotModel, RodBody
from compiler.specifications.obligations import Obligation
from grammar_lang import ir
from solvers.motions.path_timing import Entries
from solvers.motions.position_rows import ConvexSet, Dwell, Separation
from solvers.motions.task_limits import parameter_bounds

FAR = Fraction(1000)


@dataclass(frozen=True, slots=True)
class MotionConstraints:
    """A robot in a task; ``effector`` follows ``cells``, ``recorded`` starts and reaches."""

    reading: FloatReading
    workspace: ir.Workspace
    task: ir.Task
    abstraction: Abstraction
    effector: int
    recorded: int
    cells: tuple[int, ...]

    @property
    def model(self) -> RobotModel:
        """The robot."""
        return self.reading.graph.model

    @property
    def start_effector(self) -> int:
        """The effector that starts in the start region."""
        start = self.task.start
        named = start.effector if isinstance(start, ir.StartIn) else None
        return self.recorded if named is None else named - 1

    @property
    def starts_in_its_cell(self) -> bool:
        """Whether the task asks where the effector of the path starts."""
        own = self.start_effector == self.effector
        return own and isinstance(self.task.start, ir.StartIn)

    def dwells(
        self, entries: Entries | None, obligations: Sequence[Obligation]
    ) -> tuple[Dwell, ...]:
        """Where points stay; without ``entries`` only the two ends of the path bind to cells."""
        k = self.task.steps
        stays = [(self.cells[0], 0, 0)] if self.starts_in_its_cell else []
        stays.append((self.cells[-1], k, k))
        if entries is not None:
            ends = [*(entry - 1 for entry in entries[1:]), k]
            stays = list(zip(self.cells, entries, ends, strict=True))
        found = [
            Dwell(self.effector, first, last, convex_set(self.abstraction.cells[cell].polytope))
            for cell, first, last in stays
        ]
        found += self._within_bounds(with_own=entries is None)
        found += self._ends()
        found += [
            Dwell(item.effector, item.first, item.last, self._set(item.region))
            for item in obligations
            if item.inside
        ]
        return tuple(found)

    def _within_bounds(self, *, with_own: bool) -> Iterator[Dwell]:
        """Effectors, and bodies where the task says so, stay inside the bounds."""
        k, count = self.task.steps, len(self.model.effectors)
        bounds = convex_set(polytope_of(self.workspace.bounds.shape, self.workspace.dimension))
        for effector in range(count):
            if with_own or effector != self.effector:
                yield Dwell(effector, 0, k, bounds)
        if self.task.bounds_body:
            for body, hull in zip(self.model.bodies, self.reading.graph.hulls, strict=True):
                within = replace(bounds, offsets=bounds.offsets - self._thickness(body))
                for i in hull:
                    yield Dwell(count + i, 0, k, within)

    def _ends(self) -> Iterator[Dwell]:
        """Start and target of effectors that follow no path of their own."""
        k, start, reach = self.task.steps, self.task.start, self.task.reach
        if isinstance(start, ir.StartIn) and self.start_effector != self.effector:
            yield Dwell(self.start_effector, 0, 0, self._set(start.region))
        if reach is not None and self.recorded != self.effector:
            yield Dwell(self.recorded, k, k, self._set(reach.region))

    def separations(self, obligations: Sequence[Obligation]) -> tuple[Separation, ...]:
        """What points and bodies stay away from."""
        found = []
        count = len(self.model.effectors)
        for avoid in self.task.avoid:
            for name in avoid.regions:
                obstacle = self._set(name)
                distance = float(avoid.margin)
                if avoid.subject == "effector":
                    found += [Separation((e,), obstacle, distance) for e in range(count)]
                    continue
                for body, hull in zip(self.model.bodies, self.reading.graph.hulls, strict=True):
                    reach = distance + self._thickness(body)
                    found.append(Separation(tuple(count + i for i in hull), obstacle, reach))
        found += [
            Separation((item.effector,), self._set(item.region), 0.0, item.first, item.last)
            for item in obligations
            if not item.inside
        ]
        return tuple(found)

    def _set(self, name: str) -> ConvexSet:
        return convex_set(polytope_of(self.workspace.region(name).shape, self.workspace.dimension))

    def _thickness(self, body: Body) -> float:
        """A bound on the radius of a body: search only, the proof reads each one exactly."""
        if not isinstance(body, RodBody) or body.radius is None:
            return 0.0
        upper = np.array([bounds[1] for bounds in parameter_bounds(self.model)])
        values = scalar_floats(self.model.scalars, upper)
        radii = [b.radius for b in self.model.bodies if isinstance(b, RodBody)]
        return max(abs(values[r]) for r in radii if r is not None)


def convex_set(polytope: Polytope) -> ConvexSet:
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
