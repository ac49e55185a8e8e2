"""What a task keeps effectors and bodies away from, and where it keeps them, at every instant."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from fractions import Fraction

import numpy as np

from compiler.discretisation.numeric_robot import NumericRobot
from compiler.expressions.evaluators.floats import scalar_floats
from compiler.robots.robot import Body, RodBody
from compiler.workspaces.polytope import Polytope, polytope_of
from grammar_lang import ir
from solvers.motions.position_rows import ConvexSet, Dwell, Separation
from solvers.parameters.parameter_space import parameter_space

FAR = Fraction(1000)


@dataclass(frozen=True, slots=True)
class Avoidances:
    """The demands of a task on a robot that bind all the time; points count effectors first."""

    numeric: NumericRobot
    workspace: ir.Workspace
    task: ir.Task

    def region(self, name: str) -> ConvexSet:
        """A region of the workspace."""
        return convex_set(polytope_of(self.workspace.region(name).shape, self.workspace.dimension))

    @property
    def bounds(self) -> ConvexSet:
        """The bounds of the workspace."""
        return convex_set(polytope_of(self.workspace.bounds.shape, self.workspace.dimension))

    def separations(self) -> Iterator[Separation]:
        """What every ``avoid`` keeps apart."""
        graph = self.numeric.graph
        count = len(graph.model.effectors)
        for avoid in self.task.avoid:
            for name in avoid.regions:
                obstacle = self.region(name)
                distance = float(avoid.margin)
                if avoid.subject == "effector":
                    yield from (Separation((e,), obstacle, distance) for e in range(count))
                    continue
                for body, hull in zip(graph.model.bodies, graph.hulls, strict=True):
                    reach = distance + self._thickness(body)
                    yield Separation(tuple(count + i for i in hull), obstacle, reach)

    def bodies_within_bounds(self, last: int) -> Iterator[Dwell]:
        """Where ``bounds with body`` keeps bodies, from sample 0 to the ``last``."""
        if not self.task.bounds_body:
            return
        graph, bounds = self.numeric.graph, self.bounds
        for body, hull in zip(graph.model.bodies, graph.hulls, strict=True):
            within = replace(bounds, offsets=bounds.offsets - self._thickness(body))
            for i in hull:
                yield Dwell(len(graph.model.effectors) + i, 0, last, within)

    def _thickness(self, body: Body) -> float:
        """A bound on the radius of a body: search only, the proof reads each one exactly."""
        if not isinstance(body, RodBody) or body.radius is None:
            return 0.0
        model = self.numeric.graph.model
        values = scalar_floats(model.scalars, parameter_space(model).upper)
        radii = [b.radius for b in model.bodies if isinstance(b, RodBody)]
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
