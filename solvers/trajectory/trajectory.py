"""A motion on a time grid."""

from __future__ import annotations

from dataclasses import dataclass

from compiler.arrays import Array


@dataclass(frozen=True, slots=True)
class Trajectory:
    """States (k + 1, N), inputs (k, m) and parameters (p,) of a robot, in SI units; N = 2n + r.

    A state consists of n coordinates (rad or m), their rates, and the r modules' own states.
    Inputs (N m or N at joints) are held from one sample to the next.
    """

    x: Array
    u: Array
    theta: Array
