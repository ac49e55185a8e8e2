"""Where parameters lie in the unit cube that searches ask about."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from compiler.arrays import Array
from solvers.parameters.parameter_space import ParameterSpace


def cube_point(space: ParameterSpace, theta: Sequence[float]) -> Array:
    """The point (p,) of the unit cube that stands for parameters (p,).

    What lies outside the box is moved to its side, and a discrete parameter to the nearest choice.
    """
    point = np.zeros(len(space.lower))
    for index, value in enumerate(theta):
        choices = space.choices[index]
        width = space.upper[index] - space.lower[index]
        if choices is not None:
            point[index] = (int(np.argmin(np.abs(choices - value))) + 0.5) / len(choices)
        elif width > 0:
            point[index] = min(1.0, max(0.0, (value - space.lower[index]) / width))
    return point
