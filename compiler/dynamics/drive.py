r"""What drives a robot: the generalised forces on its joints, and its modules' own states.

.. math:: \tau = \tau(q, \dot q, s, u, \theta), \qquad \dot s = \sigma(q, \dot q, s, u, \theta)

A joint without dynamics of its own is driven by its free input alone (Definition 5).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import casadi as ca

from compiler.dynamics.symbolic_evaluator import SymbolicEvaluator
from compiler.expressions.evaluator import evaluate_expression
from compiler.robots.own_dynamics import OwnDynamics
from compiler.robots.robot import RobotModel
from compiler.robots.state_and_input import robot_inputs, robot_states
from grammar_lang import ir


@dataclass(frozen=True, slots=True)
class Drive:
    """Generalised forces (n,) on the joints' own coordinates, and the derivatives of s (r,)."""

    forces: ca.SX
    derivatives: ca.SX


@dataclass(frozen=True, slots=True)
class Motion:
    """What a drive may depend on, as columns: the joints' own q and rates, s, u and theta."""

    q: ca.SX
    rates: ca.SX
    states: ca.SX
    inputs: ca.SX
    parameters: ca.SX


def drive(model: RobotModel, motion: Motion, constants: SymbolicEvaluator) -> Drive:
    """The drive of a robot as expressions."""
    state_places = {(s.symbol, s.name): i for i, s in enumerate(robot_states(model))}
    forces = [ca.SX(0)] * len(model.dofs)
    efforts: dict[int, ca.SX] = {}
    declared: dict[tuple[int, str], ca.SX] = {}
    for place, entry in enumerate(robot_inputs(model)):
        if entry.dof is None:
            declared[entry.symbol, entry.name] = motion.inputs[place]
        else:
            efforts[entry.dof] = motion.inputs[place]
            forces[entry.dof] = motion.inputs[place]
    derivatives = [ca.SX(0)] * len(state_places)
    for own in model.own:
        reader = _Reader(own, motion, state_places, efforts, declared, constants)
        for state in own.states:
            derivatives[state_places[own.symbol, state.name]] = reader.read(state.derivative)
        for torque in own.torques:
            forces[own.bound_dofs[torque.dof]] = reader.read(torque.value)
    return Drive(_column(forces), _column(derivatives))


@dataclass(frozen=True, slots=True)
class _Reader:
    """Reads the expressions of one module's own dynamics."""

    own: OwnDynamics
    motion: Motion
    states: Mapping[tuple[int, str], int]
    efforts: Mapping[int, ca.SX]
    declared: Mapping[tuple[int, str], ca.SX]
    constants: SymbolicEvaluator

    def read(self, expression: ir.Expr) -> ca.SX:
        """The graph node of a scalar expression."""
        return evaluate_expression(expression, self.constants, self.leaf)

    def leaf(self, leaf: ir.Expr) -> ca.SX:
        """The graph node of a leaf; what belongs to a lost degree of freedom reads zero."""
        match leaf:
            case ir.ParameterOf(_, name):
                return self.motion.parameters[dict(self.own.parameters)[name]]
            case ir.StateOf(_, name):
                return self.motion.states[self.states[self.own.symbol, name]]
            case ir.InputOf(_, name):
                return self.declared[self.own.symbol, name]
            case ir.DofOf(_, name):
                return self.of_dof(name, lambda dof: self.motion.q[dof])
            case ir.RateOf(_, name):
                return self.of_dof(name, lambda dof: self.motion.rates[dof])
            case ir.EffortOf(_, name):
                return self.of_dof(name, lambda dof: self.efforts[dof])
            case _:
                raise TypeError(f"no scalar of a module's own dynamics: {leaf}")

    def of_dof(self, name: str, value: Callable[[int], ca.SX]) -> ca.SX:
        """A value that belongs to a degree of freedom."""
        dof = self.own.bound_dofs.get(name)
        return ca.SX(0) if dof is None else value(dof)


def _column(entries: list[ca.SX]) -> ca.SX:
    return ca.vertcat(*entries) if entries else ca.SX(0, 1)
