r"""A robot's expression graph as polynomial real terms in SMT-LIB 2.

The sine and the cosine of a revolute coordinate, and of an angle that depends on parameters, are
unknowns on the unit circle; those of sums of angles follow from these by the addition theorems.
Quotients and roots are unknowns with their defining equations. Other knowledge about angles (that a
cosine belongs to *this* parameter, the length of a range over a full turn) is left out, and
irrational constants lie in narrow rational intervals, so the script allows at least all poses of
all robots.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from fractions import Fraction

from flint import arb

from compiler.encodings.region_terms import (
    Quantity,
    RealScript,
    add,
    all_of,
    any_of,
    between,
    constant,
    equal,
    multiply,
    negate,
    negation,
    non_negative,
    subtract,
    sum_of_squares,
)
from compiler.encodings.scalar_terms import Angle, absolute
from compiler.expressions.evaluator import Evaluator
from compiler.expressions.exact_numbers import outward
from grammar_lang import ir
from grammar_lang.ir.constants import apply

BITS = 128
PI = "pi"
ONE = Fraction(1)
WHOLE = arb(0, float("inf"))


@dataclass(frozen=True, slots=True)
class LinearTerm:
    """A linear form with rational coefficients in symbols of a script; a value of the graph."""

    coefficients: Mapping[str, Fraction]
    constant: Fraction

    @property
    def value(self) -> Fraction | None:
        """The value if it is a constant, else None."""
        return None if self.coefficients else self.constant


@dataclass(slots=True)
class TermEvaluator(Evaluator[LinearTerm]):
    """Values are linear forms; products are defined as new symbols of the script."""

    script: RealScript
    quantities: dict[str, Quantity] = field(default_factory=dict[str, Quantity])
    ranges: dict[str, arb] = field(default_factory=dict[str, arb])
    choices: dict[str, list[arb]] = field(default_factory=dict[str, list[arb]])
    _defined: dict[str, LinearTerm] = field(default_factory=dict[str, LinearTerm])
    _angles: dict[tuple[tuple[str, Fraction], ...], Angle] = field(
        default_factory=dict[tuple[tuple[str, Fraction], ...], Angle]
    )

    # --- numbers -------------------------------------------------------------------------------

    def constant(self, value: Fraction | int) -> LinearTerm:
        """A rational."""
        return LinearTerm({}, Fraction(value))

    def pi(self) -> LinearTerm:
        """The symbol pi."""
        return LinearTerm({PI: ONE}, Fraction(0))

    def symbol(self, quantity: Quantity) -> LinearTerm:
        """A symbol of the script as a linear form."""
        if quantity.core is None:
            return LinearTerm({}, quantity.factor)
        self.quantities.setdefault(quantity.core, Quantity(ONE, quantity.core, quantity.ball))
        return LinearTerm({quantity.core: quantity.factor}, Fraction(0))

    # --- operations ----------------------------------------------------------------------------

    def neg(self, argument: LinearTerm, /) -> LinearTerm:
        """The negation."""
        return scaled(argument, Fraction(-1))

    def twice(self, argument: LinearTerm, /) -> LinearTerm:
        """Twice the argument."""
        return scaled(argument, Fraction(2))

    def add(self, left: LinearTerm, right: LinearTerm, /) -> LinearTerm:
        """The sum."""
        return added(left, right)

    def mul(self, left: LinearTerm, right: LinearTerm, /) -> LinearTerm:
        """The product, as a new symbol if neither factor is a number."""
        for one, other in ((left, right), (right, left)):
            if one.value is not None:
                return scaled(other, one.value)
        return self._define(multiply(self.quantity(left), self.quantity(right)))

    def div(self, left: LinearTerm, right: LinearTerm, /) -> LinearTerm:
        """The quotient, as a symbol; the divisor is asserted to be non-zero."""
        if right.value:
            return scaled(left, 1 / right.value)
        dividend, divisor = self.quantity(left), self.quantity(right)
        found = self.script.fresh("d", dividend.ball / divisor.ball)
        self.script.assertion(equal(multiply(found, divisor), dividend))
        self.script.assertion(negation(equal(divisor, constant(0))))
        return self.symbol(found)

    def sqrt(self, argument: LinearTerm, /) -> LinearTerm:
        """The square root, as a symbol."""
        square = self.quantity(argument)
        enclosure = square.ball.sqrt()
        known = self.script.number(enclosure) if argument.value is not None else None
        if known is not None:
            return self.symbol(known)
        found = self.script.fresh("r", enclosure)
        self.script.assertion(non_negative(found), equal(multiply(found, found), square))
        return self.symbol(found)

    def fabs(self, argument: LinearTerm, /) -> LinearTerm:
        """The absolute value."""
        return self.symbol(absolute(self.script, self.quantity(argument)))

    def cos(self, argument: LinearTerm, /) -> LinearTerm:
        """The cosine."""
        return self.symbol(self._angle(argument).cosine)

    def sin(self, argument: LinearTerm, /) -> LinearTerm:
        """The sine."""
        return self.symbol(self._angle(argument).sine)

    def tan(self, argument: LinearTerm, /) -> LinearTerm:
        """The tangent, as a symbol."""
        angle = self._angle(argument)
        found = self.script.fresh("t")
        self.script.assertion(equal(multiply(found, angle.cosine), angle.sine))
        return self.symbol(found)

    # --- terms ---------------------------------------------------------------------------------

    def quantity(self, number: LinearTerm) -> Quantity:
        """A number as a term; sums are defined as symbols, so that each is written only once."""
        return self._named(self.expression(number))

    def expression(self, number: LinearTerm) -> Quantity:
        """A number as a term, written out."""
        parts = [
            multiply(constant(factor), self.real(symbol))
            for symbol, factor in number.coefficients.items()
        ]
        return add(*parts, constant(number.constant))

    def real(self, symbol: str) -> Quantity:
        """A symbol; an unknown one is declared within its range."""
        if symbol not in self.quantities:
            found = self.script.number(arb.pi()) if symbol == PI else None
            enclosure = self.ranges.get(symbol)
            if found is None:
                found = self.script.declare(symbol, enclosure)
                self.script.assertion(*_inside(found))
            self.quantities[symbol] = found
        return self.quantities[symbol]

    def _define(self, quantity: Quantity) -> LinearTerm:
        return self.symbol(self._named(quantity))

    def _named(self, quantity: Quantity) -> Quantity:
        """A term as a multiple of a symbol, which is defined as the rest of the term."""
        if quantity.is_leaf or quantity.core is None:
            return quantity
        if quantity.core not in self._defined:
            name = f"w{len(self._defined) + 1}"
            self.script.lines.append(f"(define-fun {name} () Real {quantity.core})")
            core = Quantity(ONE, name, quantity.ball / arb_of(quantity.factor))
            self._defined[quantity.core] = self.symbol(core)
        (name,) = self._defined[quantity.core].coefficients
        return Quantity(quantity.factor, name, quantity.ball)

    # --- angles --------------------------------------------------------------------------------

    def _angle(self, argument: LinearTerm) -> Angle:
        """The cosine and sine of a sum of multiples of symbols, pi and a rational."""
        turns = argument.coefficients.get(PI, Fraction(0))
        angle = self._fixed(turns, argument.constant)
        seen: list[tuple[str, Fraction]] = []
        for symbol, factor in argument.coefficients.items():
            if symbol == PI:
                continue
            seen.append((symbol, factor))
            key = (*seen, (PI, turns), ("1", argument.constant))
            if key not in self._angles:
                self._angles[key] = self._sum(angle, self._multiple(symbol, factor))
            angle = self._angles[key]
        return angle

    def _fixed(self, turns: Fraction, radians: Fraction) -> Angle:
        """The cosine and sine of a known angle, exact if they are rational."""
        exact = None if radians else (turns, 1)
        value = arb_of(turns) * arb.pi() + arb_of(radians)
        cosine = self._known("cos", exact, value.cos())
        return Angle(cosine, self._known("sin", exact, value.sin()))

    def _known(
        self, function: ir.Function, exact: tuple[Fraction, int] | None, enclosure: arb
    ) -> Quantity:
        if exact is not None:
            found = apply(function, exact if exact[0] else (Fraction(0), 0))
            if found is not None and found[1] == 0:
                return constant(found[0])
        key = f"{function} {enclosure.str(30)}"
        if key not in self._defined:
            number = self.script.number(enclosure)
            if number is None:
                raise ValueError(f"too wide an enclosure of a constant: {enclosure}")
            self._defined[key] = self.symbol(number)
        (name,) = self._defined[key].coefficients
        return self.quantities[name]

    def _multiple(self, symbol: str, factor: Fraction) -> Angle:
        """The angle of a rational multiple of a symbol."""
        angle = self._repeated(symbol, abs(factor.numerator), factor.denominator)
        return angle if factor > 0 else Angle(angle.cosine, negate(angle.sine))

    def _repeated(self, symbol: str, times: int, divisor: int) -> Angle:
        """A multiple of a fraction of a symbol, by repeated doubling."""
        key = ((symbol, Fraction(times)), ("divisor", Fraction(divisor)))
        if times == 1:
            return self.unit_point(symbol, divisor)
        if key not in self._angles:
            half = self._repeated(symbol, times // 2, divisor)
            angle = self._sum(half, half)
            if times % 2:
                angle = self._sum(angle, self.unit_point(symbol, divisor))
            self._angles[key] = angle
        return self._angles[key]

    def unit_point(self, symbol: str, divisor: int = 1) -> Angle:
        """A point of the unit circle, within the range of the symbol divided by the divisor."""
        key = ((symbol, Fraction(1, divisor)),)
        if key not in self._angles:
            name = symbol if divisor == 1 else f"{symbol}_over_{divisor}"
            known = self.quantities.get(symbol)
            enclosure = self.ranges.get(symbol, WHOLE if known is None else known.ball) / divisor
            cosine = self.script.declare(f"cos_{name}", _cosine_range(enclosure.cos()))
            sine = self.script.declare(f"sin_{name}", _cosine_range(enclosure.sin()))
            self.script.assertion(equal(sum_of_squares((cosine, sine)), constant(1)))
            self.script.assertion(*_inside(cosine, ONE), *_inside(sine, ONE))
            self._choose(symbol, divisor, Angle(cosine, sine))
            self._angles[key] = Angle(cosine, sine)
        return self._angles[key]

    def _choose(self, symbol: str, divisor: int, angle: Angle) -> None:
        """Let a symbol with finitely many values have the cosine and sine of one of them."""
        if symbol not in self.choices:
            return
        whole = self.real(symbol)
        cases = []
        for value in self.choices[symbol]:
            parts = ((whole, value), (angle.cosine, (value / divisor).cos()))
            exact = [replace(quantity, ball=ball) for quantity, ball in parts]
            exact.append(replace(angle.sine, ball=(value / divisor).sin()))
            cases.append(all_of([formula for part in exact for formula in _inside(part)]))
        self.script.assertion(any_of(cases))

    def _sum(self, left: Angle, right: Angle) -> Angle:
        """The sum of two angles, by the addition theorems."""
        cosines, sines = (
            self._named(multiply(left.cosine, right.cosine)),
            self._named(multiply(left.sine, right.sine)),
        )
        first = self._named(multiply(left.sine, right.cosine))
        second = self._named(multiply(left.cosine, right.sine))
        return Angle(
            self._named(subtract(cosines, sines)),
            self._named(add(first, second)),
        )


def scaled(number: LinearTerm, factor: Fraction) -> LinearTerm:
    """A rational multiple."""
    if not factor:
        return LinearTerm({}, Fraction(0))
    coefficients = {symbol: value * factor for symbol, value in number.coefficients.items()}
    return LinearTerm(coefficients, number.constant * factor)


def added(left: LinearTerm, right: LinearTerm) -> LinearTerm:
    """The sum."""
    total = dict(left.coefficients)
    for symbol, value in right.coefficients.items():
        total[symbol] = total.get(symbol, Fraction(0)) + value
    kept = {symbol: value for symbol, value in total.items() if value}
    return LinearTerm(kept, left.constant + right.constant)


def arb_of(value: Fraction) -> arb:
    """A ball around a rational."""
    return arb(value.numerator) / arb(value.denominator)


def _cosine_range(enclosure: arb) -> arb:
    return enclosure if enclosure.is_finite() else arb(0, 1)


def _inside(quantity: Quantity, beyond: Fraction | None = None) -> list[str]:
    """Formulas that a symbol is within its enclosure, if they are not trivial.

    ``beyond``: its absolute value is known to be at most this.
    """
    bounds = outward(quantity.ball)
    if bounds is None or (beyond is not None and bounds[0] <= -beyond and bounds[1] >= beyond):
        return []
    return between(bounds, quantity)
