"""Random robots with all sorts of joints, bodies, rigid steps and parameters."""

from __future__ import annotations

import random
from fractions import Fraction

from compiler.robots.robot import WORLD, RobotModel
from tests.oracles.robots import Builder, interval

AXES = ("x", "y", "z", "-x", "-y", "-z")
TURNS = (
    Fraction(1, 6),
    Fraction(1, 4),
    Fraction(1, 3),
    Fraction(1, 2),
    Fraction(5, 18),
    Fraction(-3, 4),
)


def random_robot(seed: int, dimension: int, joints: int) -> RobotModel:
    """A tree of joints, each behind a random earlier one; lengths, angles, masses are free."""
    rng = random.Random(seed)
    builder, ends = Builder(dimension=dimension), [WORLD]
    table = builder.table
    for _ in range(joints):
        frame = rng.choice(ends[-2:])
        if rng.random() < 0.5:
            angle = rng.choice(
                (
                    table.binary("*", builder.number(rng.choice(TURNS)), table.pi()),
                    table.binary("/", builder.parameter(-1, 1, "tilt"), builder.number(2)),
                    builder.number(Fraction(7, 10)),
                )
            )
            frame = builder.turn(frame, "z" if dimension == 2 else rng.choice(AXES), angle)
        kind = "prismatic" if rng.random() < 0.3 else "revolute"
        if dimension == 3:
            axis = rng.choice(AXES)
        else:
            axis = rng.choice(("x", "-y")) if kind == "prismatic" else rng.choice(("z", "-z"))
        limits = interval(-2, 3) if rng.random() < 0.5 else None
        joint = builder.joint(frame, axis, kind, limits)  # type: ignore[arg-type]
        along = rng.choice(("x", "-y"))
        end = builder.link(joint, builder.parameter(), along, Fraction(rng.randint(1, 9), 10))
        if rng.random() < 0.4:
            tensor = [2, 3, 4, Fraction(1, 5), 0, Fraction(1, 7)]
            inertia = [Fraction(2, 3)] if dimension == 2 else tensor
            com = (Fraction(1, 10), Fraction(1, 4), 0 if dimension == 2 else Fraction(1, 3))
            builder.solid(end, rng.randint(1, 4), com, inertia)
        if rng.random() < 0.4:
            builder.point(end, builder.parameter(1, 2, "mass"))
        ends.append(end)
    builder.effector(ends[-1])
    builder.effector(ends[1])
    return builder.build()
