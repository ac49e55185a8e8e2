r"""The response to disturbances along a path within a segment, by moments of the disturbance.

Deviations obey N(t) e_w' = R(t) e + C d + c along the path, or e' = A e + G d + ..., G = N^{-1} C.
With w the integral of d, W that of w and V that of W, and any T, U,

.. math::
    z = e - G w - T W - U V
    \quad\text{obeys}\quad
    \dot z = A z + (A G - \dot G - T)\,w + (A T - \dot T - U)\,W + A U\,V + \dots,

so that with T near A G - G' and U near A T - T' the remainder is of third order in the length of
the segment.  Bounds are enough for it:

.. math:: |w| \le \bar d\,t, \quad |W| \le \bar d\,t^2 / 2, \quad |V| \le \bar d\,t^3 / 6 .
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

from flint import arb, arb_mat

from compiler.expressions.evaluators.balls import (
    absolute,
    beside,
    both_signs,
    column,
    diagonal,
    rows,
    stacked,
)
from solvers.verifier.proofs.a_priori import LinearPart, Steady, steady_part
from solvers.verifier.proofs.linearisation import InertiaMatrix

THIRD = 31
"""For |d(u)| <= 1 on 0 <= u <= 1, the integral of d(u) times (v^2 - 1/12) / 2, v = 1/2 - u, is at
most 1 / (18 sqrt 3), which is less than 1 / 31."""


@dataclass(frozen=True, slots=True)
class LinearSlice:
    """N, and A without its first rows, at all times of a part of a segment.

    ``since`` holds the times since the middle of the segment.
    """

    since: arb
    inertia: InertiaMatrix
    lower: arb_mat


def linear_slices(linear: LinearPart, half: arb, count: int) -> list[LinearSlice]:
    """The equation of deviations about a path on equal parts of a segment of length 2 ``half``.

    If there are no series of its coefficients, those of the whole segment are used.

    Raises:
        ZeroDivisionError: N may be singular.
    """
    ends = [half * (2 * k - count) / count for k in range(count + 1)]
    times = [first.union(last) for first, last in pairwise(ends)]
    if not linear.middle.inertia:
        return [LinearSlice(time, linear.inertia, linear.lower) for time in times]
    return [_slice(linear, time) for time in times]


def _slice(linear: LinearPart, since: arb) -> LinearSlice:
    inertia = InertiaMatrix(_value(*_powers(linear)[0], since))
    return LinearSlice(since, inertia, inertia.solve(_value(*_powers(linear)[1], since)))


def _powers(linear: LinearPart) -> tuple[tuple[list[arb_mat], arb_mat], ...]:
    """The coefficients of N and of R about the middle, with Lagrange's remainder as the last."""
    middle, over = linear.middle, linear.over
    return (middle.inertia, over.inertia[-1]), (middle.slopes, over.slopes[-1])


def _value(powers: Sequence[arb_mat], last: arb_mat, since: arb) -> arb_mat:
    total = last * since ** len(powers)
    for j, power in enumerate(powers):
        total = total + power * since**j
    return total


def _derivative(powers: Sequence[arb_mat], last: arb_mat, since: arb) -> arb_mat:
    """The derivative: its coefficients are j times those of the series, the remainder's too."""
    total = last * (len(powers) * since ** (len(powers) - 1))
    for j, power in enumerate(powers[1:], 1):
        total = total + power * (j * since ** (j - 1))
    return total


def _direct_and_turned(
    linear: LinearPart, part: LinearSlice, columns: arb_mat
) -> tuple[arb_mat, arb_mat]:
    """G with rows of zeros above, and A G - G', at all times of a slice."""
    dofs = linear.rates.nrows() - columns.nrows()
    none = arb_mat(dofs, columns.ncols(), [arb(0)] * (dofs * columns.ncols()))
    found = part.inertia.solve(columns)
    direct, turned = stacked(none, found), _times(part, stacked(none, found))
    change = _derivative(*_powers(linear)[0], part.since)
    return direct, turned + stacked(none, part.inertia.solve(change * found))


