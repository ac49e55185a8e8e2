"""Convex programs and the answers of their solvers: an optimum, or the reason for having none.

minimise (1/2) sum(d x^2) + c'x  subject to  A x = b,  G x <= h,  lower <= x <= upper  and, for
every second-order cone, |F x + f|_2 <= g'x + r.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from enum import Enum
from typing import Protocol

import numpy as np
from scipy.sparse import csc_matrix

from compiler.arrays import Array

MOST_DETAIL = 200
"""The most characters of a solver's own message that are passed on."""
CREDIBLE = 1e-4
"""The largest relative violation of a constraint with which a point is accepted as an optimum."""


@dataclass(frozen=True, slots=True)
class Cones:
    """Stacked second-order cones: rows of ``matrix`` x + s = ``right``, s in the cones in order.

    ``sizes`` counts the rows of each cone; its first row is the bound.
    """

    matrix: csc_matrix
    right: Array
    sizes: tuple[int, ...]


@dataclass(frozen=True, slots=True)
class ConvexProgram:
    """A program with N unknowns, matrices in compressed columns; bounds may be infinite.

    Shapes: quadratic (d), linear, lower, upper (N,), equal (E, N), equal_right (E,), less (I, N),
    less_right (I,). Programs with the same ``structure`` have the same pattern of entries.
    """

    quadratic: Array
    linear: Array
    equal: csc_matrix
    equal_right: Array
    less: csc_matrix
    less_right: Array
    lower: Array
    upper: Array
    cones: Cones | None = None
    structure: object = field(default=None, compare=False)

    def violation(self, point: Array) -> float:
        """The largest relative violation of a constraint by a point (N,); infinite if not finite.

        Violations are relative to 1 plus the largest absolute value of an entry of the point.
        """
        if point.shape != self.linear.shape or not np.isfinite(point).all():
            return float("inf")
        with np.errstate(all="ignore"):
            size = 1 + float(np.max(np.abs(point), initial=0.0))
            gaps = [
                np.abs(self.equal @ point - self.equal_right),
                self.less @ point - self.less_right,
                self.lower - point,
                point - self.upper,
            ]
            if self.cones is not None:
                gaps.append(_outside(self.cones, point))
            worst = float(np.max(np.concatenate(gaps), initial=0.0)) / size
        return worst if np.isfinite(worst) else float("inf")


class Status(Enum):
    """Why there is no optimum; none of these is a proof of anything."""

    INFEASIBLE = "infeasible"
    UNBOUNDED = "unbounded"
    INACCURATE = "almost solved"
    ITERATION_LIMIT = "iteration limit"
    TIME_LIMIT = "time limit"
    NUMERICS = "numerical error"
    NOT_CREDIBLE = "answer that breaks the program"
    FAILED = "solver failed"


@dataclass(frozen=True, slots=True)
class Optimum:
    """An optimal point (N,) and its value."""

    point: Array
    value: float


@dataclass(frozen=True, slots=True)
class NotSolved:
    """The program was not solved; ``detail`` is the solver's own message."""

    status: Status
    detail: str = ""

    @property
    def text(self) -> str:
        """Status and detail in one line."""
        detail = " ".join(self.detail.split())[:MOST_DETAIL]
        return f"{self.status.value} ({detail})" if detail else self.status.value


class ConvexSolver(Protocol):
    """Solves convex programs, one after the other; it may reuse what they have in common."""

    def solve(self, program: ConvexProgram, tolerance: float) -> Optimum | NotSolved:
        """An optimum with residuals and gap within the tolerance, or why there is none."""
        ...


def _outside(cones: Cones, point: Array) -> Array:
    """How far the point lies outside each cone, (number of cones,)."""
    inside = cones.right - cones.matrix @ point
    ends = np.cumsum(cones.sizes)
    parts = np.split(inside, ends[:-1])
    return np.array([float(np.linalg.norm(part[1:])) - part[0] for part in parts])


def credible(program: ConvexProgram, answer: Optimum | NotSolved) -> Optimum | NotSolved:
    """The answer, unless it claims an optimum that violates the program."""
    if isinstance(answer, NotSolved):
        return answer
    if np.isfinite(answer.value) and program.violation(answer.point) <= CREDIBLE:
        return answer
    return NotSolved(Status.NOT_CREDIBLE)
