"""Exact values of closed expressions (no parameters, degrees of freedom or attributes).

A *monomial* is ``q * pi**k`` with q rational and k an integer: products and quotients of numbers
with units have this form.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from fractions import Fraction
from typing import TypeAlias

from grammar_lang import ir

MAX_BITS = 20_000

Monomial: TypeAlias = tuple[Fraction, int]

_ZERO: Monomial = (Fraction(0), 0)


class MagnitudeError(ArithmeticError):
    """An exact value would need more than ``MAX_BITS`` bits."""


def _bits(q: Fraction) -> int:
    return max(q.numerator.bit_length(), q.denominator.bit_length())


def _bounded(q: Fraction, power: int) -> Monomial:
    if _bits(q) > MAX_BITS:
        raise MagnitudeError
    return (q, power) if q else _ZERO


def _power(base: Monomial, exponent: Monomial) -> Monomial | None:
    n, k = exponent
    if k or n.denominator != 1 or (not base[0] and n < 0):
        return None
    if _bits(base[0]) * abs(n) > MAX_BITS and abs(base[0]) != 1:
        raise MagnitudeError
    if abs(n) > MAX_BITS:
        raise MagnitudeError
    return _bounded(base[0] ** n.numerator, base[1] * n.numerator)


def _sum(left: Monomial, right: Monomial, sign: int) -> Monomial | None:
    if left[0] and right[0] and left[1] != right[1]:
        return None
    power = left[1] if left[0] else right[1]
    return _bounded(left[0] + sign * right[0], power)


def combine(operator: ir.Operator, left: Monomial, right: Monomial) -> Monomial | None:
    """The result of an operation if it is a monomial; raises :class:`MagnitudeError`."""
    match operator:
        case "+":
            return _sum(left, right, 1)
        case "-":
            return _sum(left, right, -1)
        case "*":
            return _bounded(left[0] * right[0], left[1] + right[1])
        case "/":
            if not right[0]:
                return None
            return _bounded(left[0] / right[0], left[1] - right[1])
        case "^":
            return _power(left, right)


def _root(value: Monomial) -> Monomial | None:
    q, k = value
    if q < 0 or k % 2:
        return None
    top, bottom = math.isqrt(q.numerator), math.isqrt(q.denominator)
    if top * top != q.numerator or bottom * bottom != q.denominator:
        return None
    return Fraction(top, bottom), k // 2


def _sine(turns: Fraction) -> Monomial | None:
    """sin(2 pi ``turns``) if it is rational at a rational angle (Niven's theorem)."""
    values = {0: 0, 1: 1, 3: 2, 5: 1, 6: 0, 7: -1, 9: -2, 11: -1}
    twelfths = (turns * 12) % 12
    if twelfths.denominator != 1 or twelfths.numerator not in values:
        return None
    return Fraction(values[twelfths.numerator], 2), 0


def _tangent(turns: Fraction) -> Monomial | None:
    values = {0: 0, 1: 1, 3: -1}
    eighths = (turns * 8) % 4
    if eighths.denominator != 1 or eighths.numerator not in values:
        return None
    return Fraction(values[eighths.numerator]), 0


def is_right_angle(angle: Monomial) -> bool:
    """Whether an angle is an odd multiple of pi/2, where the tangent has a pole."""
    quarters = 2 * angle[0]
    return angle[1] == 1 and quarters.denominator == 1 and bool(quarters.numerator % 2)


def apply(function: ir.Function, value: Monomial) -> Monomial | None:
    """The result of a function if it is a monomial."""
    q, k = value
    match function:
        case "neg":
            return -q, k
        case "abs":
            return abs(q), k
        case "sqrt":
            return _root(value)
        case "sin" | "cos" | "tan":
            if q and k != 1:
                return None
            turns = q / 2
            if function == "tan":
                return _tangent(turns)
            return _sine(turns if function == "sin" else turns + Fraction(1, 4))


def evident(expr: ir.Expr) -> Monomial | None:
    """As :func:`monomial`, but also None if its numbers are too large."""
    try:
        return monomial(expr)
    except MagnitudeError:
        return None


def monomial(expr: ir.Expr) -> Monomial | None:
    """The value of a closed scalar expression if it is evidently a monomial, otherwise None.

    Raises:
        MagnitudeError: its numbers are too large.
    """
    match expr:
        case ir.Num(value=q):
            return q, 0
        case ir.Pi():
            return Fraction(1), 1
        case ir.Unary(function=function, operand=operand):
            inner = monomial(operand)
            return None if inner is None else apply(function, inner)
        case ir.Binary(operator=operator, left=left, right=right):
            a, b = monomial(left), monomial(right)
            return None if a is None or b is None else combine(operator, a, b)
        case _:
            return None


def from_monomial(value: Monomial) -> ir.Expr:
    """The shortest expression of a monomial."""
    q, k = value
    if not k or not q:
        return ir.Num(q)
    power: ir.Expr = ir.Pi()
    if abs(k) > 1:
        power = ir.Binary("^", ir.Pi(), ir.Num(Fraction(abs(k))))
    if k < 0:
        return ir.Binary("/", ir.Num(q), power)
    return power if q == 1 else ir.Binary("*", ir.Num(q), power)


def rational(expr: ir.Expr) -> Fraction | None:
    """The exact value of a closed expression; None if it is not evidently rational.

    Roots of squares and rational sines of rational angles are recognised; sums of unlike surds are
    not.
    """
    value = evident(expr)
    return value[0] if value is not None and (not value[1] or not value[0]) else None


_FUNCTIONS: dict[ir.Function, Callable[[float], float]] = {
    "neg": lambda a: -a,
    "abs": abs,
    "sqrt": math.sqrt,
    "sin": math.sin,
    "cos": math.cos,
    "tan": math.tan,
}


# pi = 3.14159265358979323846264338327950288419...
_PI_BELOW = Fraction(314159265358979323846264338327950288, 10**35)
_PI_ABOVE = _PI_BELOW + Fraction(1, 10**35)


def rational_bounds(value: Monomial) -> tuple[Fraction, Fraction]:
    """Rational lower and upper bounds of a positive ``q * pi**k``, from 35 digits of pi."""
    factor, power = value
    ends = _PI_BELOW**power, _PI_ABOVE**power
    return factor * min(ends), factor * max(ends)


def _operate(operator: ir.Operator, a: float, b: float) -> float:
    match operator:
        case "+":
            return a + b
        case "-":
            return a - b
        case "*":
            return a * b
        case "/":
            return a / b
        case "^":
            return float(a**b)


def to_float(expr: ir.Expr) -> float:
    """The value of a closed scalar expression in floating point, not correctly rounded.

    Raises:
        ValueError: the expression is not closed, not a scalar, or has no finite value.
    """
    try:
        value = _float(expr)
    except (OverflowError, ZeroDivisionError) as error:
        raise ValueError("the expression has no finite value") from error
    if not math.isfinite(value):
        raise ValueError("the expression has no finite value")
    return value


def _float(expr: ir.Expr) -> float:
    match expr:
        case ir.Num(value=q):
            return float(q)
        case ir.Pi():
            return math.pi
        case ir.Unary(function=function, operand=operand):
            return _FUNCTIONS[function](_float(operand))
        case ir.Binary(operator=operator, left=left, right=right):
            return _operate(operator, _float(left), _float(right))
        case _:
            raise ValueError("the expression is not a closed scalar")


def unary(function: ir.Function, operand: ir.Expr) -> ir.Expr:
    """``function(operand)``, folded if it is a monomial; may raise MagnitudeError."""
    inner = monomial(operand)
    value = None if inner is None else apply(function, inner)
    return ir.Unary(function, operand) if value is None else from_monomial(value)


def binary(operator: ir.Operator, left: ir.Expr, right: ir.Expr) -> ir.Expr:
    """The expression of an operation, folded if it is a monomial; may raise MagnitudeError."""
    a, b = monomial(left), monomial(right)
    value = None if a is None or b is None else combine(operator, a, b)
    return ir.Binary(operator, left, right) if value is None else from_monomial(value)


def is_closed(expr: ir.Expr) -> bool:
    """Whether a scalar expression has no parameters, degrees of freedom or attributes."""
    match expr:
        case ir.Num() | ir.Pi():
            return True
        case ir.Unary(operand=operand):
            return is_closed(operand)
        case ir.Binary(left=left, right=right):
            return is_closed(left) and is_closed(right)
        case _:
            return False


def less(a: ir.Expr, b: ir.Expr) -> bool:
    """Whether ``a < b``: exact if both are like monomials, otherwise in floating point.

    Raises:
        ValueError: as :func:`to_float`.
    """
    p, q = evident(a), evident(b)
    if p is not None and q is not None and (p[1] == q[1] or not p[0] or not q[0]):
        return p[0] < q[0]
    return to_float(a) < to_float(b)
