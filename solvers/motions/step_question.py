"""What a convex step is asked and what it answers."""

from __future__ import annotations

from dataclasses import dataclass

from compiler.arrays import Array
from solvers.motions.motion_limits import InputGroup, MotionLimits, effort_scale
from solvers.motions.trajectory import Trajectory

LEAST = 0.1
"""Parameters smaller than this move as if they were of this size, in SI."""


@dataclass(frozen=True, slots=True)
class Weights:
    """Penalties of the convex step: per unit of effort (V), per metre (sigma), of squares.

    Squares of inputs are in units of the largest margin; ``regular`` is given to every other
    unknown, for the solver's sake.
    """

    fictitious: float = 20.0
    position: float = 200.0
    quadratic: float = 1e-4
    regular: float = 1e-9


@dataclass(frozen=True, slots=True)
class TrustRegion:
    """Where a linearisation is believed.

    ``radius`` bounds the moves of coordinates (rad or m) and, relative, of parameters;
    ``proximal`` is the price of their squares.
    """

    radius: float
    proximal: float = 0.0


@dataclass(frozen=True, slots=True)
class StepQuestion:
    """What of a convex step stays the same from one to the next.

    With ``epsilon`` every step has a slack of its own under C.6.
    """

    limits: MotionLimits
    groups: tuple[InputGroup, ...]
    theta_box: tuple[Array, Array] | None
    weights: Weights
    epsilon: float | None = None

    @property
    def scale(self) -> float:
        """The unit of effort."""
        return effort_scale(self.groups)


@dataclass(frozen=True, slots=True)
class StepResult:
    """The optimum of a convex step; slack and margin in metres and units of effort."""

    trajectory: Trajectory
    fictitious: Array
    largest_fictitious: float
    position_slack: float
    margin: float
