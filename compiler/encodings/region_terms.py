"""Real terms of an SMT script, and conditions on points and segments relative to regions."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from typing import TypeAlias

from flint import arb

from compiler.expressions.evaluators.balls import ball
from compiler.expressions.exact_numbers import GRID, outward
from compiler.workspaces.polytope import Polytope
from grammar_lang import ir

# --- Points and segments relative to convex regions, as formulas about their coordinates ----------
#
# Touching counts as inside a region and as clear of an obstacle, so each formula is necessary for
# the strict condition. A segment and a convex polygon have disjoint interiors iff the line of one
# of the polygon's edges separates them, or the segment's own line does (the separating axis theorem
# for their Minkowski difference, whose edges are edges of either).
#
# Source: de Berg, Cheong, van Kreveld & Overmars, *Computational Geometry*, section 13.3.


FAR = Fraction(10**6)
"""The distance in metres at which an unbounded obstacle is cut off."""


@dataclass(frozen=True, slots=True)
class PolygonTerms:
    """A convex polygon by the rows of its edges and its vertices, exact."""

    rows: tuple[ir.HalfSpace, ...]
    vertices: tuple[tuple[Fraction, ...], ...]


def polygon_terms(polygon: Polytope) -> PolygonTerms | None:
    """The polygon without rows that define no edge; None if it is empty."""
    if polygon.is_empty:
        return None
    if not polygon.is_bounded:
        ends = ((1, 0), (-1, 0), (0, 1), (0, -1))
        box = tuple(ir.HalfSpace((Fraction(x), Fraction(y)), FAR) for x, y in ends)
        polygon = polygon.intersection(Polytope(box))
        if polygon.is_empty:
            return None
    rows = tuple(row for row in polygon.rows if any(row.normal))
    if polygon.has_interior:
        rows = tuple(polygon.rows[i] for i in polygon.facets)
    return PolygonTerms(rows, polygon.vertices)


def inside(row: ir.HalfSpace, position: Sequence[Quantity]) -> Formula:
    """A point satisfies a half-space, written without negative factors."""
    terms = [(a, multiply(constant(abs(a)), x)) for a, x in zip(row.normal, position, strict=True)]
    left = [term for a, term in terms if a > 0]
    right = [term for a, term in terms if a < 0]
    (right if left else left).append(constant(row.offset if left else -row.offset))
    return at_most(add(*left), add(*right))


def beyond(row: ir.HalfSpace, position: Sequence[Quantity]) -> Formula:
    """A point is on the boundary of a half-space or outside."""
    return inside(ir.HalfSpace(tuple(-a for a in row.normal), -row.offset), position)


def point_clear(polygon: PolygonTerms, point: Sequence[Quantity]) -> Formula:
    """A point is not in the interior of a polygon."""
    return any_of([beyond(row, point) for row in polygon.rows])


def segment_clear(
    polygon: PolygonTerms, ends: Sequence[Sequence[Quantity]], line: Sequence[Quantity]
) -> Formula:
    """A segment has no point in the interior of a polygon.

    ``line`` is (u_x, u_y, m): a direction of the segment, and m = u_x a_y - u_y a_x of a point a on
    its line. The sign of u_x v_y - u_y v_x - m says on which side of it a vertex v lies.
    """
    edges = [all_of([beyond(row, end) for end in ends]) for row in polygon.rows]
    x, y, moment = line
    sides = []
    for sign in (1, -1):
        parts = []
        for vertex in polygon.vertices:
            ahead, across = (multiply(constant(sign * value), q)
                             for value, q in zip(vertex[::-1], (x, y), strict=True))  # fmt: skip
            opposite = multiply(constant(sign), moment)
            parts.append(at_most(add(opposite, across), ahead))
        sides.append(all_of(parts))
    return any_of([*edges, *sides])


# --------------------------------------------------------------------------------------------------
# Real terms with the balls that contain them, and the SMT-LIB 2 script in which they are asserted.
#
# Source: Barrett, Fontaine & Tinelli, *The SMT-LIB Standard, version 2.6* (logic QF_NRA). Terms are
# written directly: pySMT loads z3 when it is imported, and the verifier, which writes every script
# again, loads no solver. Constants are folded exactly.


NARROW = 4  # grid steps
TRUE, FALSE = "true", "false"

Formula: TypeAlias = str


@dataclass(frozen=True, slots=True)
class Quantity:
    """``factor * core``, where the core is an SMT-LIB term (None for one), and a ball around it."""

    factor: Fraction
    core: str | None
    ball: arb = field(compare=False)

    @property
    def value(self) -> Fraction | None:
        """The value if it is a constant, else None."""
        return self.factor if self.core is None else None

    @property
    def text(self) -> str:
        """The SMT-LIB term."""
        if self.core is None:
            return numeral(self.factor)
        if self.factor == 1:
            return self.core
        return (
            f"(- {self.core})" if self.factor == -1 else f"(* {numeral(self.factor)} {self.core})"
        )

    @property
    def is_leaf(self) -> bool:
        """Whether it is a constant or a multiple of a symbol."""
        return self.core is None or not self.core.startswith("(")


@dataclass(slots=True)
class RealScript:
    """A growing QF_NRA script; every symbol is declared once, in order of use."""

    lines: list[str] = field(default_factory=list[str])
    _counts: dict[str, int] = field(default_factory=dict[str, int])

    # --- the script ---

    def comment(self, text: str) -> None:
        """Add comment lines."""
        self.lines += [f"; {line}" for line in text.splitlines()]

    def assertion(self, *formulas: Formula) -> None:
        """Assert each formula that is not trivially true."""
        self.lines += [f"(assert {formula})" for formula in formulas if formula != TRUE]

    def declare(self, name: str, enclosure: arb | None = None) -> Quantity:
        """A new symbol; its ball, by default all numbers, must follow from what is asserted."""
        self.lines.append(f"(declare-fun {name} () Real)")
        whole = arb(0, float("inf"))
        return Quantity(Fraction(1), name, whole if enclosure is None else enclosure)

    def fresh(self, prefix: str, enclosure: arb | None = None) -> Quantity:
        """A new symbol, numbered from 1 within its prefix."""
        self._counts[prefix] = self._counts.get(prefix, 0) + 1
        return self.declare(f"{prefix}{self._counts[prefix]}", enclosure)

    def number(self, enclosure: arb) -> Quantity | None:
        """A symbol within a ball, if the ball is narrow enough for a number; else None.

        A known irrational number costs the solver less as an interval than as a root.
        """
        bounds = outward(enclosure)
        if bounds is None or bounds[1] - bounds[0] > Fraction(NARROW, GRID):
            return None
        symbol = self.fresh("k", enclosure)
        self.assertion(*between(bounds, symbol))
        return symbol

    def named(self, prefix: str, quantity: Quantity) -> Quantity:
        """A symbol asserted equal to a quantity; constants and multiples of symbols are unchanged.

        This keeps the script linear in the size of shared expressions.
        """
        if quantity.is_leaf:
            return quantity
        number = self.number(quantity.ball)
        if number is not None:
            return number
        symbol = self.fresh(prefix, quantity.ball)
        self.assertion(equal(symbol, quantity))
        return symbol


# --- terms ---------------------------------------------------------------------------------------


def numeral(value: Fraction) -> str:
    """A rational as an SMT-LIB term."""
    size = abs(value)
    whole = size.denominator == 1
    text = f"{size.numerator}.0" if whole else f"(/ {size.numerator} {size.denominator})"
    return text if value >= 0 else f"(- {text})"


def constant(value: Fraction | int) -> Quantity:
    """A rational."""
    return Quantity(Fraction(value), None, ball(value))


def add(*quantities: Quantity) -> Quantity:
    """A sum; zeros are dropped and constants are combined."""
    known = sum((q.value for q in quantities if q.value is not None), Fraction(0))
    parts = [q for q in quantities if q.value is None]
    if known or not parts:
        parts.append(constant(known))
    if len(parts) == 1:
        return parts[0]
    text = " ".join(part.text for part in parts)
    return Quantity(Fraction(1), f"(+ {text})", sum((q.ball for q in parts), arb(0)))


def multiply(left: Quantity, right: Quantity) -> Quantity:
    """A product; constant factors are combined."""
    factor = left.factor * right.factor
    cores = [core for core in (left.core, right.core) if core is not None]
    if not factor or not cores:
        return constant(factor)
    core = cores[0] if len(cores) == 1 else f"(* {cores[0]} {cores[1]})"
    return Quantity(factor, core, left.ball * right.ball)


def negate(quantity: Quantity) -> Quantity:
    """The negation."""
    return Quantity(-quantity.factor, quantity.core, -quantity.ball)


def subtract(left: Quantity, right: Quantity) -> Quantity:
    """A difference."""
    return add(left, negate(right))


def sum_of_squares(quantities: Sequence[Quantity]) -> Quantity:
    """The squared norm of a vector."""
    return add(*(multiply(q, q) for q in quantities))


# --- formulas ------------------------------------------------------------------------------------


def equal(left: Quantity, right: Quantity) -> Formula:
    """``left = right``, decided if both are constants."""
    if left.value is not None and right.value is not None:
        return TRUE if left.value == right.value else FALSE
    return f"(= {left.text} {right.text})"


def at_most(left: Quantity, right: Quantity) -> Formula:
    """``left <= right``, decided if both are constants."""
    if left.value is not None and right.value is not None:
        return TRUE if left.value <= right.value else FALSE
    return f"(<= {left.text} {right.text})"


def non_negative(quantity: Quantity) -> Formula:
    """``0 <= quantity``."""
    return at_most(constant(0), quantity)


def between(bounds: tuple[Fraction, Fraction], quantity: Quantity) -> list[Formula]:
    """``lower <= quantity <= upper``, as a list of conjuncts."""
    lower, upper = (constant(bound) for bound in bounds)
    if lower.value == upper.value:
        return [equal(quantity, lower)]
    return [at_most(lower, quantity), at_most(quantity, upper)]


def all_of(formulas: Sequence[Formula]) -> Formula:
    """A conjunction without trivially true parts; true if it is empty."""
    if FALSE in formulas:
        return FALSE
    kept = [formula for formula in formulas if formula != TRUE]
    if len(kept) < 2:
        return kept[0] if kept else TRUE
    return f"(and {' '.join(kept)})"


def any_of(formulas: Sequence[Formula]) -> Formula:
    """A disjunction without trivially false parts; false if it is empty."""
    if TRUE in formulas:
        return TRUE
    kept = [formula for formula in formulas if formula != FALSE]
    if len(kept) < 2:
        return kept[0] if kept else FALSE
    return f"(or {' '.join(kept)})"


def negation(formula: Formula) -> Formula:
    """The negation of a formula."""
    return {TRUE: FALSE, FALSE: TRUE}.get(formula, f"(not {formula})")
