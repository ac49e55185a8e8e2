from __future__ import annotations

import numpy as np

from srgc.render.robot_drawing import SHARPEST, MotionSamples, motion_samples


def sampled(count: int, most: int, *, turning: bool = True) -> MotionSamples:
    """A cubic motion, which the interpolation has to give back."""
    t = np.linspace(0, 2, count)
    q = np.stack([t**3 - t, 5 * t], axis=1)
    qd = np.stack([3 * t**2 - 1, np.full(count, 5.0)], axis=1)
    return motion_samples(t, q, qd, turning=np.array([turning, turning]), most=most)


def test_cubic_is_exact_between_samples() -> None:
    found = sampled(5, 900)
    assert len(found.times) > 5
    t = found.times
    assert np.allclose(found.coordinates, np.stack([t**3 - t, 5 * t], axis=1))


def test_samples_are_among_the_instants() -> None:
    found = sampled(21, 900)
    for time in np.linspace(0, 2, 21):
        assert np.abs(found.times - time).min() < 1e-12


def test_no_joint_turns_far_from_one_instant_to_the_next() -> None:
    found = sampled(5, 900)
    assert np.abs(np.diff(found.coordinates, axis=0)).max() <= SHARPEST * 1.5


def test_sliding_joints_need_no_more_instants() -> None:
    assert len(sampled(5, 900, turning=False).times) == 5


def test_long_motions_are_thinned_and_keep_their_ends() -> None:
    for count in (40, 300, 2001):
        found = sampled(count, 100)
        assert len(found.times) <= 100
        assert found.times[0] == 0
        assert found.times[-1] == 2
        assert (np.diff(found.times) > 0).all()


def test_standing_robot() -> None:
    t = np.array([0.0, 1])
    empty = np.zeros((2, 0))
    found = motion_samples(t, empty, empty, turning=np.zeros(0, dtype=bool), most=50)
    assert found.times.tolist() == [0, 1]
    assert found.coordinates.shape == (2, 0)
