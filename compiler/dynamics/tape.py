"""The instruction list of an expression graph, to be run in any arithmetic."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Protocol, TypeVar

import casadi as ca

from compiler.dynamics.tape_plan import Plan, plan_of
from compiler.time_limits.time_limit import check_time

Number = TypeVar("Number")

LARGEST_EXACT_INTEGER = 2**53

INPUT, OUTPUT, CONSTANT = ca.OP_INPUT, ca.OP_OUTPUT, ca.OP_CONST


class Arithmetic(Protocol[Number]):
    """The operations a reading must supply; integers are exact."""

    def integer(self, value: int) -> Number:
        """An integer constant."""
        ...

    def unary(self, name: str, argument: Number) -> Number:
        """``neg sq sqrt sin cos tan fabs sign inv twice``."""
        ...

    def binary(self, name: str, left: Number, right: Number) -> Number:
        """``add sub mul div``."""
        ...


UNARY = {
    ca.OP_NEG: "neg",
    ca.OP_SQ: "sq",
    ca.OP_SQRT: "sqrt",
    ca.OP_SIN: "sin",
    ca.OP_COS: "cos",
    ca.OP_TAN: "tan",
    ca.OP_FABS: "fabs",
    ca.OP_SIGN: "sign",
    ca.OP_INV: "inv",
    ca.OP_TWICE: "twice",
}
BINARY = {ca.OP_ADD: "add", ca.OP_SUB: "sub", ca.OP_MUL: "mul", ca.OP_DIV: "div"}


class UndefinedValueError(ValueError):
    """A graph that has no value anywhere."""


@dataclass(frozen=True)
class Tape:
    """A straight-line program.

    Each instruction is ``(name, result register, argument registers or indices)``.  Inputs are
    numbered through all input columns of the function, outputs through its first output.
    """

    instructions: tuple[tuple[str, int, tuple[int, ...]], ...]
    registers: int
    outputs: int

    @cached_property
    def plan(self) -> Plan:
        """The same program, ready to be run many times."""
        return plan_of(self.instructions, self.outputs)

    def first(self, outputs: int) -> Tape:
        """The program of the first outputs alone."""
        kept = (item for item in self.instructions if item[0] != "output" or item[1] < outputs)
        return Tape(tuple(kept), self.registers, outputs)

    def evaluate(
        self, inputs: Sequence[Number], operations: Mapping[str, Callable[..., Any]]
    ) -> list[Number]:
        """The same as ``run`` where numbers are computed by plain functions, named as there.

        Besides, ``integer`` makes a constant, and ``sin_cos`` gives both of one argument.
        """
        check_time()
        return self.plan.run(inputs, operations)

    def run(self, inputs: Sequence[Number], arithmetic: Arithmetic[Number]) -> list[Number]:
        """The outputs for the given inputs, in the given arithmetic."""
        check_time()
        zero = arithmetic.integer(0)
        register: list[Number] = [zero] * self.registers
        output: list[Number] = [zero] * self.outputs
        unary, binary = arithmetic.unary, arithmetic.binary
        for name, target, arguments in self.instructions:
            if len(arguments) == 2:
                a, b = arguments
                register[target] = binary(name, register[a], register[b])
            elif name == "input":
                register[target] = inputs[arguments[0]]
            elif name == "output":
                output[target] = register[arguments[0]]
            elif name == "constant":
                register[target] = arithmetic.integer(arguments[0])
            else:
                register[target] = unary(name, register[arguments[0]])
        return output


def tape(function: ca.Function) -> Tape:
    """The instruction list of a CasADi function with one output.

    Raises:
        UndefinedValueError: CasADi has divided by a literal zero.
        ValueError: a constant that is not an exact integer, or an operation no reading knows.
    """
    starts = [0]
    for i in range(function.n_in()):
        starts.append(starts[-1] + function.nnz_in(i))
    instructions: list[tuple[str, int, tuple[int, ...]]] = []
    for i in range(function.n_instructions()):
        check_time()
        code = function.instruction_id(i)
        arguments, results = function.instruction_input(i), function.instruction_output(i)
        if code == INPUT:
            column, row = arguments
            instructions.append(("input", results[0], (starts[column] + row,)))
        elif code == OUTPUT:
            instructions.append(("output", results[1], (arguments[0],)))
        elif code == CONSTANT:
            value = function.instruction_constant(i)
            if not math.isfinite(value):
                raise UndefinedValueError(f"a divisor in the rules is zero: the constant {value!r}")
            if not value.is_integer() or abs(value) >= LARGEST_EXACT_INTEGER:
                raise ValueError(f"the graph holds the inexact constant {value!r}")
            instructions.append(("constant", results[0], (int(value),)))
        elif code in UNARY:
            instructions.append((UNARY[code], results[0], (arguments[0],)))
        elif code in BINARY:
            instructions.append((BINARY[code], results[0], tuple(arguments)))
        else:
            raise ValueError(f"operation {code} has no exact reading")
    return Tape(tuple(instructions), function.sz_w(), function.nnz_out(0))
