"""Modules with their own bodies: frames relative to ``in``, ports, and emissions."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace

from grammar_lang import ir
from grammar_lang import syntax as s
from grammar_lang.diagnostics.diagnostic import Code, Sink
from grammar_lang.elaboration.emissions import Emissions
from grammar_lang.elaboration.frames import report_reuse
from grammar_lang.elaboration.module_scope import foreign_member
from grammar_lang.elaboration.modules import INPUT, ModuleBody, ModuleInfo
from grammar_lang.elaboration.sorts import (
    UNKNOWN,
    ZERO,
    DimensionUse,
    Sort,
    Typed,
    require_frame,
)
from grammar_lang.elaboration.typecheck import Checker, plain_name
from grammar_lang.ir.expressions import too_large
from grammar_lang.names.declarations import duplicate, members
from grammar_lang.source import Span


@dataclass(slots=True)
class _BodyScope:
    """The meaning of names in the frames and emissions of a module.

    ``kinds`` is the kind of each name that the module declares; ``frames`` are the frames so far,
    and ``own`` is the one being read.
    """

    info: ModuleInfo
    kinds: Mapping[str, str]
    frames: dict[str, Typed] = field(default_factory=dict[str, Typed])
    uses: list[DimensionUse] = field(default_factory=list[DimensionUse])
    used: dict[str, list[Span]] = field(default_factory=dict[str, list[Span]])
    own: str = ""

    def __post_init__(self) -> None:
        self.add(INPUT)

    def add(self, name: str) -> None:
        """Add a frame that may be read from here on."""
        self.frames[name] = Typed(ir.AttributeOf(ir.LOCAL, name), Sort.FRAME, None)

    def name(self, ident: s.Ident, sink: Sink) -> Typed:
        """A frame, a parameter, a constant, ``pi``, or an error."""
        name, kind = ident.text, self.kinds.get(ident.text)
        if name in self.frames:
            return self.frames[name]
        if name in self.info.members:
            return self._member(ident)
        match kind:
            case None:
                return plain_name(ident, (*self.frames, *self.info.members), sink)
            case "degree of freedom":
                dof = self.info.dofs[name]
                self.used.setdefault(name, []).append(ident.span)
                place = "rot" if dof.kind == "revolute" else "move"
                message = f"the degree of freedom `{name}` does not stand alone"
                hint = f"write it alone: `{place}({dof.axis}, {name})`"
                sink.error(Code.BAD_DOF_USE, message, ident.span, hint)
            case "frame":
                message = f"the frame `{name}` is declared further down"
                hint = "frames are declared before they are used"
                if name == self.own:
                    message, hint = f"the frame `{name}` depends on itself", "begin with `in`"
                sink.error(Code.UNKNOWN_NAME, message, ident.span, hint)
            case _:
                message = f"the {kind} `{name}` cannot be read in a frame or a body"
                hint = "frames and bodies depend on parameters and degrees of freedom alone"
                sink.error(Code.WRONG_KIND, message, ident.span, hint)
        return UNKNOWN

    def _member(self, ident: s.Ident) -> Typed:
        value = self.info.members[ident.text]
        if isinstance(value.expr, ir.Vector) and value.expr.z != ZERO:
            self.uses.append(DimensionUse(3, ident.span, "this vector leaves the plane"))
        return value

    def member(self, member: s.Member, sink: Sink) -> Typed:
        """Report an error: a module cannot read ``owner.name``."""
        owner, name = member.owner.text, member.name.text
        hint = None
        if owner == "this":
            hint = "write `in`: the frame at which the module is mounted"
        elif owner == self.info.module.name:
            hint = f"write `{name}`: inside the module, use its names alone"
        return foreign_member(member, sink, hint)

    def dof(self, name: s.Member | s.Name) -> ir.Dof | None:
        """The degree of freedom of that name, if any."""
        return self.info.dofs.get(name.ident.text) if isinstance(name, s.Name) else None

    def use_dof(self, name: s.Member | s.Name) -> ir.Expr:
        """Record a correct use of a degree of freedom."""
        ident = name.ident if isinstance(name, s.Name) else name.name
        self.used.setdefault(ident.text, []).append(ident.span)
        return ir.DofOf(ir.THIS, ident.text)

    def mentions(self, expressions: Iterable[s.Expr]) -> tuple[int, ...]:
        """Empty: the module is named where it is mounted."""
        del expressions
        return ()


# --- Frames --------------------------------------------------------------------------------------


def _check_mounted(expr: ir.Expr, at: Span, sink: Sink) -> None:
    """Report a frame that is not relative to the place where the module is mounted."""
    first, *others = ir.factors(expr)
    hint = "write `in * …`: otherwise it would stand on the world, wherever the module is mounted"
    if any(isinstance(each, ir.World) for each in (first, *others)):
        message = "`world` has no meaning inside a module"
        hint = "begin with `in`: that is where the module is mounted, the world for the first one"
    elif not isinstance(first, ir.AttributeOf):
        message = "this does not begin with `in`, or with a frame of the module"
    elif any(isinstance(each, ir.AttributeOf) for each in others):
        message = "a frame follows another frame"
        hint = "begin with one frame; what follows are `rot` and `move`"
    else:
        return
    sink.error(Code.LOOSE_FRAME, message, at, hint)


def _frame(item: s.Frame, scope: _BodyScope, sink: Sink) -> ir.AttributeRule:
    at, before = item.value.span, len(sink.found)
    value = require_frame(Checker(scope, sink).elaborate(item.value), at, sink)
    if not Sink(sink.found[before:]).has_errors:
        _check_mounted(value, at, sink)
    if too_large(value):
        message = "this expression is too large"
        sink.error(Code.TOO_DEEP, message, at, "move a part of it to another frame")
        value = ir.World()
    return ir.AttributeRule(ir.AttributeOf(ir.LOCAL, item.name.text), value, item.span)


def _emission(item: s.Emission, emissions: Emissions, sink: Sink) -> ir.Emitted | None:
    """An emission at a frame of the module; None if an error was reported."""
    before = len(sink.found)
    found = emissions.lower(item)
    if found is not None and not Sink(sink.found[before:]).has_errors:
        at = next(a.value.span for a in item.arguments if a.name and a.name.text == "frame")
        _check_mounted(found.frame, at, sink)
    return found


def _frames(
    module: s.Module, scope: _BodyScope, first: Mapping[str, Span], sink: Sink
) -> dict[str, ir.AttributeRule]:
    """The frames by name, without repeated names and names of other members."""
    found: dict[str, ir.AttributeRule] = {}
    for item in module.items:
        if not isinstance(item, s.Frame) or first.get(item.name.text) != item.name.span:
            continue
        if item.name.text == INPUT:
            message = "a module does not say where its frame `in` is"
            hint = "that is where it is mounted; choose another name"
            sink.error(Code.DUPLICATE_NAME, message, item.name.span, hint)
            continue
        scope.own = item.name.text
        found[item.name.text] = _frame(item, scope, sink)
        scope.add(item.name.text)
    scope.own = ""
    return found


# --- Ports ---------------------------------------------------------------------------------------


def _ports(
    module: s.Module, frames: Mapping[str, object], kinds: Mapping[str, str], sink: Sink
) -> dict[str, s.Port]:
    """The ports by name; an output without a frame is reported."""
    found: dict[str, s.Port] = {}
    for port in module.items:
        if not isinstance(port, s.Port):
            continue
        name = port.name.text
        if name in found:
            _second(port, found[name], module, sink)
            continue
        found[name] = port
        if name != INPUT and name not in frames and kinds.get(name) != "frame":
            message = f"the output `{name}` of module `{module.name.text}` has no frame"
            hint = f"add `frame {name} = in * …;`: where the next module stands"
            if name in kinds:
                hint = f"`{name}` is a {kinds[name]} here; name the port after a frame"
            sink.error(Code.MISSING_FRAME, message, port.name.span, hint)
    return found


def _second(port: s.Port, first: s.Port, module: s.Module, sink: Sink) -> None:
    """Report a second port of the same name."""
    if port.name.text != INPUT:
        duplicate(port.name, first.name.span, sink)
        return
    message = f"module `{module.name.text}` has two inputs"
    notes = [(first.name.span, "first here")]
    hint = "another module carries it at one of its ends; call the other one `out`, for instance"
    sink.error(Code.DUPLICATE_NAME, message, port.name.span, hint, notes)


# --- The body ------------------------------------------------------------------------------------


def with_body(
    info: ModuleInfo, module: s.Module, meshes: Mapping[Span, ir.Mesh | ir.VisualFile], sink: Sink
) -> ModuleInfo:
    """A module with its frames, ports and emissions; errors in them are reported.

    ``meshes`` are keyed by the span of the path that names each.
    """
    emitted = [item for item in module.items if isinstance(item, s.Emission)]
    declared = members(module)
    kinds = {name: each.kind for name, each in declared.items()}
    if INPUT in declared and kinds[INPUT] != "frame":
        message = f"a {kinds[INPUT]} cannot be called `in` in a module with a body"
        hint = "`in` is the frame at which the module is mounted; choose another name"
        sink.error(Code.DUPLICATE_NAME, message, declared[INPUT].span, hint)
    scope = _BodyScope(info, kinds)
    frames = _frames(module, scope, {name: e.span for name, e in declared.items()}, sink)
    ports = _ports(module, frames, kinds, sink)
    emissions = Emissions(scope, sink, [info], meshes)
    lowered = [_emission(each, emissions, sink) for each in emitted]
    for name, places in scope.used.items():
        report_reuse(name, places, "give the moved frame a name", sink)
    body = ModuleBody(
        frames,
        tuple(each for each in lowered if each is not None),
        ports,
        {name: places[0] for name, places in scope.used.items()},
        tuple(scope.uses),
    )
    return replace(info, body=body)
