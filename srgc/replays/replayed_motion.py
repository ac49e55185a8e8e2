"""A motion as another simulator has it."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction

from compiler.arrays import Array


@dataclass(frozen=True, slots=True, eq=False)
class ReplayedMotion:
    """States and effectors at k instants of a motion, in SI units.

    Attributes:
        simulator: its name.
        version: that of the simulator.
        method: of integration.
        timestep: of the simulation in seconds; None where it chooses its own.
        times: (k,) in seconds.
        states: (k, 2 n) coordinates, then rates, in the order of the degrees of freedom.
        effectors: (k, e, d) positions.
        parts: how many instants each step of the task has; its ends are among them.
    """

    simulator: str
    version: str
    method: str
    timestep: Fraction | None
    times: Array
    states: Array
    effectors: Array
    parts: int

    def at_steps(self) -> Array:
        """The states at the ends of the steps of the task."""
        return self.states[:: self.parts]
