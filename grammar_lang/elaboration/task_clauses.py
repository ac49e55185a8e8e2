"""The clauses of a task about efforts, and about an existing robot."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from grammar_lang import ir
from grammar_lang import syntax as s
from grammar_lang.diagnostics.diagnostic import Code, Sink
from grammar_lang.diagnostics.wording import did_you_mean
from grammar_lang.elaboration.closed import Constants
from grammar_lang.elaboration.modules import ModuleInfo
from grammar_lang.elaboration.sorts import Sort, Typed, mismatch, warn_implausible
from grammar_lang.ir import constants
from grammar_lang.names.declarations import Entity, Occurrences, report_unknown
from grammar_lang.names.table import NameTable
from grammar_lang.source import Span
from grammar_lang.syntax import missions as m
from grammar_lang.syntax import tasks as t
from grammar_lang.units import FORCE, ONE, TORQUE, Dimension


def clause_places(task: t.Task) -> dict[str, Span]:
    """The places of the clauses that are plain values in the task."""
    kinds = {
        t.Horizon: "horizon",
        t.Gravity: "gravity",
        t.Modules: "modules",
        t.BoundsBody: "bounds_body",
        t.Control: "control",
        t.Repeat: "repeat",
        m.Minimize: "minimize",
    }
    return {kinds[type(item)]: item.span for item in task.items if type(item) in kinds}


# --- ``effort <= v``: bounds on the free inputs, one for each kind of degree of freedom -----------


_EFFORT: dict[ir.DofKind, Dimension] = {"revolute": TORQUE, "prismatic": FORCE}
_UNIT: dict[ir.DofKind, str] = {"revolute": "N*m", "prismatic": "N"}


@dataclass(slots=True)
class _EffortReader:
    """Reads the effort bounds of a task whose family has degrees of freedom of ``kinds``."""

    task: s.Ident
    kinds: tuple[ir.DofKind, ...]
    sink: Sink
    found: dict[ir.DofKind, ir.Effort] = field(default_factory=dict[ir.DofKind, ir.Effort])

    def missing(self, kind: ir.DofKind) -> None:
        """Report a missing bound, at a bound of a kind that does not occur if there is one."""
        for other, effort in self.found.items():
            if other not in self.kinds:
                value = Typed(ir.Pi(), Sort.SCALAR, _EFFORT[other])
                mismatch(value, _EFFORT[kind], effort.span, self.sink)
                return
        message = f"task `{self.task.text}` bounds no effort of the {kind} joints"
        hint = f"add `effort <= 10 {_UNIT[kind]};`"
        self.sink.error(Code.MISSING_CLAUSE, message, self.task.span, hint)

    def _kind(self, value: Typed, at: Span) -> ir.DofKind | None:
        """The kind of degree of freedom that an effort belongs to, by its dimension."""
        for kind, dimension in _EFFORT.items():
            if value.dimension == dimension:
                return kind
        if value.bare and len(self.kinds) == 1:
            return self.kinds[0]
        if value.bare:
            message = "an effort without a unit"
            hint = "write `N*m` for revolute, `N` for prismatic joints"
            self.sink.error(Code.UNIT_MISMATCH, message, at, hint)
        else:
            mismatch(value, _EFFORT[self.kinds[0] if self.kinds else "revolute"], at, self.sink)
        return None

    def read(self, item: t.Effort) -> None:
        norm2 = False
        if item.norm is not None:
            norm2 = item.norm.text == "2"
            if not norm2:
                self.sink.error(
                    Code.BAD_VALUE, "the only norm is 2", item.norm.span, "write `norm 2`"
                )
        reader = Constants(self.sink)
        value = reader.typed(item.bound)
        if value.sort is not Sort.SCALAR:
            return
        kind = self._kind(value, item.bound.span)
        bound = None if kind is None else reader.exact(value.expr, item.bound.span)
        if kind is None or bound is None:
            return
        if value.bare:
            warn_implausible(value, _EFFORT[kind], item.bound, None, self.sink)
        if bound <= 0:
            self.sink.error(
                Code.BAD_VALUE,
                "the effort bound is not positive",
                item.bound.span,
                "write more than zero",
            )
        if kind in self.found:
            notes = [(self.found[kind].span, "first here")]
            message = f"a second `effort` bound of the {kind} joints"
            self.sink.error(Code.REPEATED_CLAUSE, message, item.span, "remove one", notes)
        self.found.setdefault(kind, ir.Effort(kind, bound, norm2, item.bound.span))


def lower_efforts(task: t.Task, kinds: tuple[ir.DofKind, ...], sink: Sink) -> tuple[ir.Effort, ...]:
    """The effort bounds: at least one for each of the ``kinds`` of degrees of freedom."""
    before = len(sink.found)
    reader = _EffortReader(task.name, kinds, sink)
    for item in task.items:
        if isinstance(item, t.Effort):
            reader.read(item)
    if not Sink(sink.found[before:]).has_errors:
        for kind in kinds:
            if kind not in reader.found:
                reader.missing(kind)
    return tuple(reader.found.values())


# --------------------------------------------------------------------------------------------------
# ``from W fixed …``: the existing robot of a task (Example 2); its occurrences are resolved.


@dataclass(slots=True)
class _ReconfigurationReader:
    modules: Mapping[str, ModuleInfo]
    item: t.From
    word: Occurrences
    known: tuple[str, ...]
    sink: Sink
    seen: dict[tuple[int, str], Span] = field(default_factory=dict[tuple[int, str], Span])

    def _place(self, name: s.Ident) -> int | None:
        """The position of an occurrence in the word; None if there is none, which is reported."""
        if name.text in self.word.places:
            return self.word.places[name.text]
        if name.text in self.word.repeated:
            message = f"`{name.text}` occurs several times in the word"
            names = ", ".join(f"`{own}`" for own in self.word.repeated[name.text][:6])
            self.sink.error(Code.AMBIGUOUS_OCCURRENCE, message, name.span, f"write one of {names}")
        else:
            message = f"the word has no occurrence `{name.text}`"
            hint = did_you_mean(name.text, self.known, "occurrence", self.sink)
            self.sink.error(Code.UNKNOWN_NAME, message, name.span, hint)
        return None

    def fixed(self, item: t.Fixing) -> ir.Fixed | None:
        place = self._place(item.occurrence)
        if place is None:
            return None
        module = self.item.word[place].text
        if module not in self.modules:
            message = f"`{item.occurrence.text}` is an edge, and edges have no parameters"
            hint = "name an occurrence of a module"
            self.sink.error(Code.WRONG_KIND, message, item.occurrence.span, hint)
            return None
        parameter = self._parameter(item, self.modules[module])
        if parameter is None:
            return None
        key = (place, parameter.name)
        if key in self.seen:
            message = f"`{item.occurrence.text}.{item.name.text}` is fixed twice"
            notes = [(self.seen[key], "first here")]
            self.sink.error(Code.DUPLICATE_NAME, message, item.span, "remove one", notes)
            return None
        self.seen[key] = item.span
        value = self._value(item, parameter, self.modules[module])
        return None if value is None else ir.Fixed(place, parameter.name, value, item.span)

    def _parameter(self, item: t.Fixing, info: ModuleInfo) -> ir.Parameter | None:
        known = {parameter.name: parameter for parameter in info.module.parameters}
        name = item.name
        if name.text in known:
            return known[name.text]
        hint = did_you_mean(name.text, known, "parameter", self.sink)
        if name.text in info.names:
            kind = "a degree of freedom" if name.text in info.dofs else "no parameter"
            message = (
                f"`{name.text}` of module `{info.module.name}` is {kind}; parameters are fixed"
            )
            self.sink.error(Code.WRONG_KIND, message, name.span, hint)
        else:
            message = f"module `{info.module.name}` has no parameter `{name.text}`"
            self.sink.error(Code.UNKNOWN_NAME, message, name.span, hint)
        return None

    def _value(self, item: t.Fixing, parameter: ir.Parameter, info: ModuleInfo) -> ir.Expr | None:
        """The value, of the parameter's dimension and in its domain; None after an error."""
        reader = Constants(self.sink)
        dimension = info.members[parameter.name].dimension or ONE
        value = reader.scalar(item.value, dimension, angle=parameter.unit == "rad")
        if value is None or _in_domain(value, parameter.domain):
            return value
        message = f"this value of `{item.occurrence.text}.{item.name.text}` is not in its domain"
        ranged = isinstance(parameter.domain, ir.Interval)
        hint = "write a value of the interval" if ranged else "write one of the values"
        hint += " that the module declares"
        notes = [(parameter.span, "declared here")]
        self.sink.error(Code.BAD_VALUE, message, item.value.span, hint, notes)
        return None


