"""Motions whose enclosure ends before they do: what is said of them, and until when."""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction

import pytest

from compiler.expressions.evaluators.balls import working_precision
from solvers.verifier.proofs.checked_condition import decisive
from solvers.verifier.proofs.scene import UNWATCHED
from solvers.verifier.proofs.trajectory_proof import ACCURACIES, Motion, Scene, prove_motion
from solvers.verifier.proofs.tube_checks import Status
from solvers.verifier.proofs.tube_proof import Followed, driven_robot, follow
from solvers.verifier.proofs.zonotope import InitialSet
from tests.solvers.test_disturbed_proof import TWO, scene, spec

STATE = tuple(map(Fraction, ("0.2", "0.7", "0", "0")))


def driven(growth: int, joint: str) -> tuple[Scene, Motion]:
    """Two rods whose joints turn as far as ``joint`` says; every torque is so much the last one."""
    where = scene(TWO, spec(8, "").replace("in [-2, 2] rad rate in [-3, 3] rad/s", joint))
    inputs = tuple((Fraction(20 * growth**k), Fraction(-9 * growth**k)) for k in range(8))
    return where, Motion((), STATE, inputs, 0, ())


def followed(where: Scene, motion: Motion) -> Iterator[Followed]:
    """The tube of every accuracy, once it is asked for."""
    for accuracy in ACCURACIES:
        with working_precision(accuracy.bits):
            robot = driven_robot(where, motion)
            tube = follow(robot, InitialSet(robot.state), None, accuracy, UNWATCHED)
        yield tube


@pytest.mark.slow
@pytest.mark.parametrize("growth", [3, 6])
def test_the_time_is_that_of_the_tube_that_got_farthest(growth: int) -> None:
    where, motion = driven(growth, "")
    tubes = list(followed(where, motion))
    assert all(tube.ended for tube in tubes)
    lost = decisive(prove_motion(where, motion))
    assert lost is not None
    assert lost.status is Status.UNDECIDED
    assert lost.time == max(tube.time for tube in tubes) > 0
    assert lost.reason == f"the enclosure of the motion ends at {lost.time:.4g} s"


@pytest.mark.slow
def test_what_is_violated_before_the_tube_ends_is_said() -> None:
    """The first joint turns by much more than two radians before the tube ends."""
    where, motion = driven(3, "in [-2, 2] rad")
    rough = next(followed(where, motion))
    assert rough.ended
    lost = decisive(prove_motion(where, motion))
    assert lost is not None
    assert lost.status is Status.FAILS
    assert lost.time is not None
    assert lost.time < rough.time
