"""``effort <= v``: bounds on the free inputs, one for each kind of degree of freedom."""

from __future__ import annotations

from dataclasses import dataclass, field

from grammar_lang import ir
from grammar_lang import syntax as s
from grammar_lang.diagnostics.codes import Code
from grammar_lang.diagnostics.diagnostic import Sink
from grammar_lang.elaboration.closed import Constants
from grammar_lang.elaboration.plausibility import warn_implausible
from grammar_lang.elaboration.sorts import Sort, Typed, mismatch
from grammar_lang.source import Span
from grammar_lang.syntax import tasks as t
from grammar_lang.units import FORCE, TORQUE, Dimension

_EFFORT: dict[ir.DofKind, Dimension] = {"revolute": TORQUE, "prismatic": FORCE}
_UNIT: dict[ir.DofKind, str] = {"revolute": "N*m", "prismatic": "N"}


@dataclass(slots=True)
class _Reader:
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
    reader = _Reader(task.name, kinds, sink)
    for item in task.items:
        if isinstance(item, t.Effort):
            reader.read(item)
    if not Sink(sink.found[before:]).has_errors:
        for kind in kinds:
            if kind not in reader.found:
                reader.missing(kind)
    return tuple(reader.found.values())
