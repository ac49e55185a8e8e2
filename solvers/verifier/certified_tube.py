"""The tube behind a certificate, to display it or to compare measurements with it.

It is computed as ``srgc verify`` computes it (decision 36). Bounds are rounded outwards to floats.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from flint import arb, arb_mat

from compiler.arrays import Array
from compiler.expressions.evaluators.balls import ball, working_precision
from solvers.verifier.claims.certificate import FoundClaim
from solvers.verifier.claims.spec_copy import claimed_task, read_claim
from solvers.verifier.found_check import claimed_robot
from solvers.verifier.proofs.disturbed_proof import disturbed_start, input_error
from solvers.verifier.proofs.enclosure import Accuracy, EnclosureFailure, TubeSegment, tube
from solvers.verifier.proofs.point_map import PointMap
from solvers.verifier.proofs.scene import scene_of
from solvers.verifier.proofs.trajectory_proof import ACCURACIES
from solvers.verifier.proofs.tube_proof import DrivenRobot, driven_robot, legs
from solvers.verifier.proofs.zonotope import Zonotope, zonotope
from solvers.verifier.report import Outcome, Refused

FLOAT_BITS = 53
"""Bounds at an instant are returned as floats, so more bits would not make them narrower."""


@dataclass(frozen=True, slots=True, eq=False)
class CertifiedTube:
    """An enclosure, at every instant, of the motion of a found robot under its stated inputs.

    Attributes:
        times: (m + 1,) the ends of its m segments, in seconds.
        coordinates: (m, n, 2) lower and upper bounds of the joints' coordinates over each segment,
            in rad or m.
        rates: (m, n, 2) bounds of their rates.
        points: (m, p, d, 2) bounds of the positions of all points in m; effectors come first.
        samples: (k + 1, 2 n, 2) bounds of coordinates and rates at the ends of the task's steps.
        sample_points: (k + 1, p, d, 2) bounds of the positions of all points at those times.
        commanded: (k, inputs, 2) bounds of the inputs that are commanded in each step.
        disturbed: whether the tube holds all disturbed motions of a task with ``robust``, or all
            rounds of a motion that goes on for ever.
        segments: the solutions themselves, as polynomials in the coordinates of the equations.
        point_map: how positions follow from the coordinates of the equations.
        rows: (n, n) the integer matrix D that gives the joints' coordinates, q = D y.
    """

    times: Array
    coordinates: Array
    rates: Array
    points: Array
    samples: Array
    sample_points: Array
    commanded: Array
    disturbed: bool
    segments: tuple[TubeSegment, ...]
    point_map: PointMap
    rows: tuple[tuple[int, ...], ...]

    def at(self, time: float) -> Array:
        """Bounds (2 n, 2) of coordinates and rates at an instant of the motion, in seconds.

        Raises:
            ValueError: the instant is before the start or after the end of the motion.
        """
        with working_precision(FLOAT_BITS):
            return _bounds(_joint_states(self.rows, self._state(time)))

    def points_at(self, time: float) -> Array:
        """Bounds (p, d, 2) of the positions of all points at an instant, in m.

        Raises:
            ValueError: the instant is before the start or after the end of the motion.
        """
        with working_precision(FLOAT_BITS):
            return _places(self.point_map, self._state(time))

    def _state(self, time: float) -> list[arb]:
        if not 0 <= time <= self.times[-1]:
            raise ValueError(f"the motion lasts from 0 to {self.times[-1]} s, without {time} s")
        number = int(np.searchsorted(self.times, time, side="right")) - 1
        segment = self.segments[min(number, len(self.segments) - 1)]
        return segment.at(arb(time) - segment.start)

    def distances(self, times: Array, states: Array) -> tuple[Array, Array]:
        """How far states are outside the tube, and how far from its middle.

        Args:
            times: (k,) in seconds.
            states: (k, 2 n) coordinates, then rates.

        Returns:
            Two arrays (k, 2 n): the distance to the nearer bound (0 inside the tube), and the
                distance to the middle.
        """
        bounds = np.array([self.at(float(time)) for time in times]).reshape(*states.shape, 2)
        lower, upper = bounds[..., 0], bounds[..., 1]
        outside = np.maximum(np.maximum(lower - states, states - upper), 0.0)
        return outside, np.abs(states - (lower + upper) / 2)


def certified_tube(folder: Path) -> CertifiedTube:
    """The tube of the robot in a result folder.

    This function does not prove that the robot does the task; ``srgc verify`` does.

    Raises:
        CertificateError: the certificate is malformed.
        Refused: the claim is refuted before anything is integrated, or it has no robot.
        EnclosureFailure: no enclosure reaches the end of the motion.
        OSError, UnicodeDecodeError: the folder cannot be read.
    """
    claimed = claimed_task(folder, read_claim(folder))
    if not isinstance(claimed.claim, FoundClaim):
        raise Refused("the verdict is impossible, so there is no motion", Outcome.UNDECIDED)
    robot = claimed_robot(claimed.claim, claimed.program, claimed.task)
    scene = scene_of(claimed.program, claimed.task, robot.model, claimed.cells, robot.derivation)
    disturbed = scene.task.robust is not None or scene.task.repeat
    for accuracy in ACCURACIES:
        with working_precision(accuracy.bits):
            try:
                return _enclosed(driven_robot(scene, robot.motion, disturbed=disturbed), accuracy)
            except EnclosureFailure:
                # More accuracy does not help a disturbed set: it grows anyway.
                if accuracy is ACCURACIES[-1] or disturbed:
                    raise
    raise AssertionError(ACCURACIES)


def _enclosed(robot: DrivenRobot, accuracy: Accuracy) -> CertifiedTube:
    """The tube at an accuracy; if the task names disturbances, from all disturbed starts."""
    task = robot.scene.task
    several = task.robust is not None or task.repeat
    initial = disturbed_start(robot.scene, robot.state)
    error = input_error(robot.scene)
    rows = robot.scene.graph.coordinates.rows
    segments, states, points = list[TubeSegment](), list[Array](), list[Array]()
    sets, commanded = list[Zonotope](), list[Array]()
    for start, steps in legs(robot, initial):
        # A round begins from its whole set, which contains the states that the prefix leads to.
        sets[steps.start :] = [zonotope(start)]
        for segment in tube(
            robot.field, start, robot.inputs, ball(task.step), accuracy, error, robot.law, steps
        ):
            half = segment.length / 2
            over = segment.at(half + SIGNED * half)
            segments.append(segment)
            if segment.number == len(commanded):
                commanded.append(_bounds(segment.commanded))
            if segment.steps[1].denominator == 1:
                sets.append(segment.last or sets[-1])
            states.append(_bounds(_joint_states(rows, over)))
            points.append(_places(robot.point_map, over))
    times = [0.0, *(float((each.start + each.length).mid()) for each in segments)]
    found, n = np.array(states).reshape(len(segments), -1, 2), len(rows)
    return CertifiedTube(
        np.array(times), found[:, :n], found[:, n:], np.array(points),
        np.array([_sample(rows, each) for each in sets]),
        np.array([_places(robot.point_map, each.hull()) for each in sets]),
        np.array(commanded), several, tuple(segments), robot.point_map, rows,
    )  # fmt: skip


SIGNED = arb(0, 1)
"""The ball [-1, 1]."""


def _joint_states(rows: Sequence[Sequence[int]], state: Sequence[arb]) -> list[arb]:
    """The joints' coordinates and rates, from a state in the coordinates of the equations."""
    n = len(rows)
    parts = (state[:n], state[n : 2 * n])
    return [
        sum((weight * item for weight, item in zip(row, part, strict=True) if weight), arb(0))
        for part in parts
        for row in rows
    ]


