r"""A robot's scalars as terms of nonlinear real arithmetic.

Sums, products, quotients, powers, roots and absolute values are exact. A sine and a cosine of one
angle are unknowns with :math:`c^2 + s^2 = 1`, within intervals from ball arithmetic over the
parameters' ranges. Their other dependence on the angle is left out, and of a known irrational
number only a narrow interval is used; this only enlarges the set of solutions. Values at which an
expression is undefined are excluded, as they give no robot.
"""

from __future__ import annotations

from dataclasses import dataclass, field
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
from compiler.expressions.evaluators.balls import BALLS, closed_ball
from compiler.expressions.exact_numbers import exact_rational, outward, rational_bounds
from compiler.expressions.scalars import (
    Apply,
    MonomialEvaluator,
    ParameterLeaf,
    PiConstant,
    ScalarNode,
    evaluate_scalars,
)
from compiler.robots.robot import RobotModel
from grammar_lang import ir
from grammar_lang.ir.constants import Monomial, apply

ONE = Fraction(1)


@dataclass(frozen=True, slots=True)
class Angle:
    """The cosine and the sine of an angle."""

    cosine: Quantity
    sine: Quantity


@dataclass(slots=True)
class ScalarTerms:
    """The terms of the scalars of one robot in one script; call ``define`` first."""

    model: RobotModel
    script: RealScript
    balls: list[arb] = field(init=False)
    monomials: list[Monomial | None] = field(init=False)
    _terms: dict[int, Quantity] = field(default_factory=dict[int, Quantity])
    _angles: dict[int, Angle] = field(default_factory=dict[int, Angle])

    def __post_init__(self) -> None:
        domains = [_domain_ball(parameter.domain) for parameter in self.model.parameters]

        self.balls = evaluate_scalars(self.model.scalars, BALLS, domains)
        values = [_only_value(parameter.domain) for parameter in self.model.parameters]
        known: list[Monomial | None] = [None if item is None else (item, 0) for item in values]
        self.monomials = evaluate_scalars(self.model.scalars, MonomialEvaluator(), known)

    def define(self, scalars: set[int]) -> None:
        """Declare the terms that the given scalars need; angles follow on demand."""
        script = self.script
        needed = _closure(self.model.scalars, scalars)
        nodes = [(i, self.model.scalars[i]) for i in sorted(needed)]
        if any(isinstance(node, ParameterLeaf) for _, node in nodes):
            script.comment("Design parameters, the same at both poses, in outer rational bounds.")
        for i, node in nodes:
            if isinstance(node, ParameterLeaf):
                self._terms[i] = self._parameter(node)
        if any(isinstance(node, Apply | PiConstant) for _, node in nodes):
            script.comment("Quantities that depend on these parameters only.")
        for i, node in nodes:
            if i not in self._terms:
                self._terms[i] = self._term(i, node)

    def term(self, scalar: int) -> Quantity:
        """The term of a defined scalar."""
        return self._terms[scalar]

    def angle(self, scalar: int) -> Angle:
        """The cosine and the sine of a scalar, in rad."""
        node = self.model.scalars[scalar]
        if isinstance(node, Apply) and node.operation == "neg":
            opposite = self.angle(node.arguments[0])
            return Angle(opposite.cosine, negate(opposite.sine))
        if scalar not in self._angles:
            self._angles[scalar] = self._new_angle(scalar)
        return self._angles[scalar]

    def _new_angle(self, scalar: int) -> Angle:
        """Exact if rational, intervals if known, else unknowns on the unit circle."""
        script, value = self.script, self.balls[scalar]
        cosine = self._known("cos", scalar, value.cos())
        sine = self._known("sin", scalar, value.sin())
        if cosine is not None and sine is not None:
            return Angle(cosine, sine)
        cosine, sine = self._unknown("cos", value.cos()), self._unknown("sin", value.sin())
        on_circle = sum_of_squares((cosine, sine))
        script.assertion(equal(on_circle, constant(1)))
        return Angle(cosine, sine)

    def _known(self, function: ir.Function, scalar: int, enclosure: arb) -> Quantity | None:
        at = self.monomials[scalar]
        exact = None if at is None else apply(function, at)
        if exact is not None and exact[1] == 0:
            return constant(exact[0])
        return self.script.number(enclosure)

    def _unknown(self, name: str, enclosure: arb) -> Quantity:
        unknown = self.script.fresh(name, enclosure)
        bounds = outward(enclosure)
        if bounds is not None and (bounds[0] > -ONE or bounds[1] < ONE):
            self.script.assertion(*between(bounds, unknown))
        return unknown

    def _parameter(self, leaf: ParameterLeaf) -> Quantity:
        script, domain = self.script, self.model.parameters[leaf.index].domain
        value = _only_value(domain)
        if value is not None:
            return constant(value)
        unknown = script.fresh("theta", _domain_ball(domain))
        if isinstance(domain, ir.Interval):
            lower, upper = rational_bounds(domain.lower)[0], rational_bounds(domain.upper)[1]
            script.assertion(*between((lower, upper), unknown))
        else:
            values = [all_of(between(rational_bounds(v), unknown)) for v in domain.values]
            script.assertion(any_of(values))
        return unknown

    def _term(self, index: int, node: ScalarNode) -> Quantity:
        script, exact = self.script, self.monomials[index]
        if exact is not None and exact[1] == 0:
            return constant(exact[0])
        number = script.number(self.balls[index])
        if number is not None:
            return number
        if not isinstance(node, Apply):
            raise TypeError(f"a constant is a number: {node}")
        return self._operation(index, node)

    def _operation(self, index: int, node: Apply) -> Quantity:
        """The term of an operation; undefined values are excluded."""
        script = self.script
        if node.operation in {"sin", "cos", "tan"}:
            return self._trigonometric(node, self.balls[index])
        first, *others = (self._terms[i] for i in node.arguments)
        match node.operation:
            case "+":
                return script.named("a", add(first, *others))
            case "-":
                return script.named("a", subtract(first, others[0]))
            case "*":
                return script.named("a", multiply(first, others[0]))
            case "neg":
                return negate(first)
            case "/":
                return self._quotient(first, others[0])
            case "^":
                return self._power(first, node.exponent)
            case "abs":
                return absolute(script, first)
            case "sqrt":
                root = script.fresh("a", self.balls[index])
                script.assertion(non_negative(root))
                script.assertion(equal(multiply(root, root), first))
                return root
            case _:
                raise ValueError(f"unknown operation {node.operation}")

    def _trigonometric(self, node: Apply, enclosure: arb) -> Quantity:
        angle = self.angle(node.arguments[0])
        if node.operation != "tan":
            return angle.sine if node.operation == "sin" else angle.cosine
        tangent = self.script.fresh("a", enclosure)
        product = multiply(tangent, angle.cosine)
        self.script.assertion(equal(product, angle.sine))
        return tangent

    def _quotient(self, dividend: Quantity, divisor: Quantity) -> Quantity:
        script = self.script
        if divisor.value:
            return script.named("a", multiply(constant(1 / divisor.value), dividend))
        quotient = script.fresh("a", dividend.ball / divisor.ball)
        script.assertion(equal(multiply(quotient, divisor), dividend))
        script.assertion(negation(equal(divisor, constant(0))))
        return quotient

    def _power(self, base: Quantity, exponent: int) -> Quantity:
        """An integer power by repeated squaring."""
        script, result, left = self.script, constant(1), abs(exponent)
        square = base
        while left:
            if left & 1:
                result = script.named("a", multiply(result, square))
            left >>= 1
            if left:
                square = script.named("a", multiply(square, square))
        return result if exponent >= 0 else self._quotient(constant(1), result)


