r"""The changes made by a production with one nonterminal, as equations in a module's parameters.

For ``A -> A z`` the robot stays the same exactly if every attribute is copied unchanged and nothing
is emitted. A frame is copied by ``N.frame * T`` if T is the identity:

.. math:: T = \begin{pmatrix} R & t \\ 0 & 1 \end{pmatrix}, \qquad R - I = 0, \quad t = 0,

entry by entry as trigonometric polynomials with exact coefficients. Unknown quantities (attributes,
quotients, roots) are symbols of their own.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from fractions import Fraction

from compiler.expressions.evaluators.trigonometric import CanonicalEvaluator
from compiler.expressions.trigonometric_polynomial import Pi as PiSymbol
from compiler.expressions.trigonometric_polynomial import (
    PolynomialRing,
    TrigonometricPolynomial,
    Variable,
)
from compiler.neutral_modules.parameter_domains import MultipleOfPi, Value
from grammar_lang import ir

TURNS, MOVES, MASS = "it turns a frame", "it shifts a frame", "it adds mass"
LARGEST_POWER = 8


class NotCopied(ValueError):
    """As far as is known, the production changes something for all parameter values."""


@dataclass(frozen=True, slots=True)
class Equation:
    """A polynomial that must be zero; ``necessary``: otherwise the robot certainly differs."""

    polynomial: TrigonometricPolynomial
    reason: str
    necessary: bool = False


@dataclass(slots=True)
class ProductionChange:
    """The equations of one block, with given values for some parameters of a module.

    ``nonterminal`` and ``module`` are occurrences on the right side; ``used`` are the attributes of
    the left side on which emissions of the grammar depend.
    """

    block: ir.SemanticBlock
    nonterminal: int
    module: int
    values: Mapping[str, Value]
    used: frozenset[str]
    evaluator: CanonicalEvaluator = field(
        default_factory=lambda: CanonicalEvaluator(PolynomialRing())
    )
    unknowns: dict[ir.Expr, int] = field(default_factory=dict[ir.Expr, int])
    parameters: dict[str, int] = field(default_factory=dict[str, int])

    def equations(self) -> list[Equation]:
        """All equations of the block.

        Raises:
            NotCopied: there are no such equations, as something changes in any case.
            TooManyTerms: a polynomial gets too long.
        """
        found = [item for rule in self.block.rules for item in self._of_rule(rule)]
        for emission in self.block.emissions:
            found += self._of_emission(emission)
        masses = [self._mass(emission) for emission in self.block.emissions]
        total = self.evaluator.constant(0)
        for mass in masses:
            if mass is None:
                return found
            total = self.evaluator.add(total, mass)
        return [*found, Equation(total, MASS, necessary=True)]

    # --- rules ----------------------------------------------------------------------------------

    def _of_rule(self, rule: ir.AttributeRule) -> Iterator[Equation]:
        name = rule.target.name
        upwards = rule.target.occurrence == ir.THIS
        source = ir.AttributeOf(self.nonterminal if upwards else ir.THIS, name)
        if rule.value == source:
            return
        match rule.value:
            case ir.World() | ir.Rot() | ir.Move() | ir.Shift() | ir.Compose():
                sure = upwards and name in self.used
                yield from self._of_frame(rule.value, source, necessary=sure)
            case ir.AttributeOf(_, other):
                raise NotCopied(f"the attribute `{name}` comes from another one, `{other}`")
            case ir.Vector():
                raise NotCopied(f"the attribute `{name}` is not copied unchanged")
            case _:
                own = self.scalar(source)
                change = self.evaluator.sub(self.scalar(rule.value), own)
                yield Equation(change, f"the attribute `{name}` depends on it")

    def _of_frame(
        self, expression: ir.Expr, source: ir.AttributeOf | None, *, necessary: bool
    ) -> Iterator[Equation]:
        """The equations for a frame to be ``source``, or any copied frame if that is None."""
        steps = [step for step in ir.factors(expression) if not isinstance(step, ir.World)]
        place = _origin(steps, source)
        for part in (steps[:place], steps[place + 1 :]):
            for equation in self._identity(part):
                sure = necessary and place == 0
                yield Equation(equation.polynomial, equation.reason, sure)

    def _identity(self, steps: Sequence[ir.Expr]) -> Iterator[Equation]:
        """The equations for a product of steps to be the identity."""
        run, one = self.evaluator, self.evaluator.constant
        turn = [[one(int(i == j)) for j in range(3)] for i in range(3)]
        shift = [one(0) for _ in range(3)]
        for step in steps:
            match step:
                case ir.Rot(axis, angle):
                    turn = self._product(turn, self._rotation(axis, angle))
                case _:
                    for j, item in enumerate(self._displacement(step)):
                        for i in range(3):
                            moved = run.mul(turn[i][j], item)
                            shift[i] = run.add(shift[i], moved)
        for i in range(3):
            for j in range(3):
                yield Equation(run.sub(turn[i][j], one(int(i == j))), TURNS)
        for item in shift:
            yield Equation(item, MOVES)

    def _product(
        self, left: list[list[TrigonometricPolynomial]], right: list[list[TrigonometricPolynomial]]
    ) -> list[list[TrigonometricPolynomial]]:
        run = self.evaluator
        rows = [[run.constant(0)] * 3 for _ in range(3)]
        for i in range(3):
            for j in range(3):
                for k in range(3):
                    term = run.mul(left[i][k], right[k][j])
                    rows[i][j] = run.add(rows[i][j], term)
        return rows

    def _rotation(self, axis: ir.Axis, angle: ir.Expr) -> list[list[TrigonometricPolynomial]]:
        run, number = self.evaluator, "xyz".index(axis[-1])
        turned = self.scalar(angle)
        if axis.startswith("-"):
            turned = run.neg(turned)
        cosine, sine = run.cos(turned), run.sin(turned)
        rows = [[run.constant(int(i == j == number)) for j in range(3)] for i in range(3)]
        first, second = (number + 1) % 3, (number + 2) % 3
        rows[first][first] = rows[second][second] = cosine
        rows[first][second], rows[second][first] = run.neg(sine), sine
        return rows

    def _displacement(self, step: ir.Expr) -> list[TrigonometricPolynomial]:
        match step:
            case ir.Move(axis, distance):
                items = [self.evaluator.constant(0) for _ in range(3)]
                moved = self.scalar(distance)
                negative = axis.startswith("-")
                items["xyz".index(axis[-1])] = self.evaluator.neg(moved) if negative else moved
                return items
            case ir.Shift(ir.Vector(x, y, z)):
                return [self.scalar(item) for item in (x, y, z)]
            case _:
                raise NotCopied(MOVES)

    # --- emissions ------------------------------------------------------------------------------

    def _of_emission(self, emission: ir.Emission) -> Iterator[Equation]:
        """No mass, no inertia, no extent, and the body's point is on a copied frame."""
        if isinstance(emission, ir.Effector):
            raise NotCopied("it adds an effector")
        for expression in _measures(emission):
            yield Equation(self.scalar(expression), MASS)
        if isinstance(emission, ir.Rod) and not defined(emission.density):
            raise NotCopied(MASS)
        yield from self._of_frame(emission.frame, None, necessary=False)

    def _mass(self, emission: ir.Emission) -> TrigonometricPolynomial | None:
        match emission:
            case ir.Rod(_, _, length, density, None):
                return self.evaluator.mul(self.scalar(length), self.scalar(density))
            case ir.PointMass(_, mass) | ir.Solid(_, mass):
                return self.scalar(mass)
            case _:
                return None

    # --- scalars --------------------------------------------------------------------------------

    def scalar(self, expression: ir.Expr) -> TrigonometricPolynomial:
        """A scalar as a polynomial; a part that may be undefined somewhere is an unknown."""
        run = self.evaluator
        match expression:
            case ir.Num(value):
                return run.ring.rational(value)
            case ir.Pi():
                return run.ring.symbol(PiSymbol())
            case ir.ParameterOf(occurrence, name) if occurrence == self.module:
                return self._parameter(name)
            case ir.Unary(function, operand) if function in {"neg", "abs", "sin", "cos"}:
                functions = {"neg": run.neg, "abs": run.fabs, "sin": run.sin, "cos": run.cos}
                return functions[function](self.scalar(operand))
            case ir.Binary("^", left, ir.Num(exponent)) if 1 <= exponent <= LARGEST_POWER:
                return self._power(left, int(exponent))
            case ir.Binary("/", left, right):
                divisor = self.scalar(right).constant
                if not divisor:
                    return self._unknown(expression)
                return run.ring.scaled(self.scalar(left), 1 / divisor)
            case ir.Binary("+" | "-" | "*" as operator, left, right):
                if not (defined(left) and defined(right)):
                    return self._unknown(expression)
                a, b = self.scalar(left), self.scalar(right)
                return {"+": run.add, "-": run.sub, "*": run.mul}[operator](a, b)
            case _:
                return self._unknown(expression)

    def _power(self, root: ir.Expr, exponent: int) -> TrigonometricPolynomial:
        number = self.scalar(root)
        found = number
        for _ in range(exponent - 1):
            found = self.evaluator.mul(found, number)
        return found

    def _parameter(self, name: str) -> TrigonometricPolynomial:
        ring, value = self.evaluator.ring, self.values.get(name)
        if value is None:
            number = self.parameters.setdefault(name, len(self.parameters))
            return ring.symbol(Variable("parameter", number))
        if isinstance(value, MultipleOfPi):
            return ring.scaled(ring.symbol(PiSymbol()), value.factor)
        return ring.rational(value)

    def _unknown(self, expression: ir.Expr) -> TrigonometricPolynomial:
        number = self.unknowns.setdefault(expression, len(self.unknowns))
        return self.evaluator.ring.symbol(Variable("rate", number))


