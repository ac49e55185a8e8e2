"""Write expressions, attribute rules and emissions as text of the language.

Numbers are exact and in SI units: a decimal if there is a finite one, otherwise a quotient.  Units
are not written, because the intermediate representation does not keep those of numbers.  Reading
the text gives the same expression; only where a number with a unit is a factor, its unit has to be
added first.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Sequence
from fractions import Fraction
from typing import TypeAlias

from grammar_lang.ir.emissions import (
    Effector,
    Emitted,
    Mesh,
    PointMass,
    Rod,
    Shape,
    ShapeKind,
    Solid,
    Visual,
)
from grammar_lang.ir.expressions import (
    LOCAL,
    THIS,
    AttributeOf,
    Axis,
    Binary,
    Compose,
    DofOf,
    EffortOf,
    Expr,
    InputOf,
    Move,
    Num,
    Operator,
    ParameterOf,
    Pi,
    RateOf,
    Rot,
    Shift,
    StateOf,
    Unary,
    Vector,
    World,
)
from grammar_lang.ir.family import AttributeRule, Production, SemanticBlock

LONGEST_PLAIN = 10
"""Longer decimals are written with an exponent if that is shorter."""
SUM, PRODUCT, FACTOR, ATOM = range(4)
_RANK: dict[Operator, int] = {"+": SUM, "-": SUM, "*": PRODUCT, "/": PRODUCT}

Names: TypeAlias = Callable[[int], str]
Ranked: TypeAlias = tuple[str, int]


def occurrence_names(production: Production) -> tuple[str, ...]:
    """The names of the symbols on a right side: by alias, by name, or as X1, X2."""
    total = Counter(symbol.name for symbol in production.right)
    seen: Counter[str] = Counter()
    found: list[str] = []
    for symbol in production.right:
        seen[symbol.name] += 1
        numbered = symbol.name if total[symbol.name] == 1 else f"{symbol.name}{seen[symbol.name]}"
        found.append(symbol.alias or numbered)
    return tuple(found)


def updates_text(production: Production, block: SemanticBlock) -> tuple[str, ...]:
    """The statements of a block without semicolons: rules first, visuals last."""
    called = occurrence_names(production)

    def names(occurrence: int) -> str:
        return called_in(occurrence, called)

    rules = (rule_text(rule, names) for rule in block.rules)
    emitted = (*block.emissions, *block.visuals)
    return (*rules, *(emission_text(emission, names) for emission in emitted))


def rule_text(rule: AttributeRule, names: Names) -> str:
    """A rule as text: ``this.frame = N.frame * rot(z, JO.q)``."""
    target = attribute_text(rule.target, names)
    local = rule.target.occurrence == LOCAL and "." not in target
    return f"{'let ' if local else ''}{target} = {expression_text(rule.value, names)}"


def called_in(occurrence: int, called: Sequence[str]) -> str:
    """The name of an occurrence in a block; ``called`` are the names on the right side."""
    return called[occurrence] if occurrence >= 0 else "this"


def attribute_text(attribute: AttributeOf, names: Names) -> str:
    """An attribute as text: ``this.frame``, ``N.frame``, or a local ``f`` or ``Elbow.out``."""
    if attribute.occurrence == LOCAL:
        return attribute.name
    return f"{names(attribute.occurrence)}.{attribute.name}"


def emission_text(emission: Emitted, names: Names) -> str:
    """An emission as text: ``rod(frame: N.frame, axis: x, length: L.length, density: 1)``."""
    kind, arguments = _emitted(emission, names)
    return f"{kind}({', '.join(f'{name}: {value}' for name, value in arguments)})"


def expression_text(expression: Expr, names: Names) -> str:
    """An expression as text; ``names`` gives the names of occurrences.

    A module's own parameters, coordinates, states and inputs (those of ``THIS``) have plain names.
    """
    return _ranked(expression, names)[0]


def number_text(value: Fraction) -> str:
    """A rational as a decimal, or as a quotient if it has no finite decimal."""
    sign, value = ("-" if value < 0 else ""), abs(value)
    digits, places = _decimal(value)
    if digits is None:
        return f"{sign}{value.numerator}/{value.denominator}"
    plain, scientific = _plain(digits, places), f"{digits}e{-places}"
    return sign + (plain if len(plain) <= max(LONGEST_PLAIN, len(scientific)) else scientific)


def _decimal(value: Fraction) -> tuple[int | None, int]:
    """``(d, k)`` with value = d / 10**k and the least k, negative for trailing zeros."""
    rest, twos, fives = value.denominator, 0, 0
    while rest % 2 == 0:
        rest, twos = rest // 2, twos + 1
    while rest % 5 == 0:
        rest, fives = rest // 5, fives + 1
    if rest > 1:
        return None, 0
    places = max(twos, fives)
    digits = value.numerator * 10**places // value.denominator
    while digits and digits % 10 == 0:
        digits, places = digits // 10, places - 1
    return digits, places


def _plain(digits: int, places: int) -> str:
    """The decimal of digits / 10**places, without an exponent."""
    text = str(digits)
    if places <= 0:
        return text + "0" * -places
    text = text.rjust(places + 1, "0")
    return f"{text[:-places]}.{text[-places:]}"


def _emitted(emission: Emitted, names: Names) -> tuple[str, list[tuple[str, str]]]:
    def text(expression: Expr) -> str:
        return expression_text(expression, names)

    frame = ("frame", text(emission.frame))
    match emission:
        case Rod(_, axis, length, density, radius):
            arguments = [("axis", axis), ("length", text(length)), ("density", text(density))]
            arguments += [] if radius is None else [("radius", text(radius))]
            return "rod", [frame, *arguments]
        case PointMass(_, mass):
            return "point", [frame, ("mass", text(mass))]
        case Solid(_, mass, com, inertia):
            moments = ", ".join(map(text, inertia))
            tensor = moments if len(inertia) == 1 else f"({moments})"
            return "solid", [frame, ("mass", text(mass)), ("com", text(com)), ("inertia", tensor)]
        case Shape(mesh=Mesh(path=path), scale=scale):
            return "hull", [frame, *_file(path, scale)]
        case Visual(_, file, scale):
            return "visual", [frame, *_file(file.path, scale)]
        case Shape(kind, _, axis, sizes):
            return kind, [frame, *_measures(kind, axis, tuple(map(text, sizes)))]
        case Effector():
            return "effector", [frame]


def _file(path: str, scale: Fraction) -> list[tuple[str, str]]:
    number = number_text(scale)
    unit = f"({number}) m" if "/" in number else f"{number} m"
    return [("file", f'"{path}"'), ("scale", unit)]


def _measures(kind: ShapeKind, axis: Axis | None, sizes: tuple[str, ...]) -> list[tuple[str, str]]:
    if kind == "box":
        return [("size", f"({', '.join(sizes)})")]
    along = [] if axis is None else [("axis", str(axis)), ("length", sizes[0])]
    return [*along, ("radius", sizes[-1])]


# --- Expressions -------------------------------------------------------------------------------


def _ranked(expression: Expr, names: Names) -> Ranked:
    """The text of an expression, and how tightly its outermost operator binds."""
    match expression:
        case Num(value):
            return _number(value)
        case Pi():
            return "pi", ATOM
        case Unary("neg", operand):
            return f"-{_at_least(FACTOR, operand, names)}", FACTOR
        case Unary(function, operand):
            return f"{function}({expression_text(operand, names)})", ATOM
        case Binary("^", left, right):
            base, exponent = _at_least(ATOM, left, names), _at_least(FACTOR, right, names)
            return f"{base}^{exponent}", FACTOR
        case Binary(operator, left, right):
            return _operation(operator, left, right, names)
        case Vector(x, y, z):
            items = (x, y) if z == Num(Fraction(0)) else (x, y, z)
            return f"({', '.join(expression_text(item, names) for item in items)})", ATOM
        case World() | Rot() | Move() | Shift() | Compose():
            return _frame(expression, names)
        case _:
            return _name(expression, names), ATOM


def _number(value: Fraction) -> Ranked:
    text = number_text(value)
    if "/" in text:
        return text, PRODUCT
    return text, FACTOR if text.startswith("-") else ATOM


def _operation(operator: Operator, left: Expr, right: Expr, names: Names) -> Ranked:
    rank = _RANK[operator]
    first, second = _at_least(rank, left, names), _at_least(rank + 1, right, names)
    return f"{first} {operator} {second}", rank


def _frame(expression: World | Rot | Move | Shift | Compose, names: Names) -> Ranked:
    match expression:
        case World():
            return "world", ATOM
        case Rot(axis, angle):
            return f"rot({axis}, {expression_text(angle, names)})", ATOM
        case Move(axis, distance):
            return f"move({axis}, {expression_text(distance, names)})", ATOM
        case Shift(vector):
            return f"move({expression_text(vector, names)})", ATOM
        case Compose(left, right):
            return _operation("*", left, right, names)


def _name(
    expression: ParameterOf | DofOf | RateOf | EffortOf | StateOf | InputOf | AttributeOf,
    names: Names,
) -> str:
    match expression:
        case EffortOf():
            return "u"
        case RateOf(occurrence, name):
            return f"rate({_owned(occurrence, name, names)})"
        case AttributeOf():
            return attribute_text(expression, names)
        case ParameterOf(occurrence, name) | DofOf(occurrence, name):
            return _owned(occurrence, name, names)
        case StateOf(occurrence, name) | InputOf(occurrence, name):
            return _owned(occurrence, name, names)


def _owned(occurrence: int, name: str, names: Names) -> str:
    return name if occurrence == THIS else f"{names(occurrence)}.{name}"


def _at_least(rank: int, expression: Expr, names: Names) -> str:
    """The text of an expression, in parentheses if its rank is below ``rank``."""
    text, own = _ranked(expression, names)
    return text if own >= rank else f"({text})"
