"""Which bodies of a robot have to stay apart where a task says ``avoid self with body``.

Bodies of one link may touch, and those of links that one joint connects.  Links without bodies are
skipped, as those between the axes of a wrist are.  So may those of two links whose joints sit at
one frame of a third.  A link with rods collides as these are, one without at its centres of mass.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations

from compiler.robots.robot import WORLD, FrameNode, Joint, RobotModel, RodBody, Step
from grammar_lang import ir


def bodies_apart(model: RobotModel, itself: ir.AvoidSelf) -> tuple[tuple[int, int], ...]:
    """The pairs of bodies, by number, that must not touch; ``model`` has all joints of its word.

    Joints that move no mass may be left out of a normal form, though they part two links.
    """
    return _pairs(model, itself, exempt=False)


def exempt_bodies(model: RobotModel, itself: ir.AvoidSelf) -> tuple[tuple[int, int], ...]:
    """The pairs of bodies of different links that may touch."""
    return _pairs(model, itself, exempt=True)


def _pairs(model: RobotModel, itself: ir.AvoidSelf, *, exempt: bool) -> tuple[tuple[int, int], ...]:
    links = _links(model)
    carrying = {links.of[body.frame] for body in model.bodies}
    modules = [owner and owner.module for owner in model.owners] or [None] * len(model.bodies)
    found = list[tuple[int, int]]()
    for one, two in combinations(_colliding(model, links), 2):
        first, second = (links.of[model.bodies[i].frame] for i in (one, two))
        if first == second:
            continue
        owners = modules[one], modules[two]
        named = None not in owners and tuple(sorted(map(str, owners))) in itself.exceptions
        if (named or links.may_touch(first, second, carrying)) == exempt:
            found.append((one, two))
    return tuple(found)


@dataclass(frozen=True, slots=True)
class _Links:
    """The links of a robot: what no joint parts; a link is called by its first frame.

    ``of`` says per frame in which link it is.
    """

    frames: Sequence[FrameNode]
    of: Sequence[int]

    def may_touch(self, one: int, two: int, carrying: set[int]) -> bool:
        """Whether bodies of two links may touch; links ``carrying`` bodies part others."""
        below, above = self._down(one), self._down(two)
        common = max(set(below) & set(above))
        if common in (one, two):
            between = {*below, *above} - {one, two}
            return not any(link in carrying for link in between if link > common)
        ways = [way[: way.index(common)] for way in (below, above)]
        alone = not any(link in carrying for way in ways for link in way[1:])
        return alone and self._mount(ways[0][-1]) == self._mount(ways[1][-1])

    def _down(self, link: int) -> list[int]:
        """A link and those that it stands on, down to the world."""
        found = [link]
        while found[-1] != WORLD:
            found.append(self.of[self.frames[found[-1]].parent])
        return found

    def _mount(self, link: int) -> tuple[Step, ...]:
        """Where the joint of a link is in the link below it: the rigid steps to its frame."""
        steps, frame = list[Step](), self.frames[link].parent
        while frame != self.of[frame]:
            step = self.frames[frame].step
            if step is not None:
                steps.append(step)
            frame = self.frames[frame].parent
        return tuple(steps)


def _colliding(model: RobotModel, links: _Links) -> list[int]:
    """The bodies that links collide as."""
    shaped = {links.of[body.frame] for body in model.bodies if isinstance(body, RodBody)}
    return [
        number
        for number, body in enumerate(model.bodies)
        if isinstance(body, RodBody) or links.of[body.frame] not in shaped
    ]


def _links(model: RobotModel) -> _Links:
    of = list[int]()
    for number, node in enumerate(model.frames):
        own = number == WORLD or isinstance(node.step, Joint)
        of.append(number if own else of[node.parent])
    return _Links(model.frames, of)
