"""The straight-line program of an expression graph, which any evaluator can run.

Every value has a number: inputs first, then constants, then results in the order they are computed.
Values that no output needs, and repeated computations, are left out. Sine and cosine of one value
are computed together, which costs no more than one of them for power series.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, TypeAlias

import casadi as ca

from compiler.expressions.evaluator import Evaluator, Value
from compiler.time_limits.time_limit import check_time

LARGEST_EXACT_INTEGER = 2**53

INPUT, OUTPUT, CONSTANT = ca.OP_INPUT, ca.OP_OUTPUT, ca.OP_CONST

OPERATIONS = {
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
    ca.OP_ADD: "add",
    ca.OP_SUB: "sub",
    ca.OP_MUL: "mul",
    ca.OP_DIV: "div",
}
"""Maps instructions to the methods of an evaluator that carry them out."""
LEAVES = {"input", "constant"}
SINE_AND_COSINE = "sin_cos"
ONE_ARGUMENT, TWO_VALUES = -1, -2
"""These stand in place of a second argument."""

Node: TypeAlias = tuple[str, tuple[int, ...]]
"""An operation with the numbers of its arguments, or an input or constant with index or value."""


class UndefinedValueError(ValueError):
    """A graph that has no value at any input."""


@dataclass(frozen=True)
class Tape:
    """An expression graph: distinct nodes, arguments before their uses, and the outputs.

    Inputs are numbered through all input columns of the function, outputs through its first output.
    """

    nodes: tuple[Node, ...]
    results: tuple[int, ...]

    @property
    def outputs(self) -> int:
        """The number of outputs."""
        return len(self.results)

    def uses(self, name: str) -> bool:
        """Whether an operation occurs in the program."""
        return any(name == node for node, _ in self.nodes)

    def first(self, outputs: int) -> Tape:
        """The program of the first ``outputs`` outputs alone."""
        return Tape(self.nodes, self.results[:outputs])

    def evaluate(self, inputs: Sequence[Value], evaluator: Evaluator[Value]) -> list[Value]:
        """The values of the outputs for given inputs."""
        check_time()
        plan = self.plan
        # Values have no common type in the loop: sin_cos returns two of them.
        values: list[Any] = [inputs[i] for i in plan.used]
        values += [evaluator.constant(constant) for constant in plan.constants]
        append = values.append
        operations: list[Callable[..., Any]] = [getattr(evaluator, name) for name in plan.names]
        for operation, a, b in plan.steps:
            if b >= 0:
                append(operations[operation](values[a], values[b]))
            elif b == ONE_ARGUMENT:
                append(operations[operation](values[a]))
            else:
                values += operations[operation](values[a])
        return [values[i] for i in plan.outputs]

    @cached_property
    def plan(self) -> Plan:
        """The operations that the outputs need, in order."""
        return _plan(self.nodes, self.results)


def tape(function: ca.Function) -> Tape:
    """The expression graph of a CasADi function with one output.

    Raises:
        UndefinedValueError: CasADi has divided by a literal zero.
        ValueError: a constant is not an exact integer, or an operation has no exact value.
    """
    nodes: dict[Node, int] = {}
    register: dict[int, int] = {}
    written: dict[int, int] = {}
    for name, target, arguments in _instructions(function):
        if name == "output":
            written[target] = register[arguments[0]]
        else:
            known = arguments if name in LEAVES else tuple(register[a] for a in arguments)
            register[target] = nodes.setdefault((name, known), len(nodes))
    count = function.nnz_out(0)
    if len(written) < count:
        # An output that no instruction writes is zero.
        zero = nodes.setdefault(("constant", (0,)), len(nodes))
        written = {i: written.get(i, zero) for i in range(count)}
    return Tape(tuple(nodes), tuple(written[i] for i in range(count)))


def _instructions(function: ca.Function) -> Iterator[tuple[str, int, tuple[int, ...]]]:
    """Name, result register (for an output its number) and argument registers, indices or value."""
    starts = [0]
    for i in range(function.n_in()):
        starts.append(starts[-1] + function.nnz_in(i))
    for i in range(function.n_instructions()):
        check_time()
        code = function.instruction_id(i)
        arguments, results = function.instruction_input(i), function.instruction_output(i)
        if code == INPUT:
            column, row = arguments
            yield "input", results[0], (starts[column] + row,)
        elif code == OUTPUT:
            yield "output", results[1], (arguments[0],)
        elif code == CONSTANT:
            yield "constant", results[0], (_exact(function.instruction_constant(i)),)
        elif code in OPERATIONS:
            yield OPERATIONS[code], results[0], tuple(arguments)
        else:
            raise ValueError(f"operation {code} has no exact value")


def _exact(value: float) -> int:
    if not math.isfinite(value):
        raise UndefinedValueError(f"a divisor in the rules is zero: the constant {value!r}")
    if not value.is_integer() or abs(value) >= LARGEST_EXACT_INTEGER:
        raise ValueError(f"the graph holds the inexact constant {value!r}")
    return int(value)


@dataclass(frozen=True, slots=True)
class Plan:
    """Operations with the numbers of their arguments, and the numbers of the outputs.

    ``used`` holds the inputs that occur, ``names`` the operations. A step is the index of its name
    and the numbers of two arguments. In place of the second argument it has ``ONE_ARGUMENT``, or
    ``TWO_VALUES`` if it computes two values from one argument, as ``sin_cos`` does.
    """

    used: tuple[int, ...]
    constants: tuple[int, ...]
    names: tuple[str, ...]
    steps: tuple[tuple[int, int, int], ...]
    outputs: tuple[int, ...]


def _plan(nodes: Sequence[Node], outputs: Sequence[int]) -> Plan:
    needed = _needed(nodes, outputs)
    first = [i for i in needed if nodes[i][0] == "input"]
    second = [i for i in needed if nodes[i][0] == "constant"]
    number = {node: place for place, node in enumerate([*first, *second])}
    count = len(number)
    sines = {arguments for name, arguments in (nodes[i] for i in needed) if name == "sin"}
    both = {a for name, a in (nodes[i] for i in needed) if name == "cos" and a in sines}
    pairs: dict[tuple[int, ...], int] = {}
    steps: list[Node] = []
    for i in needed:
        name, arguments = nodes[i]
        if name in LEAVES:
            continue
        known = tuple(number[a] for a in arguments)
        if name in ("sin", "cos") and arguments in both:
            if arguments not in pairs:
                pairs[arguments] = count
                steps.append((SINE_AND_COSINE, known))
                count += 2
            number[i] = pairs[arguments] + (name == "cos")
            continue
        steps.append((name, known))
        number[i] = count
        count += 1
    names = sorted({name for name, _ in steps})
    places = {name: place for place, name in enumerate(names)}
    return Plan(
        tuple(nodes[i][1][0] for i in first),
        tuple(nodes[i][1][0] for i in second),
        tuple(names),
        tuple((places[name], *_two(name, arguments)) for name, arguments in steps),
        tuple(number[i] for i in outputs),
    )


def _two(name: str, arguments: Sequence[int]) -> tuple[int, int]:
    if len(arguments) == 2:
        return arguments[0], arguments[1]
    return arguments[0], TWO_VALUES if name == SINE_AND_COSINE else ONE_ARGUMENT


def _needed(nodes: Sequence[Node], outputs: Sequence[int]) -> list[int]:
    """The nodes that the outputs need, in the order they are computed."""
    needed = set(outputs)
    for i in range(len(nodes) - 1, -1, -1):
        if i in needed and nodes[i][0] not in LEAVES:
            needed.update(nodes[i][1])
    return sorted(needed)
