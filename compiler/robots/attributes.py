"""Attribute evaluation: applies the semantic rules along a derivation (FRG, Definition 6).

The plans of the grammar are carried out over the derivation with an explicit stack, so that it may
be as deep as memory allows; see :mod:`compiler.robots.evaluation_order`.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import TypeAlias

from compiler.expressions.scalars import ScalarTable
from compiler.robots.evaluation_order import EvaluationOrder, EvaluationStep, Visit
from compiler.robots.frame_table import (
    Declarations,
    Frame,
    FrameTable,
    Product,
    SemanticsError,
    declarations,
    product,
)
from compiler.robots.links import links_of
from compiler.robots.mesh_corners import mesh_corners
from compiler.robots.robot import (
    Body,
    BodyOwner,
    FrameNode,
    Joint,
    Offset,
    PointBody,
    RobotModel,
    RodBody,
    Shape,
    SolidBody,
    Step,
    Turn,
)
from compiler.words.derivation import Derivation, emission_order
from grammar_lang import ir

__all__ = ["SemanticsError", "evaluate"]

ROOT_ATTRIBUTE = "frame"


def evaluate(
    derivation: Derivation,
    modules: Mapping[str, ir.Module],
    semantics: Mapping[str, ir.SemanticBlock],
    dimension: int,
    order: EvaluationOrder | None = None,
) -> RobotModel:
    """The robot of a derivation, before normalisation.

    Emissions are ordered by their place in the word, frames and scalars by their first use in
    emissions, whatever the order of evaluation. ``dimension`` is 2 in the plane. ``order`` is the
    evaluation order of the grammar; without it, one is made for the productions of this derivation.
    Visuals are left out unless ``order`` includes them.

    Raises:
        SemanticsError: the rules define no robot (a missing or circular attribute).
    """
    if order is None:
        used = {node.production.label: node.production for node in derivation.nodes}
        order = EvaluationOrder(tuple(used.values()), semantics)
    declared = declarations(derivation.word, modules)
    values = AttributeValues(derivation, declared)
    _carry_out(order, values)
    emitted = _Emitted(values, FrameTable(values.scalars.nodes, values.zero))
    bodies: list[Body] = []
    owners: list[BodyOwner | None] = []
    shapes: list[Shape] = []
    shape_owners: list[BodyOwner | None] = []
    effectors: list[int] = []
    for node in emission_order(derivation):
        for emission in semantics[derivation.nodes[node].production.label].emissions:
            if isinstance(emission, ir.Effector):
                effectors.append(emitted.frame(node, emission.frame))
            elif isinstance(emission, ir.Shape):
                shapes.append(emitted.shape(node, emission, dimension))
                shape_owners.append(_owner(derivation, node, emission))
            else:
                bodies.append(emitted.body(node, emission))
                owners.append(_owner(derivation, node, emission))
    # Visuals come after everything else, so that they change no number of a frame or a scalar.
    seen = [emitted.frame(node, visual.frame) for node in emission_order(derivation)
            for visual in semantics[derivation.nodes[node].production.label].visuals
            if order.visuals]  # fmt: skip
    return RobotModel(
        2 if dimension == 2 else 3,
        tuple(emitted.table.scalars),
        tuple(emitted.table.frames),
        tuple(declared.dofs),
        tuple(declared.parameters),
        tuple(bodies),
        tuple(effectors),
        own=tuple(declared.own),
        owners=tuple(owners),
        shapes=tuple(shapes),
        shape_owners=tuple(shape_owners),
        seen=tuple(seen),
        covered=_covered(emitted.table.frames, bodies, shapes),
    )


def _covered(
    frames: Sequence[FrameNode], bodies: Sequence[Body], shapes: Sequence[Shape]
) -> tuple[int, ...]:
    """The numbers of the bodies that are centres of mass of links with shapes."""
    links = links_of(frames)
    shaped = {links.of[shape.frame] for shape in shapes}
    return tuple(
        number
        for number, body in enumerate(bodies)
        if links.of[body.frame] in shaped and not isinstance(body, RodBody)
    )


def _owner(derivation: Derivation, node: int, emission: ir.Emission) -> BodyOwner | None:
    """The module that owns a body; None if there is no owner, or there may be several."""
    current = derivation.nodes[node]
    found = ir.owners(current.production, emission)
    if len(found) != 1:
        return None
    symbol = current.children[found[0]]
    return BodyOwner(symbol, derivation.word[symbol])


def _carry_out(order: EvaluationOrder, values: AttributeValues) -> None:
    """Evaluate all useful attributes of a derivation by visiting its nodes from the root on."""
    nodes = values.derivation.nodes
    root = nodes[0].production
    given = order.first(root.label)
    for name in sorted(given[-1]):
        if name != ROOT_ATTRIBUTE:
            raise SemanticsError(f"attribute `{name}` of `{root.left}` has no rule")
        values.known[0][name] = None
    visits: list[tuple[int, Iterator[EvaluationStep]]] = [(0, iter(order.plan(root.label, given)))]
    while visits:
        node, steps = visits[-1]
        for step in steps:
            if isinstance(step, Visit):
                child = nodes[node].children[step.position]
                plan = order.plan(nodes[child].production.label, step.given)
                visits.append((child, iter(plan)))
                break
            values.define(node, step)
        else:
            visits.pop()


@dataclass(frozen=True, slots=True)
class _Emitted:
    """Turns emissions into parts of a robot, once all attributes are known."""

    values: AttributeValues
    table: FrameTable

    def frame(self, node: int, expression: ir.Expr) -> int:
        return self.table.place(self.values.frame(node, expression))

    def scalar(self, node: int, expression: ir.Expr) -> int:
        return self.table.keep(self.values.scalar(node, expression))

    def body(self, node: int, emission: ir.Rod | ir.PointMass | ir.Solid) -> Body:
        frame = self.frame(node, emission.frame)
        match emission:
            case ir.Rod(_, axis, length, density, radius):
                number, sign = AXES[axis]
                a, b = self.scalar(node, length), self.scalar(node, density)
                thickness = None if radius is None else self.scalar(node, radius)
                return RodBody(frame, number, sign, a, b, thickness)
            case ir.PointMass(_, mass):
                return PointBody(frame, self.scalar(node, mass))
            case ir.Solid(_, mass, com, inertia):
                heavy = self.scalar(node, mass)
                x, y, z = (self.table.keep(each) for each in self.values.vector(node, com))
                tensor = tuple(self.scalar(node, item) for item in inertia)
                return SolidBody(frame, heavy, (x, y, z), tensor)

    def shape(self, node: int, emission: ir.Shape, dimension: int) -> Shape:
        frame = self.frame(node, emission.frame)
        axis, sign = AXES[emission.axis or "x"]
        sizes = tuple(self.scalar(node, size) for size in emission.sizes)
        if emission.mesh is None:
            return Shape(frame, emission.kind, axis, sign, sizes)
        corners = []
        for corner in mesh_corners(emission.mesh, emission.scale, dimension):
            x, y, z = (self.scalar(node, ir.Num(value)) for value in corner)
            corners.append((x, y, z))
        return Shape(frame, emission.kind, axis, sign, sizes, tuple(corners))


# --- Values of attributes, and of expressions in them, at the nodes of one derivation -------------


Triple: TypeAlias = tuple[int, int, int]
AttributeValue: TypeAlias = int | Triple | Frame
"""A scalar (an index into the scalar table), a vector (three scalars) or a frame."""

AXES: Mapping[str, tuple[int, int]] = {
    "x": (0, 1), "y": (1, 1), "z": (2, 1), "-x": (0, -1), "-y": (1, -1), "-z": (2, -1)
}  # fmt: skip


@dataclass(slots=True)
class AttributeValues:
    """The values known so far, by node and name, and the table of scalars that they use."""

    derivation: Derivation
    declared: Declarations
    scalars: ScalarTable = field(default_factory=ScalarTable)
    known: list[dict[str, AttributeValue]] = field(init=False)
    zero: int = field(init=False)

    def __post_init__(self) -> None:
        self.known = [{} for _ in self.derivation.nodes]
        self.zero = self.scalars.constant(0)

    def define(self, node: int, rule: ir.AttributeRule) -> None:
        """Evaluate a rule in the block of ``node``; everything that it reads must be known."""
        values, name = self._place(node, rule.target)
        values[name] = self.value(node, rule.value)

    def read(self, node: int, attribute: ir.AttributeOf) -> AttributeValue:
        """The value of an attribute that is named in the block of ``node``."""
        values, name = self._place(node, attribute)
        return values[name]

    def _place(self, node: int, attribute: ir.AttributeOf) -> tuple[dict[str, AttributeValue], str]:
        """The dictionary and the key that hold an attribute named in the block of ``node``."""
        if attribute.occurrence == ir.LOCAL:
            return self.known[node], f"let {attribute.name}"
        if attribute.occurrence != ir.THIS:
            node = self.derivation.nodes[node].children[attribute.occurrence]
        return self.known[node], attribute.name

    def value(self, node: int, expression: ir.Expr) -> AttributeValue:
        """The value of an expression of any kind in the block of ``node``."""
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
        """The index in ``scalars`` of the value of an expression in the block of ``node``.

        Raises:
            SemanticsError: the expression is not a scalar.
        """
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
        raise SemanticsError(f"a scalar is expected, found {type(expression).__name__.lower()}")

    def vector(self, node: int, expression: ir.Expr) -> Triple:
        """The value of a vector expression in the block of ``node``: three indices in ``scalars``.

        Raises:
            SemanticsError: the expression is not a vector.
        """
        found = self.value(node, expression)
        if not isinstance(found, tuple):
            raise SemanticsError("a vector is expected")
        return found

    def frame(self, node: int, expression: ir.Expr) -> Frame:
        """The value of a frame expression in the block of ``node``.

        Raises:
            SemanticsError: the expression is not a frame.
        """
        match expression:
            case ir.Compose(left, right):
                return product(self.frame(node, left), self.frame(node, right))
            case ir.AttributeOf():
                found = self.read(node, expression)
                if not isinstance(found, int | tuple):
                    return found
                raise SemanticsError("a frame is expected, found an attribute of another sort")
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
                raise SemanticsError(
                    f"a frame is expected, found {type(expression).__name__.lower()}"
                )
        return Product(None, step)

    def _along(self, node: int, axis: ir.Axis, expression: ir.Expr) -> int:
        """A scalar about or along an axis, with the sign of the axis."""
        scalar = self.scalar(node, expression)
        return scalar if AXES[axis][1] > 0 else self.scalars.unary("neg", scalar)
