"""Sums and products at 60 digits: mpmath readings of constants, tapes and the one-rod arm."""

from __future__ import annotations

import mpmath as mp
from flint import arb

from compiler.arithmetic.scalars import Constant, PiConstant

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


class Multiprecision:
    """The arithmetic of mpmath for tapes."""

    def integer(self, value: int) -> mp.mpf:
        return mp.mpf(value)

    def unary(self, name: str, argument: mp.mpf) -> mp.mpf:
        match name:
            case "neg":
                return -argument
            case "sq":
                return argument**2
            case "twice":
                return 2 * argument
            case "inv":
                return 1 / argument
            case "fabs":
                return abs(argument)
        return getattr(mp, name)(argument)

    def binary(self, name: str, left: mp.mpf, right: mp.mpf) -> mp.mpf:
        match name:
            case "add":
                return left + right
            case "sub":
                return left - right
            case "mul":
                return left * right
        return left / right
