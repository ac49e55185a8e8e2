"""The demands of a task on the points of a robot at every instant, at the start and on arrival.

They are exact. Points are numbered as in ``CornerPoints``: the effectors, then both ends of
colliders with a length and the middles of all others. These points lie in their colliders. Each
demand is necessary for a motion that does the task: margins, radii and sizes, rates and the order
of visits are left out, except for the distances between bodies of the robot.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from typing import TypeAlias

from compiler.dynamics.corner_points import MOST_OF_PAIRS
from compiler.encodings.pose_questions import PoseQuestion, effector_choices, pose_questions
from compiler.expressions.scalars import Constant
from compiler.robots.given_start import given_start
from compiler.robots.robot import RobotModel, RodBody, Shape
from compiler.tasks.necessary import task_avoidance
from compiler.workspaces.polytope import refuting_polytope
from grammar_lang import ir

Rows: TypeAlias = tuple[ir.HalfSpace, ...]


@dataclass(frozen=True, slots=True)
class Obstacle:
    """A region whose interior must not contain these points, and segments between two points."""

    name: str
    rows: Rows
    points: tuple[int, ...]
    segments: tuple[tuple[int, int], ...]


@dataclass(frozen=True, slots=True)
class Pair:
    """Two bodies that must be ``apart`` by some metres, including their known radii.

    ``points`` are the differences of their ends; ``counts`` are the numbers of ends of each body.
    """

    points: tuple[int, ...]
    counts: tuple[int, int]
    apart: Fraction


@dataclass(frozen=True, slots=True)
class PointIn:
    """Poses with a point in a closed region, where an effector may need a certain orientation."""

    point: int
    rows: Rows
    poses: tuple[ir.Pose, ...] = ()


@dataclass(frozen=True, slots=True)
class GivenPose:
    """The one pose with these coordinates, closed expressions in SI units."""

    values: tuple[ir.Expr, ...]


@dataclass(frozen=True, slots=True)
class Passage:
    """One choice of effectors (from 0): a motion leads from ``start`` to ``goal``.

    If it ``arrives``, the goal is the one of ``reach``: the motion is there from some instant not
    after ``by`` (s) to its end, which is the instant T without a stay, and the final rates hold all
    that time. Other goals, and all goals of endless motions, are visited at some instant not after
    ``by``. With a given pose, ``starting`` is the effector that reaches.
    """

    start: PointIn | GivenPose
    goal: PointIn
    starting: int
    reaching: int
    arrives: bool
    by: Fraction


@dataclass(frozen=True, slots=True)
class MotionConditions:
    """The demands on one robot.

    ``bounded`` points stay within ``bounds`` at every instant, and out of ``obstacles``. For every
    question of ``passages`` one of its choices must be possible; a question without choices is
    impossible. ``pairs`` of bodies stay apart at every instant.
    """

    model: RobotModel
    bounds: Rows
    bounded: tuple[int, ...]
    obstacles: tuple[Obstacle, ...]
    passages: tuple[tuple[Passage, ...], ...]
    pairs: tuple[Pair, ...] = ()


def motion_conditions(
    model: RobotModel, workspace: ir.Workspace, task: ir.Task
) -> MotionConditions:
    """The demands of a task, both without maps, on a robot."""
    hulls, effectors = body_points(model), tuple(range(len(model.effectors)))
    spanning = tuple(point for hull in hulls for point in hull)
    return MotionConditions(
        model,
        _rows(workspace.bounds, workspace),
        (*effectors, *spanning) if task.bounds_body else effectors,
        _obstacles(workspace, task, len(effectors), hulls),
        tuple(_passages(model, task, question) for question in pose_questions(workspace, task)),
        _pairs(model, task, hulls),
    )


def body_points(model: RobotModel) -> tuple[tuple[int, ...], ...]:
    """The numbers of the points that represent each collider: one, both ends, or all corners."""
    found: list[tuple[int, ...]] = []
    start = len(model.effectors)
    for each in model.colliders:
        long = isinstance(each, RodBody) or (isinstance(each, Shape) and each.length is not None)
        count = 2 if long else 1
        if isinstance(each, Shape) and each.corners:
            count = len(each.corners)
        found.append(tuple(range(start, start + count)))
        start += count
    return tuple(found)


def _pairs(
    model: RobotModel, task: ir.Task, hulls: tuple[tuple[int, ...], ...]
) -> tuple[Pair, ...]:
    """The pairs of bodies that must not touch; those with a hull of more corners are left out.

    Their differences come after the points of all bodies, as in ``CornerPoints``.
    """
    if task.avoid_self is None:
        return ()
    found, start = list[Pair](), len(model.effectors) + sum(map(len, hulls))
    for one, two in model.apart:
        counts = len(hulls[one]), len(hulls[two])
        if max(counts) <= MOST_OF_PAIRS:
            points = tuple(range(start, start + counts[0] * counts[1]))
            start += len(points)
            radii = sum((_radius(model, body) for body in (one, two)), Fraction(0))
            found.append(Pair(points, counts, task.avoid_self.margin + radii))
    return tuple(found)


def _radius(model: RobotModel, body: int) -> Fraction:
    """The radius of a rod, a capsule or a sphere if it is a known number; else zero."""
    each = model.colliders[body]
    if not isinstance(each, RodBody | Shape) or each.radius is None:
        return Fraction(0)
    scalar = model.scalars[each.radius]
    return scalar.value if isinstance(scalar, Constant) else Fraction(0)


def _obstacles(
    workspace: ir.Workspace, task: ir.Task, effectors: int, hulls: tuple[tuple[int, ...], ...]
) -> tuple[Obstacle, ...]:
    points: dict[str, list[int]] = {}
    segments: dict[str, list[tuple[int, int]]] = {}
    for effector in range(effectors):
        for name in task_avoidance(task, effector + 1):
            points.setdefault(name, []).append(effector)
    bodies = [name for item in task.avoid if item.subject == "body" for name in item.regions]
    for name in dict.fromkeys(bodies):
        for hull in hulls:
            if len(hull) == 2:
                segments.setdefault(name, []).append((hull[0], hull[1]))
            else:
                points.setdefault(name, []).extend(hull)
    return tuple(
        Obstacle(
            region.name,
            _rows(region, workspace),
            tuple(points.get(region.name, ())),
            tuple(segments.get(region.name, ())),
        )
        for region in workspace.regions
        if region.name in points or region.name in segments
    )


def _passages(model: RobotModel, task: ir.Task, question: PoseQuestion) -> tuple[Passage, ...]:
    found: list[Passage] = []
    for starting, reaching in effector_choices(model, question):
        start: PointIn | GivenPose
        if isinstance(task.start, ir.StartAt):
            start = GivenPose(given_start(model, task.start).values)
        else:
            start = PointIn(starting, question.start or ())
        reached = task.reach is not None and question.goal == "the target"
        poses = task.reach.poses if task.reach is not None and reached else ()
        goal = PointIn(reaching, question.target, poses)
        by = task.steps * task.step if question.by is None else question.by
        arrives = reached and not task.repeat
        found.append(Passage(start, goal, starting, reaching, arrives, by))
    return tuple(found)


def _rows(region: ir.Region, workspace: ir.Workspace) -> Rows:
    return refuting_polytope(region.shape, workspace.dimension).rows
