r"""Validated integration: an enclosure of the continuous-time solution at every instant.

Per step, from a box [x] with midpoint m: a box W that is mapped into itself by the Taylor
polynomial with Lagrange's remainder over W (a high-order Picard-Lindelof argument: the solution
exists and stays in W), and the mean value form

.. math::
    x(t) \in \sum_{j<N} \bigl(x_j(m) + \partial x_j([x])\,([x] - m)\bigr)\, t^j + x_N(W)\, t^N,
    \qquad 0 \le t \le h,

whose Jacobian keeps the dependency between the coordinates of the box.

Source: Nedialkov, Jackson & Corliss, *Validated solutions of initial value problems for ordinary
differential equations* (1999), sections 3-6, in ball arithmetic.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction

from flint import arb, arb_mat, arb_series, ctx

from compiler.arithmetic.balls import BallArithmetic, SeriesArithmetic, UncertainSignError
from compiler.dynamics.tape import Tape

Coefficients = list[arb]

MOST_HALVINGS = 9
KINK_HALVINGS, KINK_REMAINDER = 12, 1e-6
"""Where an absolute value has a kink, shorter segments of order two may be less accurate."""


class EnclosureFailure(ArithmeticError):
    """No enclosure could be validated beyond a time."""


@dataclass(frozen=True, slots=True)
class TubeSegment:
    """The solution on [start, start + length] as polynomials with ball coefficients.

    ``states[i]`` holds the coefficients of entry i of the state (coordinates, rates, modules' own
    states) in the time since ``start``.  ``steps`` holds the exact ends of the segment in units of
    the step.
    """

    start: arb
    length: arb
    steps: tuple[Fraction, Fraction]
    states: tuple[Coefficients, ...]
    end: tuple[arb, ...]

    @property
    def number(self) -> int:
        """The number of the input in force, from 0."""
        return int(self.steps[0])

    def at(self, tau: arb) -> list[arb]:
        """The state ``tau`` after the start; a ball of times gives an enclosure over it."""
        return [polynomial(coefficients, tau) for coefficients in self.states]


def polynomial(coefficients: Sequence[arb], tau: arb) -> arb:
    """Horner's rule."""
    value = arb(0)
    for coefficient in reversed(coefficients):
        value = value * tau + coefficient
    return value