def defined(expression: ir.Expr) -> bool:
    """Whether a scalar has a value everywhere: no quotient by a variable, root or tangent."""
    todo = [expression]
    while todo:
        current = todo.pop()
        match current:
            case ir.Binary("/", left, ir.Num(value)) if value:
                todo.append(left)
            case ir.Binary("^", left, ir.Num(exponent)) if exponent >= 0:
                todo.append(left)
            case ir.Binary("+" | "-" | "*", left, right):
                todo += [left, right]
            case ir.Unary("neg" | "abs" | "sin" | "cos", operand):
                todo.append(operand)
            case ir.Binary() | ir.Unary():
                return False
            case _:
                pass
    return True


def _measures(emission: ir.Emission) -> list[ir.Expr]:
    """The scalars that are all zero if a body has neither mass nor inertia nor extent."""
    match emission:
        case ir.Rod(_, _, length, _, radius):
            return [length] if radius is None else [length, radius]
        case ir.PointMass(_, mass):
            return [mass]
        case ir.Solid(_, mass, ir.Vector(x, y, z), inertia):
            return [mass, *inertia, x, y, z]
        case _:
            raise NotCopied(MASS)


def _origin(steps: Sequence[ir.Expr], source: ir.AttributeOf | None) -> int:
    """The index of the factor of a frame that is the one frame it starts from."""
    attributes = [(i, step) for i, step in enumerate(steps) if isinstance(step, ir.AttributeOf)]
    if source is None:
        if len(attributes) != 1:
            raise NotCopied("one of its bodies stands on no frame that is copied")
        return attributes[0][0]
    if not attributes:
        raise NotCopied(f"the attribute `{source.name}` starts from the world again")
    place, found = attributes[0]
    if len(attributes) > 1:
        raise NotCopied(f"the attribute `{source.name}` comes from several")
    if found != source:
        raise NotCopied(f"the attribute `{source.name}` comes from another one, `{found.name}`")
    return place


