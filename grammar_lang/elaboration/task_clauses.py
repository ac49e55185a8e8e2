"""The clauses of a task about inputs, disturbances and an existing robot."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from fractions import Fraction
from typing import Literal, TypeAlias

from grammar_lang import ir
from grammar_lang import syntax as s
from grammar_lang.diagnostics.diagnostic import Code, Sink
from grammar_lang.diagnostics.wording import did_you_mean
from grammar_lang.elaboration.closed import Constants, not_rational
from grammar_lang.elaboration.modules import ModuleInfo
from grammar_lang.elaboration.sorts import Sort, Typed, mismatch, warn_implausible
from grammar_lang.ir import constants
from grammar_lang.names.declarations import Entity, Occurrences, report_unknown
from grammar_lang.names.table import NameTable
from grammar_lang.source import Span
from grammar_lang.syntax import tasks as t
from grammar_lang.units import FORCE, FREQUENCY, LENGTH, ONE, SPEED, TORQUE, Dimension, describe


def clause_places(task: t.Task) -> dict[str, Span]:
    """Where the clauses stand that are plain values in the task."""
    kinds = {
        t.Horizon: "horizon",
        t.Gravity: "gravity",
        t.Modules: "modules",
        t.BoundsBody: "bounds_body",
        t.Control: "control",
        t.Repeat: "repeat",
    }
    return {kinds[type(item)]: item.span for item in task.items if type(item) in kinds}


# --- ``effort <= v``: bounds on the free inputs, one for each kind of degree of freedom -----------


_EFFORT: dict[ir.DofKind, Dimension] = {"revolute": TORQUE, "prismatic": FORCE}
_UNIT: dict[ir.DofKind, str] = {"revolute": "N*m", "prismatic": "N"}


@dataclass(slots=True)
class _EffortReader:
    """Reads the bounds of a task whose family has degrees of freedom of ``kinds``."""

    task: s.Ident
    kinds: tuple[ir.DofKind, ...]
    sink: Sink
    found: dict[ir.DofKind, ir.Effort] = field(default_factory=dict[ir.DofKind, ir.Effort])

    def missing(self, kind: ir.DofKind) -> None:
        """Report a missing bound; at a bound of a kind that does not occur, if there is one."""
        for other, effort in self.found.items():
            if other not in self.kinds:
                value = Typed(ir.Pi(), Sort.SCALAR, _EFFORT[other])
                mismatch(value, _EFFORT[kind], effort.span, self.sink)
                return
        message = f"task `{self.task.text}` bounds no effort of the {kind} joints"
        hint = f"add `effort <= 10 {_UNIT[kind]};`"
        self.sink.error(Code.MISSING_CLAUSE, message, self.task.span, hint)

    def _kind(self, value: Typed, at: Span) -> ir.DofKind | None:
        """The kind that an effort belongs to, by its dimension."""
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
    """The effort bounds, one for each of the ``kinds`` of degrees of freedom at least."""
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


# --- ``robust …``: disturbances that a motion has to bear -----------------------------------------


Radius: TypeAlias = Literal["length", "angle", "speed", "angular_rate"]

_KINDS: dict[Dimension, Radius] = {
    LENGTH: "length",
    ONE: "angle",
    SPEED: "speed",
    FREQUENCY: "angular_rate",
}
_ARTICLED: dict[Radius, str] = {
    "length": "a length",
    "angle": "an angle",
    "speed": "a speed",
    "angular_rate": "an angular rate",
}
_HINT = (
    "write a length, an angle, a speed or an angular rate: `1 mm`, `0.1 deg`, `1 mm/s`, `1 deg/s`"
)
_SUBJECT = {"start": "disturbance", "measure": "measurement error"}
_PERCENT = {
    "effort": ("`robust effort`", "the disturbance of the efforts"),
    "effort of bound": ("`robust effort … of bound`", "the disturbance of the efforts"),
    "mass": ("`robust mass`", "the error of the masses"),
}

# pi = 3.14159265358979323846264338327950288419...
_PI_BELOW = Fraction(314159265358979323846264338327950288, 10**35)
_PI_ABOVE = _PI_BELOW + Fraction(1, 10**35)


def _at_least(value: constants.Monomial) -> Fraction:
    """A rational at least a positive ``q * pi**k``, and above it by less than 1e-30 of it."""
    factor, power = value
    return factor * (_PI_ABOVE**power if power >= 0 else 1 / _PI_BELOW**-power)


@dataclass(slots=True)
class _RadiiReader:
    """Reads the radii of all clauses ``robust start``, or of all ``robust measure``."""

    subject: str
    sink: Sink
    radii: dict[Radius, tuple[Fraction, Span]] = field(
        default_factory=dict[Radius, tuple[Fraction, Span]]
    )

    def read(self, item: t.RobustRadii) -> None:
        for expr in item.values:
            value = Constants(self.sink).typed(expr)
            kind = self._kind(value, expr.span)
            if kind is not None:
                self._radius(kind, value, expr)

    def found(self) -> ir.Radii:
        return ir.Radii(**{kind: value for kind, (value, _) in self.radii.items()})

    def _kind(self, value: Typed, at: Span) -> Radius | None:
        if value.sort is not Sort.SCALAR:
            return None
        if value.dimension is None:
            self.sink.error(Code.UNIT_MISMATCH, f"a {self.subject} without a unit", at, _HINT)
            return None
        kind = _KINDS.get(value.dimension)
        if kind is None or (kind == "angle" and not value.angular):
            message = f"{describe(value.dimension)} is no {self.subject} of a state"
            self.sink.error(Code.UNIT_MISMATCH, message, at, _HINT)
            return None
        return kind

    def _radius(self, kind: Radius, value: Typed, expr: s.Expr) -> None:
        if kind in self.radii:
            message = f"a second {self.subject} by {_ARTICLED[kind]}"
            notes = [(self.radii[kind][1], "first here")]
            self.sink.error(Code.REPEATED_CLAUSE, message, expr.span, "remove one", notes)
            return
        # A larger disturbance is bounded than the one written, where that one is irrational.
        exact = constants.evident(value.expr)
        if exact is None:
            not_rational(expr.span, self.sink)
        elif exact[0] <= 0:
            message = f"the {self.subject} is not positive"
            self.sink.error(Code.BAD_VALUE, message, expr.span, "write more than zero")
        self.radii[kind] = (Fraction(0) if exact is None else _at_least(exact), expr.span)


def _fraction(item: t.RobustPercent, sink: Sink) -> Fraction:
    """The percentage as a fraction; zero where an error was reported."""
    value = Constants(sink).rational(item.percent, ONE)
    if value is not None and not 0 < value < 100:
        message = f"{_PERCENT[item.of][1]} is not between 0 % and 100 %"
        hint = "write a percentage such as `5 %`"
        sink.error(Code.BAD_VALUE, message, item.percent.span, hint)
    return (value or Fraction(0)) / 100


def _check_control(items: tuple[t.TaskItem, ...], measured: Span | None, sink: Sink) -> None:
    """Report errors of measurements where the inputs follow no measurement."""
    controls = [item for item in items if isinstance(item, t.Control)]
    if measured is not None and {item.loop for item in controls} == {"open loop"}:
        message = "an open-loop controller measures nothing"
        hint = "remove `robust measure`, or write `control feedback;`"
        notes = [(controls[0].span, "the inputs follow no measurement")]
        sink.error(Code.OPEN_LOOP_MEASUREMENT, message, measured, hint, notes)


def lower_robust(items: tuple[t.TaskItem, ...], sink: Sink) -> ir.Robust:
    """What the ``robust`` clauses of a task say together.

    Args:
        items: all clauses of the task, also the others.
        sink: where errors go.
    """
    radii = {of: _RadiiReader(subject, sink) for of, subject in _SUBJECT.items()}
    fractions: dict[str, Fraction] = {}
    places: dict[str, Span] = {}
    for item in items:
        match item:
            case t.RobustRadii():
                radii[item.of].read(item)
                places.setdefault(item.of, item.span)
            case t.RobustPercent() if item.of in fractions:
                notes = [(places[item.of], "first here")]
                message = f"a second {_PERCENT[item.of][0]}"
                sink.error(Code.REPEATED_CLAUSE, message, item.span, "remove one", notes)
            case t.RobustPercent():
                fractions[item.of] = _fraction(item, sink)
                places[item.of] = item.span
            case _:
                pass
    _check_control(items, places.get("measure"), sink)
    none = Fraction(0)
    return ir.Robust(
        start=radii["start"].found(),
        measured=radii["measure"].found(),
        effort=fractions.get("effort", none),
        effort_of_bound=fractions.get("effort of bound", none),
        mass=fractions.get("mass", none),
        clauses=places,
    )


# --------------------------------------------------------------------------------------------------
# ``from W fixed …``: the existing robot of a task (Example 2), its occurrences named and read.


@dataclass(slots=True)
class _ReconfigurationReader:
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
    reader = _ReconfigurationReader(modules, item, word, tuple(known), sink)
    found = [reader.fixed(fixing) for fixing in item.fixed]
    return ir.Origin(
        tuple(name.text for name in item.word),
        tuple(fixed for fixed in found if fixed is not None),
        item.span,
    )
