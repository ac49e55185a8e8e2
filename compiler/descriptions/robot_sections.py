"""What a robot consists of: the symbols of its equations of motion and what drives it."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from compiler.descriptions.document import Entry, Equation, Item, Remark, Section, escaped
from compiler.descriptions.domain_text import closed_text, domain_text
from compiler.descriptions.model_symbols import model_symbols
from compiler.expressions.trigonometric_polynomial import Variable
from compiler.robots.own_dynamics import OwnDynamics
from compiler.robots.robot import RobotDof, RobotModel
from compiler.robots.state_and_input import RobotInput, robot_inputs, robot_states
from grammar_lang import ir
from grammar_lang.ir.expression_text import expression_text, number_text

RANGE_UNITS = {"revolute": "rad", "prismatic": "m"}
RATE_UNITS = {"revolute": "rad/s", "prismatic": "m/s"}


def robot_sections(
    model: RobotModel, word: Sequence[str], task: ir.Task | None
) -> Iterator[Section]:
    """Coordinates, parameters, inputs, states and the equation they enter.

    ``task`` bounds the free inputs.
    """
    yield Section("Coordinates", tuple(_coordinates(model, word)))
    yield Section("Parameters", tuple(_parameters(model)) or (Remark("none"),))
    yield Section("Inputs", tuple(_inputs(model, word, task)) or (Remark("none"),))
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
    return f"{found}, rate {domain_text(dof.rate, RATE_UNITS[dof.kind])}"


def _parameters(model: RobotModel) -> Iterator[Item]:
    symbols = model_symbols(model).parameters
    for symbol, parameter in zip(symbols, model.parameters, strict=True):
        meaning = f"{parameter.name} of {parameter.module} at {parameter.symbol}"
        yield Entry(symbol, meaning, domain_text(parameter.domain, parameter.unit))


def _inputs(model: RobotModel, word: Sequence[str], task: ir.Task | None) -> Iterator[Item]:
    for number, entry in enumerate(robot_inputs(model), 1):
        symbol = f"u{number}", f"u_{{{number}}}"
        yield Entry(symbol, _meaning(model, entry, word), _bounds(model, entry, task))
    for effort in task.effort if task is not None else ():
        if effort.norm2:
            bound = number_text(effort.bound)
            yield Remark(f"the Euclidean norm of the {effort.kind} free inputs is at most {bound}")


def _meaning(model: RobotModel, entry: RobotInput, word: Sequence[str]) -> str:
    if entry.dof is None:
        return f"{entry.name} of {entry.module} at {entry.symbol}"
    return f"free input of q{entry.dof + 1}, {_joints(model.dofs[entry.dof], word)}"


def _bounds(model: RobotModel, entry: RobotInput, task: ir.Task | None) -> str:
    if entry.dof is None:
        return domain_text(entry.domain, entry.unit)
    if task is None:
        return f"in {entry.unit}, bounded by a task"
    kind = model.dofs[entry.dof].kind
    bounds = [e.bound for e in task.effort if e.kind == kind and not e.norm2]
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
    """What the module's own names stand for."""
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


def _equation(left: tuple[str, str], right: tuple[str, str]) -> Equation:
    text, latex = right
    return Equation(left, ([(False, text)], [(False, latex)]))