def roots_of(
    polynomial: TrigonometricPolynomial, ring: PolynomialRing
) -> tuple[int, Fraction | None, Fraction | None] | None:
    """All zeros of a polynomial in one parameter, if it has a simple form.

    Returns:
        (parameter, root, None) for ``a p + b`` and ``a p^k``, (parameter, None, unit) for
        ``a cos(c p) - a``, zero at the multiples of ``unit * pi``; else None.
    """
    terms = polynomial.key
    waves = [(wave, monomial, value) for (wave, monomial), value in terms]
    if len(waves) == 2 and waves[0][0] == (0, ()) and waves[1][0][0] == 1:
        (_, flat, constant), ((_, angle), factor_monomial, factor) = waves
        if flat or factor_monomial or constant != -factor or len(angle) != 1:
            return None
        ((monomial, rate),) = angle
        parameter = _parameter_power(monomial, ring)
        return (parameter[0], None, 2 / rate) if parameter and parameter[1] == 1 else None
    if not waves or any(wave != (0, ()) for wave, _, _ in waves) or len(waves) > 2:
        return None
    parameter = _parameter_power(waves[-1][1], ring)
    if parameter is None:
        return None
    if len(waves) == 1:
        return parameter[0], Fraction(0), None
    if waves[0][1] == () and parameter[1] == 1:
        return parameter[0], -waves[0][2] / waves[1][2], None
    return None


def _parameter_power(
    monomial: tuple[tuple[int, int], ...], ring: PolynomialRing
) -> tuple[int, int] | None:
    if len(monomial) != 1:
        return None
    ((number, power),) = monomial
    symbol = ring.symbols[number]
    if power > 0 and isinstance(symbol, Variable) and symbol.kind == "parameter":
        return symbol.index, power
    return None
