"""Missions: tasks of one grammar, for one robot or for a robot that is rebuilt between tasks."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
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
_ENDLESS: frozenset[ir.ObjectiveKind] = frozenset({"time", "energy"})
"""Objectives without a least value if the motion never ends."""


@dataclass(slots=True)
class _Reader:
    """Reads the clauses of a mission; ``tasks`` are the tasks of the file without errors."""

    mission: m.Mission
    around: Surroundings
    tasks: Mapping[str, ir.Task]
    sink: Sink

    def one(self, kind: type[Clause]) -> Clause | None:
        """The clause of that kind; a second one is reported."""
        items = [item for item in self.mission.items if isinstance(item, kind)]
        for item in items[1:]:
            message = f"a second `{_CLAUSES[kind]}`"
            notes = [(items[0].span, "first here")]
            self.sink.error(Code.REPEATED_CLAUSE, message, item.span, "remove one", notes)
        return items[0] if items else None

    # --- Tasks ---------------------------------------------------------------------------------

    def named(self, item: m.MissionTasks | None) -> list[tuple[s.Ident, ir.Task]]:
        """The tasks with their names in the clause; unknown and repeated names are reported."""
        declared, found = self.around.names.declared, list[tuple[s.Ident, ir.Task]]()
        seen: dict[str, Span] = {}
        for name in () if item is None else item.names:
            if name.text in seen:
                message = (
                    f"task `{name.text}` is listed twice in mission `{self.mission.name.text}`"
                )
                notes = [(seen[name.text], "first here")]
                hint = "remove one; for a motion that repeats, write `repeat;` in the task"
                self.sink.error(Code.REPEATED_TASK, message, name.span, hint, notes)
                continue
            seen[name.text] = name.span
            if name.text not in declared.tasks:
                report_unknown(name, "a task", declared.tasks, declared, self.sink)
            elif name.text in self.tasks:
                found.append((name, self.tasks[name.text]))
        return found

    def check_alike(self, found: list[tuple[s.Ident, ir.Task]]) -> None:
        """Report tasks whose robots cannot be compared with those of the first task."""
        if not found:
            return
        (_, first), workspaces = found[0], self.around.workspaces
        for name, task in found[1:]:
            notes = [(first.span, f"task `{first.name}`")]
            if task.grammar != first.grammar:
                message = (
                    f"task `{task.name}` uses grammar `{task.grammar}`, "
                    f"but task `{first.name}` uses `{first.grammar}`"
                )
                hint = "the tasks of a mission use one grammar: give them the same `robot`"
                self.sink.error(Code.OTHER_ROBOTS, message, name.span, hint, notes)
            elif self._dimension(workspaces, task) != self._dimension(workspaces, first):
                message = f"task `{task.name}` is in {self._where(task)}, the first one is not"
                hint = "a mission has tasks all in the plane, or all in space"
                self.sink.error(Code.OTHER_ROBOTS, message, name.span, hint, notes)
            elif {each.kind for each in task.effort} != {each.kind for each in first.effort}:
                ours, theirs = _efforts(task), _efforts(first)
                message = f"task `{task.name}` bounds {ours}, the first task bounds {theirs}"
                hint = "bound the efforts of the same kinds of joints in all tasks of a mission"
                self.sink.error(Code.OTHER_EFFORTS, message, name.span, hint, notes)

    def _dimension(self, workspaces: Mapping[str, ir.Workspace], task: ir.Task) -> int | None:
        known = workspaces.get(task.workspace)
        return None if known is None else known.dimension

    def _where(self, task: ir.Task) -> str:
        return "the plane" if self._dimension(self.around.workspaces, task) == 2 else "space"

    def check_origins(self, found: list[tuple[s.Ident, ir.Task]], *, one_robot: bool) -> None:
        """Report `from` in tasks whose initial robot is determined by the mission."""
        for place, (name, task) in enumerate(found):
            if task.origin is None or (place == 0 and not one_robot):
                continue
            if one_robot:
                message = f"task `{task.name}` rebuilds a robot, but the mission has `one robot`"
                hint = (
                    "remove `from` from the task, or write `reconfigure;` instead of `one robot;`"
                )
                if place:
                    hint += " and name this task first"
            else:
                message = f"task `{task.name}` has `from`, but is not the first task"
                hint = "its robot is that of the task before: only the first task may have `from`"
            notes = [(task.origin.span, "here")]
            self.sink.error(Code.CONTRADICTORY_MISSION, message, name.span, hint, notes)

    # --- Changes -------------------------------------------------------------------------------

    def prices(self, item: m.Reconfigure) -> ir.Prices:
        """The prices of changes; a repeated price is reported."""
        found, seen = dict[str, Fraction](), dict[str, Span]()
        for price in item.prices:
            value = self._not_negative(price.value, f"the price of `{price.of}`")
            if price.of in found:
                message, notes = f"a second price of `{price.of}`", [(seen[price.of], "first here")]
                self.sink.error(Code.REPEATED_CLAUSE, message, price.span, "remove one", notes)
            found.setdefault(price.of, value)
            seen.setdefault(price.of, price.span)
        return ir.Prices(**found)

    def _not_negative(self, value: s.Expr, what: str) -> Fraction:
        found = Constants(self.sink).rational(value, ONE)
        if found is not None and found < 0:
            self.sink.error(Code.BAD_VALUE, f"{what} is negative", value.span, "write zero or more")
        return found or Fraction(0)

    def free(self, item: m.Free | None, grammar: str | None) -> frozenset[tuple[str, str]]:
        """The parameters that may change in modules that stay.

        Args:
            item: the clause.
            grammar: the grammar of the tasks; None if it is unknown.
        """
        found = dict[tuple[str, str], Span]()
        family = None if grammar is None else self.around.families.get(grammar)
        for freed in () if item is None else item.parameters:
            if not self._is_parameter(freed):
                continue
            module, key = freed.module, (freed.module.text, freed.name.text)
            if key in found:
                message, notes = f"`{'.'.join(key)}` is free twice", [(found[key], "first here")]
                self.sink.error(Code.REPEATED_CLAUSE, message, freed.span, "remove one", notes)
            elif family is not None and module.text not in family.modules:
                message = f"no robot of `{grammar}` has a module `{module.text}`"
                hint = "remove it, or name a module of the grammar"
                self.sink.warning(Code.CONTRADICTORY_MISSION, message, module.span, hint)
            found.setdefault(key, freed.span)
        return frozenset(found)

    def check_fixed(self, item: m.Free | None, first: ir.Task) -> None:
        """Report free parameters that the first task fixes."""
        origin = first.origin
        fixed = () if origin is None else origin.fixed
        places = {(origin.word[f.symbol], f.name): f.span for f in fixed if origin is not None}
        for freed in () if item is None else item.parameters:
            at = places.get((freed.module.text, freed.name.text))
            if at is not None:
                named = f"`{freed.module.text}.{freed.name.text}`"
                message = f"{named} is free, but task `{first.name}` fixes it"
                hint = "remove it here, or from `fixed` in the task"
                self.sink.error(
                    Code.CONTRADICTORY_MISSION, message, freed.span, hint, [(at, "fixed here")]
                )

    def _is_parameter(self, freed: m.Freed) -> bool:
        """Whether a name in ``free`` is a parameter; reported if not."""
        module, name = freed.module, freed.name
        info = self.around.modules.get(module.text)
        if info is None:
            known = self.around.modules
            report_unknown(module, "a module", known, self.around.names.declared, self.sink)
            return False
        parameters = [each.name for each in info.module.parameters]
        if name.text in parameters:
            return True
        hint = did_you_mean(name.text, parameters, "parameter", self.sink)
        if name.text in info.names:
            kind = "a degree of freedom" if name.text in info.dofs else "no parameter"
            message = f"`{name.text}` of module `{module.text}` is {kind}; parameters are free"
            self.sink.error(Code.WRONG_KIND, message, name.span, hint)
        else:
            message = f"module `{module.text}` has no parameter `{name.text}`"
            self.sink.error(Code.UNKNOWN_NAME, message, name.span, hint)
        return False

    def most(self, item: m.Changes | None) -> Fraction | None:
        """The bound on the total price of all changes."""
        if item is None:
            return None
        if item.comparison != "<=":
            message = f"`changes` takes `<=`, not `{item.comparison}`"
            self.sink.error(Code.BAD_VALUE, message, item.span, "write `changes <= n;`")
        return self._not_negative(item.bound, "the bound on changes")

    def check_changes(self, rebuilt: m.Reconfigure | None, one_robot: m.OneRobot | None) -> None:
        """Report clauses about changes that have no effect, or that contradict each other."""
        if rebuilt is None:
            for item in self.mission.items:
                if isinstance(item, m.Free | m.Changes):
                    what = _CLAUSES[type(item)]
                    message = f"`{what}` without `reconfigure`: nothing is changed"
                    hint = f"write `reconfigure;` instead of `one robot;`, or remove `{what}`"
                    self.sink.error(Code.CONTRADICTORY_MISSION, message, item.span, hint)
            return
        if one_robot is not None:
            message = "`one robot` and `reconfigure` contradict each other"
            notes = [(one_robot.span, "one robot for all tasks")]
            self.sink.error(
                Code.CONTRADICTORY_MISSION, message, rebuilt.span, "remove one of them", notes
            )
        if not any(isinstance(item, m.Free) for item in self.mission.items):
            for price in (each for each in rebuilt.prices if each.of == "change"):
                message = "`change` has a price, but no parameter is `free`"
                hint = "add `free M.p;`, or remove the price"
                self.sink.error(Code.CONTRADICTORY_MISSION, message, price.span, hint)

    def check_rebuilt(self, rebuilt: m.Reconfigure, tasks: Sequence[ir.Task]) -> None:
        """Warn of a mission that rebuilds, but has only one task and no existing robot."""
        if len(tasks) == 1 and tasks[0].origin is None:
            message = "nothing is rebuilt: there is only one task and no existing robot"
            hint = f"name another task, write `from W;` in task `{tasks[0].name}`, or `one robot;`"
            self.sink.warning(Code.CONTRADICTORY_MISSION, message, rebuilt.span, hint)

    # --- Objectives ----------------------------------------------------------------------------

    def minimize(
        self, item: m.Minimize | None, tasks: Sequence[ir.Task], *, rebuilt: bool | None
    ) -> tuple[ir.Objective, ...]:
        """The objectives in their order; errors in them are reported.

        Args:
            item: the clause.
            tasks: the tasks of the mission; if empty, nothing is reported.
            rebuilt: whether robots are rebuilt; None if the mission does not say.
        """
        if item is None or not tasks:
            return ()
        around, family = self.around, self.around.families.get(tasks[0].grammar)
        found = lower_objectives(
            item, family, around.modules, around.names, self.sink, of_mission=True
        )
        for objective in found:
            self._check_end(objective, tasks)
            if rebuilt is False and objective.kind == "changes":
                message = "`minimize changes` without `reconfigure`: nothing is changed"
                hint = "write `reconfigure;` instead of `one robot;`, or remove `changes`"
                self.sink.error(Code.CONTRADICTORY_MISSION, message, objective.span, hint)
        # The first name may be a misspelt `changes` that was already reported.
        first = found[0] if found and found[0].span == item.objectives[0].span else None
        if rebuilt and first is not None and first.kind != "changes":
            message = "with `reconfigure` the first objective must be `changes`"
            hint = "write `minimize changes;`, or `minimize changes then …;`"
            self.sink.error(Code.CONTRADICTORY_MISSION, message, first.span, hint)
        return found

    def _check_end(self, objective: ir.Objective, tasks: Sequence[ir.Task]) -> None:
        """Report what has no least value in endless motions, and warn of a time that is fixed."""
        if objective.kind not in _ENDLESS:
            return
        endless = [task for task in tasks if task.repeat]
        if endless:
            kind, names = objective.kind, ", ".join(f"`{task.name}`" for task in endless)
            message = f"a motion that goes on for ever has no least {kind}"
            hint = f"remove `{kind}`, or `repeat;` from {names}"
            notes = [(task.clauses["repeat"], "the motion goes on for ever") for task in endless]
            self.sink.error(Code.TIME_WITHOUT_END, message, objective.span, hint, notes)
        elif objective.kind == "time" and not any(task.at_most for task in tasks):
            message = "all motions of a task take the same time"
            hint = "write `horizon at most n steps of dt;` in a task, or remove `time`"
            self.sink.warning(Code.FIXED_TIME, message, objective.span, hint)


def _efforts(task: ir.Task) -> str:
    """The efforts that a task bounds, in words."""
    kinds = sorted(each.kind for each in task.effort)
    return f"the efforts of {' and '.join(kinds)} joints" if kinds else "no efforts"


def lower_mission(
    mission: m.Mission, around: Surroundings, tasks: Mapping[str, ir.Task], sink: Sink
) -> ir.Mission | None:
    """The mission; None if its tasks are missing, unknown or have errors, which is reported.

    Args:
        mission: its syntax.
        around: the results for the rest of the file.
        tasks: the tasks of the file that have no error.
        sink: collects the diagnostics.
    """
    reader = _Reader(mission, around, tasks, sink)
    listed, one_robot = reader.one(m.MissionTasks), reader.one(m.OneRobot)
    rebuilt, free = reader.one(m.Reconfigure), reader.one(m.Free)
    changes, minimize = reader.one(m.Changes), reader.one(m.Minimize)
    said, name = one_robot is not None or rebuilt is not None, mission.name
    if listed is None:
        message = f"mission `{name.text}` has no tasks"
        sink.error(Code.EMPTY_MISSION, message, name.span, "write `tasks A, B;`")
    if listed is not None and not said:
        message = f"mission `{name.text}` does not say whether one robot does all tasks"
        sink.error(Code.MISSING_CLAUSE, message, name.span, _ONE_OF_TWO)
    found = reader.named(listed)
    known = [task for _, task in found]
    reader.check_alike(found)
    if said:
        reader.check_origins(found, one_robot=rebuilt is None)
        reader.check_changes(rebuilt, one_robot)
    complete = listed is not None and len(known) == len(listed.names)
    if rebuilt is not None and complete:
        reader.check_rebuilt(rebuilt, known)
    prices = None if rebuilt is None else reader.prices(rebuilt)
    freed = reader.free(free, known[0].grammar if known else None)
    if known:
        reader.check_fixed(free, known[0])
    most = reader.most(changes)
    least = reader.minimize(minimize, known, rebuilt=rebuilt is not None if said else None)
    if not complete:
        return None
    return ir.Mission(
        name=name.text,
        tasks=tuple(task.name for task in known),
        prices=prices,
        free=freed,
        most=most,
        minimize=least,
        span=mission.span,
        clauses={_CLAUSES[type(item)]: item.span for item in mission.items},
        named=tuple(ident.span for ident, _ in found),
    )


def lower_missions(
    missions: Mapping[str, m.Mission],
    around: Surroundings,
    tasks: Mapping[str, ir.Task],
    sink: Sink,
) -> dict[str, ir.Mission]:
    """The missions of a file by name; errors in them are reported.

    Args:
        missions: their syntax.
        around: the results for the rest of the file.
        tasks: the tasks of the file that have no error.
        sink: collects the diagnostics.
    """
    found = {name: lower_mission(each, around, tasks, sink) for name, each in missions.items()}
    return {name: mission for name, mission in found.items() if mission is not None}
