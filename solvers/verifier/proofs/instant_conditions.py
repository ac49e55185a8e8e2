"""What has to hold at every instant of a motion: the task's and the robot's own bounds."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from fractions import Fraction

from flint import arb

from compiler.expressions.evaluators.balls import ball, closed_ball, scalar_balls
from compiler.robots.robot import RobotModel, RodBody
from grammar_lang import ir
from solvers.verifier.proofs.apart import Apart, BodiesApart
from solvers.verifier.proofs.scene import Scene
from solvers.verifier.proofs.state_limits import StateLimit
from solvers.verifier.proofs.tube_checks import Constraint, Inside, row, rows_of


def position_conditions(scene: Scene, tail: Sequence[arb]) -> list[Constraint]:
    """Bounds, and every ``avoid``; ``tail`` holds the balls of theta and k."""
    task, workspace, graph = scene.task, scene.workspace, scene.graph
    effectors = tuple(range(len(graph.model.effectors)))
    bounds = rows_of(scene.polytope(workspace.bounds))
    bodies = _bodies(scene, tail)
    found: list[Constraint] = [Inside("bounds", effectors, rows=bounds)]
    if task.bounds_body:
        for name, points, radius in bodies:
            found.append(Inside(f"bounds of {name}", points, rows=bounds, distance=radius))
    several = len(effectors) > 1
    tips = [(f"effector {e + 1}" if several else "effector", (e,), arb(0)) for e in effectors]
    for avoid in task.avoid:
        groups = bodies if avoid.subject == "body" else tips
        for name in avoid.regions:
            region = workspace.region(name)
            found += [_apart(scene, region, avoid.margin, group) for group in groups]
    if task.avoid_self is not None:
        found += _apart_from_each_other(scene, bodies, task.avoid_self.margin)
    return found


def _bodies(scene: Scene, tail: Sequence[arb]) -> list[tuple[str, tuple[int, ...], arb]]:
    """Per body its name, its points behind the effectors, and its radius."""
    first = len(scene.model.effectors)
    return [
        (scene.body(i), tuple(first + point for point in hull), _radius(scene.model, i, tail))
        for i, hull in enumerate(scene.graph.hulls)
    ]


def _apart(
    scene: Scene, region: ir.Region, margin: Fraction, group: tuple[str, tuple[int, ...], arb]
) -> Apart:
    name, points, radius = group
    polytope = scene.polytope(region)
    vertices: tuple[tuple[arb, ...], ...] = ()
    if polytope.is_bounded:
        vertices = tuple(tuple(ball(x) for x in vertex) for vertex in polytope.vertices)
    return Apart(
        f"clearance of {name} to {region.name}",
        points,
        rows=rows_of(polytope),
        vertices=vertices,
        distance=ball(margin) + radius,
    )


def _apart_from_each_other(
    scene: Scene, bodies: Sequence[tuple[str, tuple[int, ...], arb]], margin: Fraction
) -> Iterator[BodiesApart]:
    first, axes = len(scene.model.effectors), range(scene.workspace.dimension)
    zero = tuple(
        row([Fraction(sign * (i == j)) for j in axes], Fraction(0))
        for i in axes
        for sign in (1, -1)
    )
    for (one, two), gap in zip(scene.model.apart, scene.graph.gaps, strict=True):
        (name, points, radius), (other, others, reach) = bodies[one], bodies[two]
        yield BodiesApart(
            f"clearance of {name} to {other}",
            tuple(first + point for point in gap),
            rows=zero,
            vertices=(tuple(arb(0) for _ in axes),),
            distance=ball(margin) + radius + reach,
            bodies=(points, others),
        )


def _radius(model: RobotModel, body: int, tail: Sequence[arb]) -> arb:
    """The radius of a body: that of a capsule, else zero."""
    item = model.bodies[body]
    if not isinstance(item, RodBody) or item.radius is None:
        return arb(0)
    return scalar_balls(model.scalars, tail)[item.radius]


def state_limits(scene: Scene, size: int) -> list[StateLimit]:
    """Joint and rate limits as balls, on the rows of q = D y; states have ``size`` entries."""
    graph, found = scene.graph, list[StateLimit]()
    none = (0,) * len(graph.model.dofs)
    own = (0,) * (size - 2 * len(graph.model.dofs))
    for number, dof in enumerate(graph.model.dofs):
        row = graph.coordinates.rows[number]
        unit = "rad" if dof.kind == "revolute" else "m"
        for weights, interval, what, measure in (
            ((*row, *none, *own), dof.range, "range", unit),
            ((*none, *row, *own), dof.rate, "rate", f"{unit}/s"),
        ):
            if interval is not None:
                ends = closed_ball(interval.lower), closed_ball(interval.upper)
                found.append(StateLimit(f"{what} of joint {number + 1}", measure, weights, *ends))
    return found
