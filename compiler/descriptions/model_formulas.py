"""The functions of a robot's equations of motion as formulas for readers."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from fractions import Fraction

import casadi as ca

from compiler.descriptions.document import Entry, Equation, Item, Remark, Section, escaped
from compiler.descriptions.expression_printer import ExpressionPrinter, LatexNotation, TextNotation
from compiler.descriptions.model_symbols import (
    ModelSymbols,
    closed_text,
    domain_text,
    model_symbols,
)
from compiler.dynamics.equations_of_motion import RobotGraph, robot_graph
from compiler.expressions.evaluators.trigonometric import (
    MOST_TERMS,
    CanonicalEvaluator,
    NamingEvaluator,
    TooManyTerms,
)
from compiler.expressions.exact_numbers import rational_bounds
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
from compiler.robots.robot import OwnDynamics, RobotDof, RobotModel
from compiler.robots.state_and_input import (
    EFFORT_UNITS,
    RobotInput,
    dry_friction,
    robot_inputs,
    robot_states,
)
from grammar_lang import ir
from grammar_lang.ir.expression_text import expression_text, number_text


@dataclass(frozen=True, slots=True)
class Formulas:
    """The outputs of a function of the graph, and the named results that they use, in order."""

    ring: PolynomialRing
    named: tuple[Abbreviation, ...]
    outputs: tuple[TrigonometricPolynomial, ...]


def formulas(
    graph: RobotGraph,
    function: ca.Function,
    wanted: Sequence[int] | None = None,
) -> Formulas:
    """A function of (q, theta, k) or (q, v, theta, k) of a graph in joint coordinates.

    It is in canonical form, or with named intermediate results if that is too long; ``wanted`` are
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
    """Keep only the named results that the outputs need, and renumber them."""
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
    """The symbols of a polynomial, including those in its angles, in ascending order."""
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
    """Writes formulas; intermediate results are numbered across all of them."""

    symbols: ModelSymbols
    shown: int = 0
    results: list[Item] = field(default_factory=list[Item])

    def equations(self, formulas: Formulas, lefts: Sequence[tuple[str, str]]) -> Iterator[Equation]:
        """One equation for each output; the intermediate results they need are recorded."""
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
    """M, c, g and the effectors' positions, then the intermediate results that they use."""
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
    """The names of the entries of M on and above the diagonal, row by row."""
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


# --- The parts of a robot: the symbols of its equations of motion and its drives ------------------


RANGE_UNITS = {"revolute": "rad", "prismatic": "m"}
RATE_UNITS = {"revolute": "rad/s", "prismatic": "m/s"}
ACCELERATION_UNITS = {"revolute": "rad/s^2", "prismatic": "m/s^2"}


def robot_sections(
    model: RobotModel, word: Sequence[str], task: ir.Task | None
) -> Iterator[Section]:
    """Coordinates, parameters, inputs, states and the equations in which they occur.

    ``task`` bounds the free inputs.
    """
    yield Section("Coordinates", tuple(_coordinates(model, word)))
    yield Section("Parameters", tuple(_parameters(model)) or (Remark("none"),))
    yield Section("Inputs", tuple(_input_rows(model, word, task)) or (Remark("none"),))
    if model.own:
        yield Section("Dynamics of the modules", tuple(_own(model)))
    yield Section("Equations of motion", tuple(_motion(model)))


def _coordinates(model: RobotModel, word: Sequence[str]) -> Iterator[Item]:
    for number, dof in enumerate(model.dofs, 1):
        symbol = f"q{number}", f"q_{{{number}}}"
        yield Entry(symbol, f"{dof.kind} {dof.axis}, {_joints(dof, word)}", _limits(dof))
    if not model.dofs:
        yield Remark("none: the robot is rigid")
    for joint in model.removed:
        yield Remark(f"removed, since it moves nothing: {word[joint]} at {joint}")


def _joints(dof: RobotDof, word: Sequence[str]) -> str:
    places = " and ".join(f"{word[symbol]} at {symbol}" for symbol in dof.symbols)
    return places if len(dof.symbols) == 1 else f"{places} merged"


def _limits(dof: RobotDof) -> str:
    found = domain_text(dof.range, RANGE_UNITS[dof.kind])
    found = f"{found}, rate {domain_text(dof.rate, RATE_UNITS[dof.kind])}"
    if dof.accel is not None:
        most = number_text(rational_bounds(dof.accel)[0])
        found = f"{found}, acceleration up to {most} {ACCELERATION_UNITS[dof.kind]}"
    if dof.coulomb is not None:
        size = number_text(rational_bounds(dof.coulomb)[0])
        found = f"{found}, dry friction {size} {EFFORT_UNITS[dof.kind]}"
    return found


def _parameters(model: RobotModel) -> Iterator[Item]:
    symbols = model_symbols(model).parameters
    for symbol, parameter in zip(symbols, model.parameters, strict=True):
        meaning = f"{parameter.name} of {parameter.module} at {parameter.symbol}"
        yield Entry(symbol, meaning, domain_text(parameter.domain, parameter.unit))


