"""Attribute evaluation: the semantic rules of a derivation, applied (FRG, Definition 6).

Instances (node of the derivation, attribute) are evaluated on demand with an explicit stack, so
a derivation may be as deep as memory allows.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import TypeAlias

from compiler.arithmetic.scalars import ScalarTable
from compiler.grammars.derivation import Derivation
from compiler.robots.own_dynamics import OwnDynamics, own_dynamics
from compiler.robots.robot import (
    WORLD,
    Body,
    FrameNode,
    Joint,
    Offset,
    PointBody,
    RobotDof,
    RobotModel,
    RobotParameter,
    RodBody,
    SolidBody,
    Step,
    Turn,
)
from grammar_lang import ir

Instance: TypeAlias = tuple[int, str]
Triple: TypeAlias = tuple[int, int, int]


@dataclass(frozen=True, slots=True)
class Scalar:
    """A scalar attribute value: an index into the scalar table."""

    index: int


@dataclass(frozen=True, slots=True)
class Frame:
    """A frame attribute value: an index into the frame table."""

    index: int


@dataclass(frozen=True, slots=True)
class Triplet:
    """A vector attribute value: three scalars."""

    items: Triple


AttributeValue: TypeAlias = Scalar | Frame | Triplet

AXES: Mapping[str, tuple[int, int]] = {
    "x": (0, 1), "y": (1, 1), "z": (2, 1), "-x": (0, -1), "-y": (1, -1), "-z": (2, -1)
}  # fmt: skip


class MissingValue(Exception):
    """The value of an instance is needed first."""

    def __init__(self, instance: Instance) -> None:
        self.instance = instance


class SemanticsError(ValueError):
    """The semantic rules do not give a robot for this derivation."""


@dataclass(slots=True)
class _Evaluation:
    """The tables that grow while a derivation is evaluated."""

    derivation: Derivation
    modules: Mapping[str, ir.Module]
    semantics: Mapping[str, ir.SemanticBlock]
    scalars: ScalarTable = field(default_factory=ScalarTable)
    frames: list[FrameNode] = field(default_factory=lambda: [FrameNode(WORLD, None)])
    frame_index: dict[tuple[int, Step], int] = field(default_factory=dict[tuple[int, Step], int])
    values: dict[Instance, AttributeValue] = field(default_factory=dict[Instance, AttributeValue])
    parents: list[tuple[int, int]] = field(default_factory=list[tuple[int, int]])
    parameters: list[RobotParameter] = field(default_factory=list[RobotParameter])
    parameter_index: dict[tuple[int, str], int] = field(default_factory=dict[tuple[int, str], int])
    dofs: list[RobotDof] = field(default_factory=list[RobotDof])
    dof_index: dict[tuple[int, str], int] = field(default_factory=dict[tuple[int, str], int])
    own: list[OwnDynamics] = field(default_factory=list[OwnDynamics])

    def __post_init__(self) -> None:
        self.parents = [(-1, -1)] * len(self.derivation.nodes)
        for number, node in enumerate(self.derivation.nodes):
            for position, symbol in enumerate(node.production.right):
                if symbol.kind == "nonterminal":
                    self.parents[node.children[position]] = (number, position)
        for index, symbol_name in enumerate(self.derivation.word):
            module = self.modules.get(symbol_name)
            if module is not None:
                self._declare(index, module)

    def _declare(self, index: int, module: ir.Module) -> None:
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

    # --- instances ------------------------------------------------------------------------------

    def rule(self, instance: Instance) -> tuple[int, ir.Expr]:
        """The node whose block defines an instance, and the defining expression.

        Raises:
            SemanticsError: no rule defines it.
        """
        node, name = instance
        production = self.derivation.nodes[node].production
        for rule in self.semantics[production.label].rules:
            if rule.target == ir.AttributeOf(ir.THIS, name):
                return node, rule.value
        parent, position = self.parents[node]
        if parent >= 0:
            above = self.derivation.nodes[parent].production
            for rule in self.semantics[above.label].rules:
                if rule.target == ir.AttributeOf(position, name):
                    return parent, rule.value
        raise SemanticsError(f"attribute `{name}` of `{production.left}` has no rule")

    def demand(self, instance: Instance) -> AttributeValue:
        """The value of an instance, evaluating whatever it needs first."""
        stack = [instance]
        open_instances = {instance}
        while stack:
            current = stack[-1]
            if current not in self.values:
                try:
                    self.values[current] = self.compute(current)
                except MissingValue as missing:
                    if missing.instance in open_instances:
                        raise SemanticsError(
                            f"attribute `{missing.instance[1]}` depends on itself"
                        ) from None
                    stack.append(missing.instance)
                    open_instances.add(missing.instance)
                    continue
            open_instances.discard(current)
            stack.pop()
        return self.values[instance]

    def compute(self, instance: Instance) -> AttributeValue:
        node, name = instance
        if self.parents[node][0] < 0 and name == "frame" and not self._synthesized(node, name):
            return Frame(WORLD)
        where, expression = self.rule(instance)
        return self.value(where, expression)

    def _synthesized(self, node: int, name: str) -> bool:
        label = self.derivation.nodes[node].production.label
        target = ir.AttributeOf(ir.THIS, name)
        return any(rule.target == target for rule in self.semantics[label].rules)

    def read(self, node: int, attribute: ir.AttributeOf) -> AttributeValue:
        if attribute.occurrence == ir.THIS:
            instance = (node, attribute.name)
        else:
            instance = (self.derivation.nodes[node].children[attribute.occurrence], attribute.name)
        if instance not in self.values:
            raise MissingValue(instance)
        return self.values[instance]

    # --- expressions ----------------------------------------------------------------------------

    def value(self, node: int, expression: ir.Expr) -> AttributeValue:
        """The value of an expression of any sort in the block of ``node``."""
        match expression:
            case ir.AttributeOf():
                return self.read(node, expression)
            case ir.World() | ir.Rot() | ir.Move() | ir.Shift() | ir.Compose():
                return Frame(self.frame(node, expression, WORLD))
            case ir.Vector(x, y, z):
                return Triplet((self.scalar(node, x), self.scalar(node, y), self.scalar(node, z)))
            case _:
                return Scalar(self.scalar(node, expression))

    def scalar(self, node: int, expression: ir.Expr) -> int:
        """The scalar of an expression in the block of ``node``."""
        match expression:
            case ir.Num(value):
                return self.scalars.constant(value)
            case ir.Pi():
                return self.scalars.pi()
            case ir.ParameterOf(occurrence, name):
                index = self.derivation.nodes[node].children[occurrence]
                return self.scalars.parameter(self.parameter_index[index, name])
            case ir.Unary(function, operand):
                return self.scalars.unary(function, self.scalar(node, operand))
            case ir.Binary("^", left, ir.Num(exponent)):
                return self.scalars.power(self.scalar(node, left), int(exponent))
            case ir.Binary(operator, left, right):
                a, b = self.scalar(node, left), self.scalar(node, right)
                return self.scalars.binary(operator, a, b)
            case ir.AttributeOf():
                found = self.read(node, expression)
                if isinstance(found, Scalar):
                    return found.index
            case _:
                pass
        raise SemanticsError(f"a scalar is due, found {type(expression).__name__.lower()}")

    def vector(self, node: int, expression: ir.Expr) -> Triple:
        """The vector of an expression in the block of ``node``."""
        found = self.value(node, expression)
        if not isinstance(found, Triplet):
            raise SemanticsError("a vector is due")
        return found.items

    def frame(self, node: int, expression: ir.Expr, start: int) -> int:
        """The frame reached from ``start`` by a frame expression."""
        match expression:
            case ir.World():
                return start
            case ir.Rot(axis, ir.DofOf() as dof) | ir.Move(axis, ir.DofOf() as dof):
                index = self.derivation.nodes[node].children[dof.occurrence]
                return self.step(start, Joint(self.dof_index[index, dof.name], *AXES[axis]))
            case ir.Rot(axis, angle):
                number, sign = AXES[axis]
                scalar = self.scalar(node, angle)
                signed = scalar if sign > 0 else self.scalars.unary("neg", scalar)
                return self.step(start, Turn(number, signed))
            case ir.Move(axis, distance):
                number, sign = AXES[axis]
                scalar = self.scalar(node, distance)
                signed = scalar if sign > 0 else self.scalars.unary("neg", scalar)
                zero = self.scalars.constant(0)
                x, y, z = (signed if i == number else zero for i in range(3))
                return self.step(start, Offset((x, y, z)))
            case ir.Shift(vector):
                return self.step(start, Offset(self.vector(node, vector)))
            case ir.Compose(left, right):
                return self.frame(node, right, self.frame(node, left, start))
            case ir.AttributeOf():
                found = self.read(node, expression)
                if isinstance(found, Frame):
                    return self.append(found.index, start)
            case _:
                pass
        raise SemanticsError(f"a frame is due, found {type(expression).__name__.lower()}")

    def step(self, parent: int, step: Step) -> int:
        """The frame one step from another; equal steps give the same frame."""
        zero = self.scalars.constant(0)
        if step == Offset((zero, zero, zero)) or (isinstance(step, Turn) and step.angle == zero):
            return parent
        key = (parent, step)
        if key not in self.frame_index:
            self.frame_index[key] = len(self.frames)
            self.frames.append(FrameNode(parent, step))
        return self.frame_index[key]

    def append(self, frame: int, start: int) -> int:
        """The steps from the world to ``frame``, taken from ``start``."""
        if start == WORLD:
            return frame
        steps: list[Step] = []
        while frame != WORLD:
            current = self.frames[frame]
            if current.step is not None:
                steps.append(current.step)
            frame = current.parent
        for step in reversed(steps):
            start = self.step(start, step)
        return start

    # --- emissions ------------------------------------------------------------------------------

    def place(self, node: int) -> int:
        """Where in the word a production emits: its first module, else its first terminal."""
        current = self.derivation.nodes[node]
        own = [
            (symbol.kind != "module", current.children[position])
            for position, symbol in enumerate(current.production.right)
            if symbol.kind != "nonterminal"
        ]
        return min(own)[1] if own else len(self.derivation.word)

    def body(self, node: int, emission: ir.Rod | ir.PointMass | ir.Solid) -> Body:
        frame = self.frame(node, emission.frame, WORLD)
        match emission:
            case ir.Rod(_, axis, length, density, radius):
                number, sign = AXES[axis]
                thickness = None if radius is None else self.scalar(node, radius)
                a, b = self.scalar(node, length), self.scalar(node, density)
                return RodBody(frame, number, sign, a, b, thickness)
            case ir.PointMass(_, mass):
                return PointBody(frame, self.scalar(node, mass))
            case ir.Solid(_, mass, com, inertia):
                tensor = tuple(self.scalar(node, item) for item in inertia)
                return SolidBody(frame, self.scalar(node, mass), self.vector(node, com), tensor)

    def emitted(self, order: Sequence[int]) -> tuple[list[Body], list[int]]:
        """Bodies and effector frames of all productions, in the given order of nodes."""
        bodies: list[Body] = []
        effectors: list[int] = []
        for node in order:
            block = self.semantics[self.derivation.nodes[node].production.label]
            for emission in block.emissions:
                self._prepare(node, emission)
                if isinstance(emission, ir.Effector):
                    effectors.append(self.frame(node, emission.frame, WORLD))
                else:
                    bodies.append(self.body(node, emission))
        return bodies, effectors

    def _prepare(self, node: int, emission: ir.Emission) -> None:
        """Evaluate the attributes that an emission reads."""
        ready = False
        while not ready:
            try:
                if isinstance(emission, ir.Effector):
                    self.frame(node, emission.frame, WORLD)
                else:
                    self.body(node, emission)
                ready = True
            except MissingValue as missing:
                self.demand(missing.instance)


def evaluate(
    derivation: Derivation,
    modules: Mapping[str, ir.Module],
    semantics: Mapping[str, ir.SemanticBlock],
    dimension: int,
) -> RobotModel:
    """The robot of a derivation, before normalisation.

    Emissions are ordered by their place in the word.  In the plane, ``dimension`` is 2.

    Raises:
        SemanticsError: the rules define no robot (a missing or circular attribute).
    """
    evaluation = _Evaluation(derivation, modules, semantics)
    order = sorted(range(len(derivation.nodes)), key=lambda node: (evaluation.place(node), node))
    bodies, effectors = evaluation.emitted(order)
    return RobotModel(
        2 if dimension == 2 else 3,
        tuple(evaluation.scalars.nodes),
        tuple(evaluation.frames),
        tuple(evaluation.dofs),
        tuple(evaluation.parameters),
        tuple(bodies),
        tuple(effectors),
        own=tuple(evaluation.own),
    )
