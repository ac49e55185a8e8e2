"""A motion on a time grid."""

from __future__ import annotations

from dataclasses import dataclass

from compiler.arrays import Array


@dataclass(frozen=True, slots=True)
class Trajectory:
    """States (k + 1, N), inputs (k, m) and parameters (p,) of a robot; N = 2n + r."""

    x: Array
    u: Array
    theta: Array