def _input_rows(model: RobotModel, word: Sequence[str], task: ir.Task | None) -> Iterator[Item]:
    for number, entry in enumerate(robot_inputs(model), 1):
        symbol = f"u{number}", f"u_{{{number}}}"
        yield Entry(symbol, _meaning(model, entry, word), _bounds(model, entry, task))
    for effort in task.effort if task is not None else ():
        if effort.norm2:
            bound = number_text(effort.bound)
            yield Remark(f"the Euclidean norm of the {effort.kind} free inputs is at most {bound}")


def _meaning(model: RobotModel, entry: RobotInput, word: Sequence[str]) -> str:
    if entry.is_load:
        return f"whether the {entry.name} is there, which M, c and g leave out"
    if entry.dof is None:
        return f"{entry.name} of {entry.module} at {entry.symbol}"
    return f"free input of q{entry.dof + 1}, {_joints(model.dofs[entry.dof], word)}"


def _bounds(model: RobotModel, entry: RobotInput, task: ir.Task | None) -> str:
    if entry.is_load:
        return "0 or 1"
    if entry.dof is None:
        return domain_text(entry.domain, entry.unit)
    dof = model.dofs[entry.dof]
    bounds = [] if dof.effort is None else [rational_bounds(dof.effort)[0]]
    if task is None and not bounds:
        return f"in {entry.unit}, bounded by a task"
    efforts = () if task is None else task.effort
    bounds += [e.bound for e in efforts if e.kind == dof.kind and not e.norm2]
    if not bounds:
        return f"in {entry.unit}"
    bound = number_text(min(bounds))
    return f"in [-{bound}, {bound}] {entry.unit}"


def _own(model: RobotModel) -> Iterator[Item]:
    places = {(s.symbol, s.name): i for i, s in enumerate(robot_states(model), 1)}
    for number, state in enumerate(robot_states(model), 1):
        initial = "0" if state.initial is None else closed_text(state.initial)
        meaning = f"state {state.name} of {state.module} at {state.symbol}"
        bounds = f"starts at {initial} {'' if state.unit == '1' else state.unit}".rstrip()
        yield Entry((f"s{number}", f"s_{{{number}}}"), meaning, bounds)
    for own in model.own:
        yield Remark(f"{own.module} at {own.symbol}: {', '.join(_called(model, own, places))}")
        for state_rule in own.states:
            yield Remark(f"  {state_rule.name}' = {_text(state_rule.derivative)}")
        for torque in own.torques:
            yield Remark(f"  torque({torque.dof}) = {_text(torque.value)}")


def _text(expression: ir.Expr) -> str:
    return expression_text(expression, str)


def _called(
    model: RobotModel, own: OwnDynamics, states: dict[tuple[int, str], int]
) -> Iterator[str]:
    """The meanings of the module's own names."""
    parameters = model_symbols(model)
    for name, dof in own.dofs:
        yield f"{name} is 0" if dof is None else f"{name} is q{dof + 1}"
    for number, entry in enumerate(robot_inputs(model), 1):
        mine = [name for name, dof in own.dofs if dof is not None and dof == entry.dof]
        for name in mine:
            yield f"u is u{number}" if len(own.dofs) == 1 else f"u of {name} is u{number}"
        if entry.dof is None and entry.symbol == own.symbol:
            yield f"{entry.name} is u{number}"
    for state in own.states:
        yield f"{state.name} is s{states[own.symbol, state.name]}"
    for name, index in own.parameters:
        yield f"{name} is {parameters.text(Variable('parameter', index))}"


def _motion(model: RobotModel) -> Iterator[Item]:
    if not model.dofs:
        yield Remark("none")
        return
    left = "M(q)*qdd + c(q, qd) + g(q)", r"M(q)\,\ddot{q} + c(q, \dot{q}) + g(q)"
    yield _equation(left, ("tau", r"\tau"))
    driven = {
        dof: f"torque({name}) of {own.module} at {own.symbol}"
        for own in model.own
        for name, dof in own.bound_dofs.items()
        if any(torque.dof == name for torque in own.torques)
    }
    free = {e.dof: i for i, e in enumerate(robot_inputs(model), 1) if e.dof is not None}
    for dof in range(len(model.dofs)):
        force = f"tau{dof + 1}", rf"\tau_{{{dof + 1}}}"
        if dof in driven:
            yield _equation(force, (driven[dof], rf"\text{{{escaped(driven[dof])}}}"))
        else:
            yield _equation(force, (f"u{free[dof]}", f"u_{{{free[dof]}}}"))
    for dof, size in dry_friction(model).items():
        amount = f"{number_text(rational_bounds(size)[0])} {EFFORT_UNITS[model.dofs[dof].kind]}"
        yield Remark(f"less dry friction at q{dof + 1}: {amount} against qd{dof + 1}, less at rest")


def _equation(left: tuple[str, str], right: tuple[str, str]) -> Equation:
    text, latex = right
    return Equation(left, ([(False, text)], [(False, latex)]))
