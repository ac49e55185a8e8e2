"""The instants at which a motion is drawn: its samples, and more between them where it is fast.

Between samples the coordinates are cubic with the rates that the samples have (Hermite).
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from compiler.arrays import Array

SHARPEST = 0.12
"""Radians that a joint turns at most from one drawn instant to the next; a rod that is drawn by
interpolating its ends is then at most 0.2 % too short."""


@dataclass(frozen=True, slots=True)
class MotionSamples:
    """Instants (K,) in seconds and the coordinates (K, n) then."""

    times: Array
    coordinates: Array


def motion_samples(
    times: Array, q: Array, qd: Array, *, turning: NDArray[np.bool_], most: int, least: int = 0
) -> MotionSamples:
    """Instants at which a motion is to be drawn, the first and the last among them.

    Args:
        times: of the samples, (k + 1,).
        q: coordinates, (k + 1, n).
        qd: rates, (k + 1, n).
        turning: which coordinates are angles, (n,).
        most: how many instants at most, two or more; samples are left out where there are more.
        least: about how many at least, though no joint turns far.
    """
    kept = np.arange(len(times))
    if len(times) > most:
        kept = np.unique(np.linspace(0, len(times) - 1, most).round().astype(int))
    turned = np.abs(np.diff(q[kept][:, turning], axis=0)).max(axis=1, initial=0.0)
    parts = np.maximum(-(-least // len(turned)), np.ceil(turned / SHARPEST)).astype(int)
    parts = np.maximum(1, parts)
    if parts.sum() + 1 > most:
        parts = np.maximum(1, parts * (most - len(kept)) // max(int(parts.sum()), 1))
    instants, values = [times[:1]], [q[:1]]
    for (i, j), count in zip(pairwise(kept), parts, strict=True):
        s = np.arange(1, count + 1) / count
        instants.append(times[i] + s * (times[j] - times[i]))
        values.append(_hermite(q[[i, j]], qd[[i, j]] * (times[j] - times[i]), s))
    return MotionSamples(np.concatenate(instants), np.concatenate(values))


def _hermite(q: Array, slopes: Array, s: Array) -> Array:
    """The cubic with these ends (2, n) and slopes (2, n) at s (K,) in [0, 1]."""
    s = s[:, None]
    rise: Array = s * s * (3 - 2 * s)
    start, end = s * (1 - s) ** 2, s * s * (s - 1)
    found: Array = q[0] * (1 - rise) + q[1] * rise + slopes[0] * start + slopes[1] * end
    return found
