"""A box that no solution leaves, and the length of the segment that is tried for it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from math import ceil

from flint import arb, arb_mat

from compiler.expressions.evaluators.balls import SIGNS, absolute, both_signs, column, stacked
from solvers.verifier.proofs.vector_field import InertiaMatrix, Linearisation, Path, VectorField

# --- A box that no solution leaves, by the comparison of deviations -------------------------------
#
# Let p be a path with defect rho, and x a solution for inputs u + d(t), d measurable with
# |d(t)| <= delta, from x(0) = p(0) + e(0), |e(0)| <= r.  By the mean value theorem along the
# homotopy (p + h e, u + h d), 0 <= h <= 1 (Clarke's generalised Jacobian at kinks),
#
# .. math::
#     \dot e_q = e_v, \qquad N(x)\,\dot e_w = R\,e + B\,d + \rho,
#
# where R and B lie in the hulls of the derivatives of (b - M a, d) in the state, at a = p_v', and
# in u, over all that lies between.  As long as |e| <= E this is e' = A(t) e + c(t) with A, c
# measurable, |A| <= J, |c| <= k entry by entry, J and k non-negative bounds over p([0, H]) + E.
# Hence |e(t)| <= y(t) with y' = J y + k, y(0) = r: a linear cooperative comparison system (Walter,
# *Differential and integral inequalities*, 1970; Kapela & Zgliczynski, *A Lohner-type algorithm for
# control systems and ordinary differential inclusions*, 2009, theorem 4.1).  If y(H) < E then e
# never reaches the boundary of E: were t the first time that it does, |e(t)| <= y(t) <= y(H) < E.
# So the solution exists on [0, H] and stays in p + E.


MOST_TRIALS = 6
COMPARISON_TERMS = 8
FIRST_INFLATION, FURTHER_INFLATION = arb(1.25), arb(1.125)
DEFECT_INFLATION = 16
LEAST_INFLATION = arb(2) ** -200
"""A box needs an interior, even where nothing deviates."""


@dataclass(frozen=True, slots=True)
class Drive:
    """The stated inputs of a step, and how far those in force may differ from them."""

    stated: list[arb]
    disturbance: list[arb]

    @property
    def is_disturbed(self) -> bool:
        """Whether they may differ at all."""
        return not all(item == 0 for item in self.disturbance)

    @property
    def all(self) -> list[arb]:
        """Balls that hold all inputs in force."""
        return [u + SIGNS * d for u, d in zip(self.stated, self.disturbance, strict=True)]


@dataclass(frozen=True, slots=True)
class NearPath:
    """A path, bounds of its defect and of |e(0)|, and what drives those near it."""

    path: Path
    defect: list[arb]
    start: list[arb]
    drive: Drive


@dataclass(frozen=True, slots=True)
class Deviation:
    """How solutions deviate from a path on [0, H].

    ``radii`` is E; ``rates`` the bound J of |A|, shape (size, size); ``push`` the bound k, of which
    ``residue`` is the defect's part (without the coordinates' zeros); ``inertia`` solves with
    N(x) for every x in the box; ``middle`` and ``over`` enclose N and R as series.  What disturbed
    inputs add by the end is ``steady`` times numbers of size 1 at most, plus what ``rest`` pushes;
    ``steady`` (size, m) is exact, and None without disturbances.
    """

    radii: list[arb]
    rates: arb_mat
    push: list[arb]
    residue: list[arb]
    inertia: InertiaMatrix
    middle: Linearisation
    over: Linearisation
    rest: list[arb]
    steady: arb_mat | None = None


def comparison(rates: arb_mat, push: Sequence[arb], start: Sequence[arb], time: arb) -> list[arb]:
    """Bounds of y(time), y' = J y + k, y(0) = start, all entries being non-negative.

    The Taylor terms y_j of y obey y_{j+1} = J y_j / (j + 1) from the second on; the tail of the
    series is at most the geometric one in the norm of the largest entry.

    Raises:
        ZeroDivisionError: J time is too large for the series to be cut off.
    """
    size = len(push)
    scaled = rates * time
    term = scaled * column(start) + column(push) * time
    total = column(start) + term
    for j in range(2, COMPARISON_TERMS + 1):
        term = scaled * term * (arb(1) / j)
        total = total + term
    row_sums = [sum((abs(scaled[i, j]) for j in range(size)), arb(0)) for i in range(size)]
    ratio = _largest(row_sums) / (COMPARISON_TERMS + 1)
    if not ratio < 0.5:
        raise ZeroDivisionError("the comparison system grows too fast")
    tail = _largest([abs(term[i, 0]) for i in range(size)]) * ratio / (1 - ratio)
    return [(total[i, 0] + tail).upper() for i in range(size)]


def _largest(values: Sequence[arb]) -> arb:
    largest = arb(0)
    for value in values:
        largest = largest.max(value.upper())
    return largest


def deviation(field: VectorField, near: NearPath, degree: int) -> Deviation | None:
    """A validated box of deviations, or None.

    ``degree`` is that of the series by which N and R are enclosed, 0 for plain ranges.

    Raises:
        ZeroDivisionError: M may be singular on the box, or it grows too fast.
        UncertainSignError: an absolute value is not smooth enough for this degree.
    """
    radii = [
        item * FIRST_INFLATION + error for item, error in zip(near.start, _guess(near), strict=True)
    ]
    for _ in range(MOST_TRIALS):
        found = narrowed(field, near, [item.upper() for item in radii], degree)
        bound = comparison(found.rates, found.push, near.start, near.path.length)
        if not all(item.is_finite() for item in bound):
            return None
        if all(bool(b < r) for b, r in zip(bound, found.radii, strict=True)):
            return found
        wider = (b * FURTHER_INFLATION + LEAST_INFLATION for b in bound)
        radii = [b.max(r) for b, r in zip(wider, found.radii, strict=True)]
    return None


def _guess(near: NearPath) -> list[arb]:
    """What the defect may add at most, of a robot of ordinary inertia."""
    time = near.path.length
    worst = arb(0)
    for item in near.defect:
        worst = worst.max(item)
    size, n = len(near.start), len(near.path.middle.entries) - len(near.defect)
    rates = worst * time * DEFECT_INFLATION + LEAST_INFLATION
    return [rates * time if i < n else rates for i in range(size)]


def narrowed(field: VectorField, near: NearPath, radii: Sequence[arb], degree: int) -> Deviation:
    """J and k for a box; that it holds all deviations is not validated here.

    Raises:
        ZeroDivisionError: M may be singular on the box.
        UncertainSignError: an absolute value is not smooth enough for this degree.
    """
    n, inputs = field.dofs, near.drive.all
    middle, over = _series(field, near, radii, degree)
    half = near.path.length / 2
    inertia = InertiaMatrix(_range(middle.inertia, over.inertia, half))
    rates = _rates(field, inertia.solve(_range(middle.slopes, over.slopes, half)))
    residue = absolute(inertia.solve(both_signs(column(near.defect))))
    still = [arb(0)] * n
    if not near.drive.is_disturbed:
        pushed = still + [item.upper() for item in residue.entries()]
        return Deviation(
            list(radii), rates, pushed, residue.entries(), inertia, middle, over, pushed
        )
    state = [e[0] + SIGNS * r for e, r in zip(near.path.over.entries, radii, strict=True)]
    slopes = inertia.solve(field.input_slopes_over(state, inputs))
    size = column(near.drive.disturbance)
    push = residue + absolute(slopes) * size
    steady, rest = _steady(slopes, near, rates, residue, n)
    return Deviation(
        list(radii),
        rates,
        still + [item.upper() for item in push.entries()],
        residue.entries(),
        inertia,
        middle,
        over,
        rest,
        steady,
    )


def _steady(
    slopes: arb_mat, near: NearPath, rates: arb_mat, residue: arb_mat, dofs: int
) -> tuple[arb_mat, list[arb]]:
    """What disturbed inputs add that does not depend on when they differ, and bounds of the rest.

    Let G be ``slopes``, d the disturbance, G' the midpoint of G and w the integral of d.  Then
    z = e - G' w obeys z' = A z + A G' w + defect + (G - G') d with |w(t)| <= delta t.  Half of the
    largest |w| is enough: weights exp(J (H - t)) fall where it rises (Chebyshev's integral
    inequality).  So e(H) is what z gets to, plus G' w(H) with |w(H)| <= delta H: an image of a box,
    in which coordinates and rates go together, where a bound of |e| is a box.
    """
    length, size = near.path.length, column(near.drive.disturbance)
    middle = slopes.mid()
    none = arb_mat([[arb(0)] * middle.ncols() for _ in range(dofs)]) if dofs else None
    whole = middle if none is None else stacked(none, middle)
    pushed = residue + absolute(slopes - middle) * size
    moved = rates * (absolute(whole) * size) * (length / 2)
    rest = [item.upper() for item in moved.entries()]
    rest[dofs:] = [(a + b).upper() for a, b in zip(rest[dofs:], pushed.entries(), strict=True)]
    scales = [(item * length).upper() for item in near.drive.disturbance]
    columns = [[whole[i, j] * s for j, s in enumerate(scales)] for i in range(whole.nrows())]
    return arb_mat(columns), rest


def _series(
    field: VectorField, near: NearPath, radii: Sequence[arb], degree: int
) -> tuple[Linearisation, Linearisation]:
    """N and R about the middle (``degree`` coefficients), and about all of [0, H] (one more)."""
    found = []
    for expansion, length in ((near.path.middle, degree), (near.path.over, degree + 1)):
        if length == 0:
            found.append(Linearisation([], []))
            continue
        series = expansion.widened(radii).series(length)
        slopes = expansion.slopes(field.dofs, field.dofs, length)
        found.append(field.linearise(series, slopes, near.drive.all, length))
    return found[0], found[1]


def _range(middle: list[arb_mat], over: list[arb_mat], half: arb) -> arb_mat:
    """All values on [0, H] of a matrix given by its series."""
    degree = len(middle)
    last = absolute(over[degree]) * half**degree
    if degree == 0:
        return over[0]
    for j in range(1, degree):
        last = last + absolute(middle[j]) * half**j
    return middle[0] + both_signs(last)


def _rates(field: VectorField, lower: arb_mat) -> arb_mat:
    """J: entry by entry upper bounds of |A|, whose first rows say q' = v."""
    n, size = field.dofs, field.size
    rows = [[arb(int(j == n + i)) for j in range(size)] for i in range(n)]
    rows += [[abs(lower[i, j]).upper() for j in range(size)] for i in range(n + field.own)]
    return arb_mat(rows)


