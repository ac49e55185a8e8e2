"""Workspaces: the shapes of bounds, regions, obstacles and targets."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Literal, Self, TypedDict, Unpack

from grammar_lang import syntax as s
from grammar_lang.syntax import tasks as t
from srgc.api.builder.arguments import (
    Quantity,
    Range,
    Vector,
    expression,
    ident,
    interval,
    point,
    read,
    read_all,
    shown,
)
from srgc.api.builder.part import Part
from srgc.api.spoken_faults import spoken
from srgc.faults import UsageFault


class Sizes(TypedDict, total=False):
    """A shape, given by its kind.

    Attributes:
        box: a range for each side.
        polytope: inequalities, each a text such as "x + y <= 1".
        hull: the corners.
        ball: the centre.
        capsule: both ends of the axis.
        cylinder: both ends of the axis.
        radius: the radius of a ball, a capsule or a cylinder.
        unit: the unit of numbers, by default "m".
    """

    box: Sequence[Range]
    polytope: Sequence[str]
    hull: Sequence[Vector]
    ball: Vector
    capsule: Sequence[Vector]
    cylinder: Sequence[Vector]
    radius: Quantity
    unit: str


ROUND: tuple[Literal["ball", "capsule", "cylinder"], ...] = ("ball", "capsule", "cylinder")
KINDS = ("box", "polytope", "hull", *ROUND)


class Workspace(Part):
    """A workspace: ``Workspace("Bench").bounds(box=[(0, 5), (0, 5)])``.

    A shape is a text of the language, such as "box [0, 1] x [0, 2] m", or given by its kind:
    ``box=[(0, 1), (0, 2)]``, ``polytope=["x + y <= 1", "x >= 0", "y >= 0"]``,
    ``hull=[(0, 0), (1, 0), (0, 1)]``, ``ball=(0, 0)``, or ``capsule`` and ``cylinder`` with both
    ends of their axis.  The last three have a ``radius``.  Numbers are in ``unit``, by default m.

    Args:
        name: the name of the workspace.
        dimension: 2 for the plane, 3 for space.

    Raises:
        SrgcError: ``name`` is not a name, or ``dimension`` is neither 2 nor 3.
    """

    __slots__ = ()

    @spoken
    def __init__(self, name: str, dimension: Literal[2, 3] = 2) -> None:
        if dimension not in (2, 3):
            raise UsageFault(f"`dimension` is 2 or 3, not {shown(dimension)}")
        super().__init__((t.Workspace(ident(name, "name"), (t.Dimension(dimension),)),))

    @property
    def name(self) -> str:
        """The name of the workspace."""
        return self._workspace.name.text

    @property
    def _workspace(self) -> t.Workspace:
        (workspace,) = self._items
        assert isinstance(workspace, t.Workspace)  # noqa: S101 - of no other item it is made
        return workspace

    def _with(self, *statements: Any) -> Self:
        old = self._workspace
        return self._copied((t.Workspace(old.name, (*old.items, *statements)),))

    @spoken
    def bounds(self, shape: str | None = None, **sizes: Unpack[Sizes]) -> Self:
        """Set the bounds, which no effector may leave.

        Args:
            shape: the shape as a text.
            sizes: or the shape by its kind, as described for the class.

        Raises:
            SrgcError: an argument is invalid.
        """
        return self._with(t.Region("bounds", None, shape_of(shape, sizes)))

    @spoken
    def region(self, name: str, shape: str | None = None, **sizes: Unpack[Sizes]) -> Self:
        """Add a region that tasks can name.

        Args:
            name: the name of the region.
            shape: the shape as a text.
            sizes: or the shape by its kind, as described for the class.

        Raises:
            SrgcError: an argument is invalid.
        """
        return self._with(t.Region("region", ident(name, "name"), shape_of(shape, sizes)))

    @spoken
    def obstacle(self, name: str, shape: str | None = None, **sizes: Unpack[Sizes]) -> Self:
        """Add an obstacle, a region that tasks avoid.

        Args:
            name: the name of the obstacle.
            shape: the shape as a text.
            sizes: or the shape by its kind, as described for the class.

        Raises:
            SrgcError: an argument is invalid.
        """
        return self._with(t.Region("obstacle", ident(name, "name"), shape_of(shape, sizes)))

    @spoken
    def target(self, name: str, shape: str | None = None, **sizes: Unpack[Sizes]) -> Self:
        """Add a target, a region that tasks reach.

        Args:
            name: the name of the target.
            shape: the shape as a text.
            sizes: or the shape by its kind, as described for the class.

        Raises:
            SrgcError: an argument is invalid.
        """
        return self._with(t.Region("target", ident(name, "name"), shape_of(shape, sizes)))

    @spoken
    def statement(self, text: str) -> Self:
        """Add statements given as a text of the language, for those without a method.

        Args:
            text: such as 'obstacles from "hall.png" in cm;'.

        Raises:
            SrgcError: the text does not consist of statements of a workspace.
        """
        what = "statements of a workspace"
        return self._with(*read_all("workspace W {", text, "}", "text", what))


# --- shapes ---------------------------------------------------------------------------------------


def shape_of(text: str | None, given: Sizes) -> t.Shape:
    """The shape given as a text or by its kind.

    Raises:
        UsageFault: there is not exactly one shape, or it is invalid.
    """
    sizes: dict[str, Any] = {**given}
    unknown = [name for name in sizes if name not in Sizes.__annotations__]
    if unknown:
        raise UsageFault(f"there is no argument `{unknown[0]}`: a shape has {', '.join(KINDS)}")
    kinds = [kind for kind in KINDS if kind in sizes]
    if len(kinds) + (text is not None) != 1:
        raise UsageFault(f"give one shape: a text, or one of {', '.join(KINDS)}")
    if text is not None:
        return _read_shape(text, "shape")
    if "radius" in sizes and kinds[0] not in ROUND:
        raise UsageFault(f"`radius`: a {kinds[0]} has none")
    return _sized(kinds[0], sizes[kinds[0]], sizes)


def _read_shape(text: object, name: str) -> t.Shape:
    what = 'a shape, as "box [0, 1] x [0, 2] m"'
    found = read("workspace W { region R ", text, ";}", name, what)
    if not isinstance(found, t.Region):
        raise UsageFault(f"`{name}` is {what}, not {shown(text)}")
    return found.shape


def _sized(kind: str, value: object, sizes: dict[str, Any]) -> t.Shape:
    unit = sizes.get("unit", "m")
    if kind == "polytope":
        rows = "; ".join(_listed(value, kind, "inequalities, each a text"))
        return _read_shape(f"polytope {{ {rows} }} {unit}", kind)
    if kind == "box":
        sides = _listed(value, kind, "ranges, as [(0, 1), (0, 2)]")
        return t.Box(tuple(interval(side, kind, unit) for side in sides))
    if kind == "hull":
        corners = _listed(value, kind, "corners, as [(0, 0), (1, 0), (0, 1)]")
        return t.Hull(tuple(point(corner, kind, unit) for corner in corners))
    return _round(kind, value, sizes, unit)


def _round(kind: Any, value: object, sizes: dict[str, Any], unit: str) -> t.Round:
    if "radius" not in sizes:
        raise UsageFault(f"`radius`: a {kind} has one")
    radius: s.Expr = expression(sizes["radius"], "radius", unit)
    ends = [value] if kind == "ball" else _listed(value, kind, "both ends, as [(0, 0), (1, 0)]")
    if kind != "ball" and len(ends) != 2:
        raise UsageFault(f"`{kind}` is both ends, as [(0, 0), (1, 0)], not {shown(value)}")
    return t.Round(kind, tuple(point(end, kind, unit) for end in ends), radius)


def _listed(value: object, name: str, what: str) -> Sequence[Any]:
    if isinstance(value, str) or not isinstance(value, Sequence) or not value:
        raise UsageFault(f"`{name}` is {what}, not {shown(value)}")
    return value
