"""Numbers with units as a person writes them, and what rounding them has changed.

Files of other tools hold 1.570796325 for a right angle and 1e-17 for nothing.  Such noise is taken
away: a number gets at most twelve decimals in SI units, and an angle that is within 1e-5 rad of a
multiple of 15 degrees is that multiple, a length below a micrometre is 0.  With ``exact`` they stay
as they are.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from decimal import Decimal

NOISE = 1e-5
"""Angles this near a multiple of 15 degrees are taken for it (rad)."""
SHORT = 1e-6
"""Lengths below it are taken for 0 (m)."""
WORTH_SAYING = 1e-9
"""What is rounded by less (rad, m) is not told of."""
_DECIMALS = Decimal("1e-12")
_STEP = 15
_TENTH = 0.1
_LONGEST = 20
"""A number of more characters is written with an exponent."""


def decimal_text(value: float | Decimal) -> str:
    """A number with at most twelve decimals, or digits where it is small, without an exponent."""
    number = value if isinstance(value, Decimal) else Decimal(repr(float(value)))
    if not number.is_finite():
        raise ValueError(f"{value} is no finite number")
    rounded = number.quantize(_DECIMALS) if abs(number) < 1 else _significant(number)
    text = f"{rounded.normalize():f}"
    return "0" if text in ("-0", "") else text


def digits_text(value: float) -> str:
    """A mass or another quantity that may be small: at least twelve digits, as of 1 and above."""
    if abs(value) >= _TENTH or not value:
        return decimal_text(value)
    text = f"{Decimal(f'{value:.12g}').normalize():f}"
    return text if len(text) <= _LONGEST else f"{value:.12g}"


def _significant(number: Decimal) -> Decimal:
    """At most fifteen digits, which is what a double holds."""
    return Decimal(f"{number:.15g}")


@dataclass(slots=True)
class Quantities:
    """Writes quantities.

    It remembers how many angles it has rounded and by how much at most (rad), and how many lengths
    it has left out.
    """

    exact: bool = False
    most: float = 0.0
    rounded: int = 0
    left_out: int = 0

    def angle(self, value: float) -> str:
        """An angle, in degrees where that is short and in radians else."""
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
        return f"{decimal_text(value)} rad"

    def angles(self, low: float, high: float) -> str:
        """An interval of angles."""
        first, second = self.angle(low), self.angle(high)
        units = {text.split()[1] for text in (first, second) if text != "0 rad"}
        if len(units) > 1:
            first, second = f"{decimal_text(low)} rad", f"{decimal_text(high)} rad"
            units = {"rad"}
        unit = units.pop() if units else "rad"
        return f"[{first.split()[0]}, {second.split()[0]}] {unit}"

    def lengths(self, values: Sequence[float]) -> tuple[list[str], str]:
        """Lengths in metres or millimetres, whichever is shorter, and that unit."""
        exact = [Decimal(repr(float(self._kept(value)))).quantize(_DECIMALS) for value in values]
        in_m = [decimal_text(value) for value in exact]
        in_mm = [decimal_text(value * 1000) for value in exact]
        use_m = sum(map(len, in_m)) < sum(map(len, in_mm)) or not any(exact)
        return (in_m, "m") if use_m else (in_mm, "mm")

    def _kept(self, value: float) -> float:
        """A length; one below a micrometre is noise."""
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

    def interval(self, low: float, high: float) -> str:
        """An interval of lengths."""
        texts, unit = self.lengths([low, high])
        return f"[{', '.join(texts)}] {unit}"

    def inertia(self, values: Sequence[float]) -> str:
        """Six moments of inertia; what is noise beside the largest is 0."""
        largest = max(map(abs, values), default=0.0)
        kept = [0.0 if abs(value) < 1e-9 * largest else value for value in values]
        return f"({', '.join(_digits(value) for value in kept)}) kg*m^2"


def _digits(value: float) -> str:
    """A number to fifteen digits, which moments of small parts need."""
    text = f"{Decimal(f'{value:.15g}').normalize():f}" if value else "0"
    return text if len(text) <= _LONGEST else f"{value:.15g}"
