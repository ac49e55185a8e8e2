"""Joints that move nothing: no mass, no effector and no body point."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from fractions import Fraction

from compiler.expressions.scalars import Constant
from compiler.robots.robot import (
    WORLD,
    FrameNode,
    Joint,
    Offset,
    RobotModel,
    RodBody,
    SolidBody,
    Step,
    Turn,
)


def without_idle_joints(model: RobotModel) -> RobotModel:
    """The model without its idle joints, which are reported in ``removed``.

    Removing joints may make others idle, so the search is repeated.
    """
    while True:
        idle = _idle(model)
        if not idle:
            return model
        model = without(model, idle)


def without(model: RobotModel, gone: Sequence[int]) -> RobotModel:
    """Fix the given degrees of freedom at zero and remove them."""
    kept = [dof for dof in range(len(model.dofs)) if dof not in set(gone)]
    symbols = [symbol for dof in gone for symbol in model.dofs[dof].symbols]
    places = {old: new for new, old in enumerate(kept)}
    return replace(
        model,
        dofs=tuple(model.dofs[dof] for dof in kept),
        frames=renumbered(model.frames, places),
        removed=tuple(sorted((*model.removed, *symbols))),
        own=tuple(own.renumbered(places) for own in model.own),
        joints=tuple(
            replace(joint, dof=None if joint.dof is None else places.get(joint.dof))
            for joint in model.word_dofs
        ),
    )


def renumbered(frames: Sequence[FrameNode], places: dict[int, int]) -> tuple[FrameNode, ...]:
    """The frames with renumbered degrees of freedom; joints without a new number become rigid."""

    def step(old: Step | None) -> Step | None:
        if not isinstance(old, Joint):
            return old
        return replace(old, dof=places[old.dof]) if old.dof in places else None

    return tuple(FrameNode(frame.parent, step(frame.step)) for frame in frames)


def _idle(model: RobotModel) -> list[int]:
    """The degrees of freedom that move nothing, in order."""
    reach = _Reach(model)
    moving = {
        step.dof
        for frame, node in enumerate(model.frames)
        if isinstance(step := node.step, Joint) and reach.moves(frame, step)
    }
    return [dof for dof in range(len(model.dofs)) if dof not in moving]


class _Reach:
    """What a motion of a frame moves, computed in one pass from the leaves of the tree inwards.

    ``turned[frame]`` says, for each axis, whether a rotation about a line through the frame's
    origin moves something behind it: for a line that the axis has been turned away from, and for
    the axis itself (*aligned*).
    """

    def __init__(self, model: RobotModel) -> None:
        self.model = model
        self.zero = {i for i, node in enumerate(model.scalars) if node == Constant(Fraction(0))}
        count = len(model.frames)
        self.carries = [False] * count
        self.turned = [[(False, False)] * 3 for _ in range(count)]
        for body in model.bodies:
            self.carries[body.frame] = True
            if isinstance(body, SolidBody | RodBody):
                self._add_all(body.frame, body.axis if isinstance(body, RodBody) else None)
        for shape in model.shapes:
            self.carries[shape.frame] = True
            if shape.kind != "sphere":
                self._add_all(shape.frame, None if shape.kind in {"box", "hull"} else shape.axis)
        for frame in model.effectors:
            self.carries[frame] = True
            if model.posed:
                self._add_all(frame, None)
        for frame in range(count - 1, WORLD, -1):
            self._pass_on(frame)

    def moves(self, frame: int, joint: Joint) -> bool:
        """Whether the joint that leads to a frame moves anything."""
        if self.model.dofs[joint.dof].kind == "prismatic":
            return self.carries[frame]
        return self.turned[frame][joint.axis][True]

    def _add_all(self, frame: int, along: int | None) -> None:
        """Add what a rotation about any line except the axis ``along`` moves."""
        for axis in range(3):
            self._add(frame, axis, away=True, aligned=axis != along)

    def _add(self, frame: int, axis: int, *, away: bool, aligned: bool) -> None:
        before = self.turned[frame][axis]
        self.turned[frame][axis] = (before[False] or away, before[True] or aligned)

    def _pass_on(self, frame: int) -> None:
        """Add what lies behind a frame to its parent."""
        node = self.model.frames[frame]
        self.carries[node.parent] |= self.carries[frame]
        for axis in range(3):
            away, aligned = self.turned[frame][axis]
            match node.step:
                case Offset(vector):
                    off = [i for i in range(3) if vector[i] not in self.zero]
                    away = self.carries[frame] if off else away
                    aligned = self.carries[frame] if off not in ([], [axis]) else aligned
                case Turn(about, _):
                    aligned = aligned if about == axis else away
                case Joint(dof, about, _) if self.model.dofs[dof].kind == "prismatic":
                    away = self.carries[frame]
                    aligned = aligned if about == axis else self.carries[frame]
                case Joint(_, about, _):
                    aligned = aligned if about == axis else away
                case None:
                    pass
            self._add(node.parent, axis, away=away, aligned=aligned)
