"""The vector field of a robot in balls and series, and paths near its solutions."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property

from flint import arb, arb_mat, arb_poly, arb_series, ctx

from compiler.dynamics.equations_of_motion import RobotGraph
from compiler.expressions.evaluators.balls import BALLS, SERIES, SIGNS
from compiler.expressions.tape import Tape, tape

# --------------------------------------------------------------------------------------------------
# A robot's equations of motion as a vector field on states, read in balls and in series of balls.
#
# .. math:: \dot q = v, \qquad M(q)\,\dot v = F(q, v, s, u), \qquad \dot s = \sigma(q, v, s, u)
#
# Linear systems are solved coefficient by coefficient with the constant term of M, preconditioned:
# far tighter than eliminating in series.


Coefficients = list[arb]


@dataclass(frozen=True, slots=True)
class Linearisation:
    """Series of N and R in time: N(t) de_w/dt = R(t) e for small deviations e of the state.

    N = diag(M, 1), shape (n + r, n + r), and R, shape (n + r, 2n + r), one matrix per power.
    """

    inertia: list[arb_mat]
    slopes: list[arb_mat]


@dataclass(frozen=True, slots=True)
class Curvature:
    """Second derivatives: ``places`` (i, j, k) of the outputs of a tape, j >= k; others are zero.

    That of output i of (b - M a, d) in the entries j and k of (q, v, s, a), at (q, v, s, a, u).
    ``slopes`` are what is not zero of their own first derivatives: (v, l) among ``slope_places``
    is that of value v in entry l.  None for large robots.
    """

    tape: Tape
    places: tuple[tuple[int, int, int], ...]
    slopes: Tape | None = None
    slope_places: tuple[tuple[int, int], ...] = ()

    @staticmethod
    def of(graph: RobotGraph) -> Curvature | None:
        """That of a robot; None where its second derivatives are not made."""
        second, third = graph.curvature, graph.curvature_slopes
        if second is None:
            return None
        if third is None:
            return Curvature(tape(second[0]), second[1])
        return Curvature(tape(second[0]), second[1], tape(third[0]), third[1])


@dataclass(frozen=True)
class VectorField:
    """q' = v, M(q) v' = b, s' = d with b, d of (q, v, s, u), as series with ball coefficients.

    ``balance`` gives M, b and d, ``variation`` the Jacobian of (b - M a, d) in (q, v, s) for given
    accelerations a, ``input_slopes`` that of (b, d) in u, which only disturbed inputs need;
    ``tail`` holds the balls of theta and k; s has ``own`` entries.
    """

    balance: Tape
    variation: Tape
    dofs: int
    tail: tuple[arb, ...]
    own: int = 0
    input_slopes: Tape | None = None
    curvature: Curvature | None = None

    @cached_property
    def has_kinks(self) -> bool:
        """Whether an absolute value occurs."""
        return self.balance.uses("fabs")

    @cached_property
    def _mass_matrix(self) -> Tape:
        return self.balance.first(self.dofs**2)

    @property
    def size(self) -> int:
        """The entries of a state."""
        return 2 * self.dofs + self.own

    def acceleration(self, state: Sequence[arb], u: Sequence[arb]) -> list[arb]:
        """Accelerations for a state given as balls.

        Raises:
            ZeroDivisionError: M may be singular there.
        """
        flat = self.balance.evaluate([*state, *u, *self.tail], BALLS)
        n = self.dofs
        mass = InertiaMatrix(self._square(flat[: n * n]))
        return mass.solve(arb_mat([[item] for item in flat[n * n : n * n + n]])).entries()

    def taylor(
        self,
        state: Sequence[arb],
        u: Sequence[arb],
        order: int,
        enough: Callable[[Sequence[Coefficients]], bool] = lambda _: False,
    ) -> list[Coefficients]:
        """Taylor coefficients 0 ... order of the solution through a state.

        Each pass of Picard's iteration on series fixes one more coefficient, until they are
        ``enough``.

        Raises:
            ZeroDivisionError: M may be singular on the state.
        """
        n = self.dofs
        x = [[item] for item in state]
        masses: list[arb_mat] = []
        pulls: list[arb_mat] = []
        mass: InertiaMatrix | None = None
        for length in range(1, order + 1):
            ctx.cap = length
            constants = [arb_series([item]) for item in (*u, *self.tail)]
            flat = self.balance.evaluate([*map(arb_series, x), *constants], SERIES)
            last = length - 1
            masses.append(self._square([item[last] for item in flat[: n * n]]))
            if mass is None:
                mass = InertiaMatrix(masses[0])
            right = arb_mat([[item[last]] for item in flat[n * n : n * n + n]])
            for m in range(1, length):
                right = right - masses[m] * pulls[last - m]
            pulls.append(mass.solve(right))
            for i in range(n):
                x[i].append(x[n + i][last] / length)
                x[n + i].append(pulls[last][i, 0] / length)
            for i in range(self.own):
                x[2 * n + i].append(flat[n * n + n + i][last] / length)
            if enough(x):
                break
        return x

    def defect(self, x: Sequence[arb_series], u: Sequence[arb], length: int) -> list[arb_series]:
        """The series of (b - M v', d - s') along a path x with q' = v, of ``length`` coefficients.

        Each series of x has one more coefficient, for its derivative.
        """
        n = self.dofs
        ctx.cap = length
        constants = [arb_series([item]) for item in (*u, *self.tail)]
        flat = self.balance.evaluate([*x, *constants], SERIES)
        rates = [item.derivative() for item in x[n:]]
        found = []
        for i in range(n):
            inertial = sum((flat[j * n + i] * rates[j] for j in range(n)), arb_series([]))
            found.append(flat[n * n + i] - inertial)
        return found + [flat[n * n + n + i] - rates[n + i] for i in range(self.own)]

    def linearise(
        self, x: Sequence[arb_series], a: Sequence[arb_series], u: Sequence[arb], length: int
    ) -> Linearisation:
        """The linearisation along a path with accelerations a, to ``length`` coefficients."""
        n, size, height = self.dofs, self.size, self.dofs + self.own
        ctx.cap = length
        constants = [arb_series([item]) for item in (*u, *self.tail)]
        masses = self._mass_matrix.evaluate([*x, *constants], SERIES)
        flat = self.variation.evaluate([*x, *a, *constants], SERIES)
        return Linearisation(
            [self._inertia([item[m] for item in masses[: n * n]], m) for m in range(length)],
            [
                arb_mat([[flat[j * height + i][m] for j in range(size)] for i in range(height)])
                for m in range(length)
            ],
        )

    def input_slopes_over(self, state: Sequence[arb], u: Sequence[arb]) -> arb_mat:
        """The Jacobian of (b, d) in u on a box, shape (n + r, m).

        Raises:
            ValueError: the field has no slopes in its inputs.
        """
        if self.input_slopes is None:
            raise ValueError("disturbed inputs need the slopes of the field in its inputs")
        flat = self.input_slopes.evaluate([*state, *u, *self.tail], BALLS)
        height = self.dofs + self.own
        return arb_mat([[flat[j * height + i] for j in range(len(u))] for i in range(height)])

    def _square(self, flat: Sequence[arb]) -> arb_mat:
        """A symmetric matrix from its entries, column by column."""
        n = self.dofs
        return arb_mat([[flat[j * n + i] for j in range(n)] for i in range(n)])

    def _inertia(self, flat: Sequence[arb], power: int) -> arb_mat:
        """The coefficient of diag(M, 1) at a power of time."""
        n, height = self.dofs, self.dofs + self.own
        one = arb(0) if power else arb(1)
        return arb_mat(
            [
                [
                    flat[j * n + i] if i < n and j < n else one if i == j else arb(0)
                    for j in range(height)
                ]
                for i in range(height)
            ]
        )


class InertiaMatrix:
    """Solves systems with one interval matrix, preconditioned by the inverse of its midpoint."""

    def __init__(self, matrix: arb_mat) -> None:
        self._inverse = matrix.mid().inv().mid()
        self._near_identity = self._inverse * matrix

    def solve(self, right: arb_mat) -> arb_mat:
        """An enclosure of all solutions; ZeroDivisionError if the matrix may be singular."""
        return self._near_identity.solve(self._inverse * right, algorithm="lu")


# --- A polynomial path near a solution, and how far it is from being one --------------------------
#
# The path p need not be a solution: any polynomials will do.  What decides is its defect
#
# .. math:: \rho(t) = F(p, u) - M(p)\,\dot p_v, \qquad \rho_s(t) = \sigma(p, u) - \dot p_s,
#
# while q' = v holds exactly by construction.  With its Taylor coefficients about the middle of [0,
# H], those below L at the middle and the L-th over the whole interval (Lagrange's remainder),
#
# .. math:: |\rho(t)| \le \sum_{j<L} |\rho_j| (H/2)^j + |\rho_L([0, H])| (H/2)^L .
#
# The path's coefficients are known numbers, so that the last one needs a single pass over the
# equations; the solution's own coefficient over a box, which the remainder of a Taylor method asks
# for (Nedialkov, Jackson & Corliss 1999), would need L of them, each of which widens the next.
#
# Source of defect control: Enright, *A new error-control for initial value solvers* (1989); here
# the defect is not sampled but enclosed.


@dataclass(frozen=True, slots=True)
class Expansion:
    """A path about an instant, or about all of an interval: coefficients per entry of the state.

    Those of entry i about an interval enclose the derivatives p_i^(j)(t) / j! at each t in it.
    """

    entries: tuple[Coefficients, ...]

    def series(self, length: int) -> list[arb_series]:
        """The entries, to so many coefficients."""
        ctx.cap = length
        return [arb_series(entry[:length]) for entry in self.entries]

    def slopes(self, first: int, count: int, length: int) -> list[arb_series]:
        """The derivatives of ``count`` entries from ``first``, to so many coefficients."""
        ctx.cap = length
        return [
            arb_series([j * c for j, c in enumerate(entry[1 : length + 1], 1)])
            for entry in self.entries[first : first + count]
        ]

    def widened(self, radii: Sequence[arb]) -> Expansion:
        """With the constant coefficients widened: all paths p + e with constants |e_i| <= radii."""
        return Expansion(
            tuple(
                [entry[0] + SIGNS * radius, *entry[1:]]
                for entry, radius in zip(self.entries, radii, strict=True)
            )
        )


@dataclass(frozen=True, slots=True)
class Path:
    """Polynomials on [0, H]: exact coefficients of v and s, and those of q integrated from v.

    ``middle`` is their expansion about H/2, ``over`` that about all of [0, H].
    """

    polynomials: tuple[arb_poly, ...]
    length: arb
    middle: Expansion
    over: Expansion

    def at(self, time: arb) -> list[arb]:
        """The path at an instant."""
        return [polynomial(time) for polynomial in self.polynomials]

    def about(self, centre: arb, half: arb) -> Expansion:
        """The expansion about all times within ``half`` of a ``centre``."""
        shifted = [p(arb_poly([centre, 1])).coeffs() or [arb(0)] for p in self.polynomials]
        return Expansion(tuple(over_interval(entry, half) for entry in shifted))


def taylor_polynomials(
    field: VectorField,
    state: Sequence[arb],
    u: Sequence[arb],
    order: int,
    enough: Callable[[Sequence[Coefficients]], bool] = lambda _: False,
) -> tuple[arb_poly, ...]:
    """The rounded Taylor polynomial of the solution through a point, with q' = v exactly.

    Of degree ``order`` in v, or lower once its coefficients are ``enough``.

    Raises:
        ZeroDivisionError: M may be singular there.
        UncertainSignError: an absolute value has its kink there.
    """
    n = field.dofs
    x = field.taylor(state, u, order, enough)
    exact = [[item.mid() for item in entry] for entry in x[n:]]
    places = [
        [x[i][0], *(c / j for j, c in enumerate(exact[i], 1))]
        for i in range(n)
    ]  # fmt: skip
    return tuple(arb_poly(entry) for entry in (*places, *exact))


def path_on(polynomials: Sequence[arb_poly], length: arb) -> Path:
    """The path on [0, length], an exact length."""
    half = length / 2
    shifted = [p(arb_poly([half, 1])).coeffs() or [arb(0)] for p in polynomials]
    most = max(map(len, shifted))
    middle = [[*entry, *[arb(0)] * (most - len(entry))] for entry in shifted]
    return Path(
        tuple(polynomials),
        length,
        Expansion(tuple(middle)),
        Expansion(tuple(over_interval(entry, half) for entry in middle)),
    )


def over_interval(coefficients: Coefficients, half: arb) -> Coefficients:
    """Enclosures of the Taylor coefficients of a polynomial about every s with |s| <= half.

    The j-th is off by at most the sum of C(k, j) |c_k| half^(k - j) over k > j, which are the
    coefficients about ``half`` of the polynomial of the |c_k|, less their own.
    """
    sizes = [c.abs_upper() for c in coefficients]
    most = arb_poly(sizes)(arb_poly([half, 1])).coeffs()
    most += [arb(0)] * (len(sizes) - len(most))
    return [
        centre + SIGNS * (bound - size).upper()
        for centre, bound, size in zip(coefficients, most, sizes, strict=True)
    ]


@dataclass(frozen=True, slots=True)
class Defect:
    """Bounds of |rho| on [0, H], an entry per rate and per own state.

    ``avoidable`` is the part of them that a shorter path could avoid, the rest being due to balls
    of parameters and inputs, and to rounding.
    """

    bounds: list[arb]
    avoidable: float


def defect(field: VectorField, path: Path, u: Sequence[arb], length: int) -> Defect:
    """The defect of a path by its ``length`` first coefficients and the remainder.

    Raises:
        UncertainSignError: an absolute value is not smooth enough for this ``length``.
    """
    half = path.length / 2
    middle = field.defect(path.middle.series(length + 1), u, length)
    over = field.defect(path.over.series(length + 2), u, length + 1)
    bounds, parts = [], [0.0]
    for near, far in zip(middle, over, strict=True):
        terms = [abs(near[j]) * half**j for j in range(length)]
        bound = sum(terms, abs(far[length]) * half**length).upper()
        bounds.append(bound)
        if bound > 0:
            parts.append(1 - float(2 * near[0].rad()) / float(bound))
    return Defect(bounds, max(parts))
