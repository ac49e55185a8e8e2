"""A function of one sample, evaluated at many samples at once.

CasADi interprets scalar expressions at some nanoseconds per instruction and sample. Here each
instruction is carried out for all samples at once, on vectors with an entry per sample, so the cost
of interpretation is paid once and the vector units of the processor are used. Expressions of shared
inputs alone are computed once.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import casadi as ca
import numpy as np

from compiler.arrays import Array
from compiler.expressions.tape import CONSTANT, INPUT, OUTPUT
from compiler.time_limits.time_limit import check_time

MOST_IN_BATCH = 128
"""More samples are split into blocks, so that the work vectors stay in the processor's cache."""


class BatchedFunction:
    """Evaluates a program that is built for a number of samples when that is first needed.

    Args:
        program: maps a number of samples to a function as made by ``batched``.
        shape: the shape of the output at one sample.
    """

    def __init__(self, program: Callable[[int], ca.Function], shape: tuple[int, int]) -> None:
        self._program = program
        self.shape = shape
        self._programs: dict[int, tuple[Any, Callable[[], None]]] = {}

    @classmethod
    def of(cls, function: ca.Function) -> BatchedFunction:
        """Wrap a function of one sample with a dense output."""
        shape = function.size1_out(0), function.size2_out(0)
        return cls(lambda batch: batched(function, batch), shape)

    def __call__(self, columns: tuple[Array, ...], shared: Array) -> Array:
        """The output at K samples, shape (K, rows, columns); inputs (K, size) each, then shared."""
        count = len(columns[0])
        blocks = max(1, -(-count // MOST_IN_BATCH))
        batch = -(-count // blocks)
        result = np.empty((count, *self.shape))
        for block in range(blocks):
            # The last block may overlap with the previous one, so that one program serves all
            # blocks.
            start = min(block * batch, count - batch)
            part = slice(start, start + batch)
            self._evaluate([c[part] for c in columns], shared, result[part])
        return result

    def _evaluate(self, columns: list[Array], shared: Array, result: Array) -> None:
        batch = len(result)
        if not result.size:
            return
        check_time()
        if batch not in self._programs:
            self._programs[batch] = self._program(batch).buffer()
        buffer, run = self._programs[batch]
        rows, width = self.shape
        output = np.empty((width, rows, batch))
        # Kept in a list, because the buffer refers to their memory.
        arguments = [*(np.ascontiguousarray(c.T, np.float64) for c in columns), shared]
        for place, argument in enumerate(arguments):
            if argument.size:
                buffer.set_arg(place, argument.data)
        buffer.set_res(0, output.data)
        run()
        if buffer.ret():
            raise ArithmeticError("the program was not evaluated")
        result[:] = output.transpose(2, 1, 0)


def batched(function: ca.Function, batch: int) -> ca.Function:
    """A function of one sample as a function of many, with a row for each.

    Its inputs are columns, the last of them shared by all samples; its output is read column by
    column. The instructions are carried out on vectors; shared inputs stay scalars.
    """
    last = function.n_in() - 1
    inputs = [ca.MX.sym(f"i{i}", batch, function.size1_in(i)) for i in range(last)]
    shared = ca.MX.sym("shared", function.size1_in(last))
    split = [*(ca.horzsplit(item) for item in inputs), ca.vertsplit(shared)]
    register: dict[int, ca.MX] = {}
    output = [ca.MX(0)] * function.nnz_out(0)
    for i in range(function.n_instructions()):
        check_time()
        code = function.instruction_id(i)
        arguments, results = function.instruction_input(i), function.instruction_output(i)
        if code == INPUT:
            register[results[0]] = split[arguments[0]][arguments[1]]
        elif code == OUTPUT:
            output[results[1]] = register[arguments[0]]
        elif code == CONSTANT:
            register[results[0]] = ca.MX(function.instruction_constant(i))
        elif len(arguments) == 1:
            register[results[0]] = ca.MX.unary(code, register[arguments[0]])
        else:
            # By operation code: the overloaded operators of MX take ten times as long to call.
            pair = register[arguments[0]], register[arguments[1]]
            register[results[0]] = ca.MX.binary(code, *pair)
    wide = [item if item.numel() == batch else ca.repmat(item, batch, 1) for item in output]
    return ca.Function(function.name(), [*inputs, shared], [ca.horzcat(*wide)])
