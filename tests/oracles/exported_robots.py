"""Random robots whose links simulators take as they are, and robots with plain names."""

from __future__ import annotations

from fractions import Fraction
from random import Random

from compiler.rigid_links.rigid_tree import rigid_tree
from compiler.robots.robot import WORLD, RobotModel
from grammar_lang import ir
from srgc.exports.exported_robot import ExportedRobot, PartNames
from srgc.exports.joint_drives import joint_drives
from tests.oracles.robots import Builder, interval

PLANAR: tuple[ir.Axis, ...] = ("x", "-x", "y", "-y")
AXES: tuple[ir.Axis, ...] = ("x", "y", "z", "-x", "-y", "-z")


def _tenths(rng: Random, low: int, high: int) -> Fraction:
    """A number of hundredths from low to high tenths."""
    return Fraction(rng.randrange(10 * low, 10 * high + 1), 100)


def _solid(rng: Random, builder: Builder, frame: int) -> None:
    mass = _tenths(rng, 2, 30)
    x, y, z = (_tenths(rng, -5, 5) for _ in range(3))
    if builder.dimension == 2:
        builder.solid(frame, mass, (x, y, 0), [_tenths(rng, 1, 9)])
        return
    # Well within the triangle inequality, so that nothing has to be changed.
    moments = [Fraction(1, 2) + _tenths(rng, 0, 3) for _ in range(3)]
    products = [_tenths(rng, -1, 1) / 2 for _ in range(3)]
    builder.solid(frame, mass, (x, y, z), [*moments, *products])


def _rigid(rng: Random, builder: Builder, frame: int) -> int:
    """A frame after some random rigid steps."""
    planar = builder.dimension == 2
    for _ in range(rng.randrange(3)):
        axis = rng.choice(PLANAR if planar else AXES)
        frame = builder.move(frame, axis, builder.number(_tenths(rng, 1, 12)))
        turn = "z" if planar else rng.choice(AXES)
        frame = builder.turn(frame, turn, builder.number(_tenths(rng, -30, 30)))
    return frame


def _joint(rng: Random, builder: Builder, frame: int) -> int:
    planar = builder.dimension == 2
    if rng.random() < 0.3:
        axis = rng.choice(PLANAR if planar else AXES)
        return builder.joint(frame, axis, "prismatic", rate=interval(-1, 2))
    axis = rng.choice(("z", "-z") if planar else AXES)
    return builder.joint(frame, axis, "revolute", interval(-3, 3) if rng.random() < 0.5 else None)


def _bodies(rng: Random, builder: Builder, frame: int) -> int:
    """Bodies rigidly joined, not points alone; in space a solid among them, as rods are thin."""
    planar = builder.dimension == 2
    axis = rng.choice(PLANAR if planar else AXES)
    length = builder.parameter() if rng.random() < 0.5 else builder.number(_tenths(rng, 3, 9))
    kinds = rng.sample(("rod", "point", "solid"), rng.randrange(1, 4))
    if kinds == ["point"] or (not planar and "solid" not in kinds):
        kinds.append("solid")
    tip = builder.move(frame, axis, length)
    for kind in kinds:
        if kind == "rod":
            builder.rod(frame, axis, length, _tenths(rng, 3, 20))
        elif kind == "point":
            builder.point(tip, builder.number(_tenths(rng, 2, 20)))
        else:
            _solid(rng, builder, rng.choice((frame, tip)))
    return tip


def solid_robot(seed: int, dimension: int, joints: int, *, tree: bool) -> RobotModel:
    """A robot of so many joints, each with bodies behind it; effectors in two places."""
    rng, builder = Random(f"{seed} {dimension} {joints} {tree}"), Builder(dimension)
    tips = [_rigid(rng, builder, WORLD)]
    if rng.random() < 0.5:
        _bodies(rng, builder, WORLD)
    for _ in range(joints):
        below = _rigid(rng, builder, rng.choice(tips) if tree else tips[-1])
        tips.append(_bodies(rng, builder, _joint(rng, builder, below)))
    builder.effector(_rigid(rng, builder, tips[-1]))
    builder.effector(rng.choice(tips))
    return builder.build()


def random_lengths(seed: int, model: RobotModel) -> tuple[Fraction, ...]:
    rng = Random(seed)
    return tuple(_tenths(rng, 5, 20) for _ in model.parameters)


def exported(
    model: RobotModel, theta: tuple[Fraction, ...] = (), gravity: tuple[Fraction, ...] = ()
) -> ExportedRobot:
    """A robot ready for a writer: joints j1, j2, ..., links l0, l1, ..., effectors e1, e2, ..."""
    tree = rigid_tree(model, theta)
    names = PartNames(
        tuple(f"l{i}" for i in range(len(tree.links))),
        tuple(f"j{i + 1}" for i in range(len(model.dofs))),
        tuple(f"e{i + 1}" for i in range(len(model.effectors))),
    )
    x, y, z = [*(float(value) for value in gravity), 0.0, 0.0, 0.0][:3]
    efforts, drives = (None,) * len(model.dofs), joint_drives(model, theta)
    return ExportedRobot("robot", tree, names, efforts, drives, (x, y, z), Fraction(1, 8), (), ())