@dataclass(frozen=True, slots=True)
class VectorField:
    """q' = v, M(q) v' = b, s' = d with b, d of (q, v, s, u), as series with ball coefficients.

    ``balance`` gives M, b and d, ``variation`` the Jacobian of (b - M a, d) in (q, v, s) for the
    variational equation; ``tail`` holds the balls of theta and k; s has ``own`` entries.  The
    linear systems are solved coefficient by coefficient with the constant term of M,
    preconditioned: far tighter than eliminating in series.
    """

    balance: Tape
    variation: Tape
    dofs: int
    tail: tuple[arb, ...]
    own: int = 0

    @property
    def has_kinks(self) -> bool:
        """Whether an absolute value occurs."""
        return any(name == "fabs" for name, _, _ in self.balance.instructions)

    def acceleration(self, state: Sequence[arb], u: Sequence[arb]) -> list[arb]:
        """Accelerations for a state given as balls.

        Raises:
            ZeroDivisionError: M may be singular there.
        """
        flat = self.balance.run([*state, *u, *self.tail], BallArithmetic())
        mass = _Mass(self._square(flat[: self.dofs**2]))
        forces = flat[self.dofs**2 : self.dofs**2 + self.dofs]
        return mass.solve(arb_mat([[item] for item in forces])).entries()

    def taylor(self, state: Sequence[arb], u: Sequence[arb], order: int) -> list[Coefficients]:
        """Taylor coefficients 0 ... order of the solution through a state.

        Each pass of Picard's iteration on series fixes one more coefficient.

        Raises:
            ZeroDivisionError: M may be singular on the state.
        """
        x = [[item] for item in state]
        self._extend(x, u, order)
        return x

    def jacobians(
        self, state: Sequence[arb], u: Sequence[arb], order: int
    ) -> list[list[Coefficients]]:
        """Taylor coefficients of the derivative of the solution in its initial state.

        Entry [i][j] belongs to the derivative of state i in initial state j.

        Raises:
            ZeroDivisionError: M may be singular on the state.
        """
        n, size, height = self.dofs, 2 * self.dofs + self.own, self.dofs + self.own
        x = [[item] for item in state]
        mass, masses, pulls = self._extend(x, u, order)
        slopes: list[arb_mat] = []
        s = [[[arb(1 if i == j else 0)] for j in range(size)] for i in range(size)]
        ctx.cap = order
        inputs = [arb_series(item) for item in (*x, *pulls)]
        out = self.variation.run(
            [*inputs, *(arb_series([item]) for item in (*u, *self.tail))], SeriesArithmetic()
        )
        table = [
            [[series[m] for series in out[i::height]] for i in range(height)] for m in range(order)
        ]
        blocks = [arb_mat(rows[:n]) for rows in table]
        own_blocks = [arb_mat(rows[n:]) for rows in table] if self.own else []
        grown: list[arb_mat] = []
        for length in range(1, order + 1):
            last = length - 1
            grown.append(arb_mat([[entry[last] for entry in row] for row in s]))
            right = blocks[0] * grown[last]
            for m in range(1, length):
                right = right + blocks[m] * grown[last - m] - masses[m] * slopes[last - m]
            slopes.append(mass.solve(right))
            own = arb_mat(self.own, size)
            for block, earlier in zip(own_blocks, reversed(grown), strict=False):
                own = own + block * earlier
            for j in range(size):
                for i in range(n):
                    s[i][j].append(s[n + i][j][last] / length)
                    s[n + i][j].append(slopes[last][i, j] / length)
                for i in range(self.own):
                    s[2 * n + i][j].append(own[i, j] / length)
        return s

    def _extend(
        self, x: list[Coefficients], u: Sequence[arb], order: int
    ) -> tuple[_Mass, list[arb_mat], list[Coefficients]]:
        """Append coefficients up to ``order``; also M factorised, its series and accelerations."""
        n = self.dofs
        arithmetic = SeriesArithmetic()
        mass: _Mass | None = None
        masses: list[arb_mat] = []
        pulls: list[arb_mat] = []
        for length in range(1, order + 1):
            ctx.cap = length
            constants = [arb_series([item]) for item in (*u, *self.tail)]
            flat = self.balance.run([*(arb_series(item) for item in x), *constants], arithmetic)
            last = length - 1
            masses.append(self._square([item[last] for item in flat[: n * n]]))
            if mass is None:
                mass = _Mass(masses[0])
            right = arb_mat([[item[last]] for item in flat[n * n : n * n + n]])
            for m in range(1, length):
                right = right - masses[m] * pulls[last - m]
            pulls.append(mass.solve(right))
            for i in range(n):
                x[i].append(x[n + i][last] / length)
                x[n + i].append(pulls[last][i, 0] / length)
            for i in range(self.own):
                x[2 * n + i].append(flat[n * n + n + i][last] / length)
        if mass is None:
            raise ValueError("an order of at least 1 is due")
        return mass, masses, [[pull[i, 0] for pull in pulls] for i in range(n)]

    def _square(self, flat: Sequence[arb]) -> arb_mat:
        """A symmetric matrix from its entries, column by column."""
        n = self.dofs
        return arb_mat([[flat[j * n + i] for j in range(n)] for i in range(n)])


class _Mass:
    """Solves systems with one interval matrix, preconditioned by the inverse of its midpoint."""

    def __init__(self, matrix: arb_mat) -> None:
        self._inverse = matrix.mid().inv().mid()
        self._near_identity = self._inverse * matrix

    def solve(self, right: arb_mat) -> arb_mat:
        """An enclosure of all solutions; ZeroDivisionError if the matrix may be singular."""
        return self._near_identity.solve(self._inverse * right, algorithm="lu")


def _span(h: arb) -> arb:
    """A ball that contains [0, h] for every value of h."""
    return arb(0).union(h)


