"""A monotone cubic through given values, at rest at both ends (Fritsch & Carlson 1980).

The slopes are those of Fritsch & Butland (1984), weighted harmonic means.  It is implemented here
because importing scipy takes longer than the search of a small task.
"""

from __future__ import annotations

import numpy as np

from compiler.arrays import Array


def monotone_cubic(times: Array, values: Array, at: Array) -> Array:
    """The cubic through ``values`` (w,) at increasing ``times`` (w,), evaluated at ``at`` (s,)."""
    steps = np.diff(times)
    secants = np.diff(values) / steps
    slopes = np.zeros(len(times))
    before, after = secants[:-1], secants[1:]
    first, second = 2 * steps[1:] + steps[:-1], steps[1:] + 2 * steps[:-1]
    same = before * after > 0
    means = (first + second)[same] / (first[same] / before[same] + second[same] / after[same])
    slopes[1:-1][same] = means
    number = np.clip(np.searchsorted(times, at, side="right") - 1, 0, len(steps) - 1)
    h, t = steps[number], (at - times[number]) / steps[number]
    return np.asarray(
        values[number] * (1 + 2 * t) * (1 - t) ** 2
        + values[number + 1] * t**2 * (3 - 2 * t)
        + h * t * (1 - t) * ((1 - t) * slopes[number] - t * slopes[number + 1])
    )
