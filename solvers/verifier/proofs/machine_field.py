"""The vector field of a robot in balls of doubles, in machine code.

It runs the same programs as the field in balls of any precision (``vector_field.py``), so both
describe the same robot.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import cached_property
from typing import SupportsFloat

import numpy as np
from flint import arb, arb_mat

from compiler.arrays import Array
from compiler.expressions.machine.ball_array import BallArray
from compiler.expressions.machine.program import MachineProgram
from compiler.expressions.tape import Node, Tape
from solvers.verifier.proofs.linearisation import Coefficients, Linearisation


class MachineField:
    """The field of a robot; arguments, results and attributes are as in ``VectorField``."""

    def __init__(
        self, balance: Tape, variation: Tape, dofs: int, own: int, tail: Sequence[arb]
    ) -> None:
        self._tapes = balance, variation
        self.dofs, self.own, self.size = dofs, own, 2 * dofs + own
        self._tail = BallArray.of(tail)
        self._balance = MachineProgram(balance, self.size)
        # Keyed by the address of a tape; keeping the tape alive keeps the address unique.
        self._programs: dict[int, tuple[Tape, MachineProgram]] = {}

    @cached_property
    def _defect(self) -> MachineProgram:
        """(b - M a, d) of (q, v, s, a, u)."""
        tape = residual(self._tapes[0], self.dofs, self.size)
        return MachineProgram(tape, self.size + self.dofs)

    @cached_property
    def _variation(self) -> MachineProgram:
        return MachineProgram(self._tapes[1], self.size + self.dofs)

    @cached_property
    def _mass(self) -> MachineProgram:
        return MachineProgram(self._tapes[0].first(self.dofs**2), self.size)

    def _inputs(self, moving: Sequence[Coefficients], u: Sequence[arb], length: int) -> BallArray:
        """All inputs as series: those that depend on time, then u, theta and k."""
        series = BallArray.series([*moving, *([item] for item in u)], length)
        still = BallArray.zeros(len(self._tail.middle), length)
        still.middle[:, 0], still.radius[:, 0] = self._tail.middle, self._tail.radius
        return BallArray(
            np.concatenate([series.middle, still.middle]),
            np.concatenate([series.radius, still.radius]),
        )

    def balance_at(self, state: Sequence[arb], u: Sequence[arb]) -> list[arb]:
        """M, b and d on a box."""
        return self._balance.evaluate(self._inputs([[x] for x in state], u, 1)).balls()

    def smooth_values(self, program: Tape, moving: Sequence[arb], u: Sequence[arb]) -> list[arb]:
        """The outputs of another program on a box on which every absolute value is smooth."""
        known = self._program(program, 0)
        return known.evaluate(self._inputs([[x] for x in moving], u, 1), smooth=True).balls()

    def series_of(
        self, program: Tape, q: Sequence[Coefficients], length: int, first: int = 0
    ) -> list[list[arb]]:
        """The coefficients of the outputs of a program of (q, theta, k), a row for each.

        A row has the coefficients from ``first`` up to, but not including, ``length``.
        """
        found = self._program(program, self.dofs).evaluate(self._inputs(q, [], length))
        flat, kept = found.at(slice(None), slice(first, None)).balls(), length - first
        return [flat[i : i + kept] for i in range(0, len(flat), kept)]

    def _program(self, program: Tape, moving: int) -> MachineProgram:
        if id(program) not in self._programs:
            self._programs[id(program)] = program, MachineProgram(program, moving)
        return self._programs[id(program)][1]

    def taylor(
        self,
        state: Sequence[arb],
        u: Sequence[arb],
        order: int,
        enough: Callable[[Sequence[Sequence[SupportsFloat]]], bool],
    ) -> list[list[float]]:
        """Approximate Taylor coefficients of the solution, in doubles: they prove nothing.

        Raises:
            ZeroDivisionError: M is singular there.
            UncertainSignError: an absolute value has its kink there.
        """
        n, size = self.dofs, self.size
        inputs = self._inputs([[item] for item in state], u, order)
        run = self._balance.started(inputs)
        x = np.zeros((size, order + 1))
        x[:, 0] = inputs.middle[:size, 0]
        masses, pulls = list[Array](), list[Array]()
        rows: list[list[float]] = [[value] for value in x[:, 0].tolist()]
        for k in range(order):
            if k:
                run.enter(k, x[:, k])
            flat = run.advanced(k, k + 1).middle[:, 0]
            masses.append(flat[: n * n].reshape(n, n))
            right = flat[n * n : n * n + n]
            for m in range(1, k + 1):
                right = right - masses[m] @ pulls[k - m]
            try:
                pulls.append(np.asarray(np.linalg.solve(masses[0], right), dtype=np.float64))
            except np.linalg.LinAlgError:
                raise ZeroDivisionError("the mass matrix is singular") from None
            x[:n, k + 1] = x[n : 2 * n, k] / (k + 1)
            x[n : 2 * n, k + 1] = pulls[k] / (k + 1)
            x[2 * n :, k + 1] = flat[n * n + n :] / (k + 1)
            rows = x[:, : k + 2].tolist()
            if enough(rows):
                break
        return rows

    def defect(
        self, x: Sequence[Coefficients], u: Sequence[arb], length: int
    ) -> list[Coefficients]:
        """The series of (b - M v', d - s') along a path with q' = v."""
        n = self.dofs
        rates = [[j * c for j, c in enumerate(row[1 : length + 1], 1)] for row in x[n:]]
        inputs = self._inputs([*(row[:length] for row in x), *rates[:n]], u, length)
        found = self._defect.evaluate(inputs)
        rows = [found.at(i).balls() for i in range(len(found.middle))]
        for row, rate in zip(rows[n:], rates[n:], strict=True):
            for k, item in enumerate(rate):
                row[k] = row[k] - item
        return rows

    def linearise(
        self, x: Sequence[Coefficients], a: Sequence[Coefficients], u: Sequence[arb], length: int
    ) -> Linearisation:
        """The linearisation along a path with accelerations a, to ``length`` coefficients."""
        n, size, height = self.dofs, self.size, self.dofs + self.own
        masses = self._mass.evaluate(self._inputs(x, u, length))
        slopes = self._variation.evaluate(self._inputs([*x, *a], u, length))
        square, wide = (n, n, length), (size, height, length)
        inertia = BallArray.zeros(height, height, length)
        inertia.middle[range(n, height), range(n, height), 0] = 1
        inertia.middle[:n, :n] = masses.middle.reshape(square)
        inertia.radius[:n, :n] = masses.radius.reshape(square)
        rates = BallArray(
            slopes.middle.reshape(wide).transpose(1, 0, 2),
            slopes.radius.reshape(wide).transpose(1, 0, 2),
        )
        return Linearisation(
            *(
                [_matrix(each.at(slice(None), slice(None), m)) for m in range(length)]
                for each in (inertia, rates)
            )
        )


def _matrix(balls: BallArray) -> arb_mat:
    height, width = balls.middle.shape
    return arb_mat(height, width, balls.balls())


def residual(balance: Tape, dofs: int, size: int) -> Tape:
    """The program of (b - M a, d) with inputs (q, v, s, a, u, theta, k), from that of (M, b, d)."""
    nodes: list[Node] = [
        (name, (number[0] + dofs * (number[0] >= size),)) if name == "input" else (name, number)
        for name, number in balance.nodes
    ]
    first, results = len(nodes), list(balance.results)
    nodes += [("input", (size + j,)) for j in range(dofs)]
    found = []
    for i in range(dofs):
        total = results[dofs * dofs + i]
        for j in range(dofs):
            nodes.append(("mul", (results[j * dofs + i], first + j)))
            nodes.append(("sub", (total, len(nodes) - 1)))
            total = len(nodes) - 1
        found.append(total)
    return Tape(tuple(nodes), (*found, *results[dofs * dofs + dofs :]))
