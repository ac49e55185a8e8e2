r"""Convex steps of several motions at once, with shared parameters tied by equations.

With the programs of the motions k (``convex_step.py``) side by side,

.. math::
    \max\ s + \sum_k (\lambda \rho_k - w_V V_k) / S_k - \ldots \quad\text{s.t.}\quad
    s \le \rho_k / S_k, \qquad \theta_{k,i} = \theta_{l,j} \text{ for linked } (k, i), (l, j)

and all other terms as in each of them.  The share s is the least margin relative to its maximum.
The small weight lambda also improves motions other than the worst one.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from itertools import pairwise
from typing import TypeAlias

import numpy as np
from scipy.sparse import block_array, block_diag, coo_matrix, csc_matrix

from solvers.backends.conic import Cones, ConvexProgram, ConvexSolver, NotSolved
from solvers.backends.portfolio import UsualSolver
from solvers.trajectory.control_problem import MeasuredMotion
from solvers.trajectory.convex_step import ConvexStep, OpenStep
from solvers.trajectory.subproblem import Indices, StepResult, TrustRegion
from solvers.trajectory.trajectory import Trajectory

OTHERS = 1e-3
"""The weight of the margins of motions other than the worst one."""
REGULAR = 1e-9
"""The weight of the squared share, which regularises the program."""

Link: TypeAlias = tuple[tuple[int, int], ...]
"""Equal parameters, each by the index of its problem and its own index there."""


@dataclass(slots=True)
class SharedStep:
    """The convex steps of several motions with linked parameters, one after the other.

    The parameters are unknowns in every one of ``steps``.
    """

    steps: tuple[ConvexStep, ...]
    links: tuple[Link, ...]
    solver: ConvexSolver = field(default_factory=UsualSolver)
    _structure: tuple[object, ...] = ()

    def solve(
        self,
        about: Sequence[MeasuredMotion],
        regions: Sequence[TrustRegion],
        accuracy: float,
        fictitious: Sequence[bool],
    ) -> list[StepResult] | NotSolved:
        """The optimum about motions whose linked parameters are equal, as they are in the result.

        Each motion has its own trust region, and may have fictitious inputs.
        """
        arguments = zip(self.steps, about, regions, fictitious, strict=True)
        opened = [
            step.opened(at.model, at.rows, region, fictitious=offered)
            for step, at, region, offered in arguments
        ]
        while True:
            programs = [each.program() for each in opened]
            program = self._joined(programs, opened)
            optimum = self.solver.solve(program, accuracy)
            if isinstance(optimum, NotSolved):
                return optimum
            parts = np.split(optimum.point[:-1], _starts(programs)[1:-1])
            results = [one.result(z, accuracy) for one, z in zip(opened, parts, strict=True)]
            found = [each for each in results if each is not None]
            if len(found) == len(results):
                break
        motions = tied([each.trajectory for each in found], self.links)
        return [replace(each, trajectory=at) for each, at in zip(found, motions, strict=True)]

    def _joined(self, programs: list[ConvexProgram], opened: list[OpenStep]) -> ConvexProgram:
        """The programs combined into one; the last unknown is the share."""
        starts = _starts(programs)
        width = int(starts[-1]) + 1
        layouts = [each.laid.layout for each in opened]
        rho = np.array([start + each.rho for start, each in zip(starts, layouts, strict=False)])
        linear = np.concatenate([*(each.linear for each in programs), [-1.0]])
        upper = np.concatenate([*(each.upper for each in programs), [1.0]])
        # If all inputs of a motion have only one value, its margin is 0 and is ignored.
        counted = rho[upper[rho] > 0]
        shares = _rows(counted, linear[counted], width - 1, width)
        linear[rho] *= OTHERS
        theta = [start + each.theta for start, each in zip(starts, layouts, strict=False)]
        pairs = [
            (theta[k][i], theta[other][j])
            for link in self.links
            for (k, i), (other, j) in pairwise(link)
        ]
        first, second = np.array(pairs, dtype=np.int64).reshape(-1, 2).T
        ties = _rows(first, np.ones(len(first)), second, width, -1.0)
        structure = (*(each.structure for each in programs), width)
        if len(structure) != len(self._structure) or any(
            one is not other for one, other in zip(structure[:-1], self._structure, strict=False)
        ):
            self._structure = structure
        return ConvexProgram(
            np.concatenate([*(each.quadratic for each in programs), [REGULAR]]),
            linear,
            _stacked([each.equal for each in programs], ties),
            np.concatenate([*(each.equal_right for each in programs), np.zeros(len(pairs))]),
            _stacked([each.less for each in programs], shares),
            np.concatenate([*(each.less_right for each in programs), np.zeros(len(counted))]),
            np.concatenate([*(each.lower for each in programs), [0.0]]),
            upper,
            _cones(programs),
            self._structure,
        )


def tied(motions: Sequence[Trajectory], links: Sequence[Link]) -> list[Trajectory]:
    """The motions with linked parameters equal bit by bit, as in the first of each link."""
    thetas = [motion.theta.copy() for motion in motions]
    for (k, i), *others in links:
        for other, j in others:
            thetas[other][j] = thetas[k][i]
    return [replace(motion, theta=theta) for motion, theta in zip(motions, thetas, strict=True)]


def _starts(programs: Sequence[ConvexProgram]) -> Indices:
    """The index at which the unknowns of each program begin, (K,), and the total number."""
    return np.cumsum([0, *(len(each.linear) for each in programs)])


def _rows(
    columns: Indices, values: np.ndarray, second: Indices | int, width: int, value: float = 1.0
) -> csc_matrix:
    """Rows with two entries each: ``values`` (r,) in ``columns``, ``value`` in ``second``."""
    rows, count = np.arange(len(columns)), len(columns)
    entries = np.concatenate([values, np.full(count, value)])
    places = np.concatenate([columns, np.broadcast_to(second, (count,))])
    return coo_matrix((entries, (np.tile(rows, 2), places)), shape=(count, width)).tocsc()


def _stacked(blocks: list[csc_matrix], below: csc_matrix) -> csc_matrix:
    """Blocks along the diagonal, then a zero column, with further rows below."""
    whole = block_diag(blocks, format="csc")
    whole.resize((whole.shape[0], below.shape[1]))
    return csc_matrix(block_array([[whole], [below]], format="csc"))


def _cones(programs: Sequence[ConvexProgram]) -> Cones | None:
    """The cones of all programs, with a column for the share."""
    if all(each.cones is None for each in programs):
        return None
    blocks, right, sizes = list[csc_matrix](), list[np.ndarray](), list[int]()
    for each in programs:
        cones = each.cones
        blocks.append(csc_matrix((0, len(each.linear))) if cones is None else cones.matrix)
        right.append(np.zeros(0) if cones is None else cones.right)
        sizes += () if cones is None else cones.sizes
    width = int(_starts(programs)[-1]) + 1
    matrix = _stacked(blocks, csc_matrix((0, width)))
    return Cones(matrix, np.concatenate(right), tuple(sizes))
