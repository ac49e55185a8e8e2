"""The conditions at every instant of a motion: the bounds of the task and of the robot."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace
from fractions import Fraction

from flint import arb

from compiler.expressions.evaluators.balls import ball, closed_ball, scalar_balls
from compiler.robots.hull_corners import corners_from_middle
from compiler.robots.robot import Collider, RobotModel, RodBody, Shape
from compiler.robots.state_and_input import joint_names
from grammar_lang import ir
from solvers.verifier.proofs.apart import Apart, BodiesApart
from solvers.verifier.proofs.extension import BoxExtension, DiscExtension, Extension
from solvers.verifier.proofs.hull_extension import HullExtension
from solvers.verifier.proofs.scene import Scene
from solvers.verifier.proofs.state_limits import LIMITS, AccelerationLimit, StateLimit
from solvers.verifier.proofs.tube_checks import Constraint, Inside, row, rows_of


def position_conditions(scene: Scene, tail: Sequence[arb]) -> list[Constraint]:
    """Conditions for the bounds and every ``avoid``; ``tail`` holds the balls of theta and k."""
    task, workspace, graph = scene.task, scene.workspace, scene.graph
    effectors = tuple(range(len(graph.model.effectors)))
    bounds = rows_of(scene.polytope(workspace.bounds))
    bodies = _colliders(scene, tail)
    found: list[Constraint] = [Inside("bounds", effectors, rows=bounds)]
    if task.bounds_body:
        for each in bodies:
            name, distance = f"bounds of {each.name}", each.radius
            found.append(Inside(name, each.points, each.extensions, rows=bounds, distance=distance))
    several = len(effectors) > 1
    tips = [_Moving(f"effector {e + 1}" if several else "effector", (e,)) for e in effectors]
    for avoid in task.avoid:
        groups = bodies if avoid.subject == "body" else tips
        for name in avoid.regions:
            region = workspace.region(name)
            found += [_apart(scene, region, avoid.margin, each) for each in groups]
    if task.avoid_self is not None:
        found += _apart_from_each_other(scene, bodies, task.avoid_self.margin)
    return found


@dataclass(frozen=True, slots=True)
class _Moving:
    """A moving object: its name, the numbers of its points, and its extent around them."""

    name: str
    points: tuple[int, ...]
    radius: arb = field(default_factory=lambda: arb(0))
    extensions: tuple[Extension, ...] = ()


def _colliders(scene: Scene, tail: Sequence[arb]) -> list[_Moving]:
    """The collision shapes of the robot's links."""
    model, first = scene.model, len(scene.model.effectors)
    scalars = scalar_balls(model.scalars, tail)
    return [
        _Moving(
            scene.body(number),
            _numbers(first, extent.bases),
            _radius(each, scalars),
            _extensions(scene.model, each, _numbers(first, extent.columns), scalars),
        )
        for number, (each, extent) in enumerate(
            zip(model.colliders, scene.graph.numbering.extents, strict=True)
        )
    ]


def _numbers(first: int, points: Sequence[int]) -> tuple[int, ...]:
    """The indices among all points of points that are numbered after the effectors."""
    return tuple(first + point for point in points)


def _apart(scene: Scene, region: ir.Region, margin: Fraction, moving: _Moving) -> Apart:
    polytope = scene.polytope(region)
    vertices: tuple[tuple[arb, ...], ...] = ()
    if polytope.is_bounded:
        vertices = tuple(tuple(ball(x) for x in vertex) for vertex in polytope.vertices)
    return Apart(
        f"clearance of {moving.name} to {region.name}",
        moving.points,
        moving.extensions,
        rows=rows_of(polytope),
        vertices=vertices,
        distance=ball(margin) + moving.radius,
    )


def _apart_from_each_other(
    scene: Scene, moving: Sequence[_Moving], margin: Fraction
) -> Iterator[BodiesApart]:
    model, axes = scene.model, range(scene.workspace.dimension)
    first = len(model.effectors)
    zero = tuple(
        row([Fraction(sign * (i == j)) for j in axes], Fraction(0))
        for i in axes
        for sign in (1, -1)
    )
    for pair, gap in zip(model.apart, scene.graph.numbering.gaps, strict=True):
        one, two = (moving[i] for i in pair)
        yield BodiesApart(
            f"clearance of {one.name} to {two.name}",
            _numbers(first, gap.bases),
            (
                *_along(one.extensions, _numbers(first, gap.columns[0])),
                *(
                    each.opposite()
                    for each in _along(two.extensions, _numbers(first, gap.columns[1]))
                ),
            ),
            rows=zero,
            vertices=(tuple(arb(0) for _ in axes),),
            distance=ball(margin) + one.radius + two.radius,
            body=one.points,
            shape=one.extensions,
        )


def _along(extensions: Sequence[Extension], columns: tuple[int, ...]) -> list[Extension]:
    """A body's extensions along its axes as seen from another frame."""
    return [replace(each, columns=columns) for each in extensions]


def _radius(each: Collider, scalars: Sequence[arb]) -> arb:
    """The radius of a capsule or a sphere, else zero."""
    if isinstance(each, RodBody | Shape) and each.radius is not None:
        return scalars[each.radius]
    return arb(0)


def _extensions(
    model: RobotModel, each: Collider, columns: tuple[int, ...], scalars: Sequence[arb]
) -> tuple[Extension, ...]:
    """The extensions that a box, a cylinder or a hull adds to its points."""
    if not isinstance(each, Shape) or not columns:
        return ()
    if each.corners:
        return (HullExtension.of(columns, corners_from_middle(each, model.scalars)),)
    sizes = [scalars[size] for size in each.sizes]
    if each.kind == "box":
        return (BoxExtension(columns, tuple(size / 2 for size in sizes)),)
    radius = sizes[-1]
    flat = len(columns) == 1
    return (BoxExtension(columns, (radius,)) if flat else DiscExtension(columns, radius),)


def state_limits(scene: Scene, size: int) -> list[StateLimit]:
    """Joint and rate limits as balls, on the rows of q = D y; states have ``size`` entries."""
    graph, found = scene.graph, list[StateLimit]()
    none = (0,) * len(graph.model.dofs)
    own = (0,) * (size - 2 * len(graph.model.dofs))
    names = joint_names(graph.model)
    for number, dof in enumerate(graph.model.dofs):
        row = graph.coordinates.rows[number]
        unit = "rad" if dof.kind == "revolute" else "m"
        for weights, interval, what, measure in (
            ((*row, *none, *own), dof.range, LIMITS[0], unit),
            ((*none, *row, *own), dof.rate, LIMITS[1], f"{unit}/s"),
        ):
            if interval is not None:
                ends = closed_ball(interval.lower), closed_ball(interval.upper)
                found.append(StateLimit(f"{what} {names[number]}", measure, weights, *ends))
    return found


def acceleration_limits(scene: Scene) -> list[AccelerationLimit]:
    """The limits of the joints' accelerations as balls, on the rows of q'' = D y''."""
    found, names = list[AccelerationLimit](), joint_names(scene.model)
    for number, dof in enumerate(scene.model.dofs):
        if dof.accel is not None:
            row, most = tuple(scene.graph.coordinates.rows[number]), closed_ball(dof.accel)
            name = f"acceleration of {names[number]}"
            unit = "rad/s^2" if dof.kind == "revolute" else "m/s^2"
            found.append(AccelerationLimit(name, unit, row, -most, most))
    return found
