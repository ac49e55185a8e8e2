"""The entries of a robot's state and input vectors, and the bounds of the inputs in a task."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction

from compiler.expressions.exact_numbers import rational_bounds
from compiler.robots.payloads import loads_of
from compiler.robots.robot import OwnDynamics, RobotModel
from grammar_lang import ir

# --- The entries of the state and input vectors of a robot ---------------------------------------


@dataclass(frozen=True, slots=True)
class RobotState:
    """A state of the module at word index ``symbol``; ``unit`` is its SI unit as text."""

    symbol: int
    module: str
    name: str
    unit: str
    initial: ir.Expr | None


@dataclass(frozen=True, slots=True)
class RobotInput:
    """An input of the module at word index ``symbol``.

    A free input (``u`` in the language) drives the degree of freedom ``dof`` and is bounded by the
    task (``domain`` is None); a declared input has its own bounds. A load belongs to no module: it
    is 1 while its effector carries it, else 0.
    """

    symbol: int
    module: str | None
    name: str
    unit: str
    dof: int | None
    domain: ir.Interval | None

    @property
    def is_load(self) -> bool:
        """Whether it is a load, which says that something is carried."""
        return self.dof is None and self.module is None


def robot_states(model: RobotModel) -> tuple[RobotState, ...]:
    """The modules' own states in word order: the entries of x after all rates."""
    return tuple(
        RobotState(own.symbol, own.module, state.name, state.unit, state.initial)
        for own in model.own
        for state in own.states
    )


def robot_inputs(model: RobotModel) -> tuple[RobotInput, ...]:
    """The entries of u in word order, within a module free inputs first; then the loads.

    A degree of freedom has a free input unless its module's own dynamics do not use it.
    """
    found: list[tuple[int, int, RobotInput]] = []
    without = {dof for own in model.own for dof in _without_free_input(own)}
    for number, dof in enumerate(model.dofs):
        if number not in without:
            unit = "N*m" if dof.kind == "revolute" else "N"
            symbol = dof.symbols[0]
            found.append((symbol, 0, RobotInput(symbol, None, "u", unit, number, None)))
    for own in model.own:
        for item in own.inputs:
            declared = RobotInput(own.symbol, own.module, item.name, item.unit, None, item.domain)
            found.append((own.symbol, 1, declared))
    found.sort(key=lambda entry: entry[:2])
    inputs = [item for _, _, item in found]
    loads = loads_of(model)
    for number in loads:
        effector = model.effectors.index(model.bodies[number].frame) + 1
        name = "load" if len(loads) == 1 else f"load {effector}"
        inputs.append(RobotInput(-1, None, name, "1", None, None))
    return tuple(inputs)


def _without_free_input(own: OwnDynamics) -> set[int]:
    """The degrees of freedom with an own torque whose free input nothing reads."""
    found = (leaf for expression in own.expressions() for leaf in ir.leaves(expression))
    read = {leaf.name for leaf in found if isinstance(leaf, ir.EffortOf)}
    bound = own.bound_dofs
    return {bound[torque.dof] for torque in own.torques if torque.dof not in read}


# --- Exact bounds of the inputs of a robot in a task (C.3 of the paper, Theta and U) --------------


SEVERAL_UNITS = "SI"
"""Instead of the unit of several quantities of different units."""
EFFORT_UNITS: dict[ir.DofKind, str] = {"revolute": "N*m", "prismatic": "N"}


@dataclass(frozen=True, slots=True)
class InputBound:
    """Inputs, by their positions in u, that share one bound in SI units.

    Each of them lies in [lower, upper]; with ``norm2`` their Euclidean norm is at most ``upper``.
    ``effort`` says that they are free inputs, bounded by the task.
    """

    inputs: tuple[int, ...]
    lower: Fraction
    upper: Fraction
    unit: str
    name: str
    norm2: bool = False
    effort: bool = False

    @property
    def widest_margin(self) -> Fraction:
        """The margin of inputs at the middle of their bounds."""
        return self.upper if self.norm2 else (self.upper - self.lower) / 2

    def margin(self, row: Sequence[Fraction]) -> Fraction:
        """The distance of one step's inputs (m,) from the bound; not defined for a norm."""
        return min(min(row[i] - self.lower, self.upper - row[i]) for i in self.inputs)


