"""The objectives of a ``minimize`` clause, in their order."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from fractions import Fraction

from grammar_lang import ir
from grammar_lang import syntax as s
from grammar_lang.diagnostics.diagnostic import Code, Sink
from grammar_lang.diagnostics.wording import did_you_mean, nearest
from grammar_lang.elaboration.closed import Constants, not_rational
from grammar_lang.elaboration.families import Family
from grammar_lang.elaboration.modules import ModuleInfo
from grammar_lang.elaboration.sorts import ZERO, Sort, Typed, wrong_sort
from grammar_lang.ir import constants
from grammar_lang.names.table import NameTable
from grammar_lang.source import Span
from grammar_lang.syntax import missions as m
from grammar_lang.syntax import tasks as t
from grammar_lang.units import ONE, describe, symbol

_KINDS: Mapping[str, ir.ObjectiveKind] = {
    "modules": "modules",
    "mass": "mass",
    "time": "time",
    "energy": "energy",
    "effort": "effort",
    "sum": "sum",
}
_OF_MISSIONS: Mapping[str, ir.ObjectiveKind] = {**_KINDS, "changes": "changes"}
_THERE_ARE = "the objectives are `modules`, `mass`, `time`, `energy`, `effort` and `sum(NAME)`"
_CHANGES_TOO = "; of missions with `reconfigure` also `changes`"
_SHOWN = 6


@dataclass(slots=True)
class _Reader:
    family: Family | None
    modules: Mapping[str, ModuleInfo]
    names: NameTable
    sink: Sink
    of_mission: bool = False
    seen: dict[tuple[ir.ObjectiveKind, str | None], Span] = field(
        default_factory=dict[tuple[ir.ObjectiveKind, str | None], Span]
    )

    def objective(self, item: m.Objective, *, last: bool) -> ir.Objective | None:
        """An objective; None if it is unknown or repeated, which is reported."""
        within = self._within(item, last=last)
        kind = self._kind(item)
        if kind is None:
            return None
        key = kind, None if item.attribute is None else item.attribute.text
        if key in self.seen:
            shown = kind if item.attribute is None else f"{kind}({item.attribute.text})"
            message, notes = f"a second `{shown}`", [(self.seen[key], "first here")]
            self.sink.error(Code.REPEATED_CLAUSE, message, item.span, "remove one", notes)
            return None
        self.seen[key] = item.span
        if item.attribute is None:
            return ir.Objective(kind, within, span=item.span)
        name = item.attribute.text
        if self.family is None:
            return ir.Objective(kind, within, name, span=item.span)
        infos = {module: self.modules[module] for module in self.family.modules}
        total = _Sum(item.attribute, item.span, infos, self.names, self.sink)
        unit = "" if total.unit == "1" else total.unit
        return ir.Objective(kind, within, name, total.amounts(), unit, item.span)

    def _within(self, item: m.Objective, *, last: bool) -> Fraction:
        """The fraction of its least value that later objectives may add to it."""
        if item.within is None:
            return Fraction(0)
        value, at = Constants(self.sink).rational(item.within, ONE), item.within.span
        if value is not None and value < 0:
            self.sink.error(Code.BAD_WITHIN, "`within` is below zero", at, "write zero or more")
        elif last:
            message = "no objective follows that could use this allowance"
            hint = "remove `within`, or add `then …` with another objective"
            self.sink.error(Code.BAD_WITHIN, message, at, hint)
        return (value or Fraction(0)) / 100

    # --- The kind of objective -----------------------------------------------------------------

    @property
    def _kinds(self) -> Mapping[str, ir.ObjectiveKind]:
        return _OF_MISSIONS if self.of_mission else _KINDS

    @property
    def _there_are(self) -> str:
        return f"{_THERE_ARE}{_CHANGES_TOO}" if self.of_mission else _THERE_ARE

    def _kind(self, item: m.Objective) -> ir.ObjectiveKind | None:
        name, kind = item.name, self._kinds.get(item.name.text)
        if kind is None:
            message = f"unknown objective `{name.text}`"
            self.sink.error(Code.NO_OBJECTIVE, message, name.span, self._meant(item))
        elif kind == "sum" and item.attribute is None:
            hint = "write `sum(NAME)` with the name of a `const` or `param` of the modules"
            self.sink.error(Code.NO_OBJECTIVE, "a sum of what?", name.span, hint)
            return None
        elif kind != "sum" and item.attribute is not None:
            message = f"the objective `{kind}` takes nothing in brackets"
            hint = f"write `{kind}` alone; {self._there_are}"
            self.sink.error(Code.NO_OBJECTIVE, message, item.attribute.span, hint)
            return None
        return kind

    def _meant(self, item: m.Objective) -> str:
        """A hint on what to write instead of an unknown objective."""
        name = item.name.text
        if name == "changes":
            return f"`changes` belongs to a `mission` with `reconfigure`; {_THERE_ARE}"
        if item.attribute is None and any(name in info.members for info in self.modules.values()):
            return f"did you mean `sum({name})`? {self._there_are}"
        known = [kind for kind in self._kinds if (kind == "sum") == (item.attribute is not None)]
        close = nearest(name, known, self.sink)
        meant = "" if close is None else f"did you mean `{close}`? "
        return f"{meant}{self._there_are}"


# --- Sums: the attribute of each module of the family ---------------------------------------------


@dataclass(frozen=True, slots=True)
class _Amount:
    """The attribute of a module: its value, and where the value is written."""

    module: str
    value: Typed
    at: Span
    parameter: ir.Parameter | None

    @property
    def unit(self) -> str:
        """The SI unit as text; ``1`` for a plain number."""
        if self.parameter is not None:
            return self.parameter.unit
        return symbol(self.value.dimension or ONE, angular=self.value.angular)

    @property
    def negative(self) -> bool:
        """Whether it may be below zero."""
        match self.value.expr if self.parameter is None else self.parameter.domain:
            case ir.Interval(lower=lower):
                return constants.less(lower, ZERO)
            case ir.Choices(values=values):
                return any(constants.less(value, ZERO) for value in values)
            case value:
                return constants.less(value, ZERO)


@dataclass(slots=True)
class _Sum:
    """The sum of an attribute over modules, reported at the place of its objective."""

    attribute: s.Ident
    span: Span
    modules: Mapping[str, ModuleInfo]
    names: NameTable
    sink: Sink
    found: tuple[_Amount, ...] = field(init=False)

    def __post_init__(self) -> None:
        having = (module for module in self.modules if self._has(module))
        self.found = tuple(map(self._amount, having))

    @property
    def unit(self) -> str:
        """The SI unit as text; ``1`` for a plain number."""
        return next((each.unit for each in self._sound()), "1")

    def amounts(self) -> tuple[tuple[str, Fraction | None], ...]:
        """The modules with the attribute and their values, None for parameters; report errors."""
        if not self.found:
            name = self.attribute.text
            message = f"no module of the grammar has a `const` or `param` called `{name}`"
            known = dict.fromkeys(each for info in self.modules.values() for each in info.members)
            hint = did_you_mean(name, known, "attribute", self.sink)
            self.sink.error(Code.NO_AMOUNT, message, self.attribute.span, hint)
        elif len(self.found) < len(self.modules):
            self._warn_of_zeros([module for module in self.modules if not self._has(module)])
        return tuple((each.module, self._checked(each)) for each in self.found)

    def _has(self, module: str) -> bool:
        return self.attribute.text in self.modules[module].members

    def _sound(self) -> Iterator[_Amount]:
        return (each for each in self.found if each.value.sort is Sort.SCALAR)

    def _amount(self, module: str) -> _Amount:
        name, info = self.attribute.text, self.modules[module]
        parameters = (each for each in info.module.parameters if each.name == name)
        return _Amount(module, info.members[name], self._written(module), next(parameters, None))

    def _written(self, module: str) -> Span:
        """The place of the value of the attribute."""
        for item in self.names.declared.modules[module].items:
            match item:
                case s.Const(name=name, value=value) if name.text == self.attribute.text:
                    return value.span
                case s.Param(name=name, domain=domain) if name.text == self.attribute.text:
                    return domain.span
                case _:
                    pass
        raise LookupError(module)

    # --- Errors --------------------------------------------------------------------------------

    def _warn_of_zeros(self, modules: Sequence[str]) -> None:
        """Warn of modules without the attribute."""
        name, several = self.attribute.text, len(modules) > 1
        listed = ", ".join(f"`{module}`" for module in modules[:_SHOWN])
        more = ", …" if len(modules) > _SHOWN else ""
        which = f"modules {listed}{more} have" if several else f"module {listed} has"
        message = f"{which} no `{name}` and {'count' if several else 'counts'} as 0"
        zero = "0" if self.unit == "1" else f"0 {self.unit}"
        hint = (
            f"write `const {name} = {zero};` in {'each' if several else 'it'} if that is intended"
        )
        self.sink.warning(Code.AMOUNT_OF_ZERO, message, self.attribute.span, hint)

    def _checked(self, amount: _Amount) -> Fraction | None:
        """The value of a constant; None for a parameter, or if an error was reported."""
        first, value = next(self._sound(), amount), amount.value
        called = f"`{self.attribute.text}` of module `{amount.module}`"
        if value.sort is not Sort.SCALAR:
            wrong_sort(value, "a number", amount.at, self.sink)
        elif value.dimension != first.value.dimension:
            due, found = (describe(each.value.dimension or ONE) for each in (first, amount))
            message = f"expected {due} as in module `{first.module}`, found {found}"
            hint = f"write {called} in `{first.unit}`" if first.unit != "1" else "write no unit"
            self._error(Code.UNIT_MISMATCH, message, amount.at, hint, [(first.at, "the first one")])
        elif amount.parameter is None and not constants.is_closed(value.expr):
            hint = "sum up the parameter itself, or write a number"
            self._error(Code.NOT_CONSTANT, f"{called} depends on a parameter", amount.at, hint)
        elif amount.negative:
            message = f"{called} {'is' if amount.parameter is None else 'may be'} below zero"
            self._error(Code.NEGATIVE_AMOUNT, message, amount.at, "write zero or more")
        elif amount.parameter is None:
            return self._exact(amount)
        return None

    def _exact(self, amount: _Amount) -> Fraction | None:
        found = constants.rational(amount.value.expr)
        if found is None and not self._told(Code.NOT_RATIONAL, amount.at):
            not_rational(amount.at, self.sink, [self._here])
        return found

    @property
    def _here(self) -> tuple[Span, str]:
        return self.span, "summed up here"

    def _told(self, code: Code, at: Span) -> bool:
        """Whether another task has led to the same error."""
        return any(known.code is code and known.span == at for known in self.sink.found)

    def _error(
        self, code: Code, message: str, at: Span, hint: str, notes: Sequence[tuple[Span, str]] = ()
    ) -> None:
        """Report an error in an attribute, with the objective that sums it up."""
        if not self._told(code, at):
            self.sink.error(code, message, at, hint, [*notes, self._here])


# --------------------------------------------------------------------------------------------------


def check_time(clause: m.Minimize, task: t.Task, sink: Sink) -> None:
    """Warn of an objective ``time`` if all motions take the same time, unless they never end.

    Args:
        clause: the objectives.
        task: the task of the clause.
        sink: collects the warning.
    """
    horizon = next((item for item in task.items if isinstance(item, t.Horizon)), None)
    endless = any(isinstance(item, t.Repeat) for item in task.items)
    if horizon is None or horizon.at_most or endless:
        return
    for objective in clause.objectives:
        if objective.name.text == "time" and objective.attribute is None:
            sink.warning(
                Code.FIXED_TIME, "all motions take the same time", objective.span,
                "write `horizon at most n steps of dt;`, or remove `time`",
                [(horizon.span, "every motion has this number of steps")],
            )  # fmt: skip


def lower_objectives(
    clause: m.Minimize,
    family: Family | None,
    modules: Mapping[str, ModuleInfo],
    names: NameTable,
    sink: Sink,
    *,
    of_mission: bool = False,
) -> tuple[ir.Objective, ...]:
    """The objectives of a task or mission in their order; errors in them are reported.

    Args:
        clause: the clause.
        family: the robot family; None if it is unknown, which was reported.
        modules: the modules of the file.
        names: the name table of the file.
        sink: collects the diagnostics.
        of_mission: whether the clause belongs to a mission, which may minimize ``changes``.
    """
    reader = _Reader(family, modules, names, sink, of_mission)
    final = clause.objectives[-1]
    found = [reader.objective(item, last=item is final) for item in clause.objectives]
    return tuple(objective for objective in found if objective is not None)
