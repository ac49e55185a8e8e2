"""Tasks: a robot family, a workspace and what is to be done, every clause checked."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from fractions import Fraction
from typing import TypeVar

from grammar_lang import ir
from grammar_lang import syntax as s
from grammar_lang import syntax_tasks as t
from grammar_lang.closed import Constants, coordinates, list_unit
from grammar_lang.codes import Code
from grammar_lang.diagnostics import Sink
from grammar_lang.modules import not_supported
from grammar_lang.sorts import DimensionUse, Sort, Typed, mismatch, warn_turn, wrong_sort
from grammar_lang.source import Span
from grammar_lang.spelling import did_you_mean
from grammar_lang.units import (
    ACCELERATION,
    FORCE,
    FREQUENCY,
    LENGTH,
    ONE,
    SPEED,
    TIME,
    TORQUE,
    Dimension,
)

DEFAULT_SLACK = Fraction(1, 10**6)

_EFFORT: dict[ir.DofKind, Dimension] = {"revolute": TORQUE, "prismatic": FORCE}
_UNIT: dict[ir.DofKind, str] = {"revolute": "N*m", "prismatic": "N"}

Clause = TypeVar("Clause", bound=t.TaskItem)


@dataclass(frozen=True, slots=True)
class Family:
    """A robot family as a task sees it: ``kinds`` of its degrees of freedom, in fixed order."""

    kinds: tuple[ir.DofKind, ...]
    has_semantics: bool
    uses: tuple[DimensionUse, ...]


@dataclass(slots=True)
class _Reader:
    task: t.Task
    sink: Sink
    family: Family | None
    workspace: ir.Workspace | None
    found: dict[ir.DofKind, ir.Effort] = field(default_factory=dict[ir.DofKind, ir.Effort])

    @property
    def constants(self) -> Constants:
        return Constants(self.sink)

    def one(self, kind: type[Clause], name: str, hint: str | None) -> Clause | None:
        """The clause of a kind; a second one is reported, and with a hint a missing one."""
        items = [item for item in self.task.items if isinstance(item, kind)]
        for item in items[1:]:
            notes = [(items[0].span, "first here")]
            message = f"a second `{name}`"
            self.sink.error(Code.REPEATED_CLAUSE, message, item.span, "remove one", notes)
        if not items and hint is not None:
            message = f"task `{self.task.name.text}` has no `{name}`"
            self.sink.error(Code.MISSING_CLAUSE, message, self.task.name.span, hint)
        return items[0] if items else None

    def region(self, name: s.Ident) -> str:
        """The name of a region of the workspace; reported if it is none."""
        if self.workspace is None:
            return name.text
        known = [region.name for region in self.workspace.regions]
        if name.text not in known:
            message = f"workspace `{self.workspace.name}` has no region `{name.text}`"
            hint = did_you_mean(name.text, known, "region")
            self.sink.error(Code.UNKNOWN_NAME, message, name.span, hint)
        return name.text

    def effector(self, expr: s.Expr | None) -> int | None:
        return None if expr is None else self.constants.integer(expr, 1, "an effector's number")

    def not_negative(self, expr: s.Expr, dimension: Dimension, what: str) -> Fraction:
        """A rational, at least zero; zero where an error was reported."""
        value = self.constants.rational(expr, dimension)
        if value is not None and value < 0:
            self.sink.error(Code.BAD_VALUE, f"{what} is negative", expr.span, "write zero or more")
        return value or Fraction(0)

    def positive(self, expr: s.Expr, dimension: Dimension, what: str) -> Fraction:
        """A rational above zero; one where an error was reported."""
        value = self.constants.rational(expr, dimension)
        if value is not None and value <= 0:
            self.sink.error(
                Code.BAD_VALUE, f"{what} is not positive", expr.span, "write more than zero"
            )
        return value or Fraction(1)

    # --- start, reach, avoid -------------------------------------------------------------------

    def start(self) -> ir.StartIn | ir.StartAt | None:
        items = [i for i in self.task.items if isinstance(i, t.StartIn | t.StartAt)]
        for item in items[1:]:
            notes = [(items[0].span, "first here")]
            self.sink.error(
                Code.REPEATED_CLAUSE, "a second `start`", item.span, "remove one", notes
            )
        if not items:
            message = f"task `{self.task.name.text}` has no `start`"
            hint = "add `start in R;` or `start at (…);`"
            self.sink.error(Code.MISSING_CLAUSE, message, self.task.name.span, hint)
            return None
        match items[0]:
            case t.StartIn(region=region, effector=effector, rates=rates, span=span):
                name = self.region(region)
                number = self.effector(effector)
                return ir.StartIn(name, number, self._rates(rates), span)
            case t.StartAt(point=point, span=span):
                return ir.StartAt(self._values(point), span)

    def _of_kinds(self, value: Typed, dimensions: Mapping[ir.DofKind, Dimension], at: Span) -> bool:
        """Whether a value has the dimension that some kind of dof of the family requires."""
        if value.sort is not Sort.SCALAR:
            wrong_sort(value, "a number", at, self.sink)
            return False
        kinds = self.family.kinds if self.family is not None else tuple(dimensions)
        due = [dimensions[kind] for kind in kinds or tuple(dimensions)]
        if value.dimension is None or value.dimension in due:
            return True
        mismatch(value, due[0], at, self.sink)
        return False

    def _rates(self, expr: s.Expr | None) -> Fraction:
        if expr is None:
            return Fraction(0)
        value = self.constants.typed(expr)
        if not self._of_kinds(value, {"revolute": FREQUENCY, "prismatic": SPEED}, expr.span):
            return Fraction(0)
        exact = self.constants.exact(value.expr, expr.span)
        if exact is not None and exact < 0:
            self.sink.error(
                Code.BAD_VALUE, "the rates are negative", expr.span, "write zero or more"
            )
        return exact or Fraction(0)

    def _values(self, point: t.Point) -> tuple[ir.Expr, ...]:
        unit = list_unit(point.unit, None, self.sink)
        values: list[ir.Expr] = []
        for item in point.items:
            value = self.constants.typed(item, unit)
            if self.family is not None and self.family.kinds == ("revolute",):
                warn_turn(value, item.span, self.sink)
            if self._of_kinds(value, {"revolute": ONE, "prismatic": LENGTH}, item.span):
                values.append(value.expr)
        return tuple(values)

    def reach(self) -> ir.Reach | None:
        wanted = not any(
            isinstance(i, t.Satisfy) for i in self.task.items
        )
        item = self.one(t.Reach, "reach", "add `reach R;`" if wanted else None)
        if item is None:
            return None
        effector = self.effector(item.effector)
        return ir.Reach(self.region(item.region), effector, item.at_rest, item.span)

    def avoid(self) -> tuple[ir.Avoid, ...]:
        return tuple(self._avoid(i) for i in self.task.items if isinstance(i, t.Avoid))

    def _avoid(self, item: t.Avoid) -> ir.Avoid:
        margin = Fraction(0)
        if item.margin is not None:
            margin = self.not_negative(item.margin, LENGTH, "the margin")
        names = tuple(self._avoided(region) for region in item.regions)
        return ir.Avoid(names, item.subject, margin, item.span)

    def _avoided(self, name: s.Ident) -> str:
        known = () if self.workspace is None else tuple(r.name for r in self.workspace.regions)
        if name.text == "self" and name.text not in known:
            not_supported("`avoid self`", name.span, self.sink)
            return name.text
        return self.region(name)

    # --- effort --------------------------------------------------------------------------------

    def effort(self) -> tuple[ir.Effort, ...]:
        """The effort bounds, one for each kind of degree of freedom of the family at least."""
        before = len(self.sink.found)
        for item in self.task.items:
            if isinstance(item, t.Effort):
                self._effort(item)
        missing = () if self.family is None else self.family.kinds
        if not Sink(self.sink.found[before:]).has_errors:
            for kind in missing:
                if kind not in self.found:
                    self._missing(kind, missing)
        return tuple(self.found.values())

    def _missing(self, kind: ir.DofKind, kinds: tuple[ir.DofKind, ...]) -> None:
        """Report a missing bound; at a bound of a kind that does not occur, if there is one."""
        for other, effort in self.found.items():
            if other not in kinds:
                value = Typed(ir.Pi(), Sort.SCALAR, _EFFORT[other])
                mismatch(value, _EFFORT[kind], effort.span, self.sink)
                return
        message = f"task `{self.task.name.text}` bounds no effort of the {kind} joints"
        hint = f"add `effort <= 10 {_UNIT[kind]};`"
        self.sink.error(Code.MISSING_CLAUSE, message, self.task.name.span, hint)

    def _kind(self, value: Typed, at: Span) -> ir.DofKind | None:
        """The kind that an effort belongs to, by its dimension."""
        for kind, dimension in _EFFORT.items():
            if value.dimension == dimension:
                return kind
        kinds = () if self.family is None else self.family.kinds
        if value.bare and len(kinds) == 1:
            return kinds[0]
        if value.bare:
            message = "an effort without a unit"
            hint = "write `N*m` for revolute, `N` for prismatic joints"
            self.sink.error(Code.UNIT_MISMATCH, message, at, hint)
        else:
            mismatch(value, _EFFORT[kinds[0] if kinds else "revolute"], at, self.sink)
        return None

    def _effort(self, item: t.Effort) -> None:
        norm2 = False
        if item.norm is not None:
            norm2 = item.norm.text == "2"
            if not norm2:
                self.sink.error(
                    Code.BAD_VALUE, "the only norm is 2", item.norm.span, "write `norm 2`"
                )
        value = self.constants.typed(item.bound)
        if value.sort is not Sort.SCALAR:
            return
        kind = self._kind(value, item.bound.span)
        bound = None if kind is None else self.constants.exact(value.expr, item.bound.span)
        if kind is None or bound is None:
            return
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

    # --- the rest ------------------------------------------------------------------------------

    def horizon(self) -> tuple[int, Fraction]:
        item = self.one(t.Horizon, "horizon", "add `horizon 80 steps of 0.125 s;`")
        if item is None:
            return 1, Fraction(1)
        steps = self.constants.integer(item.steps, 1, "the number of steps")
        return steps or 1, self.positive(item.step, TIME, "the step")

    def slack(self) -> Fraction:
        item = self.one(t.Slack, "slack", None)
        return DEFAULT_SLACK if item is None else self.not_negative(item.value, ONE, "the slack")

    def gravity(self) -> tuple[Fraction, ...]:
        item = self.one(t.Gravity, "gravity", None)
        size = 2 if self.workspace is None else self.workspace.dimension
        none = (Fraction(0),) * size
        if item is None or self.workspace is None:
            return none
        point = item.point
        unit = list_unit(point.unit, ACCELERATION, self.sink)
        found = coordinates(
            self.constants,
            point.items,
            unit,
            ACCELERATION,
            self.workspace.dimension,
            point.span,
        )
        return found or none

    def modules(self) -> int | None:
        item = self.one(t.Modules, "modules", None)
        if item is None:
            return None
        if item.comparison != "<=":
            message = f"`modules` takes `<=`, not `{item.comparison}`"
            self.sink.error(Code.BAD_VALUE, message, item.span, "write `modules <= n;`")
        return self.constants.integer(item.bound, 1, "the number of modules")


def _check_family(reader: _Reader, robot: t.Robot) -> None:
    """The family has a meaning, and one in the dimension of the workspace."""
    family, workspace, sink = reader.family, reader.workspace, reader.sink
    if family is None:
        return
    if not family.has_semantics:
        message = f"grammar `{robot.name.text}` has no semantics, so it describes no robot"
        hint = f"add `semantics {robot.name.text} {{ … }}`"
        sink.error(Code.MISSING_BLOCK, message, robot.name.span, hint)
    if workspace is None:
        return
    where = "`plane xy`" if workspace.dimension == 2 else "`space xyz`"
    for use in family.uses:
        known = any(d.code is Code.OUT_OF_PLANE and d.span == use.span for d in sink.found)
        if use.only != workspace.dimension and not known:
            hint = f"workspace `{workspace.name}` is {where}"
            notes = [(robot.span, "the task that joins them")]
            sink.error(Code.OUT_OF_PLANE, use.message, use.span, hint, notes)


def lower_task(
    task: t.Task,
    families: Mapping[str, Family],
    workspaces: Mapping[str, ir.Workspace],
    sink: Sink,
) -> ir.Task | None:
    """The task; None where a required clause is missing or wrong, which is reported."""
    for item in task.items:
        if isinstance(item, t.From | t.Satisfy | t.RobustStart | t.RobustEffort):
            not_supported("this", item.span, sink)
    reader = _Reader(task, sink, None, None)
    robot = reader.one(t.Robot, "robot", "add `robot G;` with the name of a grammar")
    place = reader.one(t.TaskWorkspace, "workspace", "add `workspace W;`")
    if robot is not None:
        reader.family = _named(robot.name, families, "grammar", sink)
    if place is not None:
        reader.workspace = _named(place.name, workspaces, "workspace", sink)
    if robot is not None:
        _check_family(reader, robot)
    start, reach = reader.start(), reader.reach()
    avoid, effort = reader.avoid(), reader.effort()
    steps, step = reader.horizon()
    slack, gravity, modules = reader.slack(), reader.gravity(), reader.modules()
    body = reader.one(t.BoundsBody, "bounds with body", None) is not None
    if robot is None or place is None or start is None or reach is None:
        return None
    return ir.Task(
        name=task.name.text,
        grammar=robot.name.text,
        workspace=place.name.text,
        start=start,
        reach=reach,
        avoid=avoid,
        effort=effort,
        steps=steps,
        step=step,
        slack=slack,
        gravity=gravity,
        modules=modules,
        bounds_body=body,
        span=task.span,
    )


Named = TypeVar("Named")


def _named(name: s.Ident, known: Mapping[str, Named], what: str, sink: Sink) -> Named | None:
    if name.text in known:
        return known[name.text]
    hint = did_you_mean(name.text, known, what)
    sink.error(Code.UNKNOWN_NAME, f"unknown {what} `{name.text}`", name.span, hint)
    return None
