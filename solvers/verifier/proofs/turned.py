"""The orientation of an effector's frame at every instant of a tube."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from math import inf

from flint import arb

from compiler.dynamics.equations_of_motion import RobotGraph
from compiler.tasks.pose_target import BALLS, PoseTarget, pose_target
from compiler.workspaces.polytope import Polytope
from grammar_lang import ir
from solvers.verifier.proofs.point_map import Slice
from solvers.verifier.proofs.region_distance import Gap, RegionDistance
from solvers.verifier.proofs.scene import Scene
from solvers.verifier.proofs.tube_checks import Constraint


def pose_name(reach: ir.Reach, number: int) -> str:
    """The name of the condition on a pose of a ``reach`` clause; ``number`` is from 0."""
    which = f"pose {number + 1}" if len(reach.poses) > 1 else "pose"
    return f"{which} at {reach.region}"


@dataclass(slots=True, kw_only=True)
class Turned(Constraint):
    """The axes of a frame, ``points``, are within an angle of directions; the margin is in rad.

    ``place`` is the position of the effector.
    """

    effector: int
    target: PoseTarget[arb]

    @property
    def unit(self) -> str:
        """The unit of the margin."""
        return "rad"

    def bound(self, over: Slice) -> tuple[arb, arb]:
        """How much closer to the directions the axes are than required, in rad."""
        value, middle = arb(0), arb(0)
        for point, direction in zip(self.points, self.target.directions, strict=True):
            along, centre = over.form(direction, point)
            value, middle = value + along, middle + centre
        off, off_middle = (_angle(self.target.cosine(each)) for each in (value, middle))
        return self.target.within - off, self.target.within - off_middle

    def violated(self, over: Slice) -> bool:
        """Whether the axes are certainly too far off at the middle of the slice."""
        return bool(self.bound(over)[1] < 0)

    def where(self, over: Slice) -> tuple[float, ...]:
        """The position of the effector."""
        return over.middle(self.effector)


def _angle(cosine: arb) -> arb:
    """All angles whose cosine is in a ball, which may exceed [-1, 1]."""
    if not cosine.is_finite():
        return arb("nan")
    ends = [_clamped(cosine.upper()), _clamped(cosine.lower())]
    least, most = (end.acos() for end in ends)
    return least.union(most)


def _clamped(cosine: arb) -> arb:
    """An exact number, clamped to [-1, 1]."""
    if bool(cosine > 1):
        return arb(1)
    return arb(-1) if bool(cosine < -1) else cosine


def poses_of(scene: Scene, reach: ir.Reach, effector: int) -> Iterator[Turned]:
    """The conditions on the orientation of an effector (from 0) where it reaches."""
    for number, pose in enumerate(reach.poses):
        yield _turned(scene.graph, pose, effector, pose_name(reach, number))


def _turned(graph: RobotGraph, pose: ir.Pose, effector: int, name: str) -> Turned:
    target = pose_target(pose, graph.model.dimension, BALLS)
    axes, first = graph.numbering.axes[effector], len(graph.model.effectors)
    points = tuple(first + axes[axis] for axis in target.axes)
    return Turned(name, points, effector=effector, target=target)


# --- Poses that formulas require together with a region -------------------------------------------


@dataclass(frozen=True, slots=True)
class PosedRegion:
    """A region in which the frame of an effector has certain orientations.

    Gaps are the distances of the region. A pose adds no distance: if the effector certainly has
    another orientation, it counts as outside by any distance.
    """

    region: RegionDistance
    turned: tuple[Turned, ...]

    @property
    def polytope(self) -> Polytope:
        """The set in which the effector is, if it has the pose there."""
        return self.region.polytope

    @property
    def points(self) -> int:
        """The number of points of the robot that have to be known."""
        return 1 + max(point for pose in self.turned for point in pose.points)

    def over(self, time: Slice, point: int) -> Gap:
        """The bounds for an effector, one of the points of a slice."""
        margins = [pose.bound(time)[0] for pose in self.turned]
        if any(bool(margin < 0) for margin in margins):
            return Gap(0.0, inf, 0.0, inf)
        gap = self.region.over(time, point)
        if all(bool(margin >= 0) for margin in margins):
            return gap
        return Gap(0.0, gap.outside, gap.most_inside, inf)


def posed_region(
    graph: RobotGraph, region: RegionDistance, poses: Sequence[ir.Pose], effector: int
) -> PosedRegion:
    """A region with poses of an effector, numbered from 0."""
    return PosedRegion(region, tuple(_turned(graph, pose, effector, "") for pose in poses))
