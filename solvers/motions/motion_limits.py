"""What bounds a motion apart from positions, in floats: inputs, joints, rates, its two ends."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from compiler.arrays import Array


@dataclass(frozen=True, slots=True)
class InputGroup:
    """Inputs in [lower, upper] each, or of Euclidean norm at most ``upper`` (``norm2``).

    ``effort`` says that they are free inputs of joints, not declared ones.
    """

    inputs: tuple[int, ...]
    lower: float
    upper: float
    norm2: bool
    effort: bool = True

    @property
    def widest_margin(self) -> float:
        """The margin of inputs in the middle of their bounds."""
        return self.upper if self.norm2 else (self.upper - self.lower) / 2

    def margin(self, u: Array) -> float:
        """The least distance of inputs (k, m) from the bounds."""
        own = u[:, list(self.inputs)]
        if self.norm2:
            own = np.linalg.norm(own, axis=1, keepdims=True)
        gaps = self.upper - own if self.norm2 else np.minimum(self.upper - own, own - self.lower)
        return float(np.min(gaps, initial=self.widest_margin))


def effort_scale(groups: tuple[InputGroup, ...]) -> float:
    """The unit in which defects and fictitious inputs are weighed: the largest margin of an input.

    Where every input has one value only, it is 1.
    """
    return max((group.widest_margin for group in groups), default=1.0) or 1.0


@dataclass(frozen=True, slots=True)
class MotionLimits:
    """What binds the state apart from positions; arrays have one entry per degree of freedom.

    ``start_rates`` bounds the initial rates (0: at rest), ``final_rates`` the final ones (inf:
    free), ``start_values`` fixes the initial coordinates and ``own_start`` (r,) the initial states
    of the modules' own.
    """

    lower: Array
    upper: Array
    rate_lower: Array
    rate_upper: Array
    start_rates: float
    final_rates: float
    start_values: Array | None
    own_start: Array = field(default_factory=lambda: np.zeros(0))
