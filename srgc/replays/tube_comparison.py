"""How far a replayed motion is from the certified tube."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from compiler.arrays import Array
from solvers.verifier.certified_tube import CertifiedTube
from srgc.replays.replayed_motion import ReplayedMotion


@dataclass(frozen=True, slots=True)
class Farthest:
    """A largest distance: of what, in which SI unit, and at which time in seconds."""

    value: float
    unit: str
    name: str
    time: float


@dataclass(frozen=True, slots=True)
class Deviation:
    """How far one kind of quantity gets at most: out of the tube, and from its middle."""

    outside: Farthest
    middle: Farthest


@dataclass(frozen=True, slots=True)
class TubeComparison:
    """A replayed motion beside the tube; None where there is nothing of the kind."""

    motion: ReplayedMotion
    coordinates: Deviation | None
    rates: Deviation | None
    effectors: Deviation | None


def tube_comparison(
    tube: CertifiedTube,
    motion: ReplayedMotion,
    joints: Sequence[tuple[str, str]],
    effectors: Sequence[str],
) -> TubeComparison:
    """The comparison; ``joints`` are names and units, ``effectors`` names."""
    n = len(joints)
    times = np.minimum(motion.times, tube.times[-1])
    outside, middle = tube.distances(times, motion.states)
    names = [name for name, _ in joints]
    units = [unit for _, unit in joints]

    def deviation(part: slice, suffix: str) -> Deviation | None:
        shown = [f"{unit}{suffix}" for unit in units]
        return _deviation(outside[:, part], middle[:, part], times, names, shown)

    beyond, apart = _effector_distances(tube, times, motion.effectors)
    metres = ["m"] * len(effectors)
    return TubeComparison(
        motion,
        deviation(slice(None, n), ""),
        deviation(slice(n, None), "/s"),
        _deviation(beyond, apart, times, effectors, metres),
    )


def _effector_distances(tube: CertifiedTube, times: Array, positions: Array) -> tuple[Array, Array]:
    """Distances (k, e) of effectors from their boxes, 0 inside, and from the boxes' middles."""
    count = positions.shape[1]
    boxes = np.array([tube.points_at(float(time))[:count] for time in times])
    boxes = boxes.reshape(*positions.shape, 2)
    lower, upper = boxes[..., 0], boxes[..., 1]
    gaps = np.maximum(np.maximum(lower - positions, positions - upper), 0.0)
    middles = positions - (lower + upper) / 2
    return np.linalg.norm(gaps, axis=2), np.linalg.norm(middles, axis=2)


def _deviation(
    outside: Array, middle: Array, times: Array, names: Sequence[str], units: Sequence[str]
) -> Deviation | None:
    if not names:
        return None
    return Deviation(*(_farthest(table, times, names, units) for table in (outside, middle)))


def _farthest(table: Array, times: Array, names: Sequence[str], units: Sequence[str]) -> Farthest:
    row, column = (int(i) for i in np.unravel_index(int(np.argmax(table)), table.shape))
    return Farthest(float(table[row, column]), units[column], names[column], float(times[row]))
