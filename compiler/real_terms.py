"""Real terms with the balls that contain them, and the SMT-LIB 2 script they are asserted in.

Source: Barrett, Fontaine & Tinelli, *The SMT-LIB Standard, version 2.6* (logic QF_NRA).  Terms
are pysmt's, in an environment of their own; constants are folded exactly.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from fractions import Fraction
from io import StringIO

from flint import arb
from pysmt.environment import Environment
from pysmt.fnode import FNode
from pysmt.smtlib.printers import SmtPrinter
from pysmt.typing import REAL

from compiler.balls import ball
from compiler.rational_enclosure import GRID, outward

NARROW = 4  # grid steps


@dataclass(frozen=True, slots=True)
class Quantity:
    """A term, a ball that contains its values, and its value where it is a constant."""

    term: FNode
    ball: arb
    value: Fraction | None = None


@dataclass(slots=True)
class RealScript:
    """A growing QF_NRA script; every symbol is declared once, in order of use."""

    environment: Environment = field(default_factory=Environment)
    lines: list[str] = field(default_factory=list[str])
    _counts: dict[str, int] = field(default_factory=dict[str, int])

    # --- the script ---

    def comment(self, text: str) -> None:
        """Add comment lines."""
        self.lines += [f"; {line}" for line in text.splitlines()]

    def assertion(self, formula: FNode) -> None:
        """Assert a formula, its top-level conjuncts one by one."""
        parts = formula.args() if formula.is_and() else (formula,)
        self.lines += [f"(assert {self._text(part)})" for part in parts if not part.is_true()]

    def declare(self, name: str, enclosure: arb | None = None) -> Quantity:
        """A new symbol; its ball is a claim about what is asserted of it, by default none."""
        self.lines.append(f"(declare-fun {name} () Real)")
        symbol = self.environment.formula_manager.Symbol(name, REAL)
        return Quantity(symbol, arb(0, float("inf")) if enclosure is None else enclosure)

    def fresh(self, prefix: str, enclosure: arb | None = None) -> Quantity:
        """A new symbol, numbered from 1 within its prefix."""
        self._counts[prefix] = self._counts.get(prefix, 0) + 1
        return self.declare(f"{prefix}{self._counts[prefix]}", enclosure)

    def number(self, enclosure: arb) -> Quantity | None:
        """A symbol within a ball, if the ball is as good as a number; else None.

        A known irrational number costs the solver less as an interval than as a root.
        """
        bounds = outward(enclosure)
        if bounds is None or bounds[1] - bounds[0] > Fraction(NARROW, GRID):
            return None
        symbol = self.fresh("k", enclosure)
        self.assertion(self.between(bounds, symbol))
        return symbol

    def named(self, prefix: str, quantity: Quantity) -> Quantity:
        """A symbol asserted equal to a quantity; constants and multiples of symbols stay.

        Keeps the script linear in the size of shared expressions.
        """
        core = self._factored(quantity)[1]
        if core is None or core.is_symbol():
            return quantity
        number = self.number(quantity.ball)
        if number is not None:
            return number
        symbol = self.fresh(prefix, quantity.ball)
        self.assertion(self.equal(symbol, quantity))
        return symbol

    def _text(self, formula: FNode) -> str:
        buffer = StringIO()
        SmtPrinter(buffer).printer(formula)
        return buffer.getvalue()

    # --- terms ---

    def constant(self, value: Fraction | int) -> Quantity:
        """A rational."""
        exact = Fraction(value)
        return Quantity(self.environment.formula_manager.Real(exact), ball(exact), exact)

    def add(self, *quantities: Quantity) -> Quantity:
        """A sum; zeros vanish and constants become one."""
        known = sum((q.value for q in quantities if q.value is not None), Fraction(0))
        parts = [q for q in quantities if q.value is None]
        if known or not parts:
            parts.append(self.constant(known))
        if len(parts) == 1:
            return parts[0]
        term = self.environment.formula_manager.Plus([q.term for q in parts])
        return Quantity(term, sum((q.ball for q in parts), arb(0)))

    def multiply(self, left: Quantity, right: Quantity) -> Quantity:
        """A product, a constant factor first."""
        (a, u), (b, v) = self._factored(left), self._factored(right)
        cores = [core for core in (u, v) if core is not None]
        factor = a * b
        if not factor or not cores:
            return self.constant(factor)
        manager = self.environment.formula_manager
        term = cores[0] if len(cores) == 1 else manager.Times(*cores)
        if factor != 1:
            term = manager.Times(manager.Real(factor), term)
        return Quantity(term, left.ball * right.ball)

    def _factored(self, quantity: Quantity) -> tuple[Fraction, FNode | None]:
        """The constant factor and what it multiplies (None: a constant)."""
        term = quantity.term
        if quantity.value is not None:
            return quantity.value, None
        if term.is_times() and term.arg(0).is_real_constant():
            factor = term.arg(0).constant_value()
            return Fraction(int(factor.numerator), int(factor.denominator)), term.arg(1)
        return Fraction(1), term

    def negate(self, quantity: Quantity) -> Quantity:
        """The opposite."""
        return self.multiply(self.constant(-1), quantity)

    def subtract(self, left: Quantity, right: Quantity) -> Quantity:
        """A difference."""
        return self.add(left, self.negate(right))

    def sum_of_squares(self, quantities: tuple[Quantity, ...]) -> Quantity:
        """The squared norm of a vector."""
        return self.add(*(self.multiply(q, q) for q in quantities))

    # --- formulas ---

    def equal(self, left: Quantity, right: Quantity) -> FNode:
        """``left = right``, decided where both are constants."""
        manager = self.environment.formula_manager
        if left.value is not None and right.value is not None:
            return manager.Bool(left.value == right.value)
        return manager.Equals(left.term, right.term)

    def at_most(self, left: Quantity, right: Quantity) -> FNode:
        """``left <= right``, decided where both are constants."""
        manager = self.environment.formula_manager
        if left.value is not None and right.value is not None:
            return manager.Bool(left.value <= right.value)
        return manager.LE(left.term, right.term)

    def between(self, bounds: tuple[Fraction, Fraction], quantity: Quantity) -> FNode:
        """``lower <= quantity <= upper``."""
        lower, upper = (self.constant(bound) for bound in bounds)
        if lower.value == upper.value:
            return self.equal(quantity, lower)
        return self.all_of([self.at_most(lower, quantity), self.at_most(quantity, upper)])

    def all_of(self, formulas: list[FNode]) -> FNode:
        """A conjunction, without what is trivially true."""
        kept = [formula for formula in formulas if not formula.is_true()]
        return self.environment.formula_manager.And(kept)

    def any_of(self, formulas: list[FNode]) -> FNode:
        """A disjunction; none is false."""
        return self.environment.formula_manager.Or(formulas)

    def negation(self, formula: FNode) -> FNode:
        """The opposite of a formula."""
        return self.environment.formula_manager.Not(formula)
