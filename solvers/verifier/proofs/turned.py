"""How the frame of an effector is turned, at every instant of a tube."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from flint import arb

from compiler.tasks.pose_target import BALLS, PoseTarget, pose_target
from grammar_lang import ir
from solvers.verifier.proofs.point_map import Slice
from solvers.verifier.proofs.scene import Scene
from solvers.verifier.proofs.tube_checks import Constraint


def pose_name(reach: ir.Reach, number: int) -> str:
    """What the condition on a pose of a ``reach`` clause is called; ``number`` is from 0."""
    which = f"pose {number + 1}" if len(reach.poses) > 1 else "pose"
    return f"{which} at {reach.region}"


@dataclass(slots=True, kw_only=True)
class Turned(Constraint):
    """The axes of a frame, ``points``, are within an angle of directions; the margin is in rad.

    ``place`` is that of the effector.
    """

    effector: int
    target: PoseTarget[arb]

    @property
    def unit(self) -> str:
        """Of the margin."""
        return "rad"

    def bound(self, over: Slice) -> tuple[arb, arb]:
        """How much closer to the directions they are than they have to be, in rad."""
        value, middle = arb(0), arb(0)
        for point, direction in zip(self.points, self.target.directions, strict=True):
            along, centre = over.form(direction, point)
            value, middle = value + along, middle + centre
        off, off_middle = (_angle(self.target.cosine(each)) for each in (value, middle))
        return self.target.within - off, self.target.within - off_middle

    def violated(self, over: Slice) -> bool:
        """Whether they are certainly too far off at the middle of the slice."""
        return bool(self.bound(over)[1] < 0)

    def where(self, over: Slice) -> tuple[float, ...]:
        """The place of the effector."""
        return over.middle(self.effector)


def _angle(cosine: arb) -> arb:
    """All angles whose cosine is in a ball, which may be beyond what cosines are."""
    if not cosine.is_finite():
        return arb("nan")
    ends = [_clamped(cosine.upper()), _clamped(cosine.lower())]
    least, most = (end.acos() for end in ends)
    return least.union(most)


def _clamped(cosine: arb) -> arb:
    """An exact number, brought between -1 and 1."""
    if bool(cosine > 1):
        return arb(1)
    return arb(-1) if bool(cosine < -1) else cosine


def poses_of(scene: Scene, reach: ir.Reach, effector: int) -> Iterator[Turned]:
    """The conditions on how an effector (from 0) is turned where it reaches."""
    graph = scene.graph
    for number, pose in enumerate(reach.poses):
        target = pose_target(pose, graph.model.dimension, BALLS)
        axes, first = graph.numbering.axes[effector], len(graph.model.effectors)
        points = tuple(first + axes[axis] for axis in target.axes)
        yield Turned(pose_name(reach, number), points, effector=effector, target=target)