def _times(part: LinearSlice, columns: arb_mat) -> arb_mat:
    """A times columns."""
    dofs = columns.nrows() - part.lower.nrows()
    return stacked(rows(columns, dofs, 2 * dofs), part.lower * columns)


def response(
    columns: arb_mat,
    bounds: Sequence[arb],
    length: arb,
    linear: LinearPart,
    parts: Sequence[LinearSlice],
    residue: arb_mat,
) -> Steady:
    """What measurable disturbances |d| <= ``bounds`` (c,) add to deviations on [0, ``length``].

    With |d| <= 1, x = w(H) / H and W(H) = H^2 (x / 2 + m), V(H) = H^3 (x / 6 + m / 2 + r), where
    |m| <= (1 - x^2) / 4, which is at most (1 - |x|) / 4 + 1 / 16, and |r| < 1 / 31.

    Args:
        columns: C (n + r, c), at all times of the segment.
        bounds: the bounds of |d|.
        length: H, in seconds.
        linear: the equation of deviations.
        parts: the same equation on slices of the segment, in order.
        residue: a bound (n + r, 1) of all other terms, in the rows after the coordinates'.

    Raises:
        ZeroDivisionError: N may be singular.
    """
    if not linear.middle.inertia:
        return steady_part(linear.inertia.solve(columns), bounds, length, linear, residue)
    size, dofs, half = column(bounds), linear.rates.nrows() - columns.nrows(), length / 2
    middle = columns.mid()
    pairs = [_direct_and_turned(linear, part, middle) for part in parts]
    directs, turns = [direct for direct, _ in pairs], [turned for _, turned in pairs]
    # T = P + Q s in the time s since the middle: a line through its ends.
    first, last = parts[0].since.mid(), parts[-1].since.mid()
    begin, end = turns[0].mid(), turns[-1].mid()
    slope = ((end - begin) * (1 / (last - first)) if first < last else 0 * begin).mid()
    offset = (begin - slope * first).mid()
    lines = [offset + slope * part.since for part in parts]
    twice = [_times(part, line) - slope for part, line in zip(parts, lines, strict=True)]
    bend = ((twice[0] + twice[-1]) * (arb(1) / 2)).mid()
    off = _largest([turned - line for turned, line in zip(turns, lines, strict=True)])
    left = _largest([each - bend for each in twice])
    moved = off * size * half + left * size * (length**2 / 6)
    moved = moved + linear.rates * (absolute(bend) * size) * (length**3 / 24)
    unsure = both_signs(absolute(columns - middle) * size)
    pushed = residue + absolute(linear.inertia.solve(unsure))
    rest = [item.upper() for item in moved.entries()]
    rest[dofs:] = [(a + b).upper() for a, b in zip(rest[dofs:], pushed.entries(), strict=True)]
    most = _largest(directs) * size * length
    most = most + _largest(lines) * size * (length**2 / 2)
    most = most + absolute(bend) * size * (length**3 / 6)
    scale = diagonal(bounds)
    direct = _direct_and_turned(linear, _slice(linear, half), middle)[0] * scale * length
    turn = (offset + slope * half) * scale * length**2
    third = bend * scale * length**3
    constant = direct + turn * (arb(1) / 2) + third * (arb(1) / 6)
    eighth = (turn + third * (arb(1) / 2)) * (arb(1) / 8)
    halved = constant * (arb(1) / 2)
    found = beside(beside(halved + eighth, halved - eighth), eighth * (arb(1) / 2))
    reach = [item.upper() for item in most.entries()]
    return Steady(beside(found, third * (arb(1) / THIRD)), constant, reach, rest)


def _largest(matrices: Sequence[arb_mat]) -> arb_mat:
    """The largest absolute value of each entry."""
    found = absolute(matrices[0])
    for matrix in matrices[1:]:
        entries = zip(found.entries(), absolute(matrix).entries(), strict=True)
        found = arb_mat(found.nrows(), found.ncols(), [a.max(b) for a, b in entries])
    return found
