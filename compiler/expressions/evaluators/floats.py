"""Doubles: the value of an expression graph at one point, not for proofs."""

from __future__ import annotations

import math
import operator
from collections.abc import Iterable, Sequence
from fractions import Fraction
from typing import Any, ClassVar

from compiler.expressions.evaluator import Evaluator
from compiler.expressions.scalars import ScalarNode, evaluate_scalars


class FloatEvaluator(Evaluator[float]):
    """Values are doubles.

    Raises ``ValueError`` or ``ZeroDivisionError`` if there is no value, as Python's operations do.
    """

    neg: ClassVar[Any] = staticmethod(operator.neg)
    fabs: ClassVar[Any] = staticmethod(abs)
    sqrt: ClassVar[Any] = staticmethod(math.sqrt)
    sin: ClassVar[Any] = staticmethod(math.sin)
    cos: ClassVar[Any] = staticmethod(math.cos)
    tan: ClassVar[Any] = staticmethod(math.tan)
    add: ClassVar[Any] = staticmethod(operator.add)
    sub: ClassVar[Any] = staticmethod(operator.sub)
    mul: ClassVar[Any] = staticmethod(operator.mul)
    div: ClassVar[Any] = staticmethod(operator.truediv)
    power: ClassVar[Any] = staticmethod(operator.pow)

    def constant(self, value: Fraction | int) -> float:
        """The nearest double."""
        return float(value)

    def pi(self) -> float:
        """The double nearest to pi."""
        return math.pi

    def sign(self, argument: float, /) -> float:
        """1, -1, or 0 for zero."""
        return float((argument > 0) - (argument < 0))


def scalar_floats(nodes: Sequence[ScalarNode], theta: Iterable[float]) -> list[float]:
    """The value of every scalar of a robot for parameters theta (p,) in SI units."""
    return evaluate_scalars(nodes, FloatEvaluator(), [float(value) for value in theta])
