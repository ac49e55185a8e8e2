"""Robots drawn at random: joints of both kinds, every body, chains and trees, any parameter."""

from __future__ import annotations

from fractions import Fraction
from random import Random

from compiler.robots.robot import WORLD, RobotModel
from grammar_lang import ir
from tests.oracles.robots import Builder

SIGNED: tuple[ir.Axis, ...] = ("x", "-x", "y", "-y", "z", "-z")
IN_PLANE: tuple[ir.Axis, ...] = ("x", "-x", "y", "-y")


def mixed_robot(seed: int, dimension: int, joints: int, *, tree: bool = False) -> RobotModel:
    """Each joint bears a rod of free length; in space a solid too, so that M is regular.

    The first angle between two joints and the first point mass are parameters as well.
    """
    rng, builder = Random(f"{seed}/{dimension}/{joints}/{tree}"), Builder(dimension)
    planar = dimension == 2
    ends, tilt, mass = [WORLD], None, None
    for number in range(joints):
        below = rng.choice(ends) if tree else ends[-1]
        if number and tilt is None:
            tilt = builder.parameter(-1, 1, "tilt")
            below = builder.turn(below, "z" if planar else rng.choice(SIGNED), tilt)
        elif rng.random() < 0.6:
            angle = builder.number(Fraction(rng.randrange(-15, 16), 10))
            below = builder.turn(below, "z" if planar else rng.choice(SIGNED), angle)
        slides = number > 0 and rng.random() < 0.5
        if slides:
            joint = builder.joint(below, rng.choice(IN_PLANE if planar else SIGNED), "prismatic")
        else:
            joint = builder.joint(below, rng.choice(("z", "-z") if planar else SIGNED))
        density = Fraction(rng.randrange(5, 20), 10)
        end = builder.link(joint, builder.parameter(), rng.choice(IN_PLANE), density)
        if not planar:
            products = [Fraction(rng.randrange(-5, 6), 100) for _ in range(3)]
            moments = [Fraction(rng.randrange(50, 75), 100) for _ in range(3)]
            com = [Fraction(rng.randrange(-3, 4), 10) for _ in range(3)]
            builder.solid(end, Fraction(rng.randrange(5, 20), 10), com, [*moments, *products])
        elif rng.random() < 0.5:
            builder.solid(end, 1, (Fraction(1, 3), Fraction(-1, 5), 0), [Fraction(2, 7)])
        if mass is None:
            mass = builder.parameter(1, 2, "mass")
            builder.point(end, mass)
        ends.append(end)
    builder.effector(ends[-1])
    return builder.build()