def absolute(script: RealScript, quantity: Quantity) -> Quantity:
    """The absolute value: the quantity or its negation if the sign is certain."""
    if quantity.value is not None:
        return constant(abs(quantity.value))
    if quantity.ball >= 0:
        return quantity
    opposite = negate(quantity)
    if quantity.ball <= 0:
        return opposite
    unknown = script.fresh("a", abs(quantity.ball))
    script.assertion(non_negative(unknown))
    signs = [equal(unknown, quantity), equal(unknown, opposite)]
    script.assertion(any_of(signs))
    return unknown


def _closure(nodes: tuple[ScalarNode, ...], scalars: set[int]) -> set[int]:
    """The scalars whose terms are needed; angles enter through cosine and sine only."""
    needed = set(scalars)
    for i in range(len(nodes) - 1, -1, -1):
        node = nodes[i]
        if i in needed and isinstance(node, Apply) and node.operation not in {"sin", "cos", "tan"}:
            needed.update(node.arguments)
    return needed


def _domain_ball(domain: ir.Interval | ir.Choices) -> arb:
    ends = (domain.lower, domain.upper) if isinstance(domain, ir.Interval) else domain.values
    first, *others = (closed_ball(end) for end in ends)
    for other in others:
        first = first.union(other)
    return first


def _only_value(domain: ir.Interval | ir.Choices) -> Fraction | None:
    """The value of a parameter that has only one value, a rational; else None."""
    ends = (domain.lower, domain.upper) if isinstance(domain, ir.Interval) else domain.values
    values = {exact_rational(end) for end in ends}
    return values.pop() if len(values) == 1 else None


# --- Unknown coordinates of prismatic joints, within outer rational limits ------------------------


def slide_term(model: RobotModel, script: RealScript, dof: int, pose: str) -> Quantity:
    """A new unknown for the coordinate of a prismatic joint at a pose."""
    limits = model.dofs[dof].range
    if limits is None:
        return script.fresh(f"{pose}_q")
    lower = rational_bounds(limits.lower)[0]
    upper = rational_bounds(limits.upper)[1]
    low, high = (arb(int(end.numerator)) / end.denominator for end in (lower, upper))
    unknown = script.fresh(f"{pose}_q", low.union(high))
    script.assertion(*between((lower, upper), unknown))
    return unknown
