"""The functions of a robot's equations of motion as formulas for a person."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from fractions import Fraction

import casadi as ca

from compiler.descriptions.document import Equation, Item, Remark, Section
from compiler.descriptions.expression_printer import ExpressionPrinter, LatexNotation, TextNotation
from compiler.descriptions.model_symbols import ModelSymbols, model_symbols
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
from grammar_lang.ir.expression_text import number_text


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


AXES = ("x", "y", "z")


@dataclass(slots=True)
class _Writer:
    """Writes formulas; intermediate results are numbered through all of them."""

    symbols: ModelSymbols
    shown: int = 0
    results: list[Item] = field(default_factory=list[Item])

    def equations(self, formulas: Formulas, lefts: Sequence[tuple[str, str]]) -> Iterator[Equation]:
        """One equation per output; the intermediate results they need are noted."""
        numbers = {item.number: self.shown + i + 1 for i, item in enumerate(formulas.named)}
        self.shown += len(numbers)
        text = ExpressionPrinter(formulas.ring, TextNotation(), self.symbols.text, numbers)
        latex = ExpressionPrinter(formulas.ring, LatexNotation(), self.symbols.latex, numbers)

        def equation(left: tuple[str, str], right: TrigonometricPolynomial) -> Equation:
            return Equation(left, (text.pieces(right), latex.pieces(right)))

        for item in formulas.named:
            number = numbers[item.number]
            named = text.notation.named(number), latex.notation.named(number)
            self.results.append(equation(named, item.value))
        for left, output in zip(lefts, formulas.outputs, strict=True):
            yield equation(left, output)


def motion_sections(described: ModelFormulas) -> list[Section]:
    """M, c, g and the effectors' positions, then the intermediate results they are made of."""
    model, writer = described.model, _Writer(model_symbols(described.model))
    n = len(model.dofs)
    sections: list[Section] = []
    if n:
        mass = writer.equations(described.mass, _mass_names(n))
        bias = writer.equations(described.centrifugal, _vector_names("c", n))
        remark = Remark("symmetric: the entries on and above the diagonal")
        sections += [
            Section("Mass matrix M", (remark, *mass)),
            Section("Centrifugal and Coriolis forces c", tuple(bias)),
            Section("Gravitational forces g", tuple(_gravitational(described, writer))),
        ]
    tips = writer.equations(described.effectors, _tip_names(model.dimension, len(model.effectors)))
    positions = tuple(tips) or (Remark("none"),)
    sections.append(Section("Positions of the effectors, in m", positions))
    if writer.results:
        sections.append(Section("Intermediate results", tuple(writer.results)))
    return sections


def _gravitational(described: ModelFormulas, writer: _Writer) -> Iterator[Item]:
    if not any(described.gravity):
        yield Remark("none: g = 0")
        return
    pull = ", ".join(number_text(value) for value in described.gravity)
    yield Remark(f"for gravity ({pull}) m/s^2")
    names = _vector_names("g", len(described.model.dofs))
    yield from writer.equations(described.gravitational, names)


def _mass_names(n: int) -> list[tuple[str, str]]:
    """The entries of M on and above the diagonal, row by row."""
    text, latex = ("M{}{}", "M_{{{}{}}}") if n < 10 else ("M{}_{}", "M_{{{},{}}}")
    places = [(i, j) for i in range(1, n + 1) for j in range(i, n + 1)]
    return [(text.format(*place), latex.format(*place)) for place in places]


def _vector_names(name: str, n: int) -> list[tuple[str, str]]:
    return [(f"{name}{i}", f"{name}_{{{i}}}") for i in range(1, n + 1)]


def _tip_names(dimension: int, effectors: int) -> list[tuple[str, str]]:
    return [
        (f"e{number}_{axis}", f"e_{{{number},{axis}}}")
        for number in range(1, effectors + 1)
        for axis in AXES[:dimension]
    ]
