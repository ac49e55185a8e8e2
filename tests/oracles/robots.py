"""A builder of robot models, and their readings at a state, without grammars or semantics."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from fractions import Fraction

import numpy as np

from compiler.arrays import Array
from compiler.dynamics.equations_of_motion import RobotGraph
from compiler.expressions.scalars import Constant, ScalarTable
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
    Shape,
    SolidBody,
    Step,
    Turn,
)
from grammar_lang import ir

Number = Fraction | int
AXES = {"x": (0, 1), "y": (1, 1), "z": (2, 1), "-x": (0, -1), "-y": (1, -1), "-z": (2, -1)}


def interval(low: Number, high: Number) -> ir.Interval:
    return ir.Interval(ir.Num(Fraction(low)), ir.Num(Fraction(high)))


@dataclass
class Builder:
    """Grows a robot frame by frame; scalars are table indices, frames are frame indices."""

    dimension: int = 2
    table: ScalarTable = field(default_factory=ScalarTable)
    frames: list[FrameNode] = field(default_factory=lambda: [FrameNode(WORLD, None)])
    dofs: list[RobotDof] = field(default_factory=list)
    parameters: list[RobotParameter] = field(default_factory=list)
    bodies: list[Body] = field(default_factory=list)
    effectors: list[int] = field(default_factory=list)
    shapes: list[Shape] = field(default_factory=list)
    symbols: int = 0

    def symbol(self) -> int:
        self.symbols += 1
        return self.symbols - 1

    def number(self, value: Number) -> int:
        return self.table.constant(value)

    def parameter(
        self, low: Number = Fraction(1, 2), high: Number = 5, name: str = "length"
    ) -> int:
        index = len(self.parameters)
        domain = interval(low, high)
        self.parameters.append(RobotParameter(self.symbol(), "L", name, domain, "m"))
        return self.table.parameter(index)

    def _step(self, parent: int, step: Step) -> int:
        self.frames.append(FrameNode(parent, step))
        return len(self.frames) - 1

    def turn(self, parent: int, axis: str, angle: int) -> int:
        number, sign = AXES[axis]
        signed = angle if sign > 0 else self.table.unary("neg", angle)
        return self._step(parent, Turn(number, signed))

    def move(self, parent: int, axis: str, distance: int) -> int:
        number, sign = AXES[axis]
        signed = distance if sign > 0 else self.table.unary("neg", distance)
        x, y, z = (signed if i == number else self.number(0) for i in range(3))
        return self._step(parent, Offset((x, y, z)))

    def joint(
        self,
        parent: int,
        axis: ir.Axis = "z",
        kind: ir.DofKind = "revolute",
        range_: ir.Interval | None = None,
        rate: ir.Interval | None = None,
    ) -> int:
        dof = len(self.dofs)
        self.dofs.append(RobotDof((self.symbol(),), kind, axis, range_, rate))
        return self._step(parent, Joint(dof, *AXES[axis]))

    def rod(self, frame: int, axis: str, length: int, density: Number = 1) -> None:
        number, sign = AXES[axis]
        self.bodies.append(RodBody(frame, number, sign, length, self.number(density), None))

    def point(self, frame: int, mass: int) -> None:
        self.bodies.append(PointBody(frame, mass))

    def solid(
        self, frame: int, mass: Number, com: Sequence[Number], inertia: Sequence[Number]
    ) -> None:
        x, y, z = (self.number(item) for item in com)
        tensor = tuple(self.number(item) for item in inertia)
        self.bodies.append(SolidBody(frame, self.number(mass), (x, y, z), tensor))

    def shape(self, frame: int, kind: ir.ShapeKind, sizes: Sequence[int], axis: str = "x") -> None:
        """``sizes`` are scalars, as ``ir.Shape`` has them."""
        self.shapes.append(Shape(frame, kind, *AXES[axis], tuple(sizes)))

    def hull(self, frame: int, corners: Sequence[tuple[Number, Number, Number]]) -> None:
        """The hull of corners in a frame."""
        kept = []
        for x, y, z in corners:
            kept.append((self.number(x), self.number(y), self.number(z)))
        self.shapes.append(Shape(frame, "hull", 0, 1, (), tuple(kept)))

    def effector(self, frame: int) -> None:
        self.effectors.append(frame)

    def link(self, frame: int, length: int, axis: str = "x", density: Number = 1) -> int:
        """A rod and the frame at its far end."""
        self.rod(frame, axis, length, density)
        return self.move(frame, axis, length)

    def build(self) -> RobotModel:
        return RobotModel(
            2 if self.dimension == 2 else 3,
            tuple(self.table.nodes),
            tuple(self.frames),
            tuple(self.dofs),
            tuple(self.parameters),
            tuple(self.bodies),
            tuple(self.effectors),
            shapes=tuple(self.shapes),
            shape_owners=(None,) * len(self.shapes),
        )


def rod_chain(links: int, densities: Sequence[Number] | None = None) -> RobotModel:
    """Revolute joint and rod, ``links`` times, then an effector; the lengths are parameters."""
    builder, frame = Builder(), WORLD
    for i in range(links):
        joint = builder.joint(frame, range_=interval(-3, 3))
        density = 1 if densities is None else densities[i]
        frame = builder.link(joint, builder.parameter(), density=density)
    builder.effector(frame)
    return builder.build()


def point_chain(links: int) -> RobotModel:
    """Massless links with a point mass equal to the length at each tip (Example 3)."""
    builder, frame = Builder(), WORLD
    for _ in range(links):
        length = builder.parameter()
        frame = builder.move(builder.joint(frame), "x", length)
        builder.point(frame, length)
    builder.effector(frame)
    return builder.build()


def constants_of(graph: RobotGraph) -> Array:
    return np.array([float(c.value) if isinstance(c, Constant) else np.pi for c in graph.constants])


def evaluate(graph: RobotGraph, name: str, *columns: Array) -> Array:
    """One of the graph's functions at (columns..., theta): a matrix for M, else a vector."""
    value = np.asarray(getattr(graph, name)(*columns, constants_of(graph)).full())
    return value if name == "mass_matrix" else value.ravel()
