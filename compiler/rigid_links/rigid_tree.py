"""A robot with fixed parameters as a tree of rigid links: a base, and one for each moved frame.

A degree of freedom that moves several frames is coupled, as by gears. All numbers are balls; they
are rounded once, when they are written.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import combinations, pairwise
from typing import Literal

from flint import arb

from compiler.expressions.evaluators.balls import ball, closed_ball, scalar_balls, working_precision
from compiler.rigid_links.ball_pose import WORLD_POSE, Pose, column, nearest, unit
from compiler.rigid_links.link_shape import Geometry, body_shape, shape_geometry
from compiler.rigid_links.mass_moments import MassMoments, body_moments, none
from compiler.robots.payloads import loads_of
from compiler.robots.robot import WORLD, Joint, Offset, RobotDof, RobotModel, Shape, Turn
from grammar_lang import ir

PRECISION = 256
"""Bits of the balls: far more than doubles have, enough for robots of any length."""

FLAT = Fraction(1, 100)
"""The thickness in space of a box in the plane, in metres."""

Limits = tuple[float, float] | None


class RigidTreeError(ValueError):
    """The robot is not a tree of rigid links, or not one with one joint per degree of freedom."""


@dataclass(frozen=True, slots=True)
class LinkJoint:
    """The joint that carries a link: at ``origin`` in the link ``parent``.

    The frame of the carried link is the frame of the joint. The link rotates about, or slides
    along, ``sign`` times axis 0, 1 or 2 of this frame. ``range`` and ``rate`` are in rad and rad/s,
    or in m and m/s.
    """

    dof: int
    parent: int
    origin: Pose
    axis: int
    sign: int
    kind: ir.DofKind
    range: Limits
    rate: Limits


@dataclass(frozen=True, slots=True)
class RigidLink:
    """All bodies that no joint separates, in the frame of the link; the base has no joint.

    ``looks`` are the visual geometries, ``collisions`` the collision geometries with an extent.
    """

    joint: LinkJoint | None
    moments: MassMoments
    looks: tuple[Geometry, ...]
    collisions: tuple[Geometry, ...]


@dataclass(frozen=True, slots=True)
class LinkFrame:
    """A frame that is fixed to a link."""

    link: int
    pose: Pose


@dataclass(frozen=True, slots=True)
class RigidTree:
    """The links, base (fixed in the world) first, parents before children; and the effectors.

    ``touching`` names the pairs of colliding links that may touch, if others may not.
    """

    dimension: Literal[2, 3]
    links: tuple[RigidLink, ...]
    effectors: tuple[LinkFrame, ...]
    touching: tuple[tuple[int, int], ...]

    @property
    def coupled(self) -> int | None:
        """The first degree of freedom that moves several links, or None."""
        dofs = [joint.dof for _, joint in self.carried()]
        return next((one for one, other in pairwise(dofs) if one == other), None)

    def carried(self) -> tuple[tuple[int, LinkJoint], ...]:
        """The links that joints carry, with their joints, in the order of degrees of freedom."""
        found = [(i, link.joint) for i, link in enumerate(self.links) if link.joint is not None]
        return tuple(sorted(found, key=lambda item: item[1].dof))

    def children(self) -> list[list[int]]:
        """For every link the links that its joints carry."""
        found: list[list[int]] = [[] for _ in self.links]
        for number, link in enumerate(self.links):
            if link.joint is not None:
                found[link.joint.parent].append(number)
        return found

    def tools(self) -> list[list[int]]:
        """For every link the numbers of the effectors fixed to it."""
        found: list[list[int]] = [[] for _ in self.links]
        for number, frame in enumerate(self.effectors):
            found[frame.link].append(number)
        return found


def rigid_tree(
    model: RobotModel, theta: Sequence[Fraction], factors: Sequence[float] = ()
) -> RigidTree:
    """The tree of a robot whose parameters have these values (SI).

    The masses and moments of inertia of each body are multiplied by its factor. If no factors are
    given, it is 0 for loads that are picked up and put down, and 1 for all other bodies.

    Raises:
        RigidTreeError: a degree of freedom moves nothing, or a length or angle has no value.
    """
    with working_precision(PRECISION):
        scalars = scalar_balls(model.scalars, [ball(value) for value in theta])
        if not all(scalar.is_finite() for scalar in scalars):
            raise RigidTreeError("a number of the robot has no value")
        joints, frames = _frames(model, scalars)
        moments = [none() for _ in range(len(joints) + 1)]
        looks: list[list[Geometry]] = [[] for _ in moments]
        collisions: list[list[Geometry]] = [[] for _ in moments]
        loads = loads_of(model)
        weights = [arb(factor) for factor in factors]
        weights = weights or [arb(0 if i in loads else 1) for i in range(len(model.bodies))]
        for number, (body, weight) in enumerate(zip(model.bodies, weights, strict=True)):
            frame = frames[body.frame]
            moments[frame.link] += body_moments(body, scalars, frame.pose).times(weight)
            if number not in model.covered:
                looks[frame.link] += body_shape(body, scalars, frame.pose)
        for each in model.colliders:
            frame = frames[each.frame]
            geometry = shape_geometry(each, scalars, frame.pose, FLAT)
            if geometry is not None:
                collisions[frame.link].append(geometry)
                looks[frame.link] += [geometry] * isinstance(each, Shape)
        links = tuple(
            RigidLink(joint, moment, tuple(seen), tuple(hard))
            for joint, moment, seen, hard in zip(
                [None, *joints], moments, looks, collisions, strict=True
            )
        )
        effectors = tuple(frames[i] for i in model.effectors)
        return RigidTree(model.dimension, links, effectors, _touching(model, links, frames))


def fixed_frames(
    model: RobotModel, theta: Sequence[Fraction], frames: Sequence[int]
) -> tuple[LinkFrame, ...]:
    """Where frames of a robot are in its links, which are numbered as in its tree.

    Raises:
        RigidTreeError: as for :func:`rigid_tree`.
    """
    with working_precision(PRECISION):
        scalars = scalar_balls(model.scalars, [ball(value) for value in theta])
        if not all(scalar.is_finite() for scalar in scalars):
            raise RigidTreeError("a number of the robot has no value")
        _, found = _frames(model, scalars)
        return tuple(found[frame] for frame in frames)


def _touching(
    model: RobotModel, links: Sequence[RigidLink], frames: Sequence[LinkFrame]
) -> tuple[tuple[int, int], ...]:
    if not model.apart:
        return ()
    of = [frames[each.frame].link for each in model.colliders]
    apart = {frozenset((of[one], of[two])) for one, two in model.apart}
    hard = [number for number, link in enumerate(links) if link.collisions]
    return tuple(pair for pair in combinations(hard, 2) if frozenset(pair) not in apart)


def _frames(model: RobotModel, scalars: Sequence[arb]) -> tuple[list[LinkJoint], list[LinkFrame]]:
    """The joints in the order of the links they carry, and every frame in its link."""
    joints: list[LinkJoint] = []
    frames = [LinkFrame(0, WORLD_POSE)]
    moved: dict[tuple[int, Joint], LinkFrame] = {}
    for node in model.frames[WORLD + 1 :]:
        below = frames[node.parent]
        match node.step:
            case None:
                frames.append(below)
            case Turn(axis, angle):
                frames.append(LinkFrame(below.link, below.pose.turned(axis, scalars[angle])))
            case Offset(vector):
                offset = column([scalars[i] for i in vector])
                frames.append(LinkFrame(below.link, below.pose.moved(offset)))
            case Joint() as step:
                key = node.parent, step
                if key not in moved:
                    joints.append(_joint(model.dofs[step.dof], step, below))
                    moved[key] = LinkFrame(len(joints), WORLD_POSE)
                frames.append(moved[key])
    idle = {*range(len(model.dofs))} - {joint.dof for joint in joints}
    if idle:
        raise RigidTreeError(f"degree of freedom {min(idle) + 1} moves nothing")
    return joints, frames


def _joint(dof: RobotDof, step: Joint, below: LinkFrame) -> LinkJoint:
    return LinkJoint(
        step.dof,
        below.link,
        below.pose,
        step.axis,
        step.sign,
        dof.kind,
        _limits(dof.range),
        _limits(dof.rate),
    )


def _limits(interval: ir.Interval | None) -> Limits:
    if interval is None:
        return None
    return nearest(closed_ball(interval.lower)), nearest(closed_ball(interval.upper))


def axis_of(joint: LinkJoint) -> tuple[float, float, float]:
    """The axis of a joint in its own frame."""
    x, y, z = (float(unit(joint.axis, joint.sign)[i, 0]) for i in range(3))
    return x, y, z
