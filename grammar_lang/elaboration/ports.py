"""Grammars from ports: their clauses, which modules fit where, and whether robots are finite."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Literal, TypeAlias

from grammar_lang import ir
from grammar_lang import syntax as s
from grammar_lang.diagnostics.diagnostic import Code, Severity, Sink
from grammar_lang.diagnostics.wording import did_you_mean, nearest
from grammar_lang.elaboration.modules import INPUT, ModuleInfo
from grammar_lang.elaboration.productions import Conditions
from grammar_lang.names.declarations import duplicate, report_unknown
from grammar_lang.names.table import NameTable
from grammar_lang.source import Span

Gender: TypeAlias = Literal["male", "female"] | None
Fit: TypeAlias = tuple[str, Gender]
"""The type and gender of an output."""

OTHER: Mapping[Gender, Gender] = {None: None, "male": "female", "female": "male"}


@dataclass(frozen=True, slots=True)
class Part:
    """A module of the grammar; ``place`` is where the grammar names it."""

    info: ModuleInfo
    place: Span

    @property
    def name(self) -> str:
        """The name of the module."""
        return self.info.module.name

    @property
    def outputs(self) -> tuple[s.Port, ...]:
        """Its outputs, in declaration order."""
        return () if self.info.body is None else self.info.body.outputs

    @property
    def input(self) -> s.Port | None:
        """The port by which another module carries it, if it has one."""
        return None if self.info.body is None else self.info.body.ports.get(INPUT)

    @property
    def stands_at(self) -> Fit | None:
        """The type and gender of the outputs that can carry it; None if it has no input."""
        port = self.input
        return None if port is None else (port.type.text, OTHER[port.gender])


def fit_of(port: s.Port) -> Fit:
    """The type and gender of an output."""
    return port.type.text, port.gender


def _shown(port: s.Port, name: str) -> str:
    gender = "" if port.gender is None else f" {port.gender}"
    return f"port {name}: {port.type.text}{gender}"


# --- Clauses -------------------------------------------------------------------------------------


@dataclass(slots=True)
class Clauses:
    """The clauses of a grammar from ports.

    ``broken`` are the modules with statements that could not be parsed, so that anything in them
    may be missing.
    """

    grammar: s.Grammar
    modules: Mapping[str, ModuleInfo]
    names: NameTable
    sink: Sink
    broken: Collection[str]
    start: Part | None = None
    complete: bool = True
    """Whether all names were resolved; if not, nothing is reported as missing."""
    listed: dict[str, Part] = field(default_factory=dict[str, Part])
    accepts: list[ir.Accept] = field(default_factory=list[ir.Accept])

    def read(self) -> None:
        """Read all clauses and report their errors."""
        first: s.StartSymbol | None = None
        for item in self.grammar.items:
            match item:
                case s.StartSymbol(name=name):
                    if first is not None:
                        message, hint = "a second start module", "a grammar has one start"
                        notes = [(first.span, "first here")]
                        self.sink.error(Code.REPEATED_CLAUSE, message, item.span, hint, notes)
                    first = first or item
                    self.start = self.start or self._part(name)
                case s.Listed(names=names):
                    for name in names:
                        self._list(name)
                case s.Accept(condition=condition):
                    self.accepts.append(Conditions(self.names, self.sink).lower(condition))
                case s.Production():
                    message = "a grammar from ports has no productions: the ports say what fits"
                    hint = "list the modules, as in `with Elbow, Hand;`, or remove `from ports`"
                    self.sink.error(Code.OTHER_GRAMMAR, message, item.span, hint)
        if first is None:
            message = f"grammar `{self.grammar.name.text}` has no start module"
            bases = (n for n, info in self.modules.items() if info.module.role == "base")
            hint = f"add `start {next(bases, 'Base')};`: the module that stands on the world"
            self.sink.error(Code.MISSING_START, message, self.grammar.name.span, hint)

    def _part(self, name: s.Ident) -> Part | None:
        if name.text in self.modules:
            return Part(self.modules[name.text], name.span)
        report_unknown(name, "a module", self.modules, self.names.declared, self.sink)
        self.complete = False
        return None

    def _list(self, name: s.Ident) -> None:
        if name.text in self.listed:
            hint = "a module may stand at any number of places all the same"
            duplicate(name, self.listed[name.text].place, self.sink, hint)
            return
        part = self._part(name)
        if part is None:
            return
        self.listed[name.text] = part
        if part.input is None and name.text not in self.broken:
            start = self.start is not None and self.start.name == part.name
            message = f"module `{name.text}` has no `port in`: no other module can carry it"
            hint = "add `port in: TYPE;` to the module, of the type of an output"
            if start:
                hint = "`start` names it already: remove it here"
            self.sink.error(Code.NO_INPUT, message, name.span, hint)


# --- Robots that can be built --------------------------------------------------------------------


def _ending(parts: Collection[Part]) -> dict[str, Part]:
    """The modules that can start a finite branch, by name.

    A module can if each of its outputs can carry a module that can.
    """
    missing: dict[str, set[Fit | None]] = {
        part.name: {fit_of(port) for port in part.outputs} for part in parts
    }
    waiting: dict[Fit | None, list[Part]] = {}
    for part in parts:
        for fit in missing[part.name]:
            waiting.setdefault(fit, []).append(part)
    todo = [part for part in parts if not missing[part.name]]
    found: dict[str, Part] = {}
    while todo:
        part = todo.pop()
        found[part.name] = part
        for other in waiting.pop(part.stands_at, ()):
            missing[other.name].discard(part.stands_at)
            if not missing[other.name]:
                todo.append(other)
    return found


def _carried(start: Part, listed: Collection[Part]) -> dict[str, Part]:
    """The listed modules that can be reached from the start through outputs, by name."""
    standing: dict[Fit | None, list[Part]] = {}
    for part in listed:
        standing.setdefault(part.stands_at, []).append(part)
    todo, found = [start], set[str]()
    while todo:
        for port in todo.pop().outputs:
            new = standing.pop(fit_of(port), ())
            found.update(part.name for part in new)
            todo += new
    return {part.name: part for part in listed if part.name in found}


@dataclass(frozen=True, slots=True)
class Checks:
    """Checks that every output is filled, every module is carried, and robots are finite."""

    clauses: Clauses
    start: Part

    def run(self) -> list[Part]:
        """The listed modules that occur in robots, in their order; report errors."""
        listed = self.clauses.listed
        carried = _carried(self.start, listed.values())
        # A module that lacks its input would fill some output.
        whole = all(part.input is not None for part in listed.values())
        whole = whole and not {self.start.name, *listed}.intersection(self.clauses.broken)
        whole = whole and self.clauses.complete
        filled = {part.stands_at for part in listed.values()}
        open_ones = [
            (port, part)
            for part in (self.start, *carried.values())
            for port in part.outputs
            if whole and fit_of(port) not in filled
        ]
        for port, part in open_ones:
            self._open(port, part)
        self._check_dofs([self.start, *listed.values()])
        ending = _ending([self.start, *carried.values()])
        left = _carried(self.start, [p for name, p in carried.items() if name in ending])
        if whole and not open_ones:
            self._check_end(carried, ending)
            for name, part in listed.items() if self.start.name in ending else ():
                if name not in left and (name not in carried or name in ending):
                    self._idle(part, left)
        return list(left.values())

    def _open(self, port: s.Port, part: Part) -> None:
        """Report an output that no listed module fits."""
        wanted = s.Port(port.name, port.type, OTHER[port.gender])
        message = (
            f"nothing fits the output `{port.name.text}` of module `{part.name}`: "
            f"no listed module has `{_shown(wanted, INPUT)}`"
        )
        at, notes = port.type.span, [(part.place, "listed here")]
        if at.file != part.place.file:
            at, notes = part.place, [(port.type.span, "the output")]
        self.clauses.sink.error(Code.OPEN_OUTPUT, message, at, self._fitting(port), notes)

    def _fitting(self, port: s.Port) -> str:
        """A hint on which module might fit an output."""
        parts = [Part(info, port.span) for info in self.clauses.modules.values()]
        known = [part for part in parts if part.stands_at == fit_of(port)]
        if known:
            return f"list `{known[0].name}` in `with`, which fits"
        same = [p for p in parts if p.input is not None and p.input.type.text == port.type.text]
        if same and same[0].input is not None:
            meant = _shown(same[0].input, INPUT)
            return f"`{same[0].name}` has `{meant}`: male fits female, and none fits none"
        types = {p.input.type.text: None for p in parts if p.input is not None}
        close = nearest(port.type.text, types, self.clauses.sink)
        if close is not None:
            return f"did you mean the type `{close}`?"
        return "list a module that ends it, such as a hand, or a cap: a module with `port in` alone"

    def _idle(self, part: Part, carried: Mapping[str, Part]) -> None:
        """Warn of a module that no other module carries."""
        types = {
            p.type.text: None for each in (self.start, *carried.values()) for p in each.outputs
        }
        port = part.input
        if port is None:
            return
        message = f"no robot has a `{part.name}`: no output that can be reached carries it"
        hint = "no module that can be reached has outputs"
        if part.name == self.start.name:
            message = f"nothing carries a `{part.name}`, which `start` names already"
            hint = "remove it here"
        elif port.type.text in types:
            hint = "the type is that of an output, but the gender does not fit"
        elif types:
            hint = did_you_mean(port.type.text, types, "type of an output", self.clauses.sink)
        notes = [(port.type.span, "its input")]
        self.clauses.sink.warning(Code.UNUSED_SYMBOL, message, part.place, hint, notes)

    def _check_dofs(self, parts: Sequence[Part]) -> None:
        """Report degrees of freedom that no frame of their module uses."""
        told = {found.span for found in self.clauses.sink.found}
        wrong = [d.span for d in self.clauses.sink.found if d.severity is Severity.ERROR]
        for part in {part.name: part for part in parts}.values():
            used = {} if part.info.body is None else part.info.body.used
            for name, dof in part.info.dofs.items():
                if name in used or dof.span in told or _inside(part.info.module.span, wrong):
                    continue
                place = "rot" if dof.kind == "revolute" else "move"
                message = f"no frame of module `{part.name}` uses `{name}`"
                hint = f"use it once, as in `frame out = in * {place}({dof.axis}, {name});`"
                self.clauses.sink.error(Code.BAD_DOF_USE, message, dof.span, hint)

    def _check_end(self, carried: Mapping[str, Part], ending: Mapping[str, Part]) -> None:
        """Report a grammar without finite robots, and warn of modules that occur in no robot."""
        sink, filled = self.clauses.sink, {part.stands_at for part in ending.values()}
        if self.start.name not in ending:
            port = next(port for port in self.start.outputs if fit_of(port) not in filled)
            fitting = [f"`{p.name}`" for p in carried.values() if p.stands_at == fit_of(port)]
            message = (
                f"no robot of grammar `{self.clauses.grammar.name.text}` is ever complete: "
                f"every module that fits `{port.name.text}` of `{self.start.name}` has outputs too"
            )
            hint = f"list a module without outputs beside {', '.join(fitting)}, such as a hand"
            hint = self._ending(carried) or hint
            sink.error(Code.ENDLESS_PORTS, message, self.clauses.grammar.name.span, hint)
            return
        for part in carried.values():
            if part.name not in ending:
                port = next(port for port in part.outputs if fit_of(port) not in filled)
                message = (
                    f"no robot has a `{part.name}`: the branch at its `{port.name.text}` never ends"
                )
                hint = "list a module without outputs that fits there, such as a cap"
                notes = [(port.name.span, "the output")]
                sink.warning(Code.UNPRODUCTIVE, message, part.place, hint, notes)

    def _ending(self, carried: Mapping[str, Part]) -> str | None:
        """A hint: a known module without outputs; None if there is none."""
        due = {fit_of(port) for part in (self.start, *carried.values()) for port in part.outputs}
        for name, info in self.clauses.modules.items():
            part = Part(info, info.module.span)
            if part.input is None or part.outputs:
                continue
            if part.stands_at in due:
                return f"list `{name}` in `with`, which fits and has none"
            if name in self.clauses.listed:
                shown = _shown(part.input, INPUT)
                return f"`{name}` has none, but its `{shown}` fits no output"
        return None


def _inside(whole: Span, places: Iterable[Span]) -> bool:
    """Whether one of the places is within a part of the text."""
    return any(p.file == whole.file and whole.start <= p.start < whole.end for p in places)