def _remainder(
    field: VectorField, known: Sequence[Coefficients], u: Sequence[arb], h: arb, order: int
) -> list[arb] | None:
    """x_N(W) for a validated box W, or None.

    If P([0, h]) + [0, h]^N x_N(W) lies inside W, the solution exists on [0, h] and stays in W.
    """
    span = _span(h)
    reach = [polynomial(coefficients, span) for coefficients in known]
    box = [r + arb(0, 1) * (r.rad() / 32 + arb(2) ** -40) for r in reach]
    for _ in range(3):
        last = [coefficients[order] for coefficients in field.taylor(box, u, order)]
        rest = [coefficient * span**order for coefficient in last]
        if not all(r.is_finite() for r in rest):
            return None
        image = [r + e for r, e in zip(reach, rest, strict=True)]
        if all(w.contains_interior(i) for w, i in zip(box, image, strict=True)):
            return last
        box = [i + arb(0, 1) * (i.rad() / 8) for i in image]
    return None


@dataclass(frozen=True, slots=True)
class Accuracy:
    """Taylor order, working bits, and the remainder a segment may add to a coordinate or rate."""

    order: int
    bits: int
    remainder: float


def _segment(
    field: VectorField,
    start: arb,
    steps: tuple[Fraction, Fraction],
    state: Sequence[arb],
    u: Sequence[arb],
    h: arb,
    accuracy: Accuracy,
) -> TubeSegment | None:
    """A validated segment of length h, or None if none was found."""
    order = accuracy.order
    middle = [item.mid() for item in state]
    offset = [item - m for item, m in zip(state, middle, strict=True)]
    try:
        at_middle = field.taylor(middle, u, order - 1)
        slopes = field.jacobians(state, u, order - 1)
        known = [
            [
                centre + _dot([entry[j] for entry in row], offset)
                for j, centre in enumerate(coefficients)
            ]
            for coefficients, row in zip(at_middle, slopes, strict=True)
        ]
        last = _remainder(field, known, u, h, order)
    except UncertainSignError:
        if order <= 2:
            return None
        rough = Accuracy(2, accuracy.bits, max(accuracy.remainder, KINK_REMAINDER))
        return _segment(field, start, steps, state, u, h, rough)
    except (ZeroDivisionError, ValueError):
        # A denominator's ball contains zero: the box is too wide, not the robot at fault.
        return None
    if last is None:
        return None
    rest = [coefficient * h**order for coefficient in last]
    if not all(item.rad() <= accuracy.remainder for item in rest):
        return None
    end = tuple(
        polynomial(coefficients, h) + _dot([polynomial(entry, h) for entry in row], offset) + error
        for coefficients, row, error in zip(at_middle, slopes, rest, strict=True)
    )
    states = tuple([*k, coefficient] for k, coefficient in zip(known, last, strict=True))
    return TubeSegment(start, h, steps, states, end)


def _dot(left: Sequence[arb], right: Sequence[arb]) -> arb:
    return sum((a * b for a, b in zip(left, right, strict=True)), arb(0))


def tube(
    field: VectorField,
    state: Sequence[arb],
    inputs: Sequence[Sequence[arb]],
    dt: arb,
    accuracy: Accuracy,
) -> Iterator[TubeSegment]:
    """The validated solution under inputs held for ``dt`` each, segment by segment.

    A segment that cannot be validated, or whose remainder is too large, is halved, a fixed number
    of times at most; the next input starts one halving above where the last one ended.

    Raises:
        EnclosureFailure: a segment has no validated enclosure however short.
    """
    start, first = arb(0), Fraction(0)
    level = 0
    for u in inputs:
        level = max(0, level - 1)
        pending = [(dt / 2**level, level)] * 2**level
        while pending:
            h, level = pending.pop()
            steps = first, first + Fraction(1, 2**level)
            segment = _segment(field, start, steps, state, u, h, accuracy)
            if segment is not None:
                yield segment
                state, start, first = segment.end, start + h, steps[1]
            elif level < (KINK_HALVINGS if field.has_kinks else MOST_HALVINGS):
                pending += [(h / 2, level + 1)] * 2
            else:
                time = float(start.mid())
                raise EnclosureFailure(f"no enclosure of the motion beyond {time:.4g} s")
