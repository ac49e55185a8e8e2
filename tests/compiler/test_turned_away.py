"""Frames that are turned away at all poses of a box: against rotations by scipy."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from itertools import product

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from compiler.expressions.evaluators.balls import working_precision
from compiler.expressions.evaluators.intervals import between
from compiler.robots.robot import WORLD
from compiler.unreachability.enclosed_points import PointTapes
from compiler.unreachability.motion_conditions import PointIn
from compiler.unreachability.violations import elsewhere
from grammar_lang import ir
from tests.oracles.robots import Builder, interval

F = Fraction
AXES = {2: "zzz", 3: "zyx"}
WITHIN = F(3, 10)


def tapes(dimension: int) -> PointTapes:
    builder = Builder(dimension)
    frame = WORLD
    for axis in AXES[dimension]:
        frame = builder.joint(frame, axis, range_=interval(-3, 3))
        frame = builder.move(frame, "x", builder.number(F(1, 2)))
    builder.effector(WORLD)
    builder.effector(frame)
    return PointTapes(replace(builder.build(), posed=True))


def poses(dimension: int) -> dict[str, ir.Pose]:
    direction = (F(1), F(-2), F(2))[:dimension]
    angle, turn = ir.Num(WITHIN), ir.Num(F(7, 10))
    turns: tuple[tuple[ir.Axis, ir.Expr], ...] = (("z", turn),)
    if dimension == 3:
        turns = (("z", turn), ("-x", turn))
    return {
        "aligned": ir.Aligned("-y", direction, angle),
        "oriented": ir.Oriented(turns, angle),
    }


def off(dimension: int, kind: str, q: np.ndarray) -> float:
    """By what angle the frame is off the pose, in rad."""
    turned = Rotation.from_matrix(np.eye(3))
    for axis, angle in zip(AXES[dimension], q, strict=True):
        turned *= Rotation.from_euler(axis, angle)
    if kind == "aligned":
        direction = np.array([1.0, -2.0, 2.0 if dimension == 3 else 0.0])
        along = -turned.as_matrix()[:, 1] @ direction / np.linalg.norm(direction)
        return float(np.arccos(np.clip(along, -1, 1)))
    due = Rotation.from_euler("z", 0.7)
    if dimension == 3:
        due *= Rotation.from_euler("x", -0.7)
    return float((due.inv() * turned).magnitude())


@pytest.mark.parametrize("kind", ["aligned", "oriented"])
@pytest.mark.parametrize("dimension", [2, 3])
def test_what_is_certain_is_so_at_every_pose(dimension: int, kind: str) -> None:
    rng, seen = np.random.default_rng(dimension), {True: 0, False: 0}
    with working_precision(64):
        points = tapes(dimension)
        (violation,) = elsewhere(PointIn(1, (), (poses(dimension)[kind],)), points.axes)
        for _ in range(300):
            middle = [F(int(x), 1000) for x in rng.integers(-2900, 2900, 3)]
            half = F(int(rng.integers(1, 400)), 1000)
            box = points.over([between(m - half, m + half) for m in middle])
            certain = violation.certain(box)
            at = np.array([float(m) for m in middle])
            moves = [*rng.uniform(-1, 1, (4, 3)), *np.array(list(product((-1, 1), repeat=3)))]
            angles = [off(dimension, kind, at + float(half) * move) for move in moves]
            depth = violation.depth(points.near(at[None], np.zeros(0)))[0]
            assert (depth > 0) == (off(dimension, kind, at) > float(WITHIN))
            if certain:
                assert min(angles) > float(WITHIN)
            elif half < F(1, 50):
                assert min(angles) < float(WITHIN) + 0.15
            seen[certain] += 1
    assert min(seen.values()) >= 10, seen
