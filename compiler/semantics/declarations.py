"""What the modules of a word bring into a robot: parameters, degrees of freedom, own dynamics."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from compiler.robots.own_dynamics import OwnDynamics, own_dynamics
from compiler.robots.robot import RobotDof, RobotParameter
from grammar_lang import ir


@dataclass(slots=True)
class Declarations:
    """Parameters and degrees of freedom in word order, numbered by word index and name."""

    parameters: list[RobotParameter] = field(default_factory=list[RobotParameter])
    parameter_index: dict[tuple[int, str], int] = field(default_factory=dict[tuple[int, str], int])
    dofs: list[RobotDof] = field(default_factory=list[RobotDof])
    dof_index: dict[tuple[int, str], int] = field(default_factory=dict[tuple[int, str], int])
    own: list[OwnDynamics] = field(default_factory=list[OwnDynamics])

    def declare(self, index: int, module: ir.Module) -> None:
        """Add the module at a word index."""
        for parameter in module.parameters:
            self.parameter_index[index, parameter.name] = len(self.parameters)
            self.parameters.append(
                RobotParameter(index, module.name, parameter.name, parameter.domain, parameter.unit)
            )
        for dof in module.dofs:
            self.dof_index[index, dof.name] = len(self.dofs)
            self.dofs.append(RobotDof((index,), dof.kind, dof.axis, dof.range, dof.rate))
        own = own_dynamics(index, module, self.parameter_index, self.dof_index)
        if own is not None:
            self.own.append(own)


def declarations(word: Sequence[str], modules: Mapping[str, ir.Module]) -> Declarations:
    """What the modules of a word declare; edges declare nothing."""
    found = Declarations()
    for index, symbol in enumerate(word):
        if symbol in modules:
            found.declare(index, modules[symbol])
    return found
