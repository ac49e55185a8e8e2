"""Guesses of the length and the order of a segment of a tube; validation decides on them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from math import ceil
from typing import SupportsFloat

from flint import arb

GRID = 4096
"""Segments begin and end at multiples of 1 / GRID of a step."""
LEAST_PARTS, LEAST_ROUGH_PARTS = 8, 1
"""The shortest segments that are tried, in parts of the grid; the second for rough ones at
kinks."""
SAFETY = 0.9
BACK_OFF = 0.7
LEAST_CAUTION, MOST_CAUTION = 0.25, 1.25
MOST_OF_RADIUS, LEAST_OF_RADIUS = 0.02, 1e-3
"""The most, and the least, that the error of P should add to a set, relative to its radius."""
WIDE, MOST_OF_WIDE, WIDE_DEGREE = 1e-5, 1e-4, 5
"""For sets at least this wide, whose radius reduces margins, less is allowed, and a second, tighter
box is computed in which they stay."""
MOST_GROWTH, LEAST_GROWTH, LEAST_WIDE = 2.5, 1.3, Fraction(1, 2)
"""How much too large the box that no deviation leaves may be: beyond the first factor, segments get
shorter, but not below a fraction of a step; below the second, they get longer."""
MOST_SECOND, LEAST_SECOND, LEAST_SHORT = 1 / 5, 1 / 8, Fraction(1, 16)
"""The same limits for the fraction of the rates that second-order terms add in a step."""
LEAST_EXCESS = 1e-30
LONGEST = 1e9
"""In seconds: the length of a segment if no coefficient limits it."""
SPARSE = 1e-9
"""Coefficients smaller than their neighbours by this factor belong to a series without such
powers."""
LEAST_ORDER = 4
WORK = 17.0, 0.9, 0.1
"""The work for a segment of order k: a constant, a multiple of k, and a multiple of k^2 (series
products)."""


@dataclass(slots=True)
class StepControl:
    """Lengths of segments, as fractions of a step of ``dt`` seconds.

    ``caution`` is the ratio of a good length to the guessed one, learned from accepted and refused
    segments. ``degree`` is that of the matrix polynomial P, as low as its error allows. No segment
    is longer than ``most``.
    """

    dt: float
    caution: float = 1.0
    degree: int = 2
    most: Fraction = Fraction(1)

    def close_enough(self, length: Fraction, growth: float, second: float) -> bool:
        """Whether a segment is short enough for second-order terms.

        If not, ``most`` is halved: their bounds grow with too large a box, and with themselves.

        Args:
            length: the length of the segment.
            growth: the size of the box of deviations relative to a tighter one.
            second: the fraction of the rates that second-order terms add per second.
        """
        added = second * self.dt
        too_large = growth > MOST_GROWTH and length > LEAST_WIDE
        if too_large or (added > MOST_SECOND and length > LEAST_SHORT):
            self.most = max(LEAST_WIDE if added <= MOST_SECOND else LEAST_SHORT, length / 2)
            return False
        if growth < LEAST_GROWTH and added < LEAST_SECOND and length >= self.most:
            self.most = min(Fraction(1), 2 * self.most)
        return True

    def learn_degree(self, radii: Sequence[arb], errors: Sequence[arb], order: int) -> None:
        """Learn from the error that is added to a set with these radii, besides the flow."""
        pairs = zip(errors, radii, strict=True)
        parts = [float(error) / float(radius) for error, radius in pairs if radius > 0]
        worst = max(parts, default=0.0)
        wide = max(map(float, radii), default=0.0) >= WIDE
        if wide:
            self.degree = max(self.degree, min(WIDE_DEGREE, order))
        if worst > (MOST_OF_WIDE if wide else MOST_OF_RADIUS):
            self.degree = min(self.degree + 1, max(1, order if wide else order // 3))
        elif worst < LEAST_OF_RADIUS and not wide:
            self.degree = max(1, self.degree - 1)

    def first(self, rest: Fraction, guess: float) -> Fraction:
        """The length to try if ``rest`` of the step remains and ``guess`` seconds look good."""
        rest = min(rest, self.most)
        share = guess * self.caution / self.dt
        if share >= float(rest) * SAFETY:
            return rest
        count = ceil(float(rest) / share) if share > 0 else GRID
        return min(rest, Fraction(max(1, int(rest * GRID) // count), GRID))

    def learn(self, length: Fraction, guess: float, excess: float, order: int) -> float:
        """The share of a tried length that looks good; ``excess`` is error over tolerance.

        An infinite excess only shows that the length was too large.
        """
        if excess == float("inf"):
            self.caution = max(LEAST_CAUTION, self.caution * BACK_OFF)
            return 0.5
        share: float = SAFETY * max(excess, LEAST_EXCESS) ** (-1 / (order + 1))
        good = share * float(length) * self.dt / guess
        self.caution = min(MOST_CAUTION, max(LEAST_CAUTION, good, self.caution / 2))
        return share

    def shorter(self, length: Fraction, share: float, least: int) -> Fraction | None:
        """The next length to try after a refusal; None if ``least`` parts were too many."""
        parts = int(length * GRID * Fraction(min(0.8, max(0.2, share))))
        if parts < least < length * GRID:
            parts = least
        return Fraction(parts, GRID) if parts >= least else None


def good_length(rates: Sequence[Sequence[SupportsFloat]], tolerance: float) -> float:
    """Seconds over which the first omitted coefficient is about as large as the tolerance.

    ``rates`` are the Taylor coefficients of the integrated quantities.
    """
    lengths = [LONGEST]
    for entry in rates:
        order, left_out = len(entry) - 1, _left_out([abs(float(c)) for c in entry[-4:]])
        if left_out > 0:
            lengths.append((tolerance / (left_out * (order + 1))) ** (1 / (order + 1)))
    return min(lengths)


def _left_out(sizes: Sequence[float]) -> float:
    """An estimate of the first omitted coefficient from the last ones; 0 if they do not show it.

    For a motion from rest, every other coefficient is zero up to rounding and carries no
    information.
    """
    if len(sizes) < 3:
        return 0.0
    before, middle, last = sizes[-3:]
    if max(before, last) <= SPARSE * middle:
        before = sizes[0] if len(sizes) > 3 else 0.0
        return middle * middle / before if before > 0 else 0.0
    if not (last > 0 and before > 0):
        return 0.0
    ratio: float = (last / before) ** 0.5
    if middle > SPARSE * (last * before) ** 0.5:
        ratio = max(ratio, last / middle)
    return last * ratio


@dataclass(slots=True)
class OrderChoice:
    """Whether a Taylor polynomial has reached the order with the least work per time.

    It is called with the coefficients after each order, those of the ``places`` coordinates first;
    at most ``wanted`` seconds can be used.
    """

    places: int
    tolerance: float
    wanted: float
    paces: list[float] = field(default_factory=list)

    @property
    def order(self) -> int:
        """The order that the polynomial has reached."""
        return LEAST_ORDER + max(0, len(self.paces) - 1)

    def __call__(self, x: Sequence[Sequence[SupportsFloat]]) -> bool:
        """Whether a higher order is not worth its work."""
        order = len(x[0]) - 1
        if order < LEAST_ORDER:
            return False
        length = min(self.wanted, good_length(x[self.places :], self.tolerance))
        self.paces.append(length / (WORK[0] + WORK[1] * order + WORK[2] * order**2))
        last = len(self.paces) - 1
        return length >= self.wanted or (last >= 2 and self.paces[-1] < self.paces[-3])
