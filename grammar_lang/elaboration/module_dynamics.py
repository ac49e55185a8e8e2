"""A module's own dynamics (Definition 5): states with their derivatives, inputs and torques.

``der(s) = …`` and ``torque(q) = …`` may use the module's parameters, constants, states and inputs,
the coordinates of its degrees of freedom by name, ``rate(q)`` and the free input ``u``: in
``torque(q)`` that of q, in ``der`` that of the only degree of freedom.  Their order does not
matter.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace

from grammar_lang import ir
from grammar_lang import syntax as s
from grammar_lang.diagnostics.diagnostic import Code, Sink
from grammar_lang.diagnostics.wording import did_you_mean, nearest
from grammar_lang.elaboration.closed import Constants, ListUnit, list_unit
from grammar_lang.elaboration.module_scope import ModuleScope, foreign_member
from grammar_lang.elaboration.sorts import (
    UNKNOWN,
    ZERO,
    DimensionUse,
    Sort,
    Typed,
    mismatch,
    require_scalar,
)
from grammar_lang.elaboration.typecheck import Checker, plain_name
from grammar_lang.ir.expressions import too_large
from grammar_lang.source import Span
from grammar_lang.units import (
    FORCE,
    FREQUENCY,
    LENGTH,
    ONE,
    SPEED,
    TIME,
    TORQUE,
    Dimension,
    describe,
    symbol,
)

EFFORT = "u"
RATE = "rate"
_MEANINGS = {EFFORT: "the free input", RATE: "the rate of a degree of freedom"}

_COORDINATE: dict[ir.DofKind, Dimension] = {"revolute": ONE, "prismatic": LENGTH}
_RATE: dict[ir.DofKind, Dimension] = {"revolute": FREQUENCY, "prismatic": SPEED}
_EFFORT: dict[ir.DofKind, Dimension] = {"revolute": TORQUE, "prismatic": FORCE}


@dataclass(slots=True)
class Statements:
    """The statements of a module about its dynamics, without repeated declarations of a name."""

    states: list[s.State] = field(default_factory=list[s.State])
    inputs: list[s.Input] = field(default_factory=list[s.Input])
    derivatives: list[s.Derivative] = field(default_factory=list[s.Derivative])
    torques: list[s.Torque] = field(default_factory=list[s.Torque])

    def add(self, item: s.State | s.Input | s.Derivative | s.Torque) -> None:
        """Add a statement."""
        match item:
            case s.State():
                self.states.append(item)
            case s.Input():
                self.inputs.append(item)
            case s.Derivative():
                self.derivatives.append(item)
            case s.Torque():
                self.torques.append(item)


@dataclass(frozen=True, slots=True)
class Dynamics:
    """The typed dynamics: states and inputs as declared, torques in the order of the dofs."""

    states: tuple[ir.State, ...]
    inputs: tuple[ir.Input, ...]
    torques: tuple[ir.Torque, ...]


@dataclass(slots=True)
class _Scope:
    """The meaning of names in an equation.

    ``effort`` is the degree of freedom whose input is ``u``; ``lost`` means that it is unknown,
    which is reported elsewhere.
    """

    kinds: Mapping[str, str]
    values: Mapping[str, Typed]
    dofs: Mapping[str, ir.Dof]
    effort: ir.Dof | None
    lost: bool
    uses: list[DimensionUse] = field(default_factory=list[DimensionUse])

    def name(self, ident: s.Ident, sink: Sink) -> Typed:
        if ident.text in self.values:
            return self.values[ident.text]
        if ident.text == EFFORT:
            return self._effort(ident, sink)
        if ident.text == RATE:
            message = "`rate` needs a degree of freedom"
            hint = f"write `rate({next(iter(self.dofs), 'q')})`"
            sink.error(Code.BAD_DYNAMICS, message, ident.span, hint)
            return UNKNOWN
        known = (*self.values, EFFORT) if self.dofs else tuple(self.values)
        return plain_name(ident, known, sink)

    def _effort(self, ident: s.Ident, sink: Sink) -> Typed:
        if self.effort is not None:
            expr = ir.EffortOf(ir.THIS, self.effort.name)
            return Typed(expr, Sort.SCALAR, _EFFORT[self.effort.kind])
        if self.lost:
            return UNKNOWN
        if self.dofs:
            message = "`u` could be the input of several degrees of freedom here"
            hint = "`u` stands in `torque(…)`, where it is the input of that degree of freedom"
        else:
            message = "`u` is the input of a degree of freedom, and this module has none"
            hint = "declare an input of its own: `input v in [0, 24] V;`"
        sink.error(Code.BAD_DYNAMICS, message, ident.span, hint)
        return UNKNOWN

    def member(self, member: s.Member, sink: Sink) -> Typed:
        return foreign_member(member, sink)

    def dof(self, name: s.Member | s.Name) -> ir.Dof | None:
        del name
        return None

    def use_dof(self, name: s.Member | s.Name) -> ir.Expr:
        raise LookupError(name)

    def mentions(self, expressions: Iterable[s.Expr]) -> tuple[int, ...]:
        """Empty: there are no modules of a production here."""
        del expressions
        return ()

    def rate(self, call: s.Call, sink: Sink) -> Typed:
        """The value of ``rate(q)``."""
        argument = call.arguments[0] if len(call.arguments) == 1 else None
        match None if argument is None or argument.name is not None else argument.value:
            case s.Name(ident=ident) if ident.text in self.dofs:
                kind = self.dofs[ident.text].kind
                return Typed(ir.RateOf(ir.THIS, ident.text), Sort.SCALAR, _RATE[kind])
            case s.Name(ident=ident):
                self._no_dof(ident, sink)
            case _:
                message = "`rate` takes the name of one degree of freedom"
                hint = f"write `rate({next(iter(self.dofs), 'q')})`"
                sink.error(Code.BAD_DYNAMICS, message, call.span, hint)
        return UNKNOWN

    def _no_dof(self, ident: s.Ident, sink: Sink) -> None:
        name, kind = ident.text, self.kinds.get(ident.text)
        if kind is None:
            message = f"no degree of freedom is called `{name}`"
            hint = did_you_mean(name, self.dofs, "degree of freedom", sink)
            sink.error(Code.UNKNOWN_NAME, message, ident.span, hint)
            return
        message = f"`{name}` is a {kind}, not a degree of freedom: it has no `rate`"
        if kind == "state":
            hint = f"`der({name}) = …` says how it changes; write that value"
        else:
            hint = did_you_mean(name, self.dofs, "degree of freedom", sink)
        sink.error(Code.BAD_DYNAMICS, message, ident.span, hint)


@dataclass(slots=True)
class _Reader:
    sink: Sink
    module: ModuleScope
    dofs: Mapping[str, ir.Dof]
    values: dict[str, Typed]
    units: dict[str, Dimension] = field(default_factory=dict[str, Dimension])
    derivatives: dict[str, tuple[ir.Expr, Span]] = field(
        default_factory=dict[str, tuple[ir.Expr, Span]]
    )
    torques: dict[str, ir.Torque] = field(default_factory=dict[str, ir.Torque])

    # --- Declarations --------------------------------------------------------------------------

    def input(self, item: s.Input) -> ir.Input | None:
        name = item.name.text
        found = Constants(self.sink, self.module).interval(item.domain, None)
        if found is None:
            self.values[name] = UNKNOWN
            return None
        domain, sample = found
        dimension = sample.dimension or ONE
        self.values[name] = Typed(
            ir.InputOf(ir.THIS, name), Sort.SCALAR, dimension, sample.angular, item.span
        )
        unit = symbol(dimension, angular=sample.angular)
        return ir.Input(name, domain, unit, item.span)

    def state(self, item: s.State) -> ir.State:
        """The state without its derivative; a bare initial value is in the unit of the state."""
        name, unit = item.name.text, list_unit(item.unit, None, self.sink)
        dimension = ONE if unit.unit is None else unit.unit.dimension
        angular = unit.unit is not None and unit.unit.angular
        initial = self._initial(item, unit, dimension)
        self.values[name] = UNKNOWN
        if not unit.broken:
            expr = ir.StateOf(ir.THIS, name)
            self.values[name] = Typed(expr, Sort.SCALAR, dimension, angular, item.span)
            self.units[name] = dimension
        return ir.State(name, symbol(dimension, angular=angular), initial, ZERO, item.span)

    def _initial(self, item: s.State, unit: ListUnit, dimension: Dimension) -> ir.Expr | None:
        if item.initial is None:
            return None
        reader = Constants(self.sink, self.module)
        if unit.broken:
            reader.typed(item.initial, unit)
            return None
        return reader.scalar(item.initial, dimension, unit)

    # --- Equations -----------------------------------------------------------------------------

    def _value(self, expr: s.Expr, effort: ir.Dof | None, *, lost: bool) -> Typed:
        scope = _Scope(self.module.kinds, self.values, self.dofs, effort, lost)
        rate = {RATE: lambda call: scope.rate(call, self.sink)}
        value = Checker(scope, self.sink, rate).elaborate(expr)
        if too_large(value.expr):
            message = "this expression is too large"
            self.sink.error(Code.TOO_DEEP, message, expr.span, "use fewer operations")
            return UNKNOWN
        return value

    def _fit(self, value: Typed, dimension: Dimension | None, at: Span, hint: str) -> ir.Expr:
        if dimension is None:
            return ZERO
        if value.sort is Sort.SCALAR and value.dimension not in {None, dimension}:
            mismatch(value, dimension, at, self.sink, hint)
        return require_scalar(value, value.dimension or dimension, at, self.sink)

    def derivative(self, item: s.Derivative) -> None:
        name = item.name.text
        only = next(iter(self.dofs.values())) if len(self.dofs) == 1 else None
        value = self._value(item.value, only, lost=False)
        if self.module.kinds.get(name) != "state":
            self._no_state(item.name)
        elif name in self.derivatives:
            self._second(f"der({name})", item.span, self.derivatives[name][1])
        else:
            unit = self.units.get(name)
            due = None if unit is None else unit / TIME
            hint = f"`der({name})` has the unit of `{name}` per second"
            self.derivatives[name] = self._fit(value, due, item.value.span, hint), item.span

    def torque(self, item: s.Torque) -> None:
        name = item.name.text
        dof = self.dofs.get(name)
        value = self._value(item.value, dof, lost=dof is None)
        if dof is None:
            self._no_dof(item.name)
        elif name in self.torques:
            self._second(f"torque({name})", item.span, self.torques[name].span)
        else:
            due = _EFFORT[dof.kind]
            hint = f"`{name}` is {dof.kind}, so `torque({name})` is {describe(due)}"
            expr = self._fit(value, due, item.value.span, hint)
            self.torques[name] = ir.Torque(name, expr, item.span)

    def _second(self, what: str, at: Span, first: Span) -> None:
        notes = [(first, "first here")]
        self.sink.error(Code.BAD_DYNAMICS, f"a second `{what}`", at, "remove one", notes)

    def _no_state(self, name: s.Ident) -> None:
        kind = self.module.kinds.get(name.text)
        if kind is None:
            known = [state for state, what in self.module.kinds.items() if what == "state"]
            message = f"no state is called `{name.text}`"
            hint = did_you_mean(name.text, known, "state", self.sink)
            self.sink.error(Code.UNKNOWN_NAME, message, name.span, hint)
            return
        message = f"`{name.text}` is {_a(kind)}, not a state: it has no `der`"
        hint = {
            "degree of freedom": f"what moves it is `torque({name.text}) = …;`",
            "input": "an input is chosen within its bounds; declare a state",
        }.get(kind, f"a {kind} does not change; declare a state")
        self.sink.error(Code.BAD_DYNAMICS, message, name.span, hint)

    def _no_dof(self, name: s.Ident) -> None:
        kind = self.module.kinds.get(name.text)
        if kind is None:
            message = f"no degree of freedom is called `{name.text}`"
            hint = did_you_mean(name.text, self.dofs, "degree of freedom", self.sink)
            self.sink.error(Code.UNKNOWN_NAME, message, name.span, hint)
            return
        message = f"`{name.text}` is {_a(kind)}, not a degree of freedom: it has no `torque`"
        hint = did_you_mean(name.text, self.dofs, "degree of freedom", self.sink)
        if kind == "state":
            hint = f"how a state changes is `der({name.text}) = …;`"
        self.sink.error(Code.BAD_DYNAMICS, message, name.span, hint)


def _a(kind: str) -> str:
    return f"an {kind}" if kind == "input" else f"a {kind}"


def _check_clashes(module: s.Module, sink: Sink) -> None:
    """Report declarations of names that have a fixed meaning in the dynamics."""
    for item in module.items:
        if isinstance(item, s.Param | s.Const | s.Dof | s.State | s.Input):
            name = item.name
            if name.text in _MEANINGS:
                message = f"`{name.text}` is {_MEANINGS[name.text]} in a module with dynamics"
                sink.error(Code.DUPLICATE_NAME, message, name.span, "choose another name")


def _check_derivatives(statements: Statements, sink: Sink) -> None:
    """Report the states without a ``der``, except if a misspelt one is probably theirs."""
    given = {item.name.text for item in statements.derivatives}
    states = [state.name.text for state in statements.states]
    meant = {nearest(name, states, sink) for name in given.difference(states)}
    for state in statements.states:
        name = state.name.text
        if name not in given and name not in meant:
            message = f"the state `{name}` has no `der`"
            sink.error(Code.BAD_DYNAMICS, message, state.name.span, f"add `der({name}) = …;`")


def lower_dynamics(
    module: s.Module,
    statements: Statements,
    scope: ModuleScope,
    dofs: Mapping[str, ir.Dof],
    sink: Sink,
) -> Dynamics:
    """The dynamics of a module; errors in it are reported.

    Args:
        module: the module.
        statements: its statements about its dynamics.
        scope: its parameters and constants, complete.
        dofs: its degrees of freedom by name.
        sink: collects the diagnostics.
    """
    if not (statements.states or statements.inputs or statements.derivatives or statements.torques):
        return Dynamics((), (), ())
    _check_clashes(module, sink)
    values = dict(scope.members)
    for name, dof in dofs.items():
        revolute = dof.kind == "revolute"
        values[name] = Typed(
            ir.DofOf(ir.THIS, name), Sort.SCALAR, _COORDINATE[dof.kind], angular=revolute
        )
    reader = _Reader(sink, scope, dofs, values)
    inputs = [reader.input(item) for item in statements.inputs]
    states = [reader.state(item) for item in statements.states]
    values.update((name, UNKNOWN) for name in _MEANINGS if name in values)
    for derivative in statements.derivatives:
        reader.derivative(derivative)
    for torque in statements.torques:
        reader.torque(torque)
    _check_derivatives(statements, sink)
    return Dynamics(
        tuple(
            replace(state, derivative=reader.derivatives.get(state.name, (ZERO,))[0])
            for state in states
        ),
        tuple(item for item in inputs if item is not None),
        tuple(reader.torques[name] for name in dofs if name in reader.torques),
    )
