"""What it means for a robot to be at rest."""

from __future__ import annotations

from fractions import Fraction

REST_RATE = Fraction(1, 1000)
"""``reach ... at rest``: all rates of the joints below this, in SI units."""
