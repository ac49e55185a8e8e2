"""Tasks: a robot family, a workspace and a goal, with every clause checked."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import TypeVar

from grammar_lang import ir
from grammar_lang import syntax as s
from grammar_lang.diagnostics.diagnostic import Code, Sink
from grammar_lang.elaboration.closed import Constants, coordinates, list_unit
from grammar_lang.elaboration.endless_tasks import check_endless
from grammar_lang.elaboration.families import Family, check_family
from grammar_lang.elaboration.joint_values import (
    check_duration,
    final_rates,
    start_rates,
    start_values,
)
from grammar_lang.elaboration.modules import ModuleInfo
from grammar_lang.elaboration.task_clauses import clause_places, lower_efforts
from grammar_lang.elaboration.workspaces import check_round
from grammar_lang.names.declarations import report_unknown
from grammar_lang.names.table import NameTable
from grammar_lang.syntax import formulas as f
from grammar_lang.syntax import missions as m
from grammar_lang.syntax import tasks as t
from grammar_lang.units import ACCELERATION, LENGTH, ONE, TIME, Dimension

DEFAULT_SLACK = Fraction(1, 10**6)
MOST_STEPS = 100_000
Clause = TypeVar("Clause", bound=t.TaskItem)
Named = TypeVar("Named")


@dataclass(frozen=True, slots=True)
class Surroundings:
    """The names that a task may use, and the lowered modules, families and workspaces."""

    names: NameTable
    modules: Mapping[str, ModuleInfo]
    families: Mapping[str, Family]
    workspaces: Mapping[str, ir.Workspace]


@dataclass(slots=True)
class _Reader:
    task: t.Task
    around: Surroundings
    sink: Sink
    family: Family | None = None
    workspace: ir.Workspace | None = None
    itself: ir.AvoidSelf | None = None

    @property
    def constants(self) -> Constants:
        return Constants(self.sink)

    @property
    def kinds(self) -> tuple[ir.DofKind, ...]:
        """The kinds of joints of the family; empty if the family is unknown."""
        return () if self.family is None else self.family.kinds

    def one(self, kind: type[Clause], name: str, hint: str | None) -> Clause | None:
        """The clause of a kind; a second one is reported, and with a hint a missing one too."""
        items = [item for item in self.task.items if isinstance(item, kind)]
        for item in items[1:]:
            notes = [(items[0].span, "first here")]
            message = f"a second `{name}`"
            self.sink.error(Code.REPEATED_CLAUSE, message, item.span, "remove one", notes)
        if not items and hint is not None:
            message = f"task `{self.task.name.text}` has no `{name}`"
            self.sink.error(Code.MISSING_CLAUSE, message, self.task.name.span, hint)
        return items[0] if items else None

    def avoided(self, name: s.Ident) -> str:
        """The name of a region or map to avoid; reported if it does not exist."""
        rule = "a round place to avoid has to be an `obstacle`"
        check_round(name, self.workspace, ("obstacle",), rule, self.sink)
        return self.region(name)

    def spoken_of(self, name: s.Ident) -> str:
        """The name of a region or map in a formula; reported if it does not exist."""
        rule = "formulas name only places with flat sides"
        check_round(name, self.workspace, (), rule, self.sink)
        return self.region(name)

    def region(self, name: s.Ident) -> str:
        """The name of a region or map of the workspace; reported if it does not exist."""
        if self.workspace is not None and self.around.names.entity(name) is None:
            known = self.around.names.declared.places[self.workspace.name]
            self._no_region(name, self.workspace.name, known)
        return name.text

    def place(self, name: s.Ident) -> str:
        """The name of a region where the task starts or ends; reported if it is not one."""
        ends: tuple[ir.RegionKind, ...] = ("region", "target")
        rule = "a round place to start or end has to be a `region` or `target`"
        check_round(name, self.workspace, ends, rule, self.sink)
        found = self.around.names.entity(name)
        if found is not None and found.kind == "map":
            message = f"`{name.text}` is a map of obstacles, not a place to start or to end"
            notes = [(found.span, "declared here")]
            hint = "name a region; a map is avoided, or named in a formula"
            self.sink.error(Code.WRONG_KIND, message, name.span, hint, notes)
        elif found is None and self.workspace is not None:
            known = self.around.names.declared.regions[self.workspace.name]
            self._no_region(name, self.workspace.name, known)
        return name.text

    def _no_region(self, name: s.Ident, workspace: str, known: Collection[str]) -> None:
        message = f"workspace `{workspace}` has no region `{name.text}`"
        due = f"a region of workspace `{workspace}`"
        report_unknown(name, due, known, self.around.names.declared, self.sink, message)

    def named(self, name: s.Ident, known: Mapping[str, Named], due: str) -> Named | None:
        """The declaration of that name; reported if there is none."""
        if self.around.names.entity(name) is None:
            report_unknown(name, due, known, self.around.names.declared, self.sink)
        return known.get(name.text)

    def effector(self, expr: s.Expr | None) -> int | None:
        return None if expr is None else self.constants.integer(expr, 1, "an effector's number")

    def not_negative(self, expr: s.Expr, dimension: Dimension, what: str) -> Fraction:
        """A rational, reported if it is negative; zero if it could not be read."""
        value = self.constants.rational(expr, dimension)
        if value is not None and value < 0:
            self.sink.error(Code.BAD_VALUE, f"{what} is negative", expr.span, "write zero or more")
        return value or Fraction(0)

    def positive(self, expr: s.Expr, dimension: Dimension, what: str) -> Fraction:
        """A rational, reported if it is not positive; one if it could not be read."""
        value = self.constants.rational(expr, dimension)
        if value is not None and value <= 0:
            self.sink.error(
                Code.BAD_VALUE, f"{what} is not positive", expr.span, "write more than zero"
            )
        return value or Fraction(1)

    # --- Start, reach, avoid -------------------------------------------------------------------

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
            case t.StartIn(region=region, effector=effector, rates=rates, span=span, held=held):
                name = self.place(region)
                number = self.effector(effector)
                bound = Fraction(0)
                if rates is not None:
                    bound = start_rates(rates, self.kinds, self.sink)
                return ir.StartIn(name, number, bound, span, held)
            case t.StartAt(point=point, span=span):
                return start_values(point, span, self.kinds, self.sink)

    def reach(self) -> ir.Reach | None:
        wanted = not any(isinstance(i, t.Satisfy) for i in self.task.items)
        hint = "add `reach R;`, or `satisfy FORMULA;`" if wanted else None
        item = self.one(t.Reach, "reach", hint)
        if item is None:
            return None
        region, effector = self.place(item.region), self.effector(item.effector)
        rates = None if item.rates is None else final_rates(item.rates, self.kinds, self.sink)
        return ir.Reach(region, effector, rates, item.span, self._poses(item.poses))

    def _poses(self, poses: Sequence[f.Pose]) -> tuple[ir.Pose, ...]:
        if not poses or self.workspace is None:
            return ()
        from grammar_lang.elaboration.poses import lower_poses

        return lower_poses(poses, self.workspace.dimension, self.sink)

    def avoid(self) -> tuple[ir.Avoid, ...]:
        found = (self._avoid(i) for i in self.task.items if isinstance(i, t.Avoid))
        return tuple(avoid for avoid in found if avoid is not None)

    def _avoid(self, item: t.Avoid) -> ir.Avoid | None:
        """The regions and maps to avoid; None if the clause names only the robot itself."""
        margin = Fraction(0)
        if item.margin is not None:
            margin = self.not_negative(item.margin, LENGTH, "the margin")
        others: list[str] = []
        for name in item.regions:
            if self._is_self(name):
                self._avoid_self(item, name, margin)
            else:
                others.append(self.avoided(name))
        if item.excepted and not any(self._is_self(name) for name in item.regions):
            message = "`except` belongs to `avoid self`"
            hint = "remove it: a region is avoided by every body, or by every effector"
            self.sink.error(Code.BAD_VALUE, message, item.excepted[0][0].span, hint)
        return ir.Avoid(tuple(others), item.subject, margin, item.span) if others else None

    def _is_self(self, name: s.Ident) -> bool:
        """Whether a name in ``avoid`` means the robot itself, not a region of that name."""
        if name.text != "self":
            return False
        return self.around.names.entity(name) is None

    def _avoid_self(self, item: t.Avoid, name: s.Ident, margin: Fraction) -> None:
        if item.subject == "effector":
            message = "an effector alone cannot collide with itself"
            hint = "write `avoid self with body`"
            self.sink.error(Code.BAD_VALUE, message, name.span, hint)
        elif self.itself is not None:
            notes = [(self.itself.span, "first here")]
            message = "a second `avoid self`"
            self.sink.error(Code.REPEATED_CLAUSE, message, name.span, "remove one", notes)
        else:
            self.itself = ir.AvoidSelf(margin, self._exceptions(item), item.span)

    def _exceptions(self, item: t.Avoid) -> frozenset[tuple[str, str]]:
        """The pairs of modules whose bodies may touch; unknown modules are reported."""
        names, found = self.around.names, set[tuple[str, str]]()
        for pair in item.excepted:
            unknown = [name for name in pair if names.entity(name) is None]
            for name in unknown:
                modules = names.declared.modules
                report_unknown(name, "a module", modules, names.declared, self.sink)
            if not unknown:
                one, two = sorted(name.text for name in pair)
                found.add((one, two))
        return frozenset(found)

    # --- Formulas ------------------------------------------------------------------------------

    def satisfy(self) -> tuple[ir.Satisfy, ...]:
        found: list[ir.Satisfy] = []
        for item in self.task.items:
            if isinstance(item, t.Satisfy):
                # Imported only if a task has a formula, to keep checks fast.
                from grammar_lang.elaboration.formulas import lower_formula

                formula = lower_formula(item.formula, self.spoken_of, self._poses, self.sink)
                found.append(ir.Satisfy(formula, item.span))
        return tuple(found)

    # --- The existing robot, and disturbances --------------------------------------------------

    def origin(self) -> ir.Origin | None:
        item = self.one(t.From, "from", None)
        if item is None:
            return None
        from grammar_lang.elaboration.task_clauses import lower_origin

        return lower_origin(item, self.around.modules, self.around.names, self.sink)

    def loads(self, reach: ir.Reach | None) -> tuple[tuple[ir.Payload, ...], tuple[ir.Carry, ...]]:
        if not any(isinstance(item, t.Payload | t.Carry) for item in self.task.items):
            return (), ()
        from grammar_lang.elaboration.loads import lower_carries, lower_payloads

        reaching = None if reach is None else reach.effector
        payloads = lower_payloads(self.task, reaching, self.sink)
        return payloads, lower_carries(self.task, reaching, self.place, self.kinds, self.sink)

    def robust(self) -> ir.Robust | None:
        if not any(isinstance(i, t.RobustRadii | t.RobustPercent) for i in self.task.items):
            return None
        from grammar_lang.elaboration.disturbances import lower_robust

        return lower_robust(self.task.items, self.around.names, self.sink)

    def minimize(self) -> tuple[ir.Objective, ...]:
        item = self.one(m.Minimize, "minimize", None)
        if item is None:
            return ()
        from grammar_lang.elaboration.objectives import check_time, lower_objectives

        check_time(item, self.task, self.sink)
        return lower_objectives(
            item, self.family, self.around.modules, self.around.names, self.sink
        )

    # --- Other clauses -------------------------------------------------------------------------

    def horizon(self) -> tuple[int, Fraction, bool]:
        """The number of steps, their length, and whether there may be fewer steps."""
        item = self.one(t.Horizon, "horizon", "add `horizon 80 steps of 0.125 s;`")
        if item is None:
            return 1, Fraction(1), False
        steps = self.constants.integer(item.steps, 1, "the number of steps")
        if steps is not None and steps > MOST_STEPS:
            self.sink.error(
                Code.BAD_VALUE, f"the horizon has more than {MOST_STEPS:,} steps", item.steps.span,
                "write fewer, longer steps",
            )  # fmt: skip
        return steps or 1, self.positive(item.step, TIME, "the step"), item.at_most

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


def lower_task(task: t.Task, around: Surroundings, sink: Sink) -> ir.Task | None:
    """The task; None if a required clause is missing or wrong, which is reported."""
    reader = _Reader(task, around, sink)
    robot = reader.one(t.Robot, "robot", "add `robot G;` with the name of a grammar")
    place = reader.one(t.TaskWorkspace, "workspace", "add `workspace W;`")
    if robot is not None:
        reader.family = reader.named(robot.name, around.families, "a grammar")
    if place is not None:
        reader.workspace = reader.named(place.name, around.workspaces, "a workspace")
    if robot is not None and reader.family is not None:
        check_family(reader.family, robot, reader.workspace, sink)
    start, reach, satisfy = reader.start(), reader.reach(), reader.satisfy()
    avoid = reader.avoid()
    effort = lower_efforts(task, () if reader.family is None else reader.family.driven, sink)
    steps, step, at_most = reader.horizon()
    check_duration(task, reach, steps * step, sink)
    slack, gravity, modules = reader.slack(), reader.gravity(), reader.modules()
    body = reader.one(t.BoundsBody, "bounds with body", None) is not None
    origin, robust, (payloads, carries) = reader.origin(), reader.robust(), reader.loads(reach)
    control, repeat = reader.one(t.Control, "control", None), reader.one(t.Repeat, "repeat", None)
    check_endless(task, repeat, sink)
    minimize = reader.minimize()
    if robot is None or place is None or start is None or not (reach or satisfy):
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
        avoid_self=reader.itself,
        origin=origin,
        satisfy=satisfy,
        robust=robust,
        control=None if control is None else control.loop,
        repeat=repeat is not None,
        clauses=clause_places(task),
        payloads=payloads,
        carries=carries,
        minimize=minimize,
        at_most=at_most,
    )
