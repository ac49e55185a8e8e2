"""A tape in single-assignment form, ready to be run many times with plain functions.

Every value has a number: inputs first, then constants, then results in the order they are made.
What no output needs, and what was computed before, is left out; sine and cosine of the same value
are made at once, which costs power series no more than one of them.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, TypeVar

Number = TypeVar("Number")
Instruction = tuple[str, int, tuple[int, ...]]

SINE_AND_COSINE = "sin_cos"


@dataclass(frozen=True, slots=True)
class Plan:
    """Operations by name with the numbers of their arguments, and those of the outputs.

    ``sin_cos`` makes two values; every other operation one.  ``used`` are the inputs that occur.
    """

    used: tuple[int, ...]
    constants: tuple[int, ...]
    steps: tuple[tuple[str, tuple[int, ...]], ...]
    outputs: tuple[int, ...]

    def run(
        self, inputs: Sequence[Number], operations: Mapping[str, Callable[..., Any]]
    ) -> list[Number]:
        """The outputs; ``operations`` computes what a name says, ``integer`` a constant."""
        integer = operations["integer"]
        values: list[Any] = [inputs[i] for i in self.used]
        values += [integer(constant) for constant in self.constants]
        append = values.append
        for name, arguments in self.steps:
            if len(arguments) == 2:
                a, b = arguments
                append(operations[name](values[a], values[b]))
            elif name == SINE_AND_COSINE:
                values += operations[name](values[arguments[0]])
            else:
                append(operations[name](values[arguments[0]]))
        return [values[i] for i in self.outputs]


def plan_of(instructions: Sequence[Instruction], outputs: int) -> Plan:
    """The plan of a tape's instructions, for its first ``outputs`` outputs.

    An output that no instruction writes is the constant zero.
    """
    nodes, written = _numbered(instructions)
    zero = len(nodes)
    nodes.append(("constant", (0,)))
    wanted = [written.get(i, zero) for i in range(outputs)]
    needed = _needed(nodes, wanted)
    first = [i for i in needed if nodes[i][0] == "input"]
    second = [i for i in needed if nodes[i][0] == "constant"]
    number = {node: place for place, node in enumerate([*first, *second])}
    count = len(number)
    both = {argument for name, (argument, *_) in (nodes[i] for i in needed) if name == "sin"}
    both &= {argument for name, (argument, *_) in (nodes[i] for i in needed) if name == "cos"}
    pairs: dict[int, int] = {}
    steps: list[tuple[str, tuple[int, ...]]] = []
    for i in needed:
        name, arguments = nodes[i]
        if name in ("input", "constant"):
            continue
        if name in ("sin", "cos") and arguments[0] in both:
            argument = arguments[0]
            if argument not in pairs:
                pairs[argument] = count
                steps.append((SINE_AND_COSINE, (number[argument],)))
                count += 2
            number[i] = pairs[argument] + (name == "cos")
            continue
        steps.append((name, tuple(number[a] for a in arguments)))
        number[i] = count
        count += 1
    return Plan(
        tuple(nodes[i][1][0] for i in first),
        tuple(nodes[i][1][0] for i in second),
        tuple(steps),
        tuple(number[i] for i in wanted),
    )


def _numbered(
    instructions: Sequence[Instruction],
) -> tuple[list[tuple[str, tuple[int, ...]]], dict[int, int]]:
    """The distinct values with their arguments, and which of them each output is."""
    nodes: list[tuple[str, tuple[int, ...]]] = []
    known: dict[tuple[str, tuple[int, ...]], int] = {}
    register: dict[int, int] = {}
    written: dict[int, int] = {}
    for name, target, arguments in instructions:
        if name == "output":
            written[target] = register[arguments[0]]
            continue
        is_leaf = name in ("input", "constant")
        node = (name, arguments if is_leaf else tuple(register[a] for a in arguments))
        if node not in known:
            known[node] = len(nodes)
            nodes.append(node)
        register[target] = known[node]
    return nodes, written


def _needed(nodes: Sequence[tuple[str, tuple[int, ...]]], outputs: Sequence[int]) -> list[int]:
    """The values that outputs need, in the order they are made."""
    needed = set(outputs)
    for i in range(len(nodes) - 1, -1, -1):
        if i in needed and nodes[i][0] not in ("input", "constant"):
            needed.update(nodes[i][1])
    return sorted(needed)
