"""Joints about one axis with nothing between them are one degree of freedom."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import replace
from fractions import Fraction

from compiler.expressions.scalars import Constant
from compiler.robots.idle_joints import renumbered
from compiler.robots.robot import (
    WORLD,
    FrameNode,
    Joint,
    Offset,
    RobotDof,
    RobotModel,
    Step,
    Turn,
    WordDof,
)
from grammar_lang import ir


def with_coaxial_joints_merged(model: RobotModel) -> RobotModel:
    """The model with each run of coaxial joints made one; its range is the interval sum of theirs.

    A coordinate that occurs in several frames is left alone: the others do not follow.  So is one
    that a module's own dynamics read: they are about the joint alone.
    """
    followers = _followers(model)
    heads = sorted(followers.keys() - followers.values())
    dofs, frames = list(model.dofs), list(model.frames)
    gone: set[int] = set()
    parts = {dof: (dof, 1) for dof in range(len(dofs))}
    for head in heads:
        run = _run(head, followers)
        members = [_joint(model, frame) for frame in run]
        dofs[members[0].dof] = _merged(model, members)
        for member, sign in zip(members, _signs(members), strict=True):
            parts[member.dof] = members[0].dof, sign
        gone.update(member.dof for member in members[1:])
        for frame in run[1:]:
            frames[frame] = FrameNode(frames[frame].parent, None)
    kept = sorted(
        (dof for dof in range(len(dofs)) if dof not in gone), key=lambda i: dofs[i].symbols
    )
    places = {old: new for new, old in enumerate(kept)}
    return replace(
        model,
        dofs=tuple(dofs[dof] for dof in kept),
        frames=renumbered(frames, places),
        own=tuple(own.renumbered(places) for own in model.own),
        joints=tuple(_summand(joint, parts, places) for joint in model.word_dofs),
    )


def _summand(
    joint: WordDof, parts: Mapping[int, tuple[int, int]], places: Mapping[int, int]
) -> WordDof:
    """A degree of freedom of the word, after the merging; ``parts`` has wholes with signs."""
    if joint.dof is None:
        return joint
    whole, sign = parts[joint.dof]
    return replace(joint, dof=places[whole], sign=sign * joint.sign)


def _joint(model: RobotModel, frame: int) -> Joint:
    step = model.frames[frame].step
    if not isinstance(step, Joint):
        raise TypeError("only joints are merged")
    return step


def _run(first: int, followers: dict[int, int]) -> list[int]:
    """A joint frame and those that follow it, one directly behind the other."""
    run = [first]
    while run[-1] in followers:
        run.append(followers[run[-1]])
    return run


def _followers(model: RobotModel) -> dict[int, int]:
    """For a joint frame the one that merges into it: coaxial, with nothing beside or between.

    Rigid steps that commute with the first joint's motion are nothing between: they may as well
    stand behind both joints.
    """
    items = [body.frame for body in model.bodies] + list(model.effectors)
    used = _used(model, items)
    carrier = _carriers(model)
    occupied = {carrier[frame] for frame in items}
    behind: dict[int, list[int]] = {}
    for frame in used:
        if model.frames[frame].step is not None:
            behind.setdefault(carrier[model.frames[frame].parent], []).append(frame)
    alone = _alone(model, used)
    found = {}
    for first, joint in alone.items():
        frame = first
        while True:
            nearest = behind.get(frame, [])
            if len(nearest) != 1 or frame in occupied:
                break
            (frame,) = nearest
            if frame in alone:
                if _alike(model, joint, alone[frame]):
                    found[first] = frame
                break
            if not _commutes(model, joint, model.frames[frame].step):
                break
    return found


def _alike(model: RobotModel, a: Joint, b: Joint) -> bool:
    """Whether two joints about parallel local axes are of one kind."""
    return a.axis == b.axis and model.dofs[a.dof].kind == model.dofs[b.dof].kind


def _commutes(model: RobotModel, joint: Joint, step: Step | None) -> bool:
    """Whether a rigid step may be exchanged with the motion of a joint before it."""
    match step:
        case Turn(axis, _):
            return axis == joint.axis
        case Offset(vector):
            zero = Constant(Fraction(0))
            off = [i for i in range(3) if model.scalars[vector[i]] != zero]
            return model.dofs[joint.dof].kind == "prismatic" or not off or off == [joint.axis]
        case _:
            return False


def _used(model: RobotModel, items: Sequence[int]) -> list[int]:
    """The frames on the way to an item, in order."""
    found = [False] * len(model.frames)
    for frame in items:
        found[frame] = True
    for frame in range(len(model.frames) - 1, WORLD, -1):
        found[model.frames[frame].parent] |= found[frame]
    return [frame for frame in range(WORLD + 1, len(found)) if found[frame]]


def _carriers(model: RobotModel) -> list[int]:
    """For each frame the nearest at or above it that is the world or has a step."""
    found = [WORLD]
    for frame, node in enumerate(model.frames[WORLD + 1 :], WORLD + 1):
        found.append(found[node.parent] if node.step is None else frame)
    return found


def _alone(model: RobotModel, used: Sequence[int]) -> dict[int, Joint]:
    """The joint frames whose coordinate nothing else reads."""
    read = {dof for own in model.own for dof in own.bound_dofs.values()}
    steps = {frame: s for frame in used if isinstance(s := model.frames[frame].step, Joint)}
    uses = Counter(step.dof for step in steps.values())
    return {f: s for f, s in steps.items() if uses[s.dof] == 1 and s.dof not in read}


def _merged(model: RobotModel, members: Sequence[Joint]) -> RobotDof:
    """The degree of freedom that coaxial joints are together, in the first one's direction."""
    dofs = [model.dofs[member.dof] for member in members]
    signs = _signs(members)
    return RobotDof(
        tuple(sorted(symbol for dof in dofs for symbol in dof.symbols)),
        dofs[0].kind,
        dofs[0].axis,
        _sum([dof.range for dof in dofs], signs),
        _sum([dof.rate for dof in dofs], signs),
    )


def _signs(members: Sequence[Joint]) -> list[int]:
    """Whether coaxial joints turn or slide as the first one does (1), or against it (-1)."""
    return [members[0].sign * member.sign for member in members]


def _sum(intervals: Sequence[ir.Interval | None], signs: Sequence[int]) -> ir.Interval | None:
    """The sum of intervals with signs, in pairs so that terms stay shallow; None is unlimited."""
    terms: list[ir.Interval] = []
    for interval, sign in zip(intervals, signs, strict=True):
        if interval is None:
            return None
        terms.append(interval if sign > 0 else _negated(interval))
    while len(terms) > 1:
        pairs = [terms[i : i + 2] for i in range(0, len(terms), 2)]
        terms = [pair[0] if len(pair) == 1 else _plus(*pair) for pair in pairs]
    return terms[0]


def _negated(interval: ir.Interval) -> ir.Interval:
    return ir.Interval(ir.Unary("neg", interval.upper), ir.Unary("neg", interval.lower))


def _plus(a: ir.Interval, b: ir.Interval) -> ir.Interval:
    return ir.Interval(ir.Binary("+", a.lower, b.lower), ir.Binary("+", a.upper, b.upper))
