"""Frames and declarations during attribute evaluation, and a robot's table of frames."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import TypeAlias

from compiler.expressions.scalars import Apply, ScalarNode
from compiler.robots.robot import (
    WORLD,
    FrameNode,
    Joint,
    Offset,
    OwnDynamics,
    RobotDof,
    RobotParameter,
    Step,
    Turn,
    own_dynamics,
)
from grammar_lang import ir

# --- The error for semantic rules that define no robot --------------------------------------------


class SemanticsError(ValueError):
    """The semantic rules do not give a robot for this derivation."""


# --- Frames during attribute evaluation, and the table of the frames that a robot keeps -----------
#
# A frame attribute is a product of steps that may be put behind any other: ``move(x, 1) * A.end``
# takes constant time, however long ``A.end`` is. Steps are laid out from the world and numbered
# only where something is emitted.


@dataclass(frozen=True, slots=True, eq=False)
class Product:
    """A frame: ``right``, a step or a frame, after ``left``; None is the world.

    Products are compared by identity: each is laid out once for each start.
    """

    left: Frame
    right: Step | Product


Frame: TypeAlias = Product | None


def product(left: Frame, right: Frame) -> Frame:
    """``left * right``."""
    if left is None or right is None:
        return right if left is None else left
    return Product(left, right if right.left is not None else right.right)


@dataclass(slots=True)
class FrameTable:
    """The frames and scalars that are emitted, in the order of their first use.

    ``made`` holds the scalars made during attribute evaluation; steps refer to these.
    """

    made: Sequence[ScalarNode]
    zero: int
    frames: list[FrameNode] = field(default_factory=lambda: [FrameNode(WORLD, None)])
    scalars: list[ScalarNode] = field(default_factory=list[ScalarNode])
    _steps: dict[tuple[int, Step], int] = field(default_factory=dict[tuple[int, Step], int])
    _ends: dict[tuple[Product, int], int] = field(default_factory=dict[tuple[Product, int], int])
    _kept: dict[int, int] = field(default_factory=dict[int, int])

    def place(self, frame: Frame) -> int:
        """The number of a frame; equal steps from one frame lead to one frame."""
        if frame is None:
            return WORLD
        current = WORLD
        todo: list[Step | Product | tuple[Product, int]] = [frame]
        while todo:
            item = todo.pop()
            if isinstance(item, tuple):
                self._ends[item] = current
            elif not isinstance(item, Product):
                current = self._step(current, item)
            elif (key := (item, current)) in self._ends:
                current = self._ends[key]
            else:
                todo += [key, item.right]
                if item.left is not None:
                    todo.append(item.left)
        return current

    def keep(self, scalar: int) -> int:
        """The final number of a scalar; its arguments come before it."""
        todo = [scalar]
        while todo:
            current = todo[-1]
            if current in self._kept:
                todo.pop()
                continue
            node = self.made[current]
            if isinstance(node, Apply):
                missing = [each for each in node.arguments if each not in self._kept]
                if missing:
                    todo += reversed(missing)
                    continue
                arguments = tuple(self._kept[each] for each in node.arguments)
                node = Apply(node.operation, arguments, node.exponent)
            self._kept[current] = len(self.scalars)
            self.scalars.append(node)
        return self._kept[scalar]

    def _step(self, parent: int, step: Step) -> int:
        """The frame reached from another by a step; the same frame if the step does nothing."""
        zero = self.zero
        if isinstance(step, Offset) and step.vector == (zero, zero, zero):
            return parent
        if isinstance(step, Turn) and step.angle == zero:
            return parent
        key = (parent, step)
        if key not in self._steps:
            self.keep(zero)
            self._steps[key] = len(self.frames)
            self.frames.append(FrameNode(parent, self._in_the_end(step)))
        return self._steps[key]

    def _in_the_end(self, step: Step) -> Step:
        match step:
            case Turn(axis, angle):
                return Turn(axis, self.keep(angle))
            case Offset((x, y, z)):
                return Offset((self.keep(x), self.keep(y), self.keep(z)))
            case Joint():
                return step


# --------------------------------------------------------------------------------------------------
# What the modules of a word declare in a robot: parameters, degrees of freedom, own dynamics.


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
            self.dofs.append(
                RobotDof(
                    (index,),
                    dof.kind,
                    dof.axis,
                    dof.range,
                    dof.rate,
                    dof.effort,
                    dof.inertia,
                    dof.accel,
                    dof.coulomb,
                    dof.gear,
                    f"{module.name}.{dof.name}",
                )
            )
        own = own_dynamics(index, module, self.parameter_index, self.dof_index)
        if own is not None:
            self.own.append(own)


def declarations(word: Sequence[str], modules: Mapping[str, ir.Module]) -> Declarations:
    """The declarations of the modules of a word; edges declare nothing."""
    found = Declarations()
    for index, symbol in enumerate(word):
        if symbol in modules:
            found.declare(index, modules[symbol])
    return found
