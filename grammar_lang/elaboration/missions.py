"""Missions: tasks of one grammar, for one robot or for robots that are rebuilt between them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction
from typing import TypeVar

from grammar_lang import ir
from grammar_lang import syntax as s
from grammar_lang.diagnostics.diagnostic import Code, Sink
from grammar_lang.diagnostics.wording import did_you_mean
from grammar_lang.elaboration.closed import Constants
from grammar_lang.elaboration.objectives import lower_objectives
from grammar_lang.elaboration.tasks import Surroundings
from grammar_lang.names.declarations import report_unknown
from grammar_lang.source import Span
from grammar_lang.syntax import missions as m
from grammar_lang.units import ONE

Clause = TypeVar("Clause", bound=m.MissionItem)
_CLAUSES: dict[type, str] = {
    m.MissionTasks: "tasks",
    m.OneRobot: "one robot",
    m.Reconfigure: "reconfigure",
    m.Free: "free",
    m.Changes: "changes",
    m.Minimize: "minimize",
}
_ONE_OF_TWO = "write `one robot;`, or `reconfigure;` for robots that are rebuilt between tasks"


@dataclass(slots=True)
class _Reader:
    mission: m.Mission
    around: Surroundings
    tasks: Mapping[str, ir.Task]
    sink: Sink

    def one(self, kind: type[Clause]) -> Clause | None:
        """The clause of a kind; a second one is reported."""
        items = [item for item in self.mission.items if isinstance(item, kind)]
        for item in items[1:]:
            message = f"a second `{_CLAUSES[kind]}`"
            notes = [(items[0].span, "first here")]
            self.sink.error(Code.REPEATED_CLAUSE, message, item.span, "remove one", notes)
        return items[0] if items else None

    # --- the tasks -----------------------------------------------------------------------------

    def named(self, item: m.MissionTasks | None) -> list[tuple[s.Ident, ir.Task]]:
        """The tasks with the names that they are given by; those that are none are reported."""
        declared, found = self.around.names.declared, list[tuple[s.Ident, ir.Task]]()
        seen: dict[str, Span] = {}
        for name in () if item is None else item.names:
            if name.text in seen:
                message = f"task `{name.text}` stands twice in mission `{self.mission.name.text}`"
                notes = [(seen[name.text], "first here")]
                hint = "remove one; a motion that is repeated is said by `repeat` in the task"
                self.sink.error(Code.REPEATED_TASK, message, name.span, hint, notes)
                continue
            seen[name.text] = name.span
            if name.text not in declared.tasks:
                report_unknown(name, "a task", declared.tasks, declared, self.sink)
            elif name.text in self.tasks:
                found.append((name, self.tasks[name.text]))
        return found

    def check_alike(self, found: list[tuple[s.Ident, ir.Task]]) -> None:
        """Report tasks whose robots cannot be compared with those of the first one."""
        if not found:
            return
        (_, first), workspaces = found[0], self.around.workspaces
        for name, task in found[1:]:
            notes = [(first.span, f"task `{first.name}`")]
            if task.grammar != first.grammar:
                message = (
                    f"task `{task.name}` is about robots of `{task.grammar}`, "
                    f"task `{first.name}` about those of `{first.grammar}`"
                )
                hint = "a mission has tasks of one grammar: name tasks with the same `robot`"
                self.sink.error(Code.OTHER_ROBOTS, message, name.span, hint, notes)
            elif self._dimension(workspaces, task) != self._dimension(workspaces, first):
                message = f"task `{task.name}` is in {self._where(task)}, the first one is not"
                hint = "a mission has tasks all in the plane, or all in space"
                self.sink.error(Code.OTHER_ROBOTS, message, name.span, hint, notes)
            elif {each.kind for each in task.effort} != {each.kind for each in first.effort}:
                message = f"task `{task.name}` bounds {_efforts(task)}, the first {_efforts(first)}"
                hint = "bound the efforts of the same kinds of joints in all tasks of a mission"
                self.sink.error(Code.OTHER_EFFORTS, message, name.span, hint, notes)

    def _dimension(self, workspaces: Mapping[str, ir.Workspace], task: ir.Task) -> int | None:
        known = workspaces.get(task.workspace)
        return None if known is None else known.dimension

    def _where(self, task: ir.Task) -> str:
        return "the plane" if self._dimension(self.around.workspaces, task) == 2 else "space"

    def check_origins(self, found: list[tuple[s.Ident, ir.Task]], *, one_robot: bool) -> None:
        """Report `from` in tasks before which the mission itself says which robot there is."""
        for place, (name, task) in enumerate(found):
            if task.origin is None or (place == 0 and not one_robot):
                continue
            if one_robot:
                message = f"task `{task.name}` rebuilds a robot, and the mission has `one robot`"
                hint = "remove `from` from the task, or write `reconfigure;` in the mission"
            else:
                message = f"task `{task.name}` says by `from` which robot there is before it"
                hint = "in a mission it is that of the task before: only the first task has `from`"
            notes = [(task.origin.span, "here")]
            self.sink.error(Code.CONTRADICTORY_MISSION, message, name.span, hint, notes)

    # --- what may change -----------------------------------------------------------------------

    def prices(self, item: m.Reconfigure) -> ir.Prices:
        """What changes cost; a price that stands twice is reported."""
        found: dict[str, Fraction] = {}
        for price in item.prices:
            value = self._not_negative(price.value, "a price")
            if price.of in found:
                message = f"a second price of `{price.of}`"
                self.sink.error(Code.REPEATED_CLAUSE, message, price.span, "remove one")
            found.setdefault(price.of, value)
        return ir.Prices(**found)

    def _not_negative(self, value: s.Expr, what: str) -> Fraction:
        found = Constants(self.sink).rational(value, ONE)
        if found is not None and found < 0:
            self.sink.error(Code.BAD_VALUE, f"{what} is negative", value.span, "write zero or more")
        return found or Fraction(0)

    def free(self, item: m.Free | None) -> frozenset[tuple[str, str]]:
        """The parameters that modules may change when they are kept."""
        found = set[tuple[str, str]]()
        for freed in () if item is None else item.parameters:
            module, name = freed.module, freed.name
            info = self.around.modules.get(module.text)
            if info is None:
                known = self.around.modules
                report_unknown(module, "a module", known, self.around.names.declared, self.sink)
                continue
            parameters = {each.name for each in info.module.parameters}
            if name.text not in parameters:
                message = f"module `{module.text}` has no parameter `{name.text}`"
                hint = did_you_mean(name.text, parameters, "parameter", self.sink)
                self.sink.error(Code.UNKNOWN_NAME, message, name.span, hint)
                continue
            found.add((module.text, name.text))
        return frozenset(found)

    def most(self, item: m.Changes | None) -> Fraction | None:
        """What all changes may cost together."""
        if item is None:
            return None
        if item.comparison != "<=":
            message = f"`changes` takes `<=`, not `{item.comparison}`"
            self.sink.error(Code.BAD_VALUE, message, item.span, "write `changes <= n;`")
        return self._not_negative(item.bound, "the bound on changes")

    def check_changes(self, rebuilt: m.Reconfigure | None, one_robot: m.OneRobot | None) -> None:
        """Report clauses about changes where nothing is changed, or where both kinds are said."""
        if rebuilt is not None and one_robot is not None:
            message = "`one robot` and `reconfigure` contradict each other"
            notes = [(one_robot.span, "one robot for all tasks")]
            self.sink.error(
                Code.CONTRADICTORY_MISSION, message, rebuilt.span, "remove one of them", notes
            )
        for item in self.mission.items:
            if rebuilt is None and isinstance(item, m.Free | m.Changes):
                what = _CLAUSES[type(item)]
                message = f"`{what}` is about changes, and nothing is changed"
                hint = "write `reconfigure;`, or remove the clause"
                self.sink.error(Code.CONTRADICTORY_MISSION, message, item.span, hint)
        priced = () if rebuilt is None else rebuilt.prices
        if not any(isinstance(item, m.Free) for item in self.mission.items):
            for price in (each for each in priced if each.of == "change"):
                message = "a price of changing parameters, and none may change"
                hint = "say which by `free M.p;`, or remove the price"
                self.sink.error(Code.CONTRADICTORY_MISSION, message, price.span, hint)

    # --- what is to be least -------------------------------------------------------------------

    def minimize(
        self, item: m.Minimize | None, grammar: str, *, rebuilt: bool
    ) -> tuple[ir.Objective, ...]:
        if item is None:
            return ()
        around = self.around
        found = lower_objectives(
            item, around.families.get(grammar), around.modules, around.names, self.sink,
            with_changes=True,
        )  # fmt: skip
        for place, objective in enumerate(found):
            if rebuilt and (objective.kind == "changes") is not (place == 0):
                message = "the first objective of robots that are rebuilt is `changes`"
                hint = "write `minimize changes;`, or `minimize changes then …;`"
                self.sink.error(Code.CONTRADICTORY_MISSION, message, item.span, hint)
                break
            if not rebuilt and objective.kind == "changes":
                message = "`changes` are to be few, and nothing is changed"
                hint = "write `reconfigure;`, or remove `changes`"
                self.sink.error(Code.CONTRADICTORY_MISSION, message, objective.span, hint)
        return found


def _efforts(task: ir.Task) -> str:
    """Which efforts a task bounds, in words."""
    kinds = sorted(each.kind for each in task.effort)
    return f"the efforts of {' and '.join(kinds)} joints" if kinds else "no efforts"


def lower_mission(
    mission: m.Mission, around: Surroundings, tasks: Mapping[str, ir.Task], sink: Sink
) -> ir.Mission | None:
    """The mission; None where it has no tasks, or does not say for which robots, reported.

    Args:
        mission: its syntax.
        around: what was made of the rest of the file.
        tasks: the tasks of the file that have no error.
        sink: where findings go.
    """
    reader = _Reader(mission, around, tasks, sink)
    listed, one_robot = reader.one(m.MissionTasks), reader.one(m.OneRobot)
    rebuilt, free = reader.one(m.Reconfigure), reader.one(m.Free)
    changes, minimize = reader.one(m.Changes), reader.one(m.Minimize)
    name = mission.name
    if listed is None:
        message = f"mission `{name.text}` has no tasks"
        sink.error(Code.EMPTY_MISSION, message, name.span, "write `tasks A, B;`")
    elif one_robot is None and rebuilt is None:
        message = f"mission `{name.text}` does not say whether one robot does all tasks"
        sink.error(Code.MISSING_CLAUSE, message, name.span, _ONE_OF_TWO)
    found = reader.named(listed)
    reader.check_alike(found)
    reader.check_origins(found, one_robot=rebuilt is None)
    reader.check_changes(rebuilt, one_robot)
    prices = None if rebuilt is None else reader.prices(rebuilt)
    freed, most = reader.free(free), reader.most(changes)
    if not found:
        return None
    grammar = found[0][1].grammar
    return ir.Mission(
        name=name.text,
        tasks=tuple(task.name for _, task in found),
        prices=prices,
        free=freed,
        most=most,
        minimize=reader.minimize(minimize, grammar, rebuilt=rebuilt is not None),
        span=mission.span,
        clauses={_CLAUSES[type(item)]: item.span for item in mission.items},
        named=tuple(ident.span for ident, _ in found),
    )
