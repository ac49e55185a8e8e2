"""Modules: roles, parameters (Definition 5), constants, degrees of freedom and own dynamics."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace

from grammar_lang import ir
from grammar_lang import syntax as s
from grammar_lang.diagnostics.diagnostic import Code, Sink
from grammar_lang.diagnostics.wording import did_you_mean
from grammar_lang.elaboration.closed import Constants
from grammar_lang.elaboration.drives import (
    DriveReader,
    check_driven,
    lower_acceleration,
    lower_effort,
)
from grammar_lang.elaboration.module_dynamics import Statements, lower_dynamics
from grammar_lang.elaboration.module_scope import ModuleScope
from grammar_lang.elaboration.sorts import (
    UNKNOWN,
    DimensionUse,
    Sort,
    Typed,
    warn_implausible,
    warn_implausible_vector,
    wrong_sort,
)
from grammar_lang.elaboration.typecheck import Checker
from grammar_lang.ir.expressions import too_large
from grammar_lang.names.declarations import duplicate, members
from grammar_lang.source import Span
from grammar_lang.units import FREQUENCY, LENGTH, ONE, SPEED, symbol

_ROLES: dict[str, ir.Role] = {
    "base": "base",
    "joint": "joint",
    "link": "link",
    "effector": "effector",
}


LONGEST_NAME = 200
"""The most characters of a name for exports."""
INPUT = "in"
"""The frame at which a module is mounted, and the port by which another carries it."""


@dataclass(frozen=True, slots=True)
class ModuleInfo:
    """A module and the meaning of its names.

    ``members`` are its parameters and constants; parameters in them are at ``ir.THIS``.  ``own``
    maps each name of its own dynamics to ``state`` or ``input``.  ``body`` is None if the module
    has no frames, ports or emissions.
    """

    module: ir.Module
    members: Mapping[str, Typed]
    dofs: Mapping[str, ir.Dof]
    own: Mapping[str, str]
    body: ModuleBody | None = None

    @property
    def names(self) -> tuple[str, ...]:
        """All names that may follow the dot."""
        return (*self.members, *self.dofs, *(() if self.body is None else self.body.frames))

    def at(self, occurrence: int, name: str) -> Typed:
        """A parameter or constant of the module at an occurrence; KeyError if there is none."""
        value = self.members[name]
        return replace(value, expr=_placed(value.expr, occurrence, ""))


@dataclass(frozen=True, slots=True)
class ModuleBody:
    """What a module adds wherever it is mounted.

    ``frames`` are defined from ``in`` and each other, which are ``ir.LOCAL`` in them; all other
    names of the module are at ``ir.THIS``.  ``ports`` are by name, ``used`` are the places where
    frames use degrees of freedom, and ``uses`` is what is valid only in the plane or only in space.
    """

    frames: Mapping[str, ir.AttributeRule]
    emissions: tuple[ir.Emitted, ...]
    ports: Mapping[str, s.Port]
    used: Mapping[str, Span]
    uses: tuple[DimensionUse, ...]

    @property
    def outputs(self) -> tuple[s.Port, ...]:
        """The ports other than ``in``, in declaration order."""
        return tuple(port for name, port in self.ports.items() if name != INPUT)

    def mounted(
        self, occurrence: int, called: str
    ) -> tuple[tuple[ir.AttributeRule, ...], tuple[ir.Emitted, ...]]:
        """The frame rules and emissions of the module, mounted at an occurrence with that name."""
        here = (occurrence,)

        def new(expr: ir.Expr) -> ir.Expr:
            return _placed(expr, occurrence, f"{called}.")

        rules = tuple(
            ir.AttributeRule(frame_of(called, name), new(rule.value), rule.span, here)
            for name, rule in self.frames.items()
        )
        return rules, tuple(_emitted(each, new, here) for each in self.emissions)


def _emitted(
    found: ir.Emitted, new: Callable[[ir.Expr], ir.Expr], here: tuple[int, ...]
) -> ir.Emitted:
    if isinstance(found, ir.Visual):
        return replace(found, frame=new(found.frame), mentions=here)
    return replace(ir.with_expressions(found, new), mentions=here)


def frame_of(called: str, name: str) -> ir.AttributeOf:
    """The frame of a module that is mounted in a production under the name ``called``."""
    return ir.AttributeOf(ir.LOCAL, f"{called}.{name}")


def _placed(expr: ir.Expr, occurrence: int, prefix: str) -> ir.Expr:
    """An expression of a module, moved to an occurrence; the names of its frames get a prefix."""

    def change(leaf: ir.Expr) -> ir.Expr:
        match leaf:
            case ir.ParameterOf(name=name):
                return ir.ParameterOf(occurrence, name)
            case ir.DofOf(name=name):
                return ir.DofOf(occurrence, name)
            case ir.AttributeOf(name=name):
                return ir.AttributeOf(ir.LOCAL, prefix + name)
            case _:
                return leaf

    return ir.with_leaves(expr, change, (occurrence,))


@dataclass(slots=True)
class _Reader:
    sink: Sink
    scope: ModuleScope
    seen: dict[str, Span] = field(default_factory=dict[str, Span])
    roles: list[tuple[ir.Role, Span]] = field(default_factory=list[tuple[ir.Role, Span]])
    parameters: list[ir.Parameter] = field(default_factory=list[ir.Parameter])
    dofs: list[ir.Dof] = field(default_factory=list[ir.Dof])
    drives: list[s.Drive] = field(default_factory=list[s.Drive])
    dynamics: Statements = field(default_factory=Statements)
    names: list[s.Ident] = field(default_factory=list[s.Ident])

    def item(self, item: s.ModuleItem) -> None:
        match item:
            case s.Role():
                self._role(item)
            case s.Named():
                self._named(item)
            case s.Param() if self._fresh(item.name):
                self._parameter(item)
            case s.Const() if self._fresh(item.name):
                self._constant(item)
            case s.Dof() if self._fresh(item.name):
                self._dof(item)
            case s.Drive():
                self.drives.append(item)
            case s.State() | s.Input() if self._fresh(item.name):
                self.dynamics.add(item)
            case s.Derivative() | s.Torque():
                self.dynamics.add(item)
            case s.Frame():
                self._fresh(item.name)
            case _:
                pass

    def _fresh(self, name: s.Ident) -> bool:
        if name.text in self.seen:
            duplicate(name, self.seen[name.text], self.sink)
            return False
        self.seen[name.text] = name.span
        return True

    def _role(self, item: s.Role) -> None:
        role = _ROLES.get(item.name.text)
        if role is None:
            message = f"unknown role `{item.name.text}`"
            hint = did_you_mean(item.name.text, _ROLES, "role", self.sink)
            self.sink.error(Code.UNKNOWN_NAME, message, item.name.span, hint)
            role = "link"
        if self.roles:
            notes = [(self.roles[0][1], "first here")]
            self.sink.error(
                Code.REPEATED_CLAUSE, "a second role", item.span, "a module has one role", notes
            )
        self.roles.append((role, item.span))

    def _named(self, item: s.Named) -> None:
        if self.names:
            self.sink.error(
                Code.REPEATED_CLAUSE,
                "a second name",
                item.span,
                "a module has one name in exports",
                [(self.names[0].span, "first here")],
            )
        elif part_name(item.text, self.sink):
            self.names.append(item.text)

    def _parameter(self, item: s.Param) -> None:
        reader = Constants(self.sink, self.scope)
        found: tuple[ir.Interval | ir.Choices, Typed] | None
        if isinstance(item.domain, s.Interval):
            found = reader.interval(item.domain, None)
        else:
            found = reader.choices(item.domain)
        if found is None:
            self.scope.members[item.name.text] = UNKNOWN
            return
        domain, sample = found
        unit = symbol(sample.dimension or ONE, angular=sample.angular)
        self.parameters.append(ir.Parameter(item.name.text, domain, unit, item.span))
        self.scope.members[item.name.text] = Typed(
            ir.ParameterOf(ir.THIS, item.name.text),
            Sort.SCALAR,
            sample.dimension,
            sample.angular,
            item.span,
        )

    def _constant(self, item: s.Const) -> None:
        value = Checker(self.scope, self.sink).elaborate(item.value)
        if value.sort is Sort.FRAME:
            wrong_sort(value, "a number or a vector", item.value.span, self.sink)
            value = UNKNOWN
        elif too_large(value.expr):
            self.sink.error(
                Code.TOO_DEEP,
                "this expression is too large",
                item.value.span,
                "use fewer operations",
            )
            value = UNKNOWN
        elif value.dimension is not None:
            warn_implausible(value, value.dimension, item.value, None, self.sink)
            warn_implausible_vector(value, value.dimension, item.value, self.sink)
        if value.bare:
            value = replace(value, dimension=ONE)
        self.scope.members[item.name.text] = replace(value, declared=item.span)

    def _dof(self, item: s.Dof) -> None:
        reader = Constants(self.sink, self.scope)
        revolute = item.kind == "revolute"
        ranged = rated = None
        if item.range is not None:
            ranged = reader.interval(item.range, ONE if revolute else LENGTH, angle=revolute)
        if item.rate is not None:
            rated = reader.interval(item.rate, FREQUENCY if revolute else SPEED)
        self.dofs.append(
            ir.Dof(
                item.name.text,
                item.kind,
                item.axis,
                None if ranged is None else ranged[0],
                None if rated is None else rated[0],
                lower_effort(item, reader, self.sink),
                accel=lower_acceleration(item, reader, self.sink),
                named=None if item.named is None else part_name(item.named, self.sink),
                span=item.span,
            )
        )


def part_name(name: s.Ident, sink: Sink) -> str | None:
    """A name for exports; None if it is not one, which is reported."""
    text = name.text
    if text.isprintable() and text.strip() == text and 0 < len(text) <= LONGEST_NAME:
        return text
    message = "this is no name of a part"
    hint = f"write 1 to {LONGEST_NAME} printable characters without spaces at the ends"
    sink.error(Code.BAD_VALUE, message, name.span, hint)
    return None


def lower_module(module: s.Module, sink: Sink) -> ModuleInfo:
    """The module and its names; errors in it are reported."""
    reader = _Reader(sink, ModuleScope({name: each.kind for name, each in members(module).items()}))
    for item in module.items:
        reader.item(item)
    if not reader.roles:
        message = f"module `{module.name.text}` has no role"
        hint = "add `role base;`, `role joint;`, `role link;` or `role effector;`"
        sink.error(Code.MISSING_CLAUSE, message, module.name.span, hint)
    dofs = {dof.name: dof for dof in reader.dofs}
    dynamics = lower_dynamics(module, reader.dynamics, reader.scope, dofs, sink)
    drives = DriveReader(Constants(sink, reader.scope), dofs, sink)
    for drive in reader.drives:
        drives.read(drive)
    lowered = ir.Module(
        module.name.text,
        reader.roles[0][0] if reader.roles else "link",
        tuple(reader.parameters),
        tuple(dofs.values()),
        module.span,
        dynamics.states,
        dynamics.inputs,
        drives.torques(dynamics.torques),
        reader.names[0].text if reader.names else None,
    )
    check_driven(lowered, [item for item in module.items if isinstance(item, s.Dof)], sink)
    own = {name: what for name, what in reader.scope.kinds.items() if what in {"state", "input"}}
    return ModuleInfo(lowered, reader.scope.members, dofs, own)
