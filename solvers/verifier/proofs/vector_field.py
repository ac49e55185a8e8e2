"""The vector field of a robot in balls and series."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, SupportsFloat

from flint import arb, arb_mat, arb_series, ctx

from compiler.dynamics.equations_of_motion import RobotGraph
from compiler.expressions.evaluators.balls import BALLS, SERIES, SMOOTH_BALLS, column
from compiler.expressions.tape import Tape, tape
from solvers.verifier.proofs.linearisation import Coefficients, InertiaMatrix, Linearisation

if TYPE_CHECKING:
    from solvers.verifier.proofs.machine_field import MachineField

# --------------------------------------------------------------------------------------------------
# A robot's equations of motion as a vector field on states, evaluated in balls and in series of
# balls.
#
# .. math:: \dot q = v, \qquad M(q)\,\dot v = F(q, v, s, u), \qquad \dot s = \sigma(q, v, s, u)
#
# Linear systems are solved coefficient by coefficient with the constant term of M, preconditioned:
# this is far tighter than elimination in series.


MACHINE_BITS = 96
"""Up to this working precision the digits of doubles are enough, if they may be used."""


@dataclass(frozen=True, slots=True)
class Curvature:
    """Second derivatives: ``places`` (i, j, k) of the outputs of a tape, j >= k; others are zero.

    Each is the derivative of output i of (b - M a, d) in the entries j and k of (q, v, s, a), at
    (q, v, s, a, u). ``slopes`` are their own first derivatives, as far as they are not zero: (v, l)
    in ``slope_places`` is that of value v in entry l. ``slopes`` is None for large robots.
    """

    tape: Tape
    places: tuple[tuple[int, int, int], ...]
    slopes: Tape | None = None
    slope_places: tuple[tuple[int, int], ...] = ()

    @staticmethod
    def of(graph: RobotGraph) -> Curvature | None:
        """The curvature of a robot; None if its second derivatives are not computed."""
        second, third = graph.curvature, graph.curvature_slopes
        if second is None:
            return None
        if third is None:
            return Curvature(tape(second[0]), second[1])
        return Curvature(tape(second[0]), second[1], tape(third[0]), third[1])


@dataclass(frozen=True)
class VectorField:
    """q' = v, M(q) v' = b, s' = d with b, d of (q, v, s, u), as series with ball coefficients.

    ``balance`` gives M, b and d; ``variation`` the Jacobian of (b - M a, d) in (q, v, s) for given
    accelerations a; ``input_slopes`` that of (b, d) in u, which only disturbed inputs need.
    ``tail`` holds the balls of theta and k; s has ``own`` entries. With ``in_machine``, balls of
    doubles are used up to a working precision of ``MACHINE_BITS``, in machine code if available.
    The last inputs are the efforts of dry ``friction``: the joint and the size (N m, N) of each.
    """

    balance: Tape
    variation: Tape
    dofs: int
    tail: tuple[arb, ...]
    own: int = 0
    input_slopes: Tape | None = None
    curvature: Curvature | None = None
    in_machine: bool = False
    friction: tuple[tuple[int, arb], ...] = ()

    @cached_property
    def has_kinks(self) -> bool:
        """Whether an absolute value occurs."""
        return self.balance.uses("fabs")

    @cached_property
    def _mass_matrix(self) -> Tape:
        return self.balance.first(self.dofs**2)

    @property
    def size(self) -> int:
        """The number of entries of a state."""
        return 2 * self.dofs + self.own

    @property
    def machine(self) -> MachineField | None:
        """The field in balls of doubles, if they are precise enough."""
        return self._machine if self.in_machine and ctx.prec <= MACHINE_BITS else None

    @cached_property
    def _machine(self) -> MachineField | None:
        try:
            from solvers.verifier.proofs.machine_field import MachineField
        except ImportError:
            # It was installed without a compiler: slower, but equally sound.
            return None
        return MachineField(self.balance, self.variation, self.dofs, self.own, self.tail)

    def smooth_values(self, program: Tape, moving: Sequence[arb], u: Sequence[arb]) -> list[arb]:
        """The outputs of a program of (``moving``, u, theta, k) on a box.

        Raises:
            UncertainSignError: an absolute value has its kink there.
        """
        if self.machine is not None:
            return self.machine.smooth_values(program, moving, u)
        return program.evaluate([*moving, *u, *self.tail], SMOOTH_BALLS)

    def acceleration(self, state: Sequence[arb], u: Sequence[arb]) -> list[arb]:
        """Accelerations for a state given as balls.

        Raises:
            ZeroDivisionError: M may be singular there.
        """
        mass, forces = self.balance_at(state, u)
        return InertiaMatrix(mass).solve(column(forces)).entries()

    def balance_at(self, state: Sequence[arb], u: Sequence[arb]) -> tuple[arb_mat, list[arb]]:
        """M, shape (n, n), and the forces b, (n,), for a state given as balls."""
        if self.machine is not None:
            flat = self.machine.balance_at(state, u)
        else:
            flat = self.balance.evaluate([*state, *u, *self.tail], BALLS)
        n = self.dofs
        return self._square(flat[: n * n]), flat[n * n : n * n + n]

    def taylor(
        self,
        state: Sequence[arb],
        u: Sequence[arb],
        order: int,
        enough: Callable[[Sequence[Sequence[SupportsFloat]]], bool] = lambda _: False,
    ) -> list[Coefficients]:
        """Taylor coefficients 0 ... order of the solution through a state, or near them.

        Each pass of Picard's iteration on series fixes one more coefficient, until ``enough``
        accepts them. It receives balls, or doubles in machine code; only the balls contain the
        solution's coefficients.

        Raises:
            ZeroDivisionError: M may be singular on the state.
            UncertainSignError: an absolute value has its kink there.
        """
        if self.machine is not None:
            rows = self.machine.taylor(state, u, order, enough)
            pairs = zip(state, rows, strict=True)
            return [[first, *map(arb, row[1:])] for first, row in pairs]
        n = self.dofs
        x = [[item] for item in state]
        masses: list[arb_mat] = []
        pulls: list[arb_mat] = []
        mass: InertiaMatrix | None = None
        for length in range(1, order + 1):
            ctx.cap = length
            constants = [arb_series([item]) for item in (*u, *self.tail)]
            flat = self.balance.evaluate([*map(arb_series, x), *constants], SERIES)
            last = length - 1
            masses.append(self._square([item[last] for item in flat[: n * n]]))
            if mass is None:
                mass = InertiaMatrix(masses[0])
            right = arb_mat([[item[last]] for item in flat[n * n : n * n + n]])
            for m in range(1, length):
                right = right - masses[m] * pulls[last - m]
            pulls.append(mass.solve(right))
            for i in range(n):
                x[i].append(x[n + i][last] / length)
                x[n + i].append(pulls[last][i, 0] / length)
            for i in range(self.own):
                x[2 * n + i].append(flat[n * n + n + i][last] / length)
            if enough(x):
                break
        return x

    def defect(
        self, x: Sequence[Coefficients], u: Sequence[arb], length: int
    ) -> list[Coefficients]:
        """The series of (b - M v', d - s') along a path x with q' = v, of ``length`` coefficients.

        Each series of x has one more coefficient, for its derivative.

        Raises:
            UncertainSignError: an absolute value is not smooth enough for this ``length``.
        """
        if self.machine is not None:
            return self.machine.defect(x, u, length)
        n = self.dofs
        ctx.cap = length + 1
        paths = [arb_series(row[: length + 1]) for row in x]
        ctx.cap = length
        constants = [arb_series([item]) for item in (*u, *self.tail)]
        flat = self.balance.evaluate([*paths, *constants], SERIES)
        rates = [item.derivative() for item in paths[n:]]
        found = []
        for i in range(n):
            inertial = sum((flat[j * n + i] * rates[j] for j in range(n)), arb_series([]))
            found.append(flat[n * n + i] - inertial)
        found += [flat[n * n + n + i] - rates[n + i] for i in range(self.own)]
        return [[item[k] for k in range(length)] for item in found]

    def linearise(
        self, x: Sequence[Coefficients], a: Sequence[Coefficients], u: Sequence[arb], length: int
    ) -> Linearisation:
        """The linearisation along a path with accelerations a, to ``length`` coefficients.

        Raises:
            UncertainSignError: an absolute value is not smooth enough for this ``length``.
        """
        if self.machine is not None:
            return self.machine.linearise(x, a, u, length)
        n, size, height = self.dofs, self.size, self.dofs + self.own
        ctx.cap = length
        constants = [arb_series([item]) for item in (*u, *self.tail)]
        paths, pulls = ([arb_series(row[:length]) for row in rows] for rows in (x, a))
        masses = self._mass_matrix.evaluate([*paths, *constants], SERIES)
        flat = self.variation.evaluate([*paths, *pulls, *constants], SERIES)
        return Linearisation(
            [self._inertia([item[m] for item in masses[: n * n]], m) for m in range(length)],
            [
                arb_mat([[flat[j * height + i][m] for j in range(size)] for i in range(height)])
                for m in range(length)
            ],
        )

    def input_slopes_over(self, state: Sequence[arb], u: Sequence[arb]) -> arb_mat:
        """The Jacobian of (b, d) in u on a box, shape (n + r, m).

        Raises:
            ValueError: the field has no slopes in its inputs.
        """
        if self.input_slopes is None:
            raise ValueError("disturbed inputs need the slopes of the field in its inputs")
        flat = self.input_slopes.evaluate([*state, *u, *self.tail], BALLS)
        height = self.dofs + self.own
        return arb_mat([[flat[j * height + i] for j in range(len(u))] for i in range(height)])

    def _square(self, flat: Sequence[arb]) -> arb_mat:
        """A symmetric matrix from its entries, column by column."""
        n = self.dofs
        return arb_mat([[flat[j * n + i] for j in range(n)] for i in range(n)])

    def _inertia(self, flat: Sequence[arb], power: int) -> arb_mat:
        """The coefficient of diag(M, 1) at a power of time."""
        n, height = self.dofs, self.dofs + self.own
        one = arb(0) if power else arb(1)
        return arb_mat(
            [
                [
                    flat[j * n + i] if i < n and j < n else one if i == j else arb(0)
                    for j in range(height)
                ]
                for i in range(height)
            ]
        )
