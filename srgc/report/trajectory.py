"""A sampled motion of a robot."""

from __future__ import annotations

from dataclasses import dataclass

from compiler.arrays import Array


@dataclass(frozen=True, slots=True, eq=False)
class Trajectory:
    """A motion at its samples, in SI units.

    Shapes: ``t`` (k + 1,), ``q`` and ``qd`` (k + 1, n), ``s`` (k + 1, states of the modules' own),
    ``u`` (k, inputs): row i holds from ``t[i]`` to ``t[i + 1]``; ``effectors`` (k + 1, e, d).
    """

    t: Array
    q: Array
    qd: Array
    s: Array
    u: Array
    effectors: Array
