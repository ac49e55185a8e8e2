r"""Enclosures of a matrix function over boxes, preconditioned, and a test of its regularity.

.. math:: L A(x) R \in \sum_{|a| < p} L\, \frac{\partial^a A(c)}{a!}\, R\, (x - c)^a
    + \sum_{|a| = p} L\, \frac{\partial^a A(X)}{a!}\, R\, (x - c)^a

is intersected with L A(X) R: the first is sharper on small boxes, the second on large ones.

Sources: Moore, Kearfott & Cloud, *Introduction to Interval Analysis* (2009), chapter 6
(Taylor forms); Rump, *Verification methods* (Acta Numerica 2010), section 10 (preconditioning by an
approximate inverse); Varga, *Matrix Iterative Analysis*, section 3.5 (M-matrices).
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field

import casadi as ca
import numpy as np
from flint import arb, arb_mat

from compiler.arrays import Array
from compiler.definiteness.boxes import Box
from compiler.expressions.evaluators.exact import PiLinear, exact_constant
from compiler.expressions.evaluators.intervals import INTERVALS, Ends, around
from compiler.expressions.scalars import Constant, PiConstant
from compiler.expressions.tape import Tape, tape

TERMS, LARGEST_ORDER = 24, 3
"""Of an expansion: the most derivatives of the highest order, and that order."""
UNBOUNDED = 1e30
"""Stands for an infinite radius where enclosures are compared."""


@dataclass(frozen=True, slots=True)
class Conditioned:
    """``L A R`` over a box: lower bounds of its diagonal, bounds of the sizes of all entries."""

    diagonal: list[arb]
    sizes: list[list[arb]]


@dataclass(frozen=True, slots=True)
class Expansion:
    """The derivatives of all entries by multi-index: order by order, the highest in ``outer``."""

    powers: tuple[tuple[int, ...], ...]
    inner: Tape
    outer: Tape


@dataclass(slots=True)
class EnclosedMatrix:
    """A matrix of expressions in the variables ``z`` and the exact constants ``k``.

    ``active`` are the variables that it depends on (by the sparsity of the graph).
    """

    matrix: ca.SX
    variables: ca.SX
    symbols: ca.SX
    constants: tuple[Constant | PiConstant, ...]
    active: tuple[int, ...] = field(init=False)
    numeric: ca.Function = field(init=False)
    values: Tape = field(init=False)
    _expansions: list[Expansion | None] = field(default_factory=list["Expansion | None"])
    exact_constants: tuple[PiLinear, ...] = field(init=False)
    _constants: list[Ends] = field(init=False)
    _floats: list[float] = field(init=False)

    def __post_init__(self) -> None:
        entries = ca.vec(ca.densify(self.matrix))
        inputs = [self.variables, self.symbols]
        self.active = _dependencies(entries, self.variables)
        self.numeric = ca.Function("matrix", inputs, [ca.densify(self.matrix)])
        self.values = tape(ca.Function("values", inputs, [ca.cse(entries)]))
        self.exact_constants = tuple(exact_constant(constant) for constant in self.constants)
        self._constants = [around(number.ball()) for number in self.exact_constants]
        self._floats = [float(number.ball()) for number in self.exact_constants]

    @property
    def shape(self) -> tuple[int, int]:
        """Rows and columns."""
        return int(self.matrix.size1()), int(self.matrix.size2())

    def at(self, point: Sequence[float]) -> Array:
        """The matrix in floating point, for choices that prove nothing."""
        return np.asarray(self.numeric(ca.DM(list(point)), ca.DM(self._floats)).full())

    def enclosed(self, sides: Sequence[Ends]) -> list[Ends]:
        """The entries over a box, column by column."""
        return self.values.evaluate([*sides, *self._constants], INTERVALS)

    def regular(
        self, box: Box, left: Array, right: Array, natural: list[Ends], rows: Sequence[int]
    ) -> bool:
        """Whether ``left A right`` is shown to be regular on a box (``dominant``).

        Only the given rows of A count; ``natural`` are all entries over the box, finite there.
        """
        height, columns = self.shape
        before, after = _exact(left), _exact(right)

        def product(entry: Callable[[int, int], arb]) -> arb_mat:
            table = [[entry(i, j) for j in range(columns)] for i in rows]
            return before * arb_mat(table) * after

        first = product(lambda i, j: natural[j * height + i].ball())
        if dominant(_bounded([first])):
            return True
        if not all(box[i].ends.finite for i in self.active):
            return False
        expansion = self._expansion()
        if expansion is None:
            return False
        return dominant(_bounded([first, self._expanded(expansion, box, product)]))

    def _expansion(self) -> Expansion | None:
        """The Taylor expansion, made when it is needed first."""
        if not self._expansions:
            entries = ca.vec(ca.densify(self.matrix))
            found = _expansion(entries, self.variables, self.symbols, self.active)
            self._expansions.append(found)
        return self._expansions[0]

    def _expanded(
        self,
        expansion: Expansion,
        box: Box,
        product: Callable[[Callable[[int, int], arb]], arb_mat],
    ) -> arb_mat:
        height, columns = self.shape
        sides = [side.ends for side in box]
        point, radii = list(sides), dict[int, arb]()
        for i in self.active:
            centre = sides[i].ball().mid()
            point[i] = Ends(centre, centre)
            radii[i] = (sides[i].ball() - centre).abs_upper()
        run = INTERVALS
        found = expansion.inner.evaluate([*point, *self._constants], run)
        found += expansion.outer.evaluate([*sides, *self._constants], run)
        total, size = arb_mat(0, 0), height * columns
        for number, powers in enumerate(expansion.powers):
            start = number * size

            def entry(i: int, j: int, start: int = start) -> arb:
                value = found[start + j * height + i]
                return value.ball() if value.finite else arb("nan")

            term = product(entry) * _monomial(powers, radii)
            total = term if number == 0 else total + term
        return total

    def spread(self, box: Box, variable: int, left: Array, right: Array) -> float:
        """How far ``left A right`` moves with one variable, in floating point."""
        point = [float(side.middle) for side in box]
        centre, farthest = self.at(point), 0.0
        for sample in box[variable].samples():
            moved = [*point[:variable], float(sample), *point[variable + 1 :]]
            change = left @ (self.at(moved) - centre) @ right
            if not np.all(np.isfinite(change)):
                return float("inf")
            farthest = max(farthest, float(np.abs(change).sum()))
        return farthest

    def blur(self, box: Box, variable: int, left: Array, rows: Sequence[int]) -> float:
        """How wide the enclosure of ``left A`` is if one variable is known, in floating point."""
        height, columns = self.shape
        sides = [side.ends for side in box]
        if sides[variable].finite:
            centre = sides[variable].ball().mid()
            sides[variable] = Ends(centre, centre)
        natural = self.enclosed(sides)
        radii = np.array(
            [[_radius(natural[j * height + i]) for j in range(columns)] for i in rows]
        ).reshape(len(rows), columns)
        return float((np.abs(left) @ radii).sum())


def _dependencies(entries: ca.SX, variables: ca.SX) -> tuple[int, ...]:
    """The variables that entries depend on, by the sparsity of the graph."""
    if not entries.numel() or not variables.numel():
        return ()
    pattern = ca.jacobian_sparsity(entries, variables)
    return tuple(sorted({int(column) for column in pattern.get_triplet()[1]}))


def _expansion(
    entries: ca.SX, variables: ca.SX, symbols: ca.SX, active: tuple[int, ...]
) -> Expansion | None:
    """The Taylor expansion of a column, of the highest order within ``TERMS`` that can be read."""
    known: list[ca.SX] = [entries]
    powers: list[tuple[int, ...]] = [()]
    layer: dict[tuple[int, ...], ca.SX] = {(): entries}
    best: Expansion | None = None
    inputs = [variables, symbols]
    for order in range(1, LARGEST_ORDER + 1):
        if not active or math.comb(len(active) + order - 1, order) > TERMS:
            break
        layer = {
            (*index, i): ca.densify(ca.jacobian(value, variables[i]))
            for index, value in layer.items()
            for i in active
            if not index or i >= index[-1]
        }
        try:
            inner = tape(ca.Function("inner", inputs, [ca.cse(ca.vertcat(*known))]))
            outer = tape(ca.Function("outer", inputs, [ca.cse(ca.vertcat(*layer.values()))]))
        except ValueError:  # derivatives with constants that are not integers
            break
        if inner.uses("sign"):
            break  # beyond a kink only the first order holds, with both slopes
        best = Expansion((*powers, *layer), inner, outer)
        known += layer.values()
        powers += layer
    return best


def _monomial(index: tuple[int, ...], radii: Mapping[int, arb]) -> arb:
    """``(x - c)^a / a!`` for all x within the radii; ``index`` repeats each variable a_i times."""
    size, even = arb(1), True
    for variable, power in Counter(index).items():
        size = size * radii[variable] ** power / math.factorial(power)
        even = even and power % 2 == 0
    if not index:
        return size
    return arb(0).union(size) if even else size.union(-size)


def _bounded(enclosures: Sequence[arb_mat]) -> Conditioned:
    """The common bounds of several enclosures of one square matrix."""
    n = int(enclosures[0].nrows())
    diagonal = [_largest([m[i, i].lower() for m in enclosures]) for i in range(n)]
    sizes = [
        [_least([m[i, j].abs_upper() for m in enclosures]) for j in range(n)] for i in range(n)
    ]
    return Conditioned(diagonal, sizes)


def dominant(conditioned: Conditioned) -> bool:
    """Whether every matrix within the bounds is regular; where symmetric, positive definite.

    Proved by a positive vector d with ``c_ii d_i > sum_j |c_ij| d_j`` for all rows i: the matrix
    with its columns scaled by d is strictly diagonally dominant with a positive diagonal.
    """
    n = len(conditioned.diagonal)
    if any(not entry > 0 for entry in conditioned.diagonal):
        return False
    sizes = conditioned.sizes
    comparison = np.array([[-float(size) for size in row] for row in sizes])
    comparison[range(n), range(n)] = [float(entry) for entry in conditioned.diagonal]
    if not np.all(np.isfinite(comparison)):
        return False
    try:
        weights = np.linalg.solve(comparison, np.ones(n))
    except np.linalg.LinAlgError:
        return False
    if not np.all(np.isfinite(weights)) or not np.all(weights > 0):
        return False
    exact = [arb(float(weight)) for weight in weights]
    for i in range(n):
        off = sum((sizes[i][j] * exact[j] for j in range(n) if j != i), arb(0))
        if not conditioned.diagonal[i] * exact[i] > off:
            return False
    return True


def _radius(entry: Ends) -> float:
    return float(entry.ball().rad()) if entry.finite else UNBOUNDED


def _exact(matrix: Array) -> arb_mat:
    """Floats as exact balls."""
    return arb_mat([[arb(float(item)) for item in row] for row in matrix])


def _largest(bounds: Sequence[arb]) -> arb:
    known = [bound for bound in bounds if not bound.is_nan()]
    return max(known, default=arb("-inf"))


def _least(bounds: Sequence[arb]) -> arb:
    known = [bound for bound in bounds if not bound.is_nan()]
    return min(known, default=arb("inf"))