def joint_names(model: RobotModel) -> tuple[str, ...]:
    """The degrees of freedom for people: ``Quill.sz``, or ``Arm.q (joint 2)`` if there are two."""
    every = [dof.called for dof in model.dofs]
    numbers = [f"joint {number}" for number in range(1, len(every) + 1)]
    return tuple(
        number if not name else name if every.count(name) == 1 else f"{name} ({number})"
        for name, number in zip(every, numbers, strict=True)
    )


def input_bounds(model: RobotModel, task: ir.Task) -> tuple[InputBound, ...]:
    """The bounds of all inputs: the task's efforts, in order, then joints', then declared inputs'.

    An irrational bound is replaced by a rational one just inside it.
    """
    inputs = robot_inputs(model)
    found = [
        InputBound(
            places, -effort.bound, effort.bound, EFFORT_UNITS[effort.kind], "effort",
            effort.norm2, effort=True,
        )
        for effort in task.effort
        if (places := _shared(model, inputs, effort))
    ]  # fmt: skip
    bounds = {effort.kind: effort.bound for effort in task.effort if not effort.norm2}
    names = joint_names(model)
    for place, item in enumerate(inputs):
        dof = None if item.dof is None else model.dofs[item.dof]
        if item.dof is None or dof is None or dof.effort is None:
            continue
        own = rational_bounds(dof.effort)[0]
        bound = min(own, bounds.get(dof.kind, own))
        name = f"effort of {names[item.dof]}"
        unit = EFFORT_UNITS[dof.kind]
        found.append(InputBound((place,), -bound, bound, unit, name, effort=True))
    for place, item in enumerate(inputs):
        if item.domain is not None:
            lower = rational_bounds(item.domain.lower)[1]
            upper = rational_bounds(item.domain.upper)[0]
            name = f"input {item.module}.{item.name} (symbol {item.symbol})"
            found.append(InputBound((place,), lower, upper, item.unit, name))
    return tuple(found)


def common_unit(model: RobotModel, revolute: str, prismatic: str) -> str:
    """The unit of a quantity of all joints at once; ``SI`` if there are joints of both kinds."""
    kinds = {dof.kind for dof in model.dofs}
    if len(kinds) != 1:
        return SEVERAL_UNITS
    return revolute if kinds == {"revolute"} else prismatic


def rates_unit(model: RobotModel) -> str:
    """The unit of the rates of all joints."""
    return common_unit(model, "rad/s", "m/s")


def family_unit(program: ir.Program, task: ir.Task) -> str:
    """The SI unit of all inputs that robots of a task may have; "" if there are several."""
    symbols = (
        symbol.name
        for production in program.grammars[task.grammar].productions
        for symbol in production.right
        if symbol.kind == "module"
    )
    modules = [program.modules[name] for name in dict.fromkeys(symbols)]
    units = {EFFORT_UNITS[dof.kind] for module in modules for dof in module.free_dofs}
    units |= {each.unit for module in modules for each in module.inputs}
    return units.pop() if len(units) == 1 and units != {"1"} else ""


def _shared(model: RobotModel, inputs: Sequence[RobotInput], effort: ir.Effort) -> tuple[int, ...]:
    """The free inputs that a bound of the task covers.

    If the bound applies to each input separately, inputs with their own bound get the smaller of
    both.
    """
    found = []
    for place, item in enumerate(inputs):
        dof = None if item.dof is None else model.dofs[item.dof]
        if dof is not None and dof.kind == effort.kind and (effort.norm2 or dof.effort is None):
            found.append(place)
    return tuple(found)


def unbounded_kinds(model: RobotModel, task: ir.Task) -> list[ir.DofKind]:
    """The kinds of joints with a free input that neither the task nor the joint bounds."""
    dofs = (model.dofs[item.dof] for item in robot_inputs(model) if item.dof is not None)
    free = {dof.kind for dof in dofs if dof.effort is None}
    return sorted(free - {effort.kind for effort in task.effort})


def dry_friction(model: RobotModel) -> dict[int, ir.Expr]:
    """The magnitude of dry friction (closed, SI units), by the number of the joint."""
    return {i: d.coulomb for i, d in enumerate(model.dofs) if d.coulomb is not None}
