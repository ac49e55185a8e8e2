"""A priori enclosures: a box that no solution leaves during a step."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from flint import arb, arb_mat

from compiler.expressions.evaluators.balls import (
    SIGNS,
    absolute,
    beside,
    both_signs,
    column,
    diagonal,
    rows,
    stacked,
)
from solvers.verifier.proofs.linearisation import InertiaMatrix, Linearisation
from solvers.verifier.proofs.path import Path
from solvers.verifier.proofs.vector_field import VectorField

# --- A box that no solution leaves, by comparison of deviations -----------------------------------
#
# Let p be a path with defect rho, and x a solution for inputs u + d(t), d measurable with |d(t)| <=
# delta, from x(0) = p(0) + e(0), |e(0)| <= r.  By the mean value theorem along the homotopy
# (p + h e, u + h d), 0 <= h <= 1 (Clarke's generalised Jacobian at kinks),
#
# .. math::
#     \dot e_q = e_v, \qquad N(x)\,\dot e_w = R\,e + B\,d + \rho,
#
# where R and B lie in the hulls of the derivatives of (b - M a, d) in the state, at a = p_v', and
# in u, over the whole homotopy. As long as |e| <= E this is e' = A(t) e + c(t) with A, c
# measurable, |A| <= J, |c| <= k entry by entry, J and k non-negative bounds over p([0, H]) + E.
# Hence |e(t)| <= y(t) with y' = J y + k, y(0) = r: a linear cooperative comparison system (Walter,
# *Differential and integral inequalities*, 1970; Kapela & Zgliczynski, *A Lohner-type algorithm for
# control systems and ordinary differential inclusions*, 2009, theorem 4.1). If y(H) < E then e
# never reaches the boundary of E: if t were the first time that it does, then |e(t)| <= y(t) <=
# y(H) < E. So the solution exists on [0, H] and stays in p + E.


MOST_TRIALS = 6
COMPARISON_TERMS = 8
MOST_RATIO = 0.5
"""The terms of a series must shrink by at least this factor for it to be cut off."""
LEAST_WEIGHT, WEIGHT_ROUNDS = arb(2) ** -60, 3
FIRST_INFLATION, FURTHER_INFLATION = arb(1.25), arb(1.125)
DEFECT_INFLATION = 16
LEAST_INFLATION = arb(2) ** -200
"""A box needs an interior, even if nothing deviates."""


@dataclass(frozen=True, slots=True)
class Drive:
    """The stated inputs of a step, and how far the actual inputs may differ from them."""

    stated: list[arb]
    disturbance: list[arb]

    @property
    def is_disturbed(self) -> bool:
        """Whether the inputs may differ at all."""
        return not all(item == 0 for item in self.disturbance)

    @property
    def all(self) -> list[arb]:
        """Balls that hold all possible inputs."""
        return [u + SIGNS * d for u, d in zip(self.stated, self.disturbance, strict=True)]


@dataclass(frozen=True, slots=True)
class NearPath:
    """A path, bounds of its defect and of |e(0)|, and the inputs of solutions near it."""

    path: Path
    defect: list[arb]
    start: list[arb]
    drive: Drive


@dataclass(frozen=True, slots=True)
class LinearPart:
    """The linear part of the equation for deviations within a box, |e| <= E.

    ``rates`` is the bound J of |A|, shape (size, size); ``lower`` encloses A without its first
    rows; ``inertia`` solves with N(x) for every x in the box; ``middle`` and ``over`` enclose N and
    R as series.
    """

    rates: arb_mat
    lower: arb_mat
    inertia: InertiaMatrix
    middle: Linearisation
    over: Linearisation


@dataclass(frozen=True, slots=True)
class Steady:
    """What disturbed inputs add on [0, H].

    At H it is ``columns`` r (size, 3 m), all |r_j| <= 1, plus the response to ``rest``; ``reach``
    bounds the first part at every instant. For disturbances that stay at their bounds the first
    part is ``constant``.
    """

    columns: arb_mat
    constant: arb_mat
    reach: list[arb]
    rest: list[arb]


@dataclass(frozen=True, slots=True)
class Deviation:
    """How solutions deviate from a path on [0, H].

    ``radii`` is E; ``push`` is the bound k, and ``residue`` the part of it due to the defect
    (without the zeros of the coordinates). ``steady`` is what disturbed inputs add, None without
    disturbances.
    """

    radii: list[arb]
    linear: LinearPart
    push: list[arb]
    residue: list[arb]
    steady: Steady | None = None


def comparison(rates: arb_mat, push: Sequence[arb], start: Sequence[arb], time: arb) -> list[arb]:
    """Bounds of y(time), y' = J y + k, y(0) = start, with all entries non-negative.

    The Taylor terms y_j of y obey y_{j+1} = J y_j / (j + 1) from the second on. The tail of the
    series is at most the geometric one in the norm max |y_i| / w_i, for any w > 0: w = 1 or, if
    entries differ by orders of magnitude, as those of a shoulder and a wrist do, w near y itself.

    Raises:
        ZeroDivisionError: J time is too large for the series to be cut off.
    """
    scaled = rates * time
    term = scaled * column(start) + column(push) * time
    total = column(start) + term
    for j in range(2, COMPARISON_TERMS + 1):
        term = scaled * term * (arb(1) / j)
        total = total + term
    weights = [arb(1)] * len(push)
    ratio = _growth(scaled, weights)
    if not ratio < MOST_RATIO:
        weights = _weights(scaled, total)
        ratio = _growth(scaled, weights)
    if not ratio < MOST_RATIO:
        raise ZeroDivisionError("the comparison system grows too fast")
    sizes = [abs(x) / w for x, w in zip(term.entries(), weights, strict=True)]
    tail = _largest(sizes) * ratio / (1 - ratio)
    return [(x + w * tail).upper() for x, w in zip(total.entries(), weights, strict=True)]


def _growth(scaled: arb_mat, weights: Sequence[arb]) -> arb:
    """The factor by which the next term may exceed the last, in the norm with these weights."""
    moved = scaled * column(weights)
    ratios = [x / w for x, w in zip(moved.entries(), weights, strict=True)]
    return _largest(ratios) / (COMPARISON_TERMS + 1)


def _weights(scaled: arb_mat, total: arb_mat) -> list[arb]:
    """Weights near ``total``: what the matrix adds to an entry is at most of its order."""
    least = _largest(total.entries()) * LEAST_WEIGHT
    weights = column([item.upper().max(least) for item in total.entries()])
    for _ in range(WEIGHT_ROUNDS):
        weights = (weights + scaled * weights).mid()
    return [item if item > 0 else arb(1) for item in weights.entries()]


def _largest(values: Sequence[arb]) -> arb:
    largest = arb(0)
    for value in values:
        largest = largest.max(value.upper())
    return largest


def deviation(field: VectorField, near: NearPath, degree: int) -> Deviation | None:
    """A validated box of deviations, or None if none was found.

    ``degree`` is the degree of the series that enclose N and R, 0 for plain ranges.

    Raises:
        ZeroDivisionError: M may be singular on the box, or the comparison system grows too fast.
        UncertainSignError: an absolute value is not smooth enough for this degree.
    """
    radii = [
        item * FIRST_INFLATION + error for item, error in zip(near.start, _guess(near), strict=True)
    ]
    for _ in range(MOST_TRIALS):
        found = narrowed(field, near, [item.upper() for item in radii], degree)
        bound = comparison(found.linear.rates, found.push, near.start, near.path.length)
        if not all(item.is_finite() for item in bound):
            return None
        if all(bool(b < r) for b, r in zip(bound, found.radii, strict=True)):
            return found
        wider = (b * FURTHER_INFLATION + LEAST_INFLATION for b in bound)
        radii = [b.max(r) for b, r in zip(wider, found.radii, strict=True)]
    return None


def _guess(near: NearPath) -> list[arb]:
    """A first guess of what the defect may add, for a robot of ordinary inertia."""
    time = near.path.length
    worst = arb(0)
    for item in near.defect:
        worst = worst.max(item)
    size, n = len(near.start), len(near.path.middle.entries) - len(near.defect)
    rates = worst * time * DEFECT_INFLATION + LEAST_INFLATION
    return [rates * time if i < n else rates for i in range(size)]


def narrowed(field: VectorField, near: NearPath, radii: Sequence[arb], degree: int) -> Deviation:
    """J and k for a box; this does not validate that the box holds all deviations.

    Raises:
        ZeroDivisionError: M may be singular on the box.
        UncertainSignError: an absolute value is not smooth enough for this degree.
    """
    linear = linear_part(field, near, radii, degree)
    residue = absolute(linear.inertia.solve(both_signs(column(near.defect))))
    push = residue
    steady = None
    if near.drive.is_disturbed:
        slopes = linear.inertia.solve(input_slopes(field, near, radii))
        push = residue + absolute(slopes) * column(near.drive.disturbance)
        length = near.path.length
        steady = steady_part(slopes, near.drive.disturbance, length, linear, residue)
    pushed = [*[arb(0)] * field.dofs, *(item.upper() for item in push.entries())]
    return Deviation(list(radii), linear, pushed, residue.entries(), steady)


def input_slopes(field: VectorField, near: NearPath, radii: Sequence[arb]) -> arb_mat:
    """The Jacobian of (b, d) in u over a box of deviations, shape (n + r, m)."""
    state = [e[0] + SIGNS * r for e, r in zip(near.path.over.entries, radii, strict=True)]
    return field.input_slopes_over(state, near.drive.all)


def steady_part(
    slopes: arb_mat,
    bounds: Sequence[arb],
    length: arb,
    linear: LinearPart,
    residue: arb_mat,
) -> Steady:
    """What disturbed inputs add, split into two first moments of the disturbance and a rest.

    Let G be ``slopes``, d the disturbance, |d| <= ``bounds``, G' the midpoint of G, T near A G', w
    the integral of d, and W that of w.  Then z = e - G' w - T W obeys

        z' = A z + (A G' - T) w + A T W + defect + (G - G') d,

    |w(t)| <= ``bounds`` t and |W(t)| <= ``bounds`` t^2 / 2.  The means of these bounds are enough:
    weights exp(J (H - t)) fall where they rise (Chebyshev's integral inequality).  So e(H) is z(H)
    plus the image of a set that couples coordinates and rates, which a box around |e| would not:
    with |d| <= 1 and x = w(H) / H, W(H) = H w(H) / 2 + m H^2, |m| <= (1 - x^2) / 4, which is at
    most (1 - |x|) / 4 + 1 / 16.
    """
    size = column(bounds)
    dofs = linear.rates.nrows() - slopes.nrows()
    middle = slopes.mid()
    none = arb_mat(dofs, middle.ncols(), [arb(0)] * (dofs * middle.ncols()))
    direct = stacked(none, middle)
    turned = stacked(rows(direct, dofs, 2 * dofs), linear.lower * direct)
    turn = turned.mid()
    moved = absolute(turned - turn) * size * (length / 2)
    moved = moved + linear.rates * (absolute(turn) * size) * (length**2 / 6)
    rest = [item.upper() for item in moved.entries()]
    pushed = residue + absolute(slopes - middle) * size
    rest[dofs:] = [(a + b).upper() for a, b in zip(rest[dofs:], pushed.entries(), strict=True)]
    most = absolute(direct) * size * length + absolute(turn) * size * (length**2 / 2)
    constant = (direct + turn * (length / 2)) * diagonal([item * length for item in bounds])
    eighth = turn * diagonal([item * length**2 / 8 for item in bounds])
    half = constant * (arb(1) / 2)
    columns = beside(beside(half + eighth, half - eighth), eighth * (arb(1) / 2))
    return Steady(columns, constant, [item.upper() for item in most.entries()], rest)


def linear_part(
    field: VectorField, near: NearPath, radii: Sequence[arb], degree: int
) -> LinearPart:
    """N, R and |A| over a box of deviations.

    Raises:
        ZeroDivisionError: M may be singular on the box.
        UncertainSignError: an absolute value is not smooth enough for this degree.
    """
    middle, over = _series(field, near, radii, degree)
    half = near.path.length / 2
    inertia = InertiaMatrix(_range(middle.inertia, over.inertia, half))
    lower = inertia.solve(_range(middle.slopes, over.slopes, half))
    return LinearPart(_rates(field, lower), lower, inertia, middle, over)


def _series(
    field: VectorField, near: NearPath, radii: Sequence[arb], degree: int
) -> tuple[Linearisation, Linearisation]:
    """N and R about the middle (``degree`` coefficients), and about all of [0, H] (one more)."""
    found = []
    for expansion, length in ((near.path.middle, degree), (near.path.over, degree + 1)):
        if length == 0:
            found.append(Linearisation([], []))
            continue
        near_by = expansion.widened(radii).entries
        slopes = expansion.slopes(field.dofs, field.dofs, length)
        found.append(field.linearise(near_by, slopes, near.drive.all, length))
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
    rows += [[lower[i, j].abs_upper() for j in range(size)] for i in range(n + field.own)]
    return arb_mat(rows)
