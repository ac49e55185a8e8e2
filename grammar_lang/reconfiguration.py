"""``from W fixed …``: the existing robot of a task (Example 2), its occurrences named and read."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from grammar_lang import constants, ir
from grammar_lang import syntax as s
from grammar_lang import syntax_tasks as t
from grammar_lang.closed import Constants
from grammar_lang.findings.codes import Code
from grammar_lang.findings.diagnostics import Sink
from grammar_lang.findings.spelling import did_you_mean
from grammar_lang.modules import ModuleInfo
from grammar_lang.name_kinds import NameKinds
from grammar_lang.source import Span
from grammar_lang.units import ONE


@dataclass(slots=True)
class _Names:
    """How the occurrences of a word are called: X where it occurs once, else X1 to Xn."""

    word: tuple[s.Ident, ...]
    places: dict[str, int] = field(default_factory=dict[str, int])
    repeated: dict[str, tuple[str, ...]] = field(default_factory=dict[str, tuple[str, ...]])

    def collect(self, terminals: Mapping[str, Span], sink: Sink) -> None:
        """Name the occurrences; a name that is another symbol's own is reported."""
        positions: dict[str, list[int]] = {}
        for place, symbol in enumerate(self.word):
            positions.setdefault(symbol.text, []).append(place)
        for name, places in positions.items():
            if len(places) == 1:
                self.places[name] = places[0]
                continue
            numbered = tuple(f"{name}{n}" for n in range(1, len(places) + 1))
            self.repeated[name] = numbered
            for own, place in zip(numbered, places, strict=True):
                if own in terminals:
                    message = f"this occurrence is called `{own}`, which is another symbol's name"
                    hint = f"rename the symbol `{own}`"
                    at = self.word[place].span
                    sink.error(
                        Code.DUPLICATE_NAME, message, at, hint, [(terminals[own], "declared here")]
                    )
                else:
                    self.places[own] = place

    def place(self, name: s.Ident, sink: Sink) -> int | None:
        """The position of an occurrence in the word; None where there is none, reported."""
        if name.text in self.places:
            return self.places[name.text]
        if name.text in self.repeated:
            message = f"`{name.text}` occurs several times in the word"
            names = ", ".join(f"`{own}`" for own in self.repeated[name.text][:6])
            sink.error(Code.AMBIGUOUS_OCCURRENCE, message, name.span, f"write one of {names}")
        else:
            message = f"the word has no occurrence `{name.text}`"
            hint = did_you_mean(name.text, self.places, "occurrence", sink)
            sink.error(Code.UNKNOWN_NAME, message, name.span, hint)
        return None


@dataclass(slots=True)
class _Reader:
    modules: Mapping[str, ModuleInfo]
    names: _Names
    sink: Sink
    seen: dict[tuple[int, str], Span] = field(default_factory=dict[tuple[int, str], Span])

    def fixed(self, item: t.Fixing) -> ir.Fixed | None:
        place = self.names.place(item.occurrence, self.sink)
        if place is None:
            return None
        module = self.names.word[place].text
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


def lower_origin(
    item: t.From,
    modules: Mapping[str, ModuleInfo],
    terminals: Mapping[str, Span],
    kinds: NameKinds,
    sink: Sink,
) -> ir.Origin:
    """The existing robot; whatever is wrong with its clause is reported.

    Args:
        item: the clause.
        modules: the modules of the file.
        terminals: its modules and edges, with where they are declared.
        kinds: what the other names of the file are.
        sink: where errors go.
    """
    for name in item.word:
        if name.text not in terminals:
            kinds.report(name, "a module or edge", terminals, sink)
    names = _Names(item.word)
    if item.fixed:
        names.collect(terminals, sink)
    reader = _Reader(modules, names, sink)
    found = [reader.fixed(fixing) for fixing in item.fixed]
    return ir.Origin(
        tuple(name.text for name in item.word),
        tuple(fixed for fixed in found if fixed is not None),
        item.span,
    )
