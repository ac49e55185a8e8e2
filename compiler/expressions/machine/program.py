"""The program of an expression graph, run on balls of doubles in machine code."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from compiler.arrays import Array
from compiler.expressions.evaluators.balls import UncertainSignError
from compiler.expressions.machine import ball_kernel
from compiler.expressions.machine.ball_array import BallArray
from compiler.expressions.tape import SINE_AND_COSINE, TWO_VALUES, Tape
from compiler.time_limits.time_limit import check_time

NEG, TWICE, ADD, SUB, MUL, DIV, SQRT, SIN_COS, FABS, SIGN = range(10)
EXACT, UNCERTAIN, UNDEFINED = range(3)
"""The codes that ``ball_kernel.c`` uses for operations, and for the outcome of a run."""

OPERATIONS = {
    "neg": NEG, "twice": TWICE, "add": ADD, "sub": SUB, "mul": MUL, "sq": MUL, "div": DIV,
    "sqrt": SQRT, "fabs": FABS, "sign": SIGN,
}  # fmt: skip


class MachineProgram:
    """A program on series. Only the first inputs depend on time; all others are constant.

    Args:
        tape: the program.
        moving: the number of inputs that depend on time.
    """

    def __init__(self, tape: Tape, moving: int) -> None:
        plan = tape.plan
        self._used = np.array(plan.used, dtype=np.int64)
        self._constants = np.array([*plan.constants, 1], dtype=np.float64)
        encoder = _Encoder([i >= moving for i in plan.used] + [True] * len(self._constants))
        places = list(range(len(encoder.fixed) - 1))
        for name, a, b in plan.steps:
            first = places[a]
            places += encoder.encoded(plan.names[name], first, places[b] if b >= 0 else first, b)
        self._code = np.array(encoder.code, dtype=np.int32).reshape(len(encoder.code), 4)
        self._fixed = np.array(encoder.fixed, dtype=np.bool_)
        self._outputs = np.array([places[number] for number in plan.outputs], dtype=np.int64)

    def evaluate(self, inputs: BallArray, *, smooth: bool = False) -> BallArray:
        """The series of the outputs, (outputs, length), for series of all inputs, (inputs, length).

        They are NaN if something has no value.

        Raises:
            UncertainSignError: an absolute value has its kink within a ball, and ``smooth`` is set
                or more than its first derivative is needed.
        """
        run = self.started(inputs)
        return run.advanced(0, inputs.middle.shape[1], smooth=smooth)

    def started(self, inputs: BallArray) -> MachineRun:
        """A run for inputs (inputs, length) in which nothing is computed yet."""
        check_time()
        values = BallArray.zeros(len(self._fixed), inputs.middle.shape[1])
        used, known = len(self._used), len(self._used) + len(self._constants)
        values.middle[:used] = inputs.middle[self._used]
        values.radius[:used] = inputs.radius[self._used]
        values.middle[used:known, 0] = self._constants
        return MachineRun(self._used, self._code, self._fixed, self._outputs, values)


@dataclass(frozen=True, slots=True, eq=False)
class MachineRun:
    """The values of a program, coefficient by coefficient."""

    used: NDArray[np.int64]
    code: NDArray[np.int32]
    fixed: NDArray[np.bool_]
    outputs: NDArray[np.int64]
    values: BallArray

    def enter(self, k: int, middles: Array) -> None:
        """Set the k-th coefficients of the first inputs, (inputs,), which are exact."""
        moving = self.used < len(middles)
        self.values.middle[: len(self.used), k][moving] = middles[self.used[moving]]

    def advanced(self, first: int, last: int, *, smooth: bool = False) -> BallArray:
        """The coefficients ``first`` to ``last`` - 1 of the outputs, once earlier ones are known.

        Raises:
            UncertainSignError: as in :meth:`MachineProgram.evaluate`.
        """
        middle, radius = self.values.middle, self.values.radius
        found = ball_kernel.coefficients(
            self.code, middle, radius, self.fixed, first, last, int(smooth)
        )
        if found == UNCERTAIN:
            raise UncertainSignError("the sign under an absolute value is not certain")
        wanted = self.outputs, slice(first, last)
        part = BallArray(middle[wanted], radius[wanted])
        if found == UNDEFINED:
            part.middle[:], part.radius[:] = np.nan, np.inf
        return part


@dataclass(slots=True)
class _Encoder:
    """Operations with the indices of arguments and results; ``fixed`` marks the constant ones."""

    fixed: list[bool]
    code: list[tuple[int, int, int, int]] = field(default_factory=list)
    one: int = field(init=False)

    def __post_init__(self) -> None:
        self.one = len(self.fixed) - 1

    def encoded(self, name: str, a: int, b: int, kind: int) -> list[int]:
        """The indices of the results of a step."""
        if name == "inv":
            return [self._append(DIV, self.one, a)]
        if name not in ("sin", "cos", "tan", SINE_AND_COSINE):
            return [self._append(OPERATIONS[name], a, b)]
        sine = self._append(SIN_COS, a, a)
        if name == "tan":
            return [self._append(DIV, sine, sine + 1)]
        return [sine, sine + 1] if kind == TWO_VALUES else [sine + (name == "cos")]

    def _append(self, operation: int, a: int, b: int) -> int:
        place, fixed = len(self.fixed), self.fixed[a] and self.fixed[b]
        self.code.append((operation, a, b, place))
        self.fixed += [fixed, fixed] if operation == SIN_COS else [fixed]
        return place
