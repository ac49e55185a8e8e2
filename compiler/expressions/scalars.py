"""Scalar expressions over a robot's parameters, and their values as monomials."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from typing import TypeAlias

from compiler.expressions.evaluator import METHODS, Evaluator, Value
from grammar_lang import ir
from grammar_lang.ir.constants import MagnitudeError, Monomial, apply, combine

# --- Scalar expressions over a robot's parameters, as a hash-consed table without recursion -------
#
# A scalar is its index in the table. Equal expressions have equal indices, and arguments precede
# the nodes that use them, so evaluation is one loop.


@dataclass(frozen=True, slots=True)
class Constant:
    """An exact rational."""

    value: Fraction


@dataclass(frozen=True, slots=True)
class PiConstant:
    """The number pi."""


@dataclass(frozen=True, slots=True)
class ParameterLeaf:
    """The ``index``-th parameter of the robot, in SI units."""

    index: int


@dataclass(frozen=True, slots=True)
class Apply:
    """An operation (``+ - * /``, ``neg abs sqrt sin cos tan``, ``^`` with an integer) on nodes."""

    operation: str
    arguments: tuple[int, ...]
    exponent: int = 0


ScalarNode: TypeAlias = Constant | PiConstant | ParameterLeaf | Apply


@dataclass(slots=True)
class ScalarTable:
    """Builds scalars; it simplifies only exactly, with rationals, 0 and 1."""

    nodes: list[ScalarNode] = field(default_factory=list[ScalarNode])
    _index: dict[ScalarNode, int] = field(default_factory=dict[ScalarNode, int])

    def add(self, node: ScalarNode) -> int:
        """The index of a node, which is added unsimplified if it is new."""
        if node not in self._index:
            self._index[node] = len(self.nodes)
            self.nodes.append(node)
        return self._index[node]

    def constant(self, value: Fraction | int) -> int:
        """The index of an exact rational."""
        return self.add(Constant(Fraction(value)))

    def pi(self) -> int:
        """The index of the number pi."""
        return self.add(PiConstant())

    def parameter(self, index: int) -> int:
        """The index of a parameter of the robot."""
        return self.add(ParameterLeaf(index))

    def rational(self, scalar: int) -> Fraction | None:
        """The value of a scalar that is a rational constant; None for other scalars."""
        node = self.nodes[scalar]
        return node.value if isinstance(node, Constant) else None

    def unary(self, operation: str, argument: int) -> int:
        """``neg abs sqrt sin cos tan`` of a scalar."""
        value = self.rational(argument)
        if value is not None:
            if operation == "neg":
                return self.constant(-value)
            if operation == "abs":
                return self.constant(abs(value))
            if value == 0:
                return self.constant(1 if operation == "cos" else 0)
        return self.add(Apply(operation, (argument,)))

    def power(self, argument: int, exponent: int) -> int:
        """An integer power."""
        value = self.rational(argument)
        if value is not None and (value != 0 or exponent >= 0):
            return self.constant(value**exponent)
        return argument if exponent == 1 else self.add(Apply("^", (argument,), exponent))

    def binary(self, operation: str, left: int, right: int) -> int:
        """``+ - * /`` of two scalars."""
        a, b = self.rational(left), self.rational(right)
        if a is not None and b is not None and not (operation == "/" and b == 0):
            folded = {"+": a + b, "-": a - b, "*": a * b}.get(operation)
            return self.constant(a / b if folded is None else folded)
        if operation in "+-" and b == 0:
            return left
        if operation == "+" and a == 0:
            return right
        if operation in "*/" and b == 1:
            return left
        if operation == "*" and a == 1:
            return right
        if operation == "*" and 0 in (a, b):
            return self.constant(0)
        return self.add(Apply(operation, (left, right)))


def evaluate_constant(constant: Constant | PiConstant, evaluator: Evaluator[Value]) -> Value:
    """The value of a constant of a graph."""
    return evaluator.constant(constant.value) if isinstance(constant, Constant) else evaluator.pi()


def evaluate_scalars(
    nodes: Sequence[ScalarNode], evaluator: Evaluator[Value], parameters: Sequence[Value]
) -> list[Value]:
    """The value of every node for given values of the parameters."""
    operations: dict[str, Callable[..., Value]] = {
        operation: getattr(evaluator, name) for operation, name in METHODS.items()
    }
    values: list[Value] = []
    for node in nodes:
        if isinstance(node, ParameterLeaf):
            values.append(parameters[node.index])
        elif not isinstance(node, Apply):
            values.append(evaluate_constant(node, evaluator))
        elif node.operation == "^":
            values.append(evaluator.power(values[node.arguments[0]], node.exponent))
        else:
            values.append(operations[node.operation](*(values[i] for i in node.arguments)))
    return values


# --- Monomials ``q * pi**k`` with rational q: values of closed scalars that are recognised --------


Known: TypeAlias = Monomial | None


class MonomialEvaluator(Evaluator[Known]):
    """Values are monomials; None if a value is not recognised as one, or is too large."""

    def constant(self, value: Fraction | int) -> Known:
        """A rational."""
        return Fraction(value), 0

    def pi(self) -> Known:
        """The number pi."""
        return Fraction(1), 1

    def add(self, left: Known, right: Known, /) -> Known:
        """The sum."""
        return _combined("+", left, right)

    def sub(self, left: Known, right: Known, /) -> Known:
        """The difference."""
        return _combined("-", left, right)

    def mul(self, left: Known, right: Known, /) -> Known:
        """The product."""
        return _combined("*", left, right)

    def div(self, left: Known, right: Known, /) -> Known:
        """The quotient."""
        return _combined("/", left, right)

    def power(self, base: Known, exponent: int, /) -> Known:
        """An integer power."""
        return _combined("^", base, (Fraction(exponent), 0))

    def neg(self, argument: Known, /) -> Known:
        """The negation."""
        return _applied("neg", argument)

    def fabs(self, argument: Known, /) -> Known:
        """The absolute value."""
        return _applied("abs", argument)

    def sqrt(self, argument: Known, /) -> Known:
        """The square root."""
        return _applied("sqrt", argument)

    def sin(self, argument: Known, /) -> Known:
        """The sine."""
        return _applied("sin", argument)

    def cos(self, argument: Known, /) -> Known:
        """The cosine."""
        return _applied("cos", argument)

    def tan(self, argument: Known, /) -> Known:
        """The tangent."""
        return _applied("tan", argument)


def _combined(operator: ir.Operator, left: Known, right: Known) -> Known:
    if left is None or right is None:
        return None
    try:
        return combine(operator, left, right)
    except MagnitudeError:
        return None


def _applied(function: ir.Function, argument: Known) -> Known:
    if argument is None:
        return None
    try:
        return apply(function, argument)
    except MagnitudeError:
        return None