# --- How long a segment is tried: only a guess, which the validation accepts or refuses -----------


GRID = 4096
"""Segments begin and end at multiples of this part of a step."""
LEAST_PARTS, LEAST_ROUGH_PARTS = 8, 1
"""The shortest segments tried, in parts of the grid; of rough ones at kinks."""
SAFETY = 0.9
BACK_OFF = 0.7
LEAST_CAUTION, MOST_CAUTION = 0.25, 1.25
MOST_OF_RADIUS, LEAST_OF_RADIUS = 0.02, 1e-3
"""What the error of P may add to a set as a part of its radius, and what is too little."""
WIDE, MOST_OF_WIDE, WIDE_DEGREE = 1e-5, 1e-4, 5
"""Of sets as wide as this, whose radius counts against margins, less is allowed, and the box they
stay in is computed a second time, and closer."""
LEAST_EXCESS = 1e-30
LONGEST = 1e9
"""Seconds; where no coefficient says how long a segment may be."""
SPARSE = 1e-9
"""Coefficients so much smaller than their neighbours are those of a series without such powers."""
LEAST_ORDER = 4
WORK = 17.0, 0.9, 0.1
"""The work of a segment by its order k: constant, times k, times k^2 (series products)."""


@dataclass(slots=True)
class StepControl:
    """Lengths in parts of a step of ``dt`` seconds.

    ``caution`` is the length that was good over the one that its guess said, learned from what was
    accepted and refused.
    ``degree`` is that of the matrix polynomial P, as low as its error allows.
    """

    dt: float
    caution: float = 1.0
    degree: int = 2

    def learn_degree(self, radii: Sequence[arb], errors: Sequence[arb], order: int) -> None:
        """Learn from what is added to a set of these radii, other than by the flow."""
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
        """The length to try where ``rest`` of the step is left and ``guess`` seconds look good."""
        share = guess * self.caution / self.dt
        if share >= float(rest) * SAFETY:
            return rest
        count = ceil(float(rest) / share) if share > 0 else GRID
        return min(rest, Fraction(max(1, int(rest * GRID) // count), GRID))

    def learn(self, length: Fraction, guess: float, excess: float, order: int) -> float:
        """The share of a tried length that looks good, ``excess`` being error over tolerance.

        Of an excess of infinity nothing is known but that the length was too much.
        """
        if excess == float("inf"):
            self.caution = max(LEAST_CAUTION, self.caution * BACK_OFF)
            return 0.5
        share: float = SAFETY * max(excess, LEAST_EXCESS) ** (-1 / (order + 1))
        good = share * float(length) * self.dt / guess
        self.caution = min(MOST_CAUTION, max(LEAST_CAUTION, good, self.caution / 2))
        return share

    def shorter(self, length: Fraction, share: float, least: int) -> Fraction | None:
        """The next length to try after a refusal; None where ``least`` parts were too much."""
        parts = int(length * GRID * Fraction(min(0.8, max(0.2, share))))
        if parts < least < length * GRID:
            parts = least
        return Fraction(parts, GRID) if parts >= least else None


def good_length(rates: Sequence[Sequence[arb]], tolerance: float) -> float:
    """Seconds over which the first coefficient left out is about as large as the tolerance.

    ``rates`` are the Taylor coefficients of what is integrated.
    """
    lengths = [LONGEST]
    for entry in rates:
        order, left_out = len(entry) - 1, _left_out([abs(float(c)) for c in entry[-4:]])
        if left_out > 0:
            lengths.append((tolerance / (left_out * (order + 1))) ** (1 / (order + 1)))
    return min(lengths)


def _left_out(sizes: Sequence[float]) -> float:
    """About the first coefficient that is left out, by the last ones; 0 where they do not tell.

    Of a motion from rest every other one is zero but for rounding, and tells nothing.
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
    """Whether a Taylor polynomial has an order at which time is enclosed with least work.

    Called with its coefficients after each order, with those of the ``places`` coordinates first;
    ``wanted`` seconds are all that can be used.
    """

    places: int
    tolerance: float
    wanted: float
    paces: list[float] = field(default_factory=list)

    @property
    def order(self) -> int:
        """The order that the polynomial has got."""
        return LEAST_ORDER + max(0, len(self.paces) - 1)

    def __call__(self, x: Sequence[Sequence[arb]]) -> bool:
        """Whether another order is not worth its work."""
        order = len(x[0]) - 1
        if order < LEAST_ORDER:
            return False
        length = min(self.wanted, good_length(x[self.places :], self.tolerance))
        self.paces.append(length / (WORK[0] + WORK[1] * order + WORK[2] * order**2))
        last = len(self.paces) - 1
        return length >= self.wanted or (last >= 2 and self.paces[-1] < self.paces[-3])
