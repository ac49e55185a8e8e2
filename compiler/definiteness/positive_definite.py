"""Whether a symmetric matrix is positive definite at every point of a box, by subdivision.

On each part the matrix, preconditioned by T'MT with T from its Cholesky factor at the middle, is
enclosed and shown to be diagonally dominant; or a point is found where it is not definite.

Sources: Rump, *Verification of positive definiteness* (BIT 46, 2006) and *Verification methods*
(Acta Numerica 2010), section 10.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import casadi as ca
import numpy as np

from compiler.arrays import Array
from compiler.definiteness.box_search import Examined, Searched, search, widest_effect
from compiler.definiteness.boxes import Box
from compiler.definiteness.enclosed_matrix import EnclosedMatrix
from compiler.definiteness.exact_witnesses import ExactWitnesses
from compiler.definiteness.identities import symmetric_entries
from compiler.definiteness.indefiniteness import Refuter, Witness
from compiler.expressions.evaluators.balls import working_precision
from compiler.expressions.scalars import Constant, PiConstant

PRECISION = 64
BOXES = 4096
"""Boxes examined unless told otherwise."""
NEARLY_SINGULAR = 1e-13

Symmetry = Literal["construction", "identity", "not shown"]


@dataclass(frozen=True, slots=True)
class Definiteness:
    """Whether M is positive definite over a box (v'Mv > 0 for all v other than zero).

    - ``symmetry``: by ``construction``, by an ``identity`` of polynomials in the entries' atoms,
      or ``not shown``; the status is then about the symmetric part.
    - ``argument``: what proved it.
    - ``witness`` and ``box``: where it fails; without a witness, ``box`` is a part that resisted
      and ``reason`` says why.  Sides are in the order of ``names``.
    - ``decided`` and ``left``: the parts on which it is proved, and those on which it is not.
    """

    status: Literal["proved", "fails", "undecided"]
    boxes: int
    symmetry: Symmetry
    argument: str = ""
    box: Box | None = None
    witness: Witness | None = None
    reason: str = ""
    names: tuple[str, ...] = ()
    decided: int = 0
    left: int = 0

    @property
    def text(self) -> str:
        """The result in one line."""
        count = f"{self.boxes} box{'es' if self.boxes != 1 else ''}"
        if self.status == "proved":
            return f"positive definite: {self.argument} ({count})"
        if self.witness is None:
            return f"undecided ({count}): {self.reason}; {self._left()}"
        vector = ", ".join(map(str, self.witness.vector))
        if self.witness.identically:
            every = f"v'Mv = 0 for v = ({vector}) at every point of the box"
            return f"not positive definite anywhere: {every} ({count})"
        point = ", ".join(
            f"{name} = {value}" for name, value in zip(self.names, self.witness.point, strict=False)
        )
        where = "at"
        if self.witness.throughout:
            where = f"at every point of {self._sides()}, such as"
        return f"not positive definite: v'Mv <= 0 for v = ({vector}) {where} {point} ({count})"

    def _sides(self) -> str:
        pairs = zip(self.names, self.box or (), strict=False)
        return ", ".join(f"{name} in {side}" for name, side in pairs)

    def _left(self) -> str:
        """What is left undecided."""
        if not self.decided:
            return f"nothing was decided on any part of the box, such as {self._sides()}"
        if self.left == 1:
            return f"left: {self._sides()}"
        parts = f"proved on {self.decided} part{'s' if self.decided > 1 else ''}"
        return f"{parts}, left are {self.left}, such as {self._sides()}"


@dataclass(frozen=True, slots=True)
class DominanceTest:
    """Positive definiteness of a symmetric matrix on one box."""

    matrix: EnclosedMatrix

    def examine(self, box: Box) -> Examined:
        """Whether the preconditioned matrix is diagonally dominant on the box."""
        middle = self.matrix.at([float(side.middle) for side in box])
        diagonal = np.abs(np.diag(middle)) if np.all(np.isfinite(middle)) else np.zeros(len(middle))
        scale = np.diag(1 / np.sqrt(np.where(diagonal > 0, diagonal, 1.0)))
        if not np.all(np.isfinite(middle)):
            return Examined(proved=False, score=-np.inf, split=lambda: self._split(box, scale))
        scaled = scale @ middle @ scale
        least = float(np.linalg.eigvalsh(scaled)[0])
        if least > NEARLY_SINGULAR:
            factor = scale @ np.linalg.inv(np.linalg.cholesky(scaled)).T
            natural = self.matrix.enclosed([side.ends for side in box])
            if all(entry.finite for entry in natural):
                rows = range(len(middle))
                if self.matrix.regular(box, factor.T, factor, natural, rows):
                    return Examined(proved=True)
            scale = factor
        return Examined(proved=False, score=least, split=lambda: self._split(box, scale))

    def _split(self, box: Box, factor: Array) -> int | None:
        return widest_effect(
            box, self.matrix.active, lambda i: self.matrix.spread(box, i, factor.T, factor)
        )


def positive_definite(
    function: ca.Function,
    constants: Sequence[Constant | PiConstant],
    box: Box,
    *,
    names: Sequence[str] = (),
    budget: int = BOXES,
) -> Definiteness:
    """Whether ``function(z, k)``, a square matrix, is positive definite for all z of a box.

    Args:
        function: CasADi function of the variables z and the exact constants k (columns).
        constants: the values of k.
        box: one side per variable.
        names: what the variables are called in the result.
        budget: the most boxes to examine.

    Raises:
        ValueError: the function has no exact value.
    """
    z, k = (ca.SX.sym(name, function.size1_in(i)) for i, name in enumerate("zk"))
    matrix = ca.densify(function(z, k))
    identical = symmetric_entries(ca.Function("matrix", [z, k], [matrix]), int(matrix.size1()))
    symmetric = ca.tril2symm(ca.tril(matrix)) if identical else matrix + matrix.T
    enclosed = EnclosedMatrix(symmetric, z, k, tuple(constants))
    with working_precision(PRECISION):
        witness = ExactWitnesses(enclosed, box).witness()
        found: Searched[Witness] = (
            search(box, DominanceTest(enclosed).examine, Refuter(enclosed).refute, budget)
            if witness is None
            else Searched("fails", 1, witness.box, witness)
        )
    called = tuple(names) or tuple(f"z{i}" for i in range(len(box)))
    return definiteness(found, "identity" if identical else "not shown", called)


def definiteness(
    found: Searched[Witness], symmetry: Symmetry, names: tuple[str, ...]
) -> Definiteness:
    """The result of a search as an answer about the matrix."""
    argument = "diagonally dominant after preconditioning" if found.status == "proved" else ""
    witness = found.counterexample
    box = found.box if witness is None else witness.box
    return Definiteness(
        found.status,
        found.boxes,
        symmetry,
        argument,
        box,
        witness,
        found.reason,
        names,
        found.proved,
        found.left,
    )
