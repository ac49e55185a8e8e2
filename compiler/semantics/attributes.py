"""Attribute evaluation: the semantic rules of a derivation, applied (FRG, Definition 6).

The plans of the grammar are carried out over the derivation with an explicit stack, so that it may
be as deep as memory allows; see :mod:`compiler.semantics.evaluation_order`.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from compiler.grammars.derivation import Derivation
from compiler.robots.robot import Body, PointBody, RobotModel, RodBody, SolidBody
from compiler.semantics.attribute_values import AXES, AttributeValues
from compiler.semantics.declarations import declarations
from compiler.semantics.emission_order import emission_order
from compiler.semantics.evaluation_order import EvaluationOrder, Step, Visit
from compiler.semantics.frame_table import FrameTable
from compiler.semantics.semantics_error import SemanticsError
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

    Emissions are ordered by their place in the word, frames and scalars by their first use in them,
    whatever the order of evaluation.  In the plane, ``dimension`` is 2.  ``order`` is that of the
    grammar; without it, one is made for the productions of this derivation.

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
    effectors: list[int] = []
    for node in emission_order(derivation):
        for emission in semantics[derivation.nodes[node].production.label].emissions:
            if isinstance(emission, ir.Effector):
                effectors.append(emitted.frame(node, emission.frame))
            else:
                bodies.append(emitted.body(node, emission))
    return RobotModel(
        2 if dimension == 2 else 3,
        tuple(emitted.table.scalars),
        tuple(emitted.table.frames),
        tuple(declared.dofs),
        tuple(declared.parameters),
        tuple(bodies),
        tuple(effectors),
        own=tuple(declared.own),
    )


def _carry_out(order: EvaluationOrder, values: AttributeValues) -> None:
    """Evaluate all useful attributes of a derivation: the visits, from the root on."""
    nodes = values.derivation.nodes
    root = nodes[0].production
    given = order.first(root.label)
    for name in sorted(given[-1]):
        if name != ROOT_ATTRIBUTE:
            raise SemanticsError(f"attribute `{name}` of `{root.left}` has no rule")
        values.known[0][name] = None
    visits: list[tuple[int, Iterator[Step]]] = [(0, iter(order.plan(root.label, given)))]
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
    """Turns emissions into what a robot has, once all attributes are known."""

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
