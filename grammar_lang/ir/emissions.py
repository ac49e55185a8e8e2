"""The emissions of productions: bodies, shapes and effectors, each at a frame."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from fractions import Fraction
from typing import Literal, TypeAlias

from grammar_lang.ir.expressions import NOWHERE, Axis, Expr
from grammar_lang.source import Span, node


@node
class Rod:
    """A uniform rod along an axis from the frame's origin; ``radius`` makes it a capsule."""

    frame: Expr
    axis: Axis
    length: Expr
    density: Expr
    radius: Expr | None
    span: Span = field(default=NOWHERE, compare=False, repr=False)
    mentions: tuple[int, ...] = field(default=(), compare=False, repr=False)


@node
class PointMass:
    """A point mass at the frame's origin."""

    frame: Expr
    mass: Expr
    span: Span = field(default=NOWHERE, compare=False, repr=False)
    mentions: tuple[int, ...] = field(default=(), compare=False, repr=False)


@node
class Solid:
    """A rigid body; inertia about its com: one number in the plane, else xx yy zz xy xz yz."""

    frame: Expr
    mass: Expr
    com: Expr
    inertia: tuple[Expr, ...]
    span: Span = field(default=NOWHERE, compare=False, repr=False)
    mentions: tuple[int, ...] = field(default=(), compare=False, repr=False)


ShapeKind: TypeAlias = Literal["sphere", "capsule", "cylinder", "box", "hull"]


@dataclass(frozen=True, slots=True)
class Mesh:
    """The distinct vertices of the mesh file at ``path``, whose contents have that ``digest``."""

    path: str
    digest: str
    vertices: tuple[tuple[Fraction, ...], ...] = field(compare=False, repr=False)


@node
class Shape:
    """The shape of a link for collisions; it has no mass.

    A sphere or a box is centred at the frame's origin; a capsule or a cylinder leads from there
    along ``axis``.  ``sizes`` are the radius of a sphere, the length and radius of a capsule or
    cylinder, or the edges of a box: two in the plane, three in space.  A hull is that of ``mesh``
    in the frame, whose unit is ``scale`` metres.
    """

    kind: ShapeKind
    frame: Expr
    axis: Axis | None
    sizes: tuple[Expr, ...]
    span: Span = field(default=NOWHERE, compare=False, repr=False)
    mentions: tuple[int, ...] = field(default=(), compare=False, repr=False)
    mesh: Mesh | None = None
    scale: Fraction = Fraction(1)


@dataclass(frozen=True, slots=True)
class VisualFile:
    """The file at ``path`` with that ``digest``, kept unchanged."""

    path: str
    digest: str
    data: bytes = field(compare=False, repr=False)


@node
class Visual:
    """A mesh in a frame for pictures and exports only, whose unit is ``scale`` metres.

    It is not an emission: it has no mass and does not collide, so it does not change the robot.
    """

    frame: Expr
    file: VisualFile
    scale: Fraction
    span: Span = field(default=NOWHERE, compare=False, repr=False)
    mentions: tuple[int, ...] = field(default=(), compare=False, repr=False)


@node
class Effector:
    """An effector at the frame's origin."""

    frame: Expr
    span: Span = field(default=NOWHERE, compare=False, repr=False)
    mentions: tuple[int, ...] = field(default=(), compare=False, repr=False)


Emission: TypeAlias = Rod | PointMass | Solid | Shape | Effector
Emitted: TypeAlias = Emission | Visual
"""The result of an emitting statement."""


def with_expressions(emission: Emission, change: Callable[[Expr], Expr]) -> Emission:
    """An emission with each of its expressions replaced."""
    frame = change(emission.frame)
    match emission:
        case Rod(_, _, length, density, radius):
            thickness = None if radius is None else change(radius)
            return replace(
                emission,
                frame=frame,
                length=change(length),
                density=change(density),
                radius=thickness,
            )
        case PointMass(_, mass):
            return replace(emission, frame=frame, mass=change(mass))
        case Solid(_, mass, com, inertia):
            moments = tuple(map(change, inertia))
            return replace(
                emission, frame=frame, mass=change(mass), com=change(com), inertia=moments
            )
        case Shape(sizes=sizes):
            return replace(emission, frame=frame, sizes=tuple(map(change, sizes)))
        case Effector():
            return replace(emission, frame=frame)
