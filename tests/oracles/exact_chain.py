"""Sums and products at 60 digits: mpmath values of constants, tapes and the one-rod arm."""

from __future__ import annotations

import operator
from fractions import Fraction

import mpmath as mp
from flint import arb

from compiler.expressions.evaluator import Evaluator
from compiler.expressions.scalars import Constant, PiConstant

DIGITS = 60


def exact(constant: Constant | PiConstant) -> mp.mpf:
    """A constant of a graph at 60 digits."""
    if isinstance(constant, PiConstant):
        return +mp.pi
    return mp.mpf(constant.value.numerator) / constant.value.denominator


def contains(ball: arb, value: mp.mpf) -> bool:
    """Whether a ball contains a number known to DIGITS digits, give or take the last ten."""
    tolerance = abs(value) * mp.mpf(10) ** (10 - DIGITS) + mp.mpf(10) ** (5 - DIGITS)
    around = arb(mp.nstr(value, DIGITS), mp.nstr(tolerance, 5))
    return bool(ball.overlaps(around))


class Multiprecision(Evaluator[mp.mpf]):
    """Numbers of mpmath, at its working precision."""

    neg = staticmethod(operator.neg)
    fabs = staticmethod(abs)
    sqrt, sin, cos, tan = map(staticmethod, (mp.sqrt, mp.sin, mp.cos, mp.tan))
    sign = staticmethod(mp.sign)
    add, sub, mul, div = map(
        staticmethod, (operator.add, operator.sub, operator.mul, operator.truediv)
    )

    def constant(self, value: Fraction | int) -> mp.mpf:
        return mp.mpf(Fraction(value).numerator) / Fraction(value).denominator

    def pi(self) -> mp.mpf:
        return +mp.pi


class Rationals(Evaluator[Fraction]):
    """Fractions: no roots, no angles."""

    neg = staticmethod(operator.neg)
    fabs = staticmethod(abs)
    power = staticmethod(operator.pow)
    add, sub, mul, div = map(
        staticmethod, (operator.add, operator.sub, operator.mul, operator.truediv)
    )

    def constant(self, value: Fraction | int) -> Fraction:
        return Fraction(value)
