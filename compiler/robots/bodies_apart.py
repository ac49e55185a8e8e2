"""Which bodies of a robot have to stay apart where a task says ``avoid self with body``.

Bodies may touch that are of one link, of two links that one joint connects, or of two links whose
joints sit at one frame of a third.  Links without bodies are skipped, as those between the axes of
a wrist are.  A link with rods collides as these are, one without at its centres of mass.
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
    touching = links.touching({links.of[body.frame] for body in model.bodies})
    modules = [owner and owner.module for owner in model.owners] or [None] * len(model.bodies)
    found = list[tuple[int, int]]()
    for one, two in combinations(_colliding(model, links), 2):
        first, second = sorted(links.of[model.bodies[i].frame] for i in (one, two))
        if first == second:
            continue
        owners = modules[one], modules[two]
        named = None not in owners and tuple(sorted(map(str, owners))) in itself.exceptions
        if (named or (first, second) in touching) == exempt:
            found.append((one, two))
    return tuple(found)


@dataclass(frozen=True, slots=True)
class _Links:
    """The links of a robot: what no joint parts; a link is called by its first frame.

    ``of`` says per frame in which link it is.
    """

    frames: Sequence[FrameNode]
    of: Sequence[int]

    def touching(self, carrying: set[int]) -> set[tuple[int, int]]:
        """The pairs of links ``carrying`` bodies that may touch, the smaller number in front.

        From each link the way down through links without bodies is followed, and the first one
        that has some.
        """
        found = set[tuple[int, int]]()
        mounted: dict[tuple[int, tuple[Step, ...]], list[tuple[int, int]]] = {}
        for link in sorted(carrying - {WORLD}):
            above = below = link
            while below == link or (below not in carrying and below != WORLD):
                above, below = below, self.of[self.frames[below].parent]
                # Those on other joints at the same frame.
                beside = mounted.setdefault((below, self._mount(above)), [])
                found |= {(other, link) for joint, other in beside if joint != above}
                beside.append((above, link))
            if below in carrying:
                found.add((below, link))
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
