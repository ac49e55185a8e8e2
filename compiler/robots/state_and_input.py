"""What the state and input vectors of a robot hold, entry by entry."""

from __future__ import annotations

from dataclasses import dataclass

from compiler.robots.own_dynamics import OwnDynamics
from compiler.robots.robot import RobotModel
from grammar_lang import ir


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

    A free input (``u`` of the language) drives the degree of freedom ``dof`` and is bounded by the
    task (``domain`` None); a declared one has its own bounds.
    """

    symbol: int
    module: str | None
    name: str
    unit: str
    dof: int | None
    domain: ir.Interval | None


def robot_states(model: RobotModel) -> tuple[RobotState, ...]:
    """The modules' own states in the order of the word: the entries of x behind all rates."""
    return tuple(
        RobotState(own.symbol, own.module, state.name, state.unit, state.initial)
        for own in model.own
        for state in own.states
    )


def robot_inputs(model: RobotModel) -> tuple[RobotInput, ...]:
    """The entries of u in the order of the word, of one module free inputs first.

    A degree of freedom has a free input unless its module's own dynamics do without.
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
    return tuple(item for _, _, item in found)


def _without_free_input(own: OwnDynamics) -> set[int]:
    """The degrees of freedom with a torque of their own whose input is read nowhere."""
    found = (leaf for expression in own.expressions() for leaf in ir.leaves(expression))
    read = {leaf.name for leaf in found if isinstance(leaf, ir.EffortOf)}
    bound = own.bound_dofs
    return {bound[torque.dof] for torque in own.torques if torque.dof not in read}