def _sample(rows: Sequence[Sequence[int]], states: Zonotope) -> Array:
    """Bounds (2 n, 2) of the joints' coordinates and rates in a set of states.

    They are tighter than the bounds from its box, most of whose corners are far from the set.
    """
    n, size = len(rows), len(states.middle)
    turned = [
        [0] * (part * n) + list(row) + [0] * (size - (part + 1) * n)
        for part in (0, 1)
        for row in rows
    ]
    if not turned:
        return np.zeros((0, 2))
    matrix = arb_mat(turned)
    middle = (matrix * arb_mat([[x] for x in states.middle])).entries()
    radii = states.radii_under(matrix)
    return _bounds([m + SIGNED * r for m, r in zip(middle, radii, strict=True)])


def _places(point_map: PointMap, state: Sequence[arb]) -> Array:
    """Bounds (p, d, 2) of the positions of all points in a set of states."""
    return np.array([_bounds(place) for place in point_map.positions(state)])


def _bounds(balls: Sequence[arb]) -> Array:
    """Floats (k, 2), rounded outwards, that bound the values of the balls."""
    return np.array(
        [
            (
                math.nextafter(float(item.lower()), -math.inf),
                math.nextafter(float(item.upper()), math.inf),
            )
            for item in balls
        ]
    ).reshape(len(balls), 2)
