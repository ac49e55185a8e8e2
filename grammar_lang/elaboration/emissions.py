"""Emissions: rods, point masses, solids, shapes, effectors and visuals, with named arguments."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from grammar_lang import ir
from grammar_lang import syntax as s
from grammar_lang.diagnostics.diagnostic import Code, Sink
from grammar_lang.diagnostics.wording import did_you_mean
from grammar_lang.elaboration.closed import Constants, list_unit
from grammar_lang.elaboration.frames import require_axis
from grammar_lang.elaboration.modules import ModuleInfo
from grammar_lang.elaboration.sorts import (
    ZERO,
    DimensionUse,
    Scope,
    Sort,
    require_frame,
    require_scalar,
    require_vector,
    scale,
    warn_implausible,
    warn_implausible_vector,
)
from grammar_lang.elaboration.typecheck import FUNCTIONS, Checker
from grammar_lang.ir import constants
from grammar_lang.ir.expressions import too_large
from grammar_lang.source import Span
from grammar_lang.units import DENSITY, INERTIA, LENGTH, MASS, Dimension

_ARGUMENTS: dict[str, tuple[str, ...]] = {
    "rod": ("frame", "axis", "length", "density", "radius"),
    "point": ("frame", "mass"),
    "solid": ("frame", "mass", "com", "inertia"),
    "effector": ("frame",),
    "sphere": ("frame", "radius"),
    "capsule": ("frame", "axis", "length", "radius"),
    "cylinder": ("frame", "axis", "length", "radius"),
    "box": ("frame", "size"),
    "hull": ("frame", "file", "scale"),
    "visual": ("frame", "file", "scale"),
}
_OPTIONAL = frozenset({("rod", "radius")})


@dataclass(frozen=True, slots=True)
class Emissions:
    """Lowers the emissions of a block; ``modules`` are those of the right side, by occurrence."""

    scope: Scope
    sink: Sink
    modules: Sequence[ModuleInfo | None] = ()
    meshes: Mapping[Span, ir.Mesh | ir.VisualFile] = field(
        default_factory=dict[Span, ir.Mesh | ir.VisualFile]
    )

    def lower(self, emission: s.Emission) -> ir.Emitted | None:
        """The emission; None if an error was reported."""
        kind = emission.kind.text
        if kind in FUNCTIONS:
            message = f"`{kind}(…)` is a value, not an emission"
            hint = "assign it to an attribute: `this.frame = …;`"
            self.sink.error(Code.SORT_MISMATCH, message, emission.kind.span, hint)
            return None
        if kind not in _ARGUMENTS:
            hint = did_you_mean(kind, _ARGUMENTS, "emission", self.sink)
            self.sink.error(
                Code.BAD_EMISSION, f"unknown emission `{kind}`", emission.kind.span, hint
            )
            return None
        arguments = self._arguments(emission)
        if arguments is None:
            return None
        return self._build(kind, arguments, emission)

    def _build(
        self, kind: str, arguments: Mapping[str, s.Expr], emission: s.Emission
    ) -> ir.Emitted | None:
        frame = self._frame(arguments["frame"])
        others = [value for name, value in arguments.items() if name != "frame"]
        mentions = self.scope.mentions(others)
        match kind:
            case "rod":
                return self._rod(frame, arguments, emission, mentions)
            case "point":
                mass = self._positive(arguments["mass"], MASS)
                return ir.PointMass(frame, mass, emission.span, mentions)
            case "solid":
                mass = self._positive(arguments["mass"], MASS)
                com = self._com(arguments["com"])
                inertia = self._inertia(arguments["inertia"])
                return ir.Solid(frame, mass, com, inertia, emission.span, mentions)
            case "effector":
                return ir.Effector(frame, emission.span, mentions)
            case "sphere":
                radius = self._positive(arguments["radius"], LENGTH)
                return ir.Shape("sphere", frame, None, (radius,), emission.span, mentions)
            case "box":
                edges = self._edges(arguments["size"])
                return ir.Shape("box", frame, None, edges, emission.span, mentions)
            case "hull" | "visual":
                return self._of_file(frame, arguments, emission, mentions)
            case _:
                shape: ir.ShapeKind = "capsule" if kind == "capsule" else "cylinder"
                axis = self._axis(arguments["axis"], kind)
                length, radius = (
                    self._positive(arguments[name], LENGTH) for name in ("length", "radius")
                )
                return ir.Shape(shape, frame, axis, (length, radius), emission.span, mentions)

    def _rod(
        self,
        frame: ir.Expr,
        arguments: Mapping[str, s.Expr],
        emission: s.Emission,
        mentions: tuple[int, ...],
    ) -> ir.Rod:
        axis = self._axis(arguments["axis"], "rod")
        length = self._positive(arguments["length"], LENGTH)
        density = self._positive(arguments["density"], DENSITY)
        radius = None
        if "radius" in arguments:
            radius = self._positive(arguments["radius"], LENGTH)
        return ir.Rod(frame, axis, length, density, radius, emission.span, mentions)

    def _of_file(
        self,
        frame: ir.Expr,
        arguments: Mapping[str, s.Expr],
        emission: s.Emission,
        mentions: tuple[int, ...],
    ) -> ir.Shape | ir.Visual | None:
        """A hull or a visual, from the file that was read for it."""
        kind = emission.kind.text
        path, scale = arguments["file"], Constants(self.sink).rational(arguments["scale"], LENGTH)
        if scale is not None and scale <= 0:
            message = "the unit of a mesh is not positive"
            at = arguments["scale"].span
            self.sink.error(Code.BAD_EMISSION, message, at, "write `scale: 1 mm`, or what it is")
            return None
        if not isinstance(path, s.Text):
            message = f"the file of a {kind} is a path in quotes"
            self.sink.error(Code.BAD_EMISSION, message, path.span, 'write `file: "part.stl"`')
            return None
        found = self.meshes.get(path.ident.span)
        if found is None or scale is None:
            return None
        if isinstance(found, ir.VisualFile):
            return ir.Visual(frame, found, scale, emission.span, mentions)
        return ir.Shape("hull", frame, None, (), emission.span, mentions, found, scale)

    def _axis(self, written: s.Expr, kind: str) -> ir.Axis:
        axis = require_axis(written, self.sink)
        if axis in {"z", "-z"}:
            message = f"a {kind} along {axis} leaves the plane"
            self.scope.uses.append(DimensionUse(3, written.span, message))
        return axis

    # --- Arguments -----------------------------------------------------------------------------

    def _arguments(self, emission: s.Emission) -> dict[str, s.Expr] | None:
        """The arguments by name; unknown, repeated and missing ones are reported."""
        kind, known = emission.kind.text, _ARGUMENTS[emission.kind.text]
        found: dict[str, s.Expr] = {}
        sound = True
        for argument in emission.arguments:
            problem = self._problem(argument, kind, found)
            if problem is None and argument.name is not None:
                found[argument.name.text] = argument.value
                continue
            sound = False
            message, hint = problem or ("", None)
            at = argument.span if argument.name is None else argument.name.span
            self.sink.error(Code.BAD_EMISSION, message, at, hint)
        missing = [n for n in known if n not in found and (kind, n) not in _OPTIONAL]
        if missing and sound:
            names = ", ".join(f"`{n}`" for n in missing)
            hint = f"add {', '.join(f'`{n}: …`' for n in missing)}"
            self.sink.error(Code.BAD_EMISSION, f"`{kind}` lacks {names}", emission.kind.span, hint)
        return found if sound and not missing else None

    def _problem(
        self, argument: s.Argument, kind: str, found: Mapping[str, s.Expr]
    ) -> tuple[str, str] | None:
        known = _ARGUMENTS[kind]
        if argument.name is None:
            form = ", ".join(f"{n}: …" for n in known)
            return f"an argument of `{kind}` has no name", f"write `{kind}({form})`"
        name = argument.name.text
        if name not in known:
            hint = did_you_mean(name, known, "argument", self.sink)
            return f"`{kind}` has no argument `{name}`", hint
        if name in found:
            return f"the argument `{name}` occurs twice", "remove one"
        return None

    def _sized(self, expr: ir.Expr, at: s.Expr) -> ir.Expr:
        if not too_large(expr):
            return expr
        self.sink.error(
            Code.TOO_DEEP,
            "this expression is too large",
            at.span,
            "assign a part of it to an attribute",
        )
        return ZERO

    def _frame(self, expr: s.Expr) -> ir.Expr:
        value = Checker(self.scope, self.sink).elaborate(expr)
        return self._sized(require_frame(value, expr.span, self.sink), expr)

    def _scalar(self, expr: s.Expr, dimension: Dimension) -> ir.Expr:
        value = Checker(self.scope, self.sink).elaborate(expr)
        found = require_scalar(value, dimension, expr.span, self.sink)
        warn_implausible(value, dimension, expr, None, self.sink)
        return self._sized(found, expr)

    def _positive(self, expr: s.Expr, dimension: Dimension) -> ir.Expr:
        """A scalar; a negative constant is reported."""
        return self._not_negative(self._scalar(expr, dimension), expr)

    def _not_negative(self, value: ir.Expr, expr: s.Expr) -> ir.Expr:
        known = constants.evident(value)
        if known is not None and known[0] < 0:
            self.sink.error(
                Code.BAD_EMISSION, "this value is negative", expr.span, "write a positive value"
            )
        if isinstance(value, ir.ParameterOf):
            self._check_range(value, expr)
        return value

    def _check_range(self, parameter: ir.ParameterOf, expr: s.Expr) -> None:
        """Report a parameter that stands for an amount but may be negative."""
        info = self.modules[parameter.occurrence] if self.modules else None
        found = () if info is None else info.module.parameters
        domain = next((p.domain for p in found if p.name == parameter.name), None)
        if domain is None:
            return
        values = (domain.lower,) if isinstance(domain, ir.Interval) else domain.values
        least = [known[0] for v in values if (known := constants.evident(v)) is not None]
        if least and min(least) < 0:
            message = f"the range of `{parameter.name}` allows a negative value here"
            hint = "narrow the range to zero and more"
            self.sink.error(Code.BAD_EMISSION, message, expr.span, hint)

    def _edges(self, expr: s.Expr) -> tuple[ir.Expr, ...]:
        """The edges of a box: two in the plane, three in space."""
        if not isinstance(expr, s.Tuple) or len(expr.items) not in {2, 3}:
            message = "the size of a box is two numbers in the plane, three in space"
            self.sink.error(Code.BAD_EMISSION, message, expr.span, "write `size: (a, b, c) m`")
            return (ZERO, ZERO, ZERO)
        only, other = (2, "in space") if len(expr.items) == 2 else (3, "in the plane")
        message = f"{other} a box has {5 - len(expr.items)} edges"
        self.scope.uses.append(DimensionUse(2 if only == 2 else 3, expr.span, message))
        found = self._scalars(expr, LENGTH)
        return tuple(self._not_negative(e, x) for e, x in zip(found, expr.items, strict=True))

    def _scalars(self, expr: s.Tuple, dimension: Dimension) -> tuple[ir.Expr, ...]:
        """Scalars of one dimension, each with its own unit or all with the trailing one."""
        unit = list_unit(expr.unit, dimension, self.sink)
        found: list[ir.Expr] = []
        for item in expr.items:
            value = Checker(self.scope, self.sink).elaborate(item)
            if unit.unit is not None and value.sort is Sort.SCALAR:
                value = scale(value, unit.unit, item.span, self.sink)
            warn_implausible(value, dimension, item, unit.unit, self.sink)
            found.append(require_scalar(value, dimension, item.span, self.sink))
        return tuple(self._sized(e, expr) for e in found)

    def _com(self, expr: s.Expr) -> ir.Expr:
        value = Checker(self.scope, self.sink).elaborate(expr)
        found = require_vector(value, LENGTH, expr.span, self.sink)
        warn_implausible_vector(value, LENGTH, expr, self.sink)
        return self._sized(found, expr)

    def _inertia(self, expr: s.Expr) -> tuple[ir.Expr, ...]:
        """One moment about the com in the plane; xx, yy, zz, xy, xz, yz in space."""
        if not isinstance(expr, s.Tuple):
            message = "in space an inertia has six numbers"
            self.scope.uses.append(DimensionUse(2, expr.span, message))
            return (self._positive(expr, INERTIA),)
        if len(expr.items) != 6:
            message = f"an inertia has one number or six, not {len(expr.items)}"
            hint = "write one in the plane, `(xx, yy, zz, xy, xz, yz)` in space"
            self.sink.error(Code.BAD_EMISSION, message, expr.span, hint)
            return (ZERO,)
        message = "in the plane an inertia is one number"
        self.scope.uses.append(DimensionUse(3, expr.span, message))
        return self._scalars(expr, INERTIA)
