"""What poses ask of the axes of a frame, against SciPy's rotations."""

from __future__ import annotations

from fractions import Fraction
from typing import Any, Literal

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from compiler.expressions.evaluators.balls import working_precision
from compiler.tasks.pose_target import BALLS, FLOATS, pose_target
from grammar_lang import ir

AXES: tuple[ir.Axis, ...] = ("x", "y", "z", "-x", "-y", "-z")


def degrees(value: int) -> ir.Expr:
    return ir.Binary("*", ir.Num(Fraction(value, 180)), ir.Pi())


def about(axis: ir.Axis, angle: float) -> Rotation:
    unit = np.eye(3)["xyz".index(axis[-1])] * (-1 if axis.startswith("-") else 1)
    return Rotation.from_rotvec(np.radians(angle) * unit)


@pytest.mark.parametrize("seed", range(20))
def test_angles_between_frames(seed: int) -> None:
    rng = np.random.default_rng(seed)
    turns, due = list[tuple[ir.Axis, ir.Expr]](), Rotation.identity()
    for _ in range(rng.integers(0, 4)):
        axis, angle = AXES[rng.integers(6)], int(rng.integers(-200, 200))
        turns.append((axis, degrees(angle)))
        due = due * about(axis, angle)
    pose = ir.Oriented(tuple(turns), degrees(10))
    is_like = Rotation.random(rng=rng)
    found = pose_target(pose, 3, FLOATS)
    np.testing.assert_allclose(np.array(found.directions).T, due.as_matrix(), atol=1e-12)
    frame = is_like.as_matrix()
    along = sum(np.dot(t, frame[:, i]) for i, t in zip(found.axes, found.directions, strict=True))
    angle = (due.inv() * is_like).magnitude()
    assert found.cosine(float(along)) == pytest.approx(np.cos(angle), abs=1e-12)
    with working_precision(128):
        exact = pose_target(pose, 3, BALLS)
        for one, two in zip(exact.directions, found.directions, strict=True):
            assert all(abs(float(a.mid()) - b) < 1e-14 for a, b in zip(one, two, strict=True))
            assert all(float(a.rad()) < 1e-30 for a in one)


@pytest.mark.parametrize("dimension", [2, 3])
@pytest.mark.parametrize("axis", AXES)
def test_an_axis_along_a_direction(axis: ir.Axis, dimension: Literal[2, 3]) -> None:
    direction = (Fraction(1), Fraction(-2), Fraction(3))[:dimension]
    pose = ir.Aligned(axis, direction, degrees(10))
    if dimension == 2 and axis.endswith("z"):
        return
    found = pose_target(pose, dimension, FLOATS)
    rng = np.random.default_rng(1)
    turned = Rotation.random(rng=rng) if dimension == 3 else about("z", 77)
    column = turned.as_matrix()[:dimension, found.axes[0]]
    along = (-1 if axis.startswith("-") else 1) * column
    due = np.array(direction, dtype=float)
    cosine = due @ along / np.linalg.norm(due)
    assert found.cosine(float(np.dot(found.directions[0], column))) == pytest.approx(cosine)
    assert found.within == pytest.approx(np.radians(10))


def test_in_the_plane_one_axis_says_all() -> None:
    turns: tuple[tuple[ir.Axis, ir.Expr], ...] = (("z", degrees(50)), ("-z", degrees(15)))
    found = pose_target(ir.Oriented(turns, degrees(1)), 2, FLOATS)
    assert found.axes == (0,)
    angle = np.radians(35)
    assert found.directions[0] == pytest.approx((np.cos(angle), np.sin(angle)))


@pytest.mark.parametrize("size", [Fraction(10) ** 200, Fraction(1, 10**200)])
@pytest.mark.parametrize("numbers", [FLOATS, BALLS])
def test_a_direction_of_any_length(numbers: Any, size: Fraction) -> None:
    pose = ir.Aligned("x", (3 * size, -4 * size), ir.Num(Fraction(1, 10)))
    ((x, y),) = pose_target(pose, 2, numbers).directions
    assert float(x) == pytest.approx(0.6, rel=1e-15)
    assert float(y) == pytest.approx(-0.8, rel=1e-15)
