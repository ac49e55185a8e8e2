"""Polynomial paths near solutions of a robot's equations of motion, and their defects."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import SupportsFloat

from flint import arb, arb_poly

from compiler.expressions.evaluators.balls import SIGNS
from solvers.verifier.proofs.linearisation import Coefficients
from solvers.verifier.proofs.vector_field import VectorField

# --- A polynomial path near a solution, and its defect --------------------------------------------
#
# The path p need not be a solution; any polynomials may be used.  Its accuracy shows in its defect
#
# .. math:: \rho(t) = F(p, u) - M(p)\,\dot p_v, \qquad \rho_s(t) = \sigma(p, u) - \dot p_s,
#
# while q' = v holds exactly by construction.  With its Taylor coefficients about the middle of [0,
# H], those below L at the middle and the L-th over the whole interval (Lagrange's remainder),
#
# .. math:: |\rho(t)| \le \sum_{j<L} |\rho_j| (H/2)^j + |\rho_L([0, H])| (H/2)^L .
#
# The path's coefficients are known numbers, so the last one needs a single pass over the equations.
# A Taylor method needs the solution's own coefficient over a box for its remainder (Nedialkov,
# Jackson & Corliss 1999); that would take L passes, and each of them widens the next.
#
# Source of defect control: Enright, *A new error-control for initial value solvers* (1989); here
# the defect is not sampled but enclosed.


@dataclass(frozen=True, slots=True)
class Expansion:
    """A path about an instant, or about a whole interval: coefficients per entry of the state.

    About an interval, those of entry i enclose the derivatives p_i^(j)(t) / j! at each t in it.
    """

    entries: tuple[Coefficients, ...]

    def slopes(self, first: int, count: int, length: int) -> list[Coefficients]:
        """The derivatives of ``count`` entries from ``first``, up to ``length`` coefficients."""
        return [
            [j * c for j, c in enumerate(entry[1 : length + 1], 1)]
            for entry in self.entries[first : first + count]
        ]

    def widened(self, radii: Sequence[arb]) -> Expansion:
        """The expansion of all paths p + e with constants |e_i| <= radii."""
        return Expansion(
            tuple(
                [entry[0] + SIGNS * radius, *entry[1:]]
                for entry, radius in zip(self.entries, radii, strict=True)
            )
        )


@dataclass(frozen=True, slots=True)
class Path:
    """Polynomials on [0, H]: exact coefficients of v and s, and those of q integrated from v.

    ``middle`` is their expansion about H/2, ``over`` the one about all of [0, H].
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
    enough: Callable[[Sequence[Sequence[SupportsFloat]]], bool] = lambda _: False,
) -> tuple[arb_poly, ...]:
    """The rounded Taylor polynomial of the solution through a point, with q' = v exactly.

    It has degree ``order`` in v, or a lower one as soon as its coefficients are ``enough``.

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

    The j-th changes by at most the sum of C(k, j) |c_k| half^(k - j) over k > j: the coefficients
    about ``half`` of the polynomial with coefficients |c_k|, minus |c_j|.
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

    ``avoidable`` is the fraction of them that a shorter path could avoid; the rest is due to balls
    of parameters and inputs, and to rounding.
    """

    bounds: list[arb]
    avoidable: float


def defect(field: VectorField, path: Path, u: Sequence[arb], length: int) -> Defect:
    """The defect of a path, from its first ``length`` coefficients and the remainder.

    Raises:
        UncertainSignError: an absolute value is not smooth enough for this ``length``.
    """
    half = path.length / 2
    middle = field.defect(path.middle.entries, u, length)
    over = field.defect(path.over.entries, u, length + 1)
    bounds, parts = [], [0.0]
    for near, far in zip(middle, over, strict=True):
        terms = [abs(near[j]) * half**j for j in range(length)]
        bound = sum(terms, abs(far[length]) * half**length).upper()
        bounds.append(bound)
        if bound > 0:
            parts.append(1 - float(2 * near[0].rad()) / float(bound))
    return Defect(bounds, max(parts))
