"""The dynamics of its own that a module brings into a robot (Definition 5)."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace

from grammar_lang import ir


@dataclass(frozen=True, slots=True)
class OwnDynamics:
    """States, declared inputs and torques of the module at word index ``symbol``.

    Their expressions name the module's own things; ``parameters`` and ``dofs`` say which of the
    robot's those are.  The coordinate, rate and input of a degree of freedom that the robot has
    lost (None) read zero.
    """

    symbol: int
    module: str
    states: tuple[ir.State, ...]
    inputs: tuple[ir.Input, ...]
    torques: tuple[ir.Torque, ...]
    parameters: tuple[tuple[str, int], ...]
    dofs: tuple[tuple[str, int | None], ...]

    @property
    def bound_dofs(self) -> dict[str, int]:
        """The robot's degrees of freedom by the names they have here."""
        return {name: dof for name, dof in self.dofs if dof is not None}

    @property
    def read_parameters(self) -> frozenset[int]:
        """The robot's parameters that the expressions name."""
        numbers = dict(self.parameters)
        found = (leaf for expression in self.expressions() for leaf in ir.leaves(expression))
        return frozenset(numbers[leaf.name] for leaf in found if isinstance(leaf, ir.ParameterOf))

    def expressions(self) -> Iterator[ir.Expr]:
        """What it is made of: derivatives, then torques."""
        yield from (state.derivative for state in self.states)
        yield from (torque.value for torque in self.torques)

    def renumbered(self, places: Mapping[int, int]) -> OwnDynamics:
        """The same after the robot's degrees of freedom got new numbers; the others are lost.

        What then acts on no degree of freedom is left out.
        """
        dofs = tuple((name, None if dof is None else places.get(dof)) for name, dof in self.dofs)
        return replace(self, dofs=dofs).acting()

    def acting(self) -> OwnDynamics:
        """Without the states and inputs that no torque depends on, and the torques on lost dofs."""
        bound = self.bound_dofs
        torques = tuple(torque for torque in self.torques if torque.dof in bound)
        read: set[ir.Expr] = set()
        todo = [torque.value for torque in torques]
        by_name = {state.name: state for state in self.states}
        while todo:
            for leaf in ir.leaves(todo.pop()):
                if leaf not in read:
                    read.add(leaf)
                    if isinstance(leaf, ir.StateOf):
                        todo.append(by_name[leaf.name].derivative)
        return replace(
            self,
            torques=torques,
            states=tuple(s for s in self.states if ir.StateOf(ir.THIS, s.name) in read),
            inputs=tuple(i for i in self.inputs if ir.InputOf(ir.THIS, i.name) in read),
        )


def own_dynamics(
    symbol: int,
    module: ir.Module,
    parameters: Mapping[tuple[int, str], int],
    dofs: Mapping[tuple[int, str], int],
) -> OwnDynamics | None:
    """The dynamics of the module at a word index; None if it has none.

    ``parameters`` and ``dofs`` number the robot's by word index and name.
    """
    if not (module.states or module.inputs or module.torques):
        return None
    return OwnDynamics(
        symbol,
        module.name,
        module.states,
        module.inputs,
        module.torques,
        tuple((p.name, parameters[symbol, p.name]) for p in module.parameters),
        tuple((d.name, dofs[symbol, d.name]) for d in module.dofs),
    )
