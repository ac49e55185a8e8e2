"""The functions of a robot's equations of motion as formulas for a person."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction

import casadi as ca

from compiler.dynamics.equations_of_motion import RobotGraph, robot_graph
from compiler.expressions.evaluators.trigonometric import (
    MOST_TERMS,
    CanonicalEvaluator,
    NamingEvaluator,
    TooManyTerms,
)
from compiler.expressions.scalars import evaluate_constant
from compiler.expressions.tape import tape
from compiler.expressions.trigonometric_polynomial import (
    Abbreviation,
    Opaque,
    PolynomialRing,
    Symbol,
    TrigonometricPolynomial,
    Variable,
)
from compiler.robots.robot import RobotModel


@dataclass(frozen=True, slots=True)
class Formulas:
    """The outputs of a function of the graph, and the named results they are made of, in order."""

    ring: PolynomialRing
    named: tuple[Abbreviation, ...]
    outputs: tuple[TrigonometricPolynomial, ...]


def formulas(
    graph: RobotGraph,
    function: ca.Function,
    wanted: Sequence[int] | None = None,
) -> Formulas:
    """A function of (q, theta, k) or (q, v, theta, k) of a graph in joint coordinates.

    In canonical form, or with named intermediate results where that is too long; ``wanted`` are
    the outputs to read, by default all.
    """
    program, rates = tape(function), function.n_in() == 4
    evaluator = CanonicalEvaluator(PolynomialRing())
    try:
        found = program.evaluate(_inputs(graph, evaluator, rates=rates), evaluator)
        found = found if wanted is None else [found[i] for i in wanted]
        if all(len(number.terms) <= MOST_TERMS for number in found):
            return Formulas(evaluator.ring, (), tuple(found))
    except TooManyTerms:
        pass
    naming = NamingEvaluator(PolynomialRing())
    found = program.evaluate(_inputs(graph, naming, rates=rates), naming)
    found = found if wanted is None else [found[i] for i in wanted]
    return _used(naming.ring, naming.named, found)


def _inputs(
    graph: RobotGraph, evaluator: CanonicalEvaluator | NamingEvaluator, *, rates: bool
) -> list[TrigonometricPolynomial]:
    """The inputs of a function; coordinates first, so that angles begin with them."""
    n, p = len(graph.model.dofs), len(graph.model.parameters)
    ring = evaluator.ring
    coordinates = [ring.symbol(Variable("coordinate", i)) for i in range(n)]
    parameters = [ring.symbol(Variable("parameter", i)) for i in range(p)]
    velocities = [ring.symbol(Variable("rate", i)) for i in range(n if rates else 0)]
    constants = [evaluate_constant(constant, evaluator) for constant in graph.constants]
    return [*coordinates, *velocities, *parameters, *constants]


def _used(
    ring: PolynomialRing,
    named: Sequence[Abbreviation],
    outputs: Sequence[TrigonometricPolynomial],
) -> Formulas:
    """Only the named results that the outputs need, numbered again."""
    needed: set[int] = set()
    todo = list(outputs)
    while todo:
        for symbol in symbols_of(ring, todo.pop()):
            match symbol:
                case Abbreviation(number, value) if number not in needed:
                    needed.add(number)
                    todo.append(value)
                case Opaque(_, argument):
                    todo.append(argument)
                case _:
                    pass
    kept = tuple(item for item in named if item.number in needed)
    return Formulas(ring, kept, tuple(outputs))


def symbols_of(ring: PolynomialRing, number: TrigonometricPolynomial) -> list[Symbol]:
    """The symbols of a polynomial, its angles included, in ascending order."""
    found = {s for (_, monomial) in number.terms for s, _ in monomial}
    for (_, angle), _ in number.terms:
        found.update(s for monomial, _ in angle for s, _ in monomial)
    return [ring.symbols[s] for s in sorted(found)]


@dataclass(frozen=True, slots=True)
class ModelFormulas:
    """The functions of a robot's equations of motion as formulas, in the joints' coordinates.

    ``mass`` holds the entries of M on and above its diagonal row by row, ``centrifugal`` c (n,),
    ``gravitational`` g (n,), ``effectors`` positions (d * e,).
    """

    model: RobotModel
    gravity: tuple[Fraction, ...]
    graph: RobotGraph
    mass: Formulas
    centrifugal: Formulas
    gravitational: Formulas
    effectors: Formulas


def model_formulas(model: RobotModel, gravity: tuple[Fraction, ...] = ()) -> ModelFormulas:
    """The formulas of a robot; ``gravity`` in m/s^2."""
    graph, n = robot_graph(model, gravity), len(model.dofs)
    return ModelFormulas(
        model,
        gravity,
        graph,
        formulas(graph, graph.mass_matrix, [j * n + i for i in range(n) for j in range(i, n)]),
        formulas(graph, graph.centrifugal),
        formulas(graph, graph.gravitational),
        formulas(graph, graph.effectors),
    )