def _in_domain(value: ir.Expr, domain: ir.Interval | ir.Choices) -> bool:
    less = constants.less
    if isinstance(domain, ir.Interval):
        return not less(value, domain.lower) and not less(domain.upper, value)
    return any(not less(value, one) and not less(one, value) for one in domain.values)


def _check_clashes(word: Occurrences, terminals: Mapping[str, Entity], sink: Sink) -> None:
    """Report the occurrences whose name is that of another symbol."""
    for name, own in word.clashes:
        message = f"this occurrence is called `{own}`, which is another symbol's name"
        notes = [(terminals[own].span, "declared here")]
        sink.error(Code.DUPLICATE_NAME, message, name.span, f"rename the symbol `{own}`", notes)


def lower_origin(
    item: t.From, modules: Mapping[str, ModuleInfo], names: NameTable, sink: Sink
) -> ir.Origin:
    """The existing robot; errors in its clause are reported.

    Args:
        item: the clause.
        modules: the modules of the file.
        names: the name table of the file.
        sink: collects the errors.
    """
    terminals = names.declared.terminals
    for name in item.word:
        if names.entity(name) is None:
            report_unknown(name, "a module or edge", terminals, names.declared, sink)
    word = names.words[item.span]
    if item.fixed:
        _check_clashes(word, terminals, sink)
    first = {name.text: at for at, name in reversed([*enumerate(item.word)])}
    known = sorted(word.places, key=lambda own: first[item.word[word.places[own]].text])
    reader = _ReconfigurationReader(modules, item, word, tuple(known), sink)
    found = [reader.fixed(fixing) for fixing in item.fixed]
    return ir.Origin(
        tuple(name.text for name in item.word),
        tuple(fixed for fixed in found if fixed is not None),
        item.span,
    )
