"""The bodies of a robot that must not touch if a task says ``avoid self with body``.

Bodies may touch if they are of one link, or of two links that may touch
(:mod:`compiler.robots.links`). A link collides as its shapes and rods, or, if it has none, at its
centres of mass.
"""

from __future__ import annotations

from itertools import combinations

from compiler.robots.links import Links, links_of
from compiler.robots.robot import RobotModel, RodBody, Shape
from grammar_lang import ir


def bodies_apart(model: RobotModel, itself: ir.AvoidSelf) -> tuple[tuple[int, int], ...]:
    """The pairs of bodies, by number, that must not touch; ``model`` has all joints of its word.

    A normal form may lack joints that move no mass although they separate two links.
    """
    return _pairs(model, itself, exempt=False)


def exempt_bodies(model: RobotModel, itself: ir.AvoidSelf) -> tuple[tuple[int, int], ...]:
    """The pairs of bodies of different links that may touch."""
    return _pairs(model, itself, exempt=True)


def _pairs(model: RobotModel, itself: ir.AvoidSelf, *, exempt: bool) -> tuple[tuple[int, int], ...]:
    links, colliders = links_of(model.frames), model.colliders
    touching = links.touching({links.of[each.frame] for each in colliders})
    modules = [owner and owner.module for owner in model.collider_owners] or [None] * len(colliders)
    found = list[tuple[int, int]]()
    for one, two in combinations(_colliding(model, links), 2):
        first, second = sorted(links.of[colliders[i].frame] for i in (one, two))
        if first == second:
            continue
        owners = modules[one], modules[two]
        named = None not in owners and tuple(sorted(map(str, owners))) in itself.exceptions
        if (named or (first, second) in touching) == exempt:
            found.append((one, two))
    return tuple(found)


def _colliding(model: RobotModel, links: Links) -> list[int]:
    """The numbers of the colliders that links collide as: rods and shapes, else centres of mass."""
    extended = (RodBody, Shape)
    shaped = {links.of[each.frame] for each in model.colliders if isinstance(each, extended)}
    return [
        number
        for number, each in enumerate(model.colliders)
        if isinstance(each, extended) or links.of[each.frame] not in shaped
    ]
