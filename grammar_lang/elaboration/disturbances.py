"""The ``robust`` clauses of a task: disturbances that a motion has to withstand."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from fractions import Fraction
from typing import Literal, TypeAlias

from grammar_lang import ir
from grammar_lang import syntax as s
from grammar_lang.diagnostics.diagnostic import Code, Sink
from grammar_lang.elaboration.closed import Constants, not_rational
from grammar_lang.elaboration.sorts import Sort, Typed
from grammar_lang.ir.enclosures import rational_bounds
from grammar_lang.names.declarations import report_unknown
from grammar_lang.names.table import NameTable
from grammar_lang.source import Span
from grammar_lang.syntax import tasks as t
from grammar_lang.units import FREQUENCY, LENGTH, ONE, SPEED, Dimension, describe

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
    "payload": ("`robust payload`", "the error of the payload"),
}


@dataclass(slots=True)
class _RadiiReader:
    """Reads the radii of all ``robust start`` clauses, or of all ``robust measure`` clauses."""

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

    def places(self) -> Iterator[tuple[str, Span]]:
        """The kind and place of each radius."""
        return ((kind, at) for kind, (_, at) in self.radii.items())

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
        # An irrational radius is rounded up, so that the bound covers the disturbance as written.
        bounds = rational_bounds(value.expr)
        if bounds is None:
            not_rational(expr.span, self.sink)
        elif bounds[1] <= 0:
            message = f"the {self.subject} is not positive"
            self.sink.error(Code.BAD_VALUE, message, expr.span, "write more than zero")
        self.radii[kind] = Fraction(0) if bounds is None else bounds[1], expr.span


def _fraction(item: t.RobustPercent, sink: Sink) -> Fraction:
    """The percentage as a fraction; zero if it could not be read."""
    value = Constants(sink).rational(item.percent, ONE)
    if value is not None and not 0 < value < 100:
        message = f"{_PERCENT[item.of][1]} is not between 0 % and 100 %"
        hint = "write a percentage such as `5 %`"
        sink.error(Code.BAD_VALUE, message, item.percent.span, hint)
    return (value or Fraction(0)) / 100


def _check_control(items: tuple[t.TaskItem, ...], measured: Span | None, sink: Sink) -> None:
    """Report measurement errors in a task with an open-loop controller."""
    controls = [item for item in items if isinstance(item, t.Control)]
    if measured is not None and {item.loop for item in controls} == {"open loop"}:
        message = "an open-loop controller measures nothing"
        hint = "remove `robust measure`, or write `control feedback;`"
        notes = [(controls[0].span, "the inputs follow no measurement")]
        sink.error(Code.OPEN_LOOP_MEASUREMENT, message, measured, hint, notes)


def _check_payload(items: tuple[t.TaskItem, ...], robust: Span | None, sink: Sink) -> None:
    """Report a payload error in a task without a payload."""
    if robust is not None and not any(isinstance(item, t.Payload | t.Carry) for item in items):
        hint = "add `payload m;` or `carry m from A to B;`, or remove `robust payload`"
        sink.error(Code.MISSING_CLAUSE, "the task has no `payload`, nor `carry`", robust, hint)


def _module_mass(
    item: t.RobustPercent,
    module: s.Ident,
    masses: dict[str, ir.ModuleMass],
    names: NameTable,
    sink: Sink,
) -> None:
    """Read ``robust mass p % of M``; report M if it is not a module, or is repeated."""
    if names.entity(module) is None:
        report_unknown(module, "a module", names.declared.modules, names.declared, sink)
    elif module.text in masses:
        notes = [(masses[module.text].span, "first here")]
        message = f"a second `robust mass` of `{module.text}`"
        sink.error(Code.REPEATED_CLAUSE, message, item.span, "remove one", notes)
    else:
        masses[module.text] = ir.ModuleMass(module.text, _fraction(item, sink), item.span)


def lower_robust(items: tuple[t.TaskItem, ...], names: NameTable, sink: Sink) -> ir.Robust:
    """The disturbances of all ``robust`` clauses of a task together.

    Args:
        items: all clauses of the task, including others.
        names: the name table of the file.
        sink: collects the errors.
    """
    radii = {of: _RadiiReader(subject, sink) for of, subject in _SUBJECT.items()}
    fractions: dict[str, Fraction] = {}
    masses: dict[str, ir.ModuleMass] = {}
    places: dict[str, Span] = {}
    for item in items:
        match item:
            case t.RobustRadii():
                radii[item.of].read(item)
                places.setdefault(item.of, item.span)
            case t.RobustPercent(module=module) if module is not None:
                _module_mass(item, module, masses, names, sink)
                places.setdefault("mass of", item.span)
            case t.RobustPercent() if item.of in fractions:
                notes = [(places[item.of], "first here")]
                message = f"a second {_PERCENT[item.of][0]}"
                sink.error(Code.REPEATED_CLAUSE, message, item.span, "remove one", notes)
            case t.RobustPercent():
                fractions[item.of] = _fraction(item, sink)
                places[item.of] = item.span
            case _:
                pass
    for of, reader in radii.items():
        places |= {f"{of} {kind}": at for kind, at in reader.places()}
    _check_control(items, places.get("measure"), sink)
    _check_payload(items, places.get("payload"), sink)
    none = Fraction(0)
    return ir.Robust(
        start=radii["start"].found(),
        measured=radii["measure"].found(),
        effort=fractions.get("effort", none),
        effort_of_bound=fractions.get("effort of bound", none),
        mass=fractions.get("mass", none),
        masses=tuple(masses.values()),
        payload=fractions.get("payload", none),
        clauses=places,
    )


# --- The modules that bodies belong to, if a task asks for the bodies of a module -----------------


def check_ownership(task: ir.Task, grammars: Mapping[str, ir.Grammar], sink: Sink) -> None:
    """Report a clause about the bodies of a module if it has none, or if their owner is unclear.

    Such clauses are ``robust mass p % of M`` and ``avoid self … except M N``.

    Args:
        task: the task.
        grammars: the grammars of the file, by name.
        sink: collects the errors.
    """
    grammar = grammars.get(task.grammar)
    if grammar is None or not grammar.semantics:
        return
    for module, clause in _asked_for(task):
        bodies = list(_bodies_of(grammar, module))
        mixed = next((each for each in bodies if len(each[1]) > 1), None)
        if mixed is not None:
            at, names = mixed
            message = f"it is not clear which module this body belongs to: {' or '.join(names)}"
            hint = "emit it in a production of one module, or name one module in its quantities"
            notes = [(clause, "the task asks for it here")]
            sink.error(Code.MIXED_OWNERS, message, at, hint, notes)
        elif not bodies:
            message = f"no body of a robot of `{grammar.name}` is that of module `{module}`"
            hint = "name a module that has a body"
            sink.error(Code.BAD_VALUE, message, clause, hint)


def _asked_for(task: ir.Task) -> Iterator[tuple[str, Span]]:
    """The modules whose bodies a task refers to, and where."""
    if task.robust is not None:
        yield from ((clause.module, clause.span) for clause in task.robust.masses)
    if task.avoid_self is not None:
        for module in sorted({name for pair in task.avoid_self.exceptions for name in pair}):
            yield module, task.avoid_self.span


def _bodies_of(grammar: ir.Grammar, module: str) -> Iterator[tuple[Span, tuple[str, ...]]]:
    """The places of the bodies that may belong to a module, with their possible owners."""
    for production in grammar.productions:
        block = (grammar.semantics or {}).get(production.label)
        for emission in () if block is None else block.emissions:
            if isinstance(emission, ir.Effector):
                continue
            names = [production.right[i].name for i in ir.owners(production, emission)]
            if module in names:
                yield emission.span, tuple(f"`{name}`" for name in names)
