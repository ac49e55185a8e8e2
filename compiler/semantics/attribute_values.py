"""Values of attributes and of the expressions over them, at the nodes of one derivation."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TypeAlias

from compiler.expressions.scalars import ScalarTable
from compiler.grammars.derivation import Derivation
from compiler.robots.robot import Joint, Offset, Step, Turn
from compiler.semantics.declarations import Declarations
from compiler.semantics.frame_table import Frame, Product, product
from compiler.semantics.semantics_error import SemanticsError
from grammar_lang import ir

Triple: TypeAlias = tuple[int, int, int]
AttributeValue: TypeAlias = int | Triple | Frame
"""A scalar (an index into the scalar table), a vector (three scalars) or a frame."""

AXES: Mapping[str, tuple[int, int]] = {
    "x": (0, 1), "y": (1, 1), "z": (2, 1), "-x": (0, -1), "-y": (1, -1), "-z": (2, -1)
}  # fmt: skip


@dataclass(slots=True)
class AttributeValues:
    """The values known so far, by node and name, and the table of the scalars in them."""

    derivation: Derivation
    declared: Declarations
    scalars: ScalarTable = field(default_factory=ScalarTable)
    known: list[dict[str, AttributeValue]] = field(init=False)
    zero: int = field(init=False)

    def __post_init__(self) -> None:
        self.known = [{} for _ in self.derivation.nodes]
        self.zero = self.scalars.constant(0)

    def define(self, node: int, rule: ir.AttributeRule) -> None:
        """Evaluate a rule in the block of ``node``; everything that it reads has to be known."""
        target = rule.target
        owner = node
        if target.occurrence != ir.THIS:
            owner = self.derivation.nodes[node].children[target.occurrence]
        self.known[owner][target.name] = self.value(node, rule.value)

    def read(self, node: int, attribute: ir.AttributeOf) -> AttributeValue:
        """The value of an attribute that the block of ``node`` names."""
        if attribute.occurrence != ir.THIS:
            node = self.derivation.nodes[node].children[attribute.occurrence]
        return self.known[node][attribute.name]

    def value(self, node: int, expression: ir.Expr) -> AttributeValue:
        """The value of an expression of any sort in the block of ``node``."""
        match expression:
            case ir.AttributeOf():
                return self.read(node, expression)
            case ir.World() | ir.Rot() | ir.Move() | ir.Shift() | ir.Compose():
                return self.frame(node, expression)
            case ir.Vector(x, y, z):
                return self.scalar(node, x), self.scalar(node, y), self.scalar(node, z)
            case _:
                return self.scalar(node, expression)

    def scalar(self, node: int, expression: ir.Expr) -> int:
        """The scalar of an expression in the block of ``node``."""
        match expression:
            case ir.Num(value):
                return self.scalars.constant(value)
            case ir.Pi():
                return self.scalars.pi()
            case ir.ParameterOf(occurrence, name):
                index = self.derivation.nodes[node].children[occurrence]
                return self.scalars.parameter(self.declared.parameter_index[index, name])
            case ir.Unary(function, operand):
                return self.scalars.unary(function, self.scalar(node, operand))
            case ir.Binary("^", left, ir.Num(exponent)):
                return self.scalars.power(self.scalar(node, left), int(exponent))
            case ir.Binary(operator, left, right):
                a, b = self.scalar(node, left), self.scalar(node, right)
                return self.scalars.binary(operator, a, b)
            case ir.AttributeOf():
                found = self.read(node, expression)
                if isinstance(found, int):
                    return found
            case _:
                pass
        raise SemanticsError(f"a scalar is due, found {type(expression).__name__.lower()}")

    def vector(self, node: int, expression: ir.Expr) -> Triple:
        """The vector of an expression in the block of ``node``."""
        found = self.value(node, expression)
        if not isinstance(found, tuple):
            raise SemanticsError("a vector is due")
        return found

    def frame(self, node: int, expression: ir.Expr) -> Frame:
        """The frame of an expression in the block of ``node``."""
        match expression:
            case ir.Compose(left, right):
                return product(self.frame(node, left), self.frame(node, right))
            case ir.AttributeOf():
                found = self.read(node, expression)
                if not isinstance(found, int | tuple):
                    return found
                raise SemanticsError("a frame is due, found an attribute of another sort")
            case ir.World():
                return None
            case ir.Rot(axis, ir.DofOf() as dof) | ir.Move(axis, ir.DofOf() as dof):
                index = self.derivation.nodes[node].children[dof.occurrence]
                step: Step = Joint(self.declared.dof_index[index, dof.name], *AXES[axis])
            case ir.Rot(axis, angle):
                step = Turn(AXES[axis][0], self._along(node, axis, angle))
            case ir.Move(axis, distance):
                signed, zero = self._along(node, axis, distance), self.zero
                x, y, z = (signed if i == AXES[axis][0] else zero for i in range(3))
                step = Offset((x, y, z))
            case ir.Shift(vector):
                step = Offset(self.vector(node, vector))
            case _:
                raise SemanticsError(f"a frame is due, found {type(expression).__name__.lower()}")
        return Product(None, step)

    def _along(self, node: int, axis: ir.Axis, expression: ir.Expr) -> int:
        """A scalar about or along an axis, with the sign of the axis."""
        scalar = self.scalar(node, expression)
        return scalar if AXES[axis][1] > 0 else self.scalars.unary("neg", scalar)
