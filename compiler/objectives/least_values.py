"""Lower bounds on the objectives of a structure: from its symbols, and from its robot.

The weights of symbols add up to a bound that orders whole languages; the robot of a structure gives
a sharper bound. Both hold for all values of the parameters. No body of a proved design has a
negative mass, so no part of a sum reduces another.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from math import prod

from flint import arb

from compiler.expressions.evaluator import evaluate_expression
from compiler.expressions.evaluators.balls import (
    ball,
    closed_ball,
    scalar_balls,
    working_precision,
)
from compiler.expressions.evaluators.intervals import INTERVALS, Ends, between
from compiler.expressions.exact_numbers import Bounds, outward, rational_bounds
from compiler.expressions.scalars import MonomialEvaluator, evaluate_scalars
from compiler.neutral_modules.neutral_parameters import inlined
from compiler.objectives.objective_text import objective_text
from compiler.objectives.word_weights import Weights, weights_of_modules
from compiler.robots.parameter_values import ExactValue
from compiler.robots.robot import PointBody, RobotModel, RodBody, SolidBody
from grammar_lang import ir

PRECISION = 128
NONE = Fraction(0)


@dataclass(frozen=True, slots=True)
class Amount:
    """An objective in a family: ``weights`` of symbols, in SI units, 0 for symbols not named.

    A word has at least the sum of its weights; ``exact``: every robot of it has exactly that.
    """

    objective: ir.Objective
    weights: Weights
    exact: bool

    @property
    def text(self) -> str:
        """The objective as it is written."""
        return objective_text(self.objective)

    @property
    def is_ordering(self) -> bool:
        """Whether words can be ordered by it before they are searched."""
        return self.objective.kind not in ("effort", "energy", "time")

    def of_word(self, word: Iterable[str]) -> Fraction:
        """The lower bound from the weights of a word."""
        return sum((self.weights.get(symbol, NONE) for symbol in word), NONE)

    def of_robot(self, word: Sequence[str], model: RobotModel | None) -> Fraction:
        """A lower bound for a structure with any parameters; ``model`` is its robot or None."""
        least = self.of_word(word)
        if model is None or self.exact or self.objective.kind != "mass":
            return least
        bounds = mass_bounds(model, [_range(p.domain) for p in model.parameters])
        return least if bounds is None else max(least, bounds[0])


def amounts(program: ir.Program, task: ir.Task) -> tuple[Amount, ...]:
    """The objectives of a task, the most important first."""
    return tuple(_amount(program, task, objective) for objective in task.minimize)


def _amount(program: ir.Program, task: ir.Task, objective: ir.Objective) -> Amount:
    weights = weights_of_modules(program, objective, lambda domain: parameter_bounds(domain)[0])
    if weights is not None:
        chosen = any(value is None for _, value in objective.amounts)
        return Amount(objective, weights, exact=not chosen)
    if objective.kind == "mass":
        weights = _masses(program, program.grammars[task.grammar])
    return Amount(objective, weights or {}, exact=False)


def parameter_bounds(domain: ir.Interval | ir.Choices) -> Bounds:
    """Bounds of the values of a parameter."""
    if isinstance(domain, ir.Interval):
        return rational_bounds(domain.lower)[0], rational_bounds(domain.upper)[1]
    every = [rational_bounds(value) for value in domain.values]
    return min(low for low, _ in every), max(high for _, high in every)


def _range(domain: ir.Interval | ir.Choices) -> Fraction | arb:
    """The only value of a parameter, or a ball around its range."""
    low, high = parameter_bounds(domain)
    return low if low == high else ball(low).union(ball(high))


# --- Masses ---------------------------------------------------------------------------------------


def mass_bounds(model: RobotModel, parameters: Sequence[ExactValue | arb]) -> Bounds | None:
    """Bounds of the mass of all bodies except payloads, in kg; equal if it is rational.

    Args:
        model: the robot.
        parameters: the value of each of its parameters, or a ball around its range.

    Returns:
        None if it has no finite value.
    """
    exact = _exact_mass(model, parameters)
    if exact is not None:
        return exact, exact
    with working_precision(PRECISION):
        scalars = scalar_balls(model.scalars, [_ball(value) for value in parameters])
        total = ball(0)
        for factors in _masses_of(model):
            total += prod((scalars[factor] for factor in factors), start=ball(1))
        return outward(total)


def _exact_mass(model: RobotModel, parameters: Sequence[ExactValue | arb]) -> Fraction | None:
    """The mass of all bodies except payloads if it is recognised as rational, else None."""
    known = [(value, 0) if isinstance(value, Fraction) else None for value in parameters]
    evaluator = MonomialEvaluator()
    scalars = evaluate_scalars(model.scalars, evaluator, known)
    total = evaluator.constant(0)
    for factors in _masses_of(model):
        mass = evaluator.constant(1)
        for factor in factors:
            mass = evaluator.mul(mass, scalars[factor])
        total = evaluator.add(total, mass)
    return total[0] if total is not None and total[1] == 0 else None


def _masses_of(model: RobotModel) -> Iterator[tuple[int, ...]]:
    """For each body except payloads, the scalars whose product is its mass."""
    for number, body in enumerate(model.bodies):
        if number in model.payloads:
            continue
        match body:
            case RodBody(length=length, density=density):
                yield length, density
            case PointBody(mass=mass, load=None) | SolidBody(mass=mass):
                yield (mass,)
            case _:
                continue


def _ball(value: ExactValue | arb) -> arb:
    if isinstance(value, arb):
        return value
    return ball(value) if isinstance(value, Fraction) else closed_ball(value)


def _masses(program: ir.Program, grammar: ir.Grammar) -> Weights:
    """For each module a mass that it has at least, wherever it stands.

    The bodies of a production are counted at the first of its modules. Not counted are bodies of
    productions without a module, and bodies that depend on attributes.
    """
    found: dict[str, Fraction] = {}
    for production in grammar.productions:
        block = (grammar.semantics or {}).get(production.label)
        emissions = () if block is None else inlined(block).emissions
        mass = sum((_emitted(program, production, each) for each in emissions), NONE)
        for symbol in production.right:
            if symbol.kind == "module":
                found[symbol.name] = min(found.get(symbol.name, mass), mass)
                mass = NONE
    return found


def _emitted(program: ir.Program, production: ir.Production, emission: ir.Emission) -> Fraction:
    """The least mass of an emission."""
    match emission:
        case ir.Rod(length=length, density=density):
            factors = [length, density]
        case ir.PointMass(mass=mass) | ir.Solid(mass=mass):
            factors = [mass]
        case _:
            return NONE

    def leaf(expression: ir.Expr) -> Ends:
        if not isinstance(expression, ir.ParameterOf):
            raise _UnknownError
        module = program.modules[production.right[expression.occurrence].name]
        parameter = next(p for p in module.parameters if p.name == expression.name)
        return between(*parameter_bounds(parameter.domain))

    with working_precision(PRECISION):
        product = Fraction(1)
        for factor in factors:
            try:
                value = evaluate_expression(factor, INTERVALS, leaf)
            except (_UnknownError, ValueError):
                return NONE
            product *= NONE if value.undefined else max(NONE, _below(value.low))
    return product


def _below(value: arb) -> Fraction:
    bounds = outward(value)
    return NONE if bounds is None else bounds[0]


class _UnknownError(Exception):
    """A value depends on more than the parameters of a module."""
