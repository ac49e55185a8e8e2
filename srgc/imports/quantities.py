"""Write numbers with units as a person would, and count what rounding has changed.

Files of other tools hold 1.570796325 for a right angle and 1e-17 for 0.  Such noise is removed:
lengths and angles get at most twelve decimals in SI units, other numbers ten digits, which changes
no effort by more than 1e-9 of itself.  An angle within 1e-5 rad of a multiple of 15 degrees becomes
that multiple, and a length below a micrometre becomes 0.  With ``exact`` numbers keep the fifteen
digits of a double, and angles and lengths are not changed.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from decimal import Decimal

import numpy as np

NOISE = 1e-5
"""Angles this close to a multiple of 15 degrees are rounded to it (rad)."""
SHORT = 1e-6
"""Lengths below this are rounded to 0 (m)."""
WORTH_SAYING = 1e-9
"""Rounding by less than this is not reported (rad, m)."""
DIGITS, ALL_DIGITS = 10, 15
"""Digits of numbers other than lengths and angles, and the digits of a double."""
THIN = 5e-15
"""How much rounding may reduce the least second moment of a body, as a share of their sum."""
_DECIMALS = Decimal("1e-12")
_STEP = 15


def decimal_text(value: float | Decimal, digits: int = DIGITS) -> str:
    """A number to ``digits`` significant digits without an exponent; below 1e-12 it is 0.

    Raises:
        ValueError: the number is not finite.
    """
    number = value if isinstance(value, Decimal) else Decimal(repr(float(value)))
    if not number.is_finite():
        raise ValueError(f"{value} is not a finite number")
    rounded = Decimal(f"{number:.{digits}g}")
    text = f"{rounded.normalize():f}" if abs(rounded) >= _DECIMALS else "0"
    return "0" if text == "-0" else text


def placed_text(value: float) -> str:
    """A number with the decimals of lengths and angles, and at most the digits of a double."""
    return decimal_text(Decimal(repr(float(value))).quantize(_DECIMALS), ALL_DIGITS)


@dataclass(slots=True)
class Quantities:
    """Writes quantities, and records what was rounded.

    ``rounded`` counts the angles that were rounded, by at most ``most`` (rad), and ``left_out`` the
    lengths that were rounded to 0.
    """

    exact: bool = False
    most: float = 0.0
    rounded: int = 0
    left_out: int = 0

    def angle(self, value: float) -> str:
        """An angle, in degrees if that is short, otherwise in radians."""
        degrees = math.degrees(value)
        near = round(degrees / _STEP) * _STEP
        shift = abs(value - math.radians(near))
        if shift == 0 or (shift <= NOISE and not self.exact):
            if shift > WORTH_SAYING:
                self.rounded += 1
                self.most = max(self.most, shift)
            return f"{near} deg" if near else "0 rad"
        whole = Decimal(f"{degrees:.2f}")
        most = 4e-16 * abs(value) if self.exact else WORTH_SAYING
        if abs(math.radians(float(whole)) - value) <= most:
            return f"{decimal_text(whole)} deg"
        return f"{placed_text(value)} rad"

    def number(self, value: float) -> str:
        """A number that is neither a length nor an angle."""
        return decimal_text(value, ALL_DIGITS if self.exact else DIGITS)

    def angles(self, low: float, high: float) -> str:
        """An interval of angles."""
        first, second = self.angle(low), self.angle(high)
        units = {text.split()[1] for text in (first, second) if text != "0 rad"}
        if len(units) > 1:
            first, second = f"{placed_text(low)} rad", f"{placed_text(high)} rad"
            units = {"rad"}
        unit = units.pop() if units else "rad"
        return f"[{first.split()[0]}, {second.split()[0]}] {unit}"

    def lengths(self, values: Sequence[float]) -> tuple[list[str], str]:
        """Lengths in metres or millimetres, whichever is shorter, and the unit."""
        exact = [Decimal(repr(float(self._kept(value)))).quantize(_DECIMALS) for value in values]
        in_m = [decimal_text(value, ALL_DIGITS) for value in exact]
        in_mm = [decimal_text(value * 1000, ALL_DIGITS) for value in exact]
        use_m = sum(map(len, in_m)) < sum(map(len, in_mm)) or not any(exact)
        return (in_m, "m") if use_m else (in_mm, "mm")

    def _kept(self, value: float) -> float:
        """A length, with 0 for one below a micrometre."""
        if self.exact or abs(value) >= SHORT:
            return value
        self.left_out += abs(value) > WORTH_SAYING
        return 0.0

    def length(self, value: float) -> str:
        """One length."""
        (text,), unit = self.lengths([value])
        return f"{text} {unit}"

    def vector(self, values: Sequence[float]) -> str:
        """A vector of lengths."""
        texts, unit = self.lengths(values)
        return f"({', '.join(texts)}) {unit}"

    def centre(self, values: Sequence[float]) -> str:
        """A centre of mass, whose largest coordinate has as many digits as a mass."""
        largest = max(map(abs, values))
        if self.exact or not largest:
            return self.vector(values)
        decimals = DIGITS - 1 - math.floor(math.log10(largest))
        return self.vector([round(value, decimals) for value in values])

    def interval(self, low: float, high: float) -> str:
        """An interval of lengths."""
        texts, unit = self.lengths([low, high])
        return f"[{', '.join(texts)}] {unit}"

    def inertia(self, values: Sequence[float]) -> str:
        """Six moments of inertia; those negligible compared with the largest are 0.

        They get more digits if with fewer the inertia of a thin body would not be physical.
        """
        largest = max(map(abs, values), default=0.0)
        kept = [0.0 if abs(value) < 1e-9 * largest else value for value in values]
        least = min(_thinness(kept), 0.0) - THIN
        enough = (
            digits
            for digits in range(ALL_DIGITS if self.exact else DIGITS, ALL_DIGITS)
            if _thinness([_rounded(value, digits) for value in kept]) >= least
        )
        digits = next(enough, ALL_DIGITS)
        return f"({', '.join(_digits(value, digits) for value in kept)}) kg*m^2"


def _rounded(value: float, digits: int) -> float:
    return float(f"{value:.{digits}g}")


def _digits(value: float, digits: int) -> str:
    """A number to ``digits`` significant digits, however small it is."""
    text = f"{Decimal(f'{value:.{digits}g}').normalize():f}" if value else "0"
    return text if len(text) <= digits + 5 else f"{value:.{digits}g}"


def _thinness(six: Sequence[float]) -> float:
    """The least second moment of a body as a share of their sum; below 0 no such body exists."""
    xx, yy, zz, xy, xz, yz = six
    tensor = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    total = float(np.trace(tensor)) / 2
    return float(total - np.linalg.eigvalsh(tensor)[-1]) / total if total else 0.0
