"""What the search of parameters has evaluated, for tables and pictures; no proof rests on it."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Sample:
    """One evaluation: ``theta`` (p,) in SI units, as the robot orders its parameters.

    ``robustness`` is rho (Definition 7); where the motion is not ``feasible`` it is negative, by
    how much the constraints are violated.
    """

    theta: tuple[float, ...]
    robustness: float
    feasible: bool


@dataclass(frozen=True, slots=True)
class PathSamples:
    """All samples of one cell path: the ``path``-th (from 0) that was tried for a structure.

    ``structure`` is the number of the structure in order, ``names`` are its parameters as
    ``symbol.name``, the symbol being an index into its word.
    """

    structure: int
    path: int
    names: tuple[str, ...]
    samples: tuple[Sample, ...]


@dataclass(frozen=True, slots=True)
class BlockedPrefix:
    """A counterexample: no path that begins with these cells is tried again (ZEROPREFIX).

    ``structure`` and ``path`` are those of the samples it was found with, ``effector`` (from 0) is
    the one that could not follow.  ``sample`` is the first that the most robust motion cannot be
    brought to, None where it is not known; ``robustness`` is what that motion has.
    """

    structure: int
    path: int
    effector: int
    cells: tuple[str, ...]
    sample: int | None
    robustness: float
