"""What a production adds to a robot, as text: its quantities, and products of powers."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from fractions import Fraction

from grammar_lang import ir
from grammar_lang.ir import constants
from grammar_lang.ir.expression_text import (
    Names,
    emission_text,
    expression_text,
    number_text,
    occurrence_names,
    rule_text,
)
from grammar_lang.units import Unit, symbol

# --- Numbers and quantities as text for hovers ----------------------------------------------------


_DIGITS = 6


def rounded(value: float) -> str:
    """A number with six significant digits."""
    return f"{value:.{_DIGITS}g}"


def _exactly(value: Fraction, power: int) -> str:
    """The text of ``q * pi^k``."""
    pi = "pi" if power == 1 else f"pi^{power}"
    if not power:
        return number_text(value)
    return pi if value == 1 else f"{number_text(value)}*{pi}"


def in_si(value: Fraction, unit: Unit) -> str:
    """A number with a unit, in SI units: exact, and also rounded if that differs."""
    total = value * unit.factor
    exact = _exactly(total, unit.pi_power)
    si = symbol(unit.dimension, angular=unit.angular)
    near = rounded(float(total) * 3.141592653589793**unit.pi_power)
    shown = exact if exact == near else f"{exact} ≈ {near}"
    return shown if si == "1" else f"{shown} {si}"


def closed_text(expression: ir.Expr) -> str:
    """A closed expression: rounded, with its exact form if that is short."""
    exact = expression_text(expression, lambda _: "")
    exact = exact.replace("-1 * pi", "-pi")
    try:
        near = rounded(constants.to_float(expression))
    except ValueError:
        return exact
    return near if near == exact or len(exact) > 20 else f"{exact} ≈ {near}"


def domain_text(domain: ir.Interval | ir.Choices, unit: str) -> str:
    """An interval or a set, in SI units."""
    after = "" if unit in {"", "1"} else f" {unit}"
    if isinstance(domain, ir.Interval):
        return f"[{closed_text(domain.lower)}, {closed_text(domain.upper)}]{after}"
    return f"{{{', '.join(map(closed_text, domain.values))}}}{after}"


# --- What a production adds to the dynamics of a robot --------------------------------------------
#
# A body of mass m whose centre of mass moves with velocity v and that turns with angular velocity w
# adds to the kinetic energy
#
# .. math:: T = m |v|^2 / 2 + I w^2 / 2
#
# and thus m J_v^T J_v + J_w^T I J_w to the mass matrix M, and -m g . c to the potential energy.  A
# uniform rod has m = density * length and, about an axis through its centre of mass perpendicular
# to the rod, I = m * length^2 / 12; about its end, m * length^2 / 3.
#
# Source: Murray, Li & Sastry, *A Mathematical Introduction to Robotic Manipulation* (1994), section
# 4.2.


@dataclass(frozen=True, slots=True)
class AddedBody:
    """A body: its description, its mass (kg) and its moments of inertia (kg m^2) as text.

    ``least`` and ``most`` are the bounds of its mass over the parameters, if they are known.
    """

    what: str
    mass: str
    inertia: str
    least: float | None = None
    most: float | None = None


@dataclass(frozen=True, slots=True)
class AddedPhysics:
    """What a production adds, each part as text."""

    frames: tuple[str, ...]
    dofs: tuple[str, ...]
    bodies: tuple[AddedBody, ...]
    effectors: tuple[str, ...]
    shapes: tuple[str, ...]
    torques: tuple[str, ...]
    visuals: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class _Reader:
    production: ir.Production
    modules: tuple[ir.Module | None, ...]
    names: Names

    def text(self, expression: ir.Expr) -> str:
        return expression_text(expression, self.names)

    # --- Bodies --------------------------------------------------------------------------------

    def body(self, emission: ir.Rod | ir.PointMass | ir.Solid) -> AddedBody:
        match emission:
            case ir.Rod():
                return self._rod(emission)
            case ir.PointMass(mass=mass):
                weight = product_of(mass)
                frame = self.text(emission.frame)
                return self._weighed(f"a point mass at `{frame}`", weight, "none")
            case ir.Solid(mass=mass, inertia=inertia):
                moments = ", ".join(map(self.text, inertia))
                where = f"{self.text(emission.frame)}` at `{self.text(emission.com)}"
                shown = moments if len(inertia) == 1 else f"({moments})"
                return self._weighed(f"a solid in `{where}`", product_of(mass), f"`{shown}` kg*m^2")

    def _rod(self, rod: ir.Rod) -> AddedBody:
        length = product_of(rod.length)
        mass = product_of(rod.density) * length
        squared = mass * length**2
        centre = squared * Product(Fraction(1, 12), ())
        end = squared * Product(Fraction(1, 3), ())
        inertia = (
            f"`{centre.text(self.names)}` kg*m^2 about its centre of mass, "
            f"`{end.text(self.names)}` about its beginning"
        )
        capsule = "" if rod.radius is None else f", radius `{self.text(rod.radius)}` m"
        what = (
            f"a rod of length `{length.text(self.names)}` m along {rod.axis} "
            f"from `{self.text(rod.frame)}`{capsule}"
        )
        return self._weighed(what, mass, inertia)

    def _weighed(self, what: str, mass: Product, inertia: str) -> AddedBody:
        bounds = self._bounds(mass)
        text = f"`{mass.text(self.names)}` kg"
        if bounds is None:
            return AddedBody(what, text, inertia)
        return AddedBody(what, text, inertia, *bounds)

    def _bounds(self, product: Product) -> tuple[float, float] | None:
        """The least and greatest value over the parameters; None if a factor may be negative."""
        low = high = float(product.factor)
        if product.factor < 0:
            return None
        for expression, exponent in product.powers:
            ends = self._ends(expression)
            if ends is None or ends[0] < 0 or (exponent < 0 and ends[0] == 0):
                return None
            powers = sorted((ends[0] ** exponent, ends[1] ** exponent))
            low, high = low * powers[0], high * powers[1]
        return low, high

    def _ends(self, expression: ir.Expr) -> tuple[float, float] | None:
        try:
            if constants.is_closed(expression):
                value = constants.to_float(expression)
                return value, value
            if not isinstance(expression, ir.ParameterOf):
                return None
            module = self.modules[expression.occurrence]
            found = () if module is None else module.parameters
            domain = next((p.domain for p in found if p.name == expression.name), None)
            if isinstance(domain, ir.Interval):
                return constants.to_float(domain.lower), constants.to_float(domain.upper)
            values = [] if domain is None else [constants.to_float(v) for v in domain.values]
        except (ValueError, OverflowError):
            return None
        return (min(values), max(values)) if values else None

    # --- Coordinates ---------------------------------------------------------------------------

    def dofs(self) -> Iterator[str]:
        for position, module in enumerate(self.modules):
            for dof in () if module is None else module.dofs:
                unit = "rad" if dof.kind == "revolute" else "m"
                way = "about" if dof.kind == "revolute" else "along"
                ranged = "without limits"
                if dof.range is not None:
                    ranged = f"in {domain_text(dof.range, unit)}"
                yield f"`{self.names(position)}.{dof.name}`: {dof.kind} {way} {dof.axis}, {ranged}"

    def torques(self) -> Iterator[str]:
        for module in self.modules:
            for torque in () if module is None else module.torques:
                law = expression_text(torque.value, lambda _: "")
                yield f"`torque({torque.dof}) = {law}`"
            for state in () if module is None else module.states:
                law = expression_text(state.derivative, lambda _: "")
                yield f"`der({state.name}) = {law}`"


def added_physics(program: ir.Program, grammar: ir.Grammar, label: str) -> AddedPhysics | None:
    """What a production adds to a robot; None if the grammar has no sound semantics.

    Args:
        program: the program.
        grammar: one of its grammars.
        label: a production of the grammar.
    """
    production = next((p for p in grammar.productions if p.label == label), None)
    block = None if grammar.semantics is None else grammar.semantics.get(label)
    if production is None or block is None:
        return None
    called = occurrence_names(production)

    def names(occurrence: int) -> str:
        return "this" if occurrence == ir.THIS else called[occurrence]

    modules = tuple(program.modules.get(symbol.name) for symbol in production.right)
    reader = _Reader(production, modules, names)
    bodies = [e for e in block.emissions if not isinstance(e, ir.Effector | ir.Shape)]
    shapes = [e for e in block.emissions if isinstance(e, ir.Shape)]
    effectors = [e for e in block.emissions if isinstance(e, ir.Effector)]
    return AddedPhysics(
        tuple(f"`{rule_text(rule, names)}`" for rule in block.rules),
        tuple(reader.dofs()),
        tuple(map(reader.body, bodies)),
        tuple(f"`{reader.text(effector.frame)}`" for effector in effectors),
        tuple(f"`{emission_text(shape, names)}`" for shape in shapes),
        tuple(reader.torques()),
        tuple(f"`{emission_text(visual, names)}`" for visual in block.visuals),
    )


def physics_text(added: AddedPhysics, dimension: int | None) -> str:
    """The addition as Markdown.

    Args:
        added: what a production adds.
        dimension: the dimension of the workspace, if it is known.
    """
    parts: list[str] = []
    if added.frames:
        parts.append("**Frames and attributes**\n\n" + _listed(added.frames))
    if added.dofs:
        grows = "a row and a column of M and an input each, unless another joint does the same"
        parts.append(f"**Degrees of freedom** ({grows})\n\n{_listed(added.dofs)}")
    if added.torques:
        parts.append(f"**Own dynamics**\n\n{_listed(added.torques)}")
    parts += [_body_text(body, dimension) for body in added.bodies]
    if added.effectors:
        parts.append(f"**Effector** at {', '.join(added.effectors)}")
    if added.shapes:
        parts.append(f"**Collides as**\n\n{_listed(added.shapes)}")
    if added.visuals:
        parts.append(f"**Is seen as**\n\n{_listed(added.visuals)}")
    if not added.bodies:
        parts.append("It adds no mass: nothing to the kinetic energy.")
    return "\n\n".join(parts)


def _body_text(body: AddedBody, dimension: int | None) -> str:
    lines = [f"**Adds to the dynamics**: {body.what}", "", f"- mass m = {body.mass}"]
    if body.least is not None and body.most is not None and body.least != body.most:
        lines[-1] += f", from {rounded(body.least)} to {rounded(body.most)} kg"
    if body.inertia == "none":
        lines += ["- kinetic energy m·|v|²/2", "- mass matrix M: m·JᵥᵀJᵥ, at its place"]
    else:
        turning = "I·ω²/2" if dimension == 2 else "ωᵀIω/2"
        lines += [
            f"- inertia I = {body.inertia}",
            f"- kinetic energy m·|v|²/2 + {turning}, at its centre of mass",
            "- mass matrix M: m·JᵥᵀJᵥ + JωᵀI·Jω",
        ]
    lines.append("- with gravity, potential energy −m·g·c")
    return "\n".join(lines)


def _listed(lines: tuple[str, ...]) -> str:
    return "\n".join(f"- {line}" for line in lines)


# --- Products of powers, in the usual notation: ``1.2 * L.length^3 / 12`` -------------------------


@dataclass(frozen=True, slots=True)
class Product:
    """``factor`` times powers of expressions, each with its exponent."""

    factor: Fraction
    powers: tuple[tuple[ir.Expr, int], ...]

    def __mul__(self, other: Product) -> Product:
        exponents: dict[ir.Expr, int] = dict(self.powers)
        for expression, exponent in other.powers:
            exponents[expression] = exponents.get(expression, 0) + exponent
        kept = tuple((e, n) for e, n in exponents.items() if n)
        return Product(self.factor * other.factor, kept)

    def __pow__(self, exponent: int) -> Product:
        return Product(self.factor**exponent, tuple((e, n * exponent) for e, n in self.powers))

    def text(self, names: Names) -> str:
        """The product as text; as a quotient if its factor is one of small integers."""
        if not self.powers or not self.factor:
            return number_text(self.factor)
        over = [e for e in self.powers if e[1] > 0]
        under = [(e, -n) for e, n in self.powers if n < 0]
        top = [_power(e, n, names) for e, n in over]
        bottom = [_power(e, n, names) for e, n in under]
        factor, divisor = self.factor, 1
        if "/" in number_text(factor):
            factor, divisor = Fraction(factor.numerator), factor.denominator
        if factor != 1 or not top:
            top.insert(0, number_text(factor))
        if divisor > 1:
            bottom.insert(0, str(divisor))
        return " / ".join([" * ".join(top), *bottom])


def _power(expression: ir.Expr, exponent: int, names: Names) -> str:
    text = expression_text(expression, names)
    if isinstance(expression, ir.Binary):
        text = f"({text})"
    return text if exponent == 1 else f"{text}^{exponent}"


def product_of(expression: ir.Expr) -> Product:
    """An expression as a product; a sum is a single factor."""
    known = constants.evident(expression)
    if known is not None and not known[1]:
        return Product(known[0], ())
    if isinstance(expression, ir.Unary) and expression.function == "neg":
        return Product(Fraction(-1), ()) * product_of(expression.operand)
    if isinstance(expression, ir.Binary) and expression.operator == "*":
        return product_of(expression.left) * product_of(expression.right)
    if isinstance(expression, ir.Binary) and expression.operator == "/":
        below = product_of(expression.right)
        if below.factor:
            return product_of(expression.left) * below**-1
    return Product(Fraction(1), ((expression, 1),))
