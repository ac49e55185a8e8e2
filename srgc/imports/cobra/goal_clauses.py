"""Convert goals to regions and clauses of a task: its start, what it passes, and its end."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from srgc.imports.cobra.pose_data import ToleratedPose
from srgc.imports.cobra.region_sets import RegionSets, is_turned
from srgc.imports.cobra.task_data import Goal, TaskData
from srgc.imports.json_place import Place
from srgc.imports.names import Names
from srgc.imports.quantities import decimal_text

MOST_POSES = 12
"""Of a path with more poses, this many are passed, evenly chosen."""
MOST_STOPS = 40


@dataclass(slots=True)
class Stop:
    """A region and an orientation to pass, at rest or not, and the time to stay (s)."""

    region: str
    turned: str
    rests: bool
    place: Place
    hold: float = 0.0
    after: float | None = None

    @property
    def where(self) -> str:
        """The path of its goal in the file."""
        return self.place.path

    @property
    def atom(self) -> str:
        """The atomic formula that holds there."""
        return f"{self.region}{self.turned}"


@dataclass(slots=True)
class Clauses:
    """Regions by name, lines of the task, and the least total time of pauses and paths (s)."""

    regions: dict[str, str] = field(default_factory=dict)
    lines: list[str] = field(default_factory=list)
    least_time: float = 0.0
    stops: int = 0


def goal_clauses(task: TaskData, sets: RegionSets, names: Names, *, any_order: bool) -> Clauses:
    """The clauses of the goals of a task, in order.

    Since a robot may start anywhere, the task starts at its first goal; the way to it is left out.
    Everything between the first goal and the last becomes a formula.
    """
    found = Clauses()
    goals = _in_order(task, sets.remarks, any_order=any_order)
    stops = _Stops(goals, sets, names, found, any_order=any_order).all()
    found.stops = len(stops)
    if len(stops) > MOST_STOPS:
        raise stops[-1].place.fault(
            f"{len(stops)} poses one after the other; at most {MOST_STOPS} are passed"
        )
    if not stops:
        sets.remarks.append("no goal has a pose: the task asks for nothing")
        return found
    if any_order:
        _unordered(stops, found, sets)
    else:
        _ordered(stops, found, sets)
    return found


def _in_order(task: TaskData, remarks: list[str], *, any_order: bool) -> list[Goal]:
    """The goals in the order that a constraint demands, otherwise in the order of the file."""
    order = next((each.order for each in task.constraints if each.order), ())
    by_id = {goal.id: goal for goal in task.goals}
    for each in task.constraints:
        for number, name in enumerate(each.order):
            if name not in by_id:
                raise each.place["order"].entries()[number].fault(f"there is no goal {name[:40]!r}")
    if not order and len(by_id) > 1 and not any_order:
        remarks.append(
            "goals are reached in the order of the file, which the task leaves open; --any-order "
            "leaves it open, too"
        )
    # Goals that the order does not name stay after the goal that precedes them in the file.
    result = [by_id[name] for name in dict.fromkeys(order)]
    for number, goal in enumerate(task.goals):
        if goal not in result:
            before = task.goals[number - 1] if number else None
            result.insert(0 if before is None else result.index(before) + 1, goal)
    return result


@dataclass(slots=True)
class _Stops:
    goals: Sequence[Goal]
    sets: RegionSets
    names: Names
    found: Clauses
    any_order: bool
    known: dict[str, list[Stop]] = field(default_factory=dict)

    def all(self) -> list[Stop]:
        stops = list[Stop]()
        for number, goal in enumerate(self.goals):
            self._goal(goal, stops, last=number == len(self.goals) - 1)
        return stops

    def _goal(self, goal: Goal, stops: list[Stop], *, last: bool) -> None:
        remarks, where = self.sets.remarks, goal.place.path
        match goal.kind:
            case "at" | "reach":
                flat = self._in_formula(goal, first=not stops, last=last)
                stop = self._stop(goal, goal.poses[0], _named(goal.id), flat=flat)
                self.known[goal.id] = [stop]
                stops.append(stop)
            case "pause":
                self.found.least_time += goal.duration
                if stops:
                    stops[-1].hold += goal.duration
                    stops[-1].rests = stops[-1].rests or last
                else:
                    remarks.append(f"{where}: a pause before the first goal")
            case "returnTo":
                target = self.known.get(goal.target) if goal.target else stops[:1]
                if not target:
                    remarks.append(f"{where}: a return to what has not been yet")
                    return
                remarks.append(
                    f"{where}: a return to the region of a goal, not to its joint angles"
                )
                seen = target[0]
                stops.append(Stop(seen.region, seen.turned, last and seen.rests, goal.place))
                self.known[goal.id] = stops[-1:]
            case "follow":
                self._follow(goal, stops)

    def _in_formula(self, goal: Goal, *, first: bool, last: bool) -> bool:
        """Whether a formula may name the region of a goal, which then has to be a polytope."""
        if self.any_order or not (first or last):
            return True
        returns = any(each.kind == "returnTo" for each in self.goals)
        pauses = any(each.kind == "pause" for each in self.goals)
        return returns or (first and (pauses or is_turned(goal.poses[0])))

    def _follow(self, goal: Goal, stops: list[Stop]) -> None:
        count = len(goal.poses)
        chosen = np.unique(np.linspace(0, count - 1, min(count, MOST_POSES)).round().astype(int))
        if len(chosen) < count:
            self.sets.remarks.append(
                f"{goal.place.path}: {len(chosen)} of its {count} poses, evenly chosen"
            )
        made, before = list[Stop](), 0.0
        for number in chosen.tolist():
            pose = goal.poses[number]
            stop = self._stop(goal, pose, f"{_named(goal.id)}_{number + 1}", flat=True)
            if goal.times and made:
                stop.after = goal.times[number] - before
            before = goal.times[number] if goal.times else 0.0
            made.append(stop)
        self.found.least_time += goal.times[-1] if goal.times else 0.0
        self.known[goal.id] = made[-1:]
        stops += made

    def _stop(self, goal: Goal, pose: ToleratedPose, wanted: str, *, flat: bool) -> Stop:
        text = self.sets.region(pose, flat=flat)
        region = next((name for name, said in self.found.regions.items() if said == text), "")
        if not region:
            region = self.names.name(wanted)
            self.found.regions[region] = text
        turned = self.sets.turned(pose)
        return Stop(region, turned, goal.kind == "reach", goal.place)


def _ordered(stops: Sequence[Stop], found: Clauses, sets: RegionSets) -> None:
    first, last = stops[0], stops[-1]
    found.lines.append(f"start in {first.region} at rest;")
    if not first.rests:
        sets.remarks.append(f"{first.where}: the robot begins there at rest")
    here = [first.atom] if first.turned else []
    here += [f"always[0 s, {decimal_text(first.hold)} s] {first.atom}"] if first.hold else []
    if len(stops) > 1:
        here += [f"eventually {rest}"] if (rest := _passed(stops[1:-1])) else []
    if here:
        found.lines.append(f"satisfy {' and '.join(here)};")
    rests = " at rest" if last.rests else ""
    hold = f" for {decimal_text(last.hold)} s" if last.hold and len(stops) > 1 else ""
    found.lines.append(f"reach {last.atom}{rests}{hold};")
    _say_moving([*stops[1:-1]], sets)


def _passed(stops: Sequence[Stop]) -> str:
    """A formula: the first stop holds, and eventually the others."""
    if not stops:
        return ""
    stop, rest = stops[0], _passed(stops[1:])
    parts = [stop.atom]
    if stop.hold:
        parts.append(f"always[0 s, {decimal_text(stop.hold)} s] {stop.atom}")
    if rest:
        after = stops[1].after
        window = "" if after is None else f"[{decimal_text(after)} s, {decimal_text(after)} s]"
        parts.append(f"eventually{window} {rest}")
    return parts[0] if len(parts) == 1 else f"({' and '.join(parts)})"


def _unordered(stops: Sequence[Stop], found: Clauses, sets: RegionSets) -> None:
    anywhere = "Anywhere"
    while anywhere in found.regions:
        anywhere += "_"
    found.regions[anywhere] = sets.box(sets.bounds)
    found.lines.append(f"start in {anywhere} at rest;")
    found.lines += [f"satisfy eventually {_passed([stop])};" for stop in stops]
    _say_moving(stops, sets)


def _say_moving(stops: Sequence[Stop], sets: RegionSets) -> None:
    """Add remarks that the robot need not rest at these stops: formulas cannot express rates."""
    for stop in stops:
        if stop.rests or stop.hold:
            what = "it pauses in the region" if stop.hold else "it is passed"
            sets.remarks.append(
                f"{stop.where}: {what}; that the robot rests there is not asked for"
            )


def _named(identifier: str) -> str:
    plain = Names().camel(identifier, "Goal")
    return plain if plain[:1].isalpha() else f"Goal{plain.lstrip('_')}"
