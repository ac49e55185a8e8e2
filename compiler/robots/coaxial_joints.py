"""Joints about one axis with nothing between them are one degree of freedom."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import replace

from compiler.robots.idle_joints import renumbered
from compiler.robots.robot import WORLD, FrameNode, Joint, RobotDof, RobotModel
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
    for head in heads:
        run = _run(head, followers)
        members = [_joint(model, frame) for frame in run]
        dofs[members[0].dof] = _merged(model, members)
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
    )


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
    """For a joint frame the one that merges into it: directly behind, coaxial, nothing beside."""
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
    for first, nearest in behind.items():
        if len(nearest) == 1 and first not in occupied and {first, *nearest} <= alone.keys():
            a, b = alone[first], alone[nearest[0]]
            if a.axis == b.axis and model.dofs[a.dof].kind == model.dofs[b.dof].kind:
                found[first] = nearest[0]
    return found


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
    signs = [members[0].sign * member.sign for member in members]
    return RobotDof(
        tuple(sorted(symbol for dof in dofs for symbol in dof.symbols)),
        dofs[0].kind,
        dofs[0].axis,
        _sum([dof.range for dof in dofs], signs),
        _sum([dof.rate for dof in dofs], signs),
    )


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
