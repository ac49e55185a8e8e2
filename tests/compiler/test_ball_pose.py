"""Poses in balls against rotations of scipy and by hand."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest
from flint import arb
from scipy.spatial.transform import Rotation

from compiler.arrays import Array
from compiler.expressions.evaluators.balls import ball, working_precision
from compiler.rigid_links.ball_pose import WORLD_POSE, Pose, column, doubles, nearest


def built(turns: list[tuple[int, Fraction]]) -> tuple[Pose, Array]:
    """A pose after turns by multiples of a right angle, each with a shift, and its matrix."""
    pose, expected = WORLD_POSE, np.eye(4)
    for axis, quarters in turns:
        pose = pose.moved(column([1, 0, ball(quarters)])).turned(
            axis, ball(quarters) * arb.pi() / 2
        )
        step = np.eye(4)
        step[:3, 3] = [1, 0, float(quarters)]
        turn = Rotation.from_rotvec(np.eye(3)[axis] * float(quarters) * np.pi / 2)
        step[:3, :3] = turn.as_matrix()
        expected = expected @ step
    return pose, expected


def cases() -> list[list[tuple[int, Fraction]]]:
    """Turns by thirds and by whole right angles, so that every special case occurs."""
    rng = np.random.default_rng(7)
    found = []
    for parts in (3, 1):
        for _ in range(60):
            length = int(rng.integers(1, 5))
            axes, amounts = rng.integers(0, 3, length), rng.integers(-5, 6, length)
            pairs = zip(axes, amounts, strict=True)
            found.append([(int(axis), Fraction(int(amount), parts)) for axis, amount in pairs])
    return found


def test_descriptions_give_the_rotation_back() -> None:
    signs, stuck = set(), 0
    with working_precision(256):
        for turns in cases():
            pose, expected = built(turns)
            w, x, y, z = pose.quaternion()
            assert w >= 0
            signs.add(int(np.argmax(np.abs([w, x, y, z]))))
            back = Rotation.from_quat([x, y, z, w]).as_matrix()
            np.testing.assert_allclose(back, expected[:3, :3], atol=5e-15)
            angles = pose.roll_pitch_yaw()
            stuck += abs(abs(angles[1]) - np.pi / 2) < 1e-12
            back = Rotation.from_euler("xyz", angles).as_matrix()
            np.testing.assert_allclose(back, expected[:3, :3], atol=5e-15)
            np.testing.assert_allclose(doubles(pose.origin), expected[:3, 3], atol=1e-14)
    assert signs == {0, 1, 2, 3}
    assert stuck > 5


def test_the_inverse_leads_back() -> None:
    with working_precision(256):
        for turns in cases()[::10]:
            pose, _ = built(turns)
            there = pose * pose.inverse()
            np.testing.assert_allclose(doubles(there.origin), 0, atol=0)
            assert there.quaternion() == (1, 0, 0, 0)


def test_numbers_are_rounded_once() -> None:
    with working_precision(256):
        assert nearest(ball(Fraction(1, 10))) == 0.1
        assert nearest((arb.pi() / 2).cos()) == 0
        assert nearest(arb.pi()) == np.pi
        for wide in (arb(1, 1e-20), arb(0, 1), arb("inf"), arb("nan")):
            with pytest.raises(ValueError, match="no definite value"):
                nearest(wide)
