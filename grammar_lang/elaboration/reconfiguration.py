"""``from W fixed …``: the existing robot of a task (Example 2), its occurrences named and read."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from grammar_lang import ir
from grammar_lang import syntax as s
from grammar_lang.diagnostics.codes import Code
from grammar_lang.diagnostics.diagnostic import Sink
from grammar_lang.diagnostics.wording import did_you_mean
from grammar_lang.elaboration.closed import Constants
from grammar_lang.elaboration.modules import ModuleInfo
from grammar_lang.ir import constants
from grammar_lang.names.declarations import report_unknown
from grammar_lang.names.entities import Entity, Occurrences
from grammar_lang.names.table import NameTable
from grammar_lang.source import Span
from grammar_lang.syntax import tasks as t
from grammar_lang.units import ONE


@dataclass(slots=True)
class _Reader:
    modules: Mapping[str, ModuleInfo]
    item: t.From
    word: Occurrences
    known: tuple[str, ...]
    sink: Sink
    seen: dict[tuple[int, str], Span] = field(default_factory=dict[tuple[int, str], Span])

    def _place(self, name: s.Ident) -> int | None:
        """The position of an occurrence in the word; None where there is none, reported."""
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
        """The value, of the parameter's dimension and in its domain."""
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
    """Report the occurrences whose name is another symbol's own."""
    for name, own in word.clashes:
        message = f"this occurrence is called `{own}`, which is another symbol's name"
        notes = [(terminals[own].span, "declared here")]
        sink.error(Code.DUPLICATE_NAME, message, name.span, f"rename the symbol `{own}`", notes)


def lower_origin(
    item: t.From, modules: Mapping[str, ModuleInfo], names: NameTable, sink: Sink
) -> ir.Origin:
    """The existing robot; whatever is wrong with its clause is reported.

    Args:
        item: the clause.
        modules: the modules of the file.
        names: what the names of the file stand for.
        sink: where errors go.
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
    reader = _Reader(modules, item, word, tuple(known), sink)
    found = [reader.fixed(fixing) for fixing in item.fixed]
    return ir.Origin(
        tuple(name.text for name in item.word),
        tuple(fixed for fixed in found if fixed is not None),
        item.span,
    )
