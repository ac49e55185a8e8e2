"""The robots of a mission in order, and what happens to each of their modules."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Literal

import numpy as np

from compiler.arrays import Array
from compiler.missions.robot_changes import Changes
from compiler.robots.attributes import SemanticsError
from compiler.robots.candidate import robot_in_task
from compiler.robots.normal_form import family_of
from compiler.robots.robot import RobotModel, RobotParameter
from compiler.words.derivation import Derivation
from compiler.words.structures import InfiniteAmbiguityError, structures_of
from grammar_lang import ir
from grammar_lang.ir.constants import to_float
from srgc.results.found_design import FoundDesign
from srgc.results.mission_folder import MissionFolder, RobotBefore

Fate = Literal["added", "removed", "changed"]
"""What happens to a module: added before the task, removed after it, or changed before it."""


@dataclass(frozen=True, slots=True, eq=False)
class StandingRobot:
    """The robot for one task or several successive ones; without tasks, the existing robot.

    ``model`` and ``derivation`` are None if the robot cannot be built again.  ``known`` has the
    parameters with known values; ``theta`` has substitutes for the others.  ``fates`` says what
    happens to the modules at places of the word; the others are kept.  ``step`` has the changes
    from the ``earlier`` word.
    """

    tasks: tuple[str, ...]
    word: tuple[str, ...]
    derivation: Derivation | None
    model: RobotModel | None
    theta: Array
    known: tuple[tuple[RobotParameter, float], ...]
    step: Changes | None = None
    earlier: tuple[str, ...] = ()
    fates: Mapping[int, frozenset[Fate]] = field(default_factory=dict[int, frozenset[Fate]])


def line_of_robots(mission: MissionFolder) -> tuple[StandingRobot, ...]:
    """The robots of a mission; equal successive ones are merged."""
    modules = mission.program.modules
    found: list[StandingRobot] = []
    if mission.before is not None:
        first = None if not mission.robots else (mission.robots[0], mission.steps[0])
        found.append(_before(mission, mission.before, first))
    names = mission.mission.tasks
    for number, robot in enumerate(mission.robots):
        step = mission.steps[number]
        if found and found[-1].tasks and _is_same(mission.robots[number - 1], robot):
            found[-1] = replace(found[-1], tasks=(*found[-1].tasks, names[number]))
            continue
        earlier = found[-1].word if found else ()
        found.append(_standing(names[number], robot, step, earlier))
    return tuple(_with_fates(found, modules))


def different_robots(mission: MissionFolder) -> int:
    """The number of distinct robots; a robot that returns after another one counts once."""
    return len({(robot.claim.word, robot.claim.parameters) for robot in mission.robots})


def _is_same(one: FoundDesign, other: FoundDesign) -> bool:
    return one.claim.word == other.claim.word and one.claim.parameters == other.claim.parameters


def _standing(
    task: str, robot: FoundDesign, step: Changes | None, earlier: tuple[str, ...]
) -> StandingRobot:
    known = tuple((value.parameter, float(value)) for value in robot.parameters)
    return StandingRobot(
        (task,), robot.claim.word, robot.derivation, robot.model, robot.theta, known, step, earlier
    )


def _with_fates(
    line: Sequence[StandingRobot], modules: Mapping[str, ir.Module]
) -> Iterator[StandingRobot]:
    """The robots, with what happens to their modules before and after their tasks."""
    for number, robot in enumerate(line):
        here = module_places(robot.word, modules)
        fates: dict[int, set[Fate]] = {}
        if robot.step is not None:
            for j in robot.step.added:
                fates.setdefault(here[j], set()).add("added")
            for _, j, _ in robot.step.changed:
                fates.setdefault(here[j], set()).add("changed")
        after = line[number + 1].step if number + 1 < len(line) else None
        for i in () if after is None else after.removed:
            fates.setdefault(here[i], set()).add("removed")
        yield replace(robot, fates={place: frozenset(each) for place, each in fates.items()})


def module_places(word: Sequence[str], modules: Mapping[str, ir.Module]) -> list[int]:
    """The places of the modules in a word, in order."""
    return [place for place, symbol in enumerate(word) if symbol in modules]


# --- The existing robot before the first task -----------------------------------------------------


def _before(
    mission: MissionFolder,
    before: RobotBefore,
    first: tuple[FoundDesign, Changes | None] | None,
) -> StandingRobot:
    """The robot as the spec builds it; unknown values are taken from kept modules later."""
    task = mission.program.tasks[mission.mission.tasks[0]]
    robot = StandingRobot((), before.word, None, None, np.zeros(0), ())
    try:
        family = family_of(mission.program, task)
        derivation = next(structures_of(family.language, [before.word]), None)
        if derivation is None:
            return robot
        model = robot_in_task(family, None, derivation)
    except (SemanticsError, InfiniteAmbiguityError):
        return robot
    later = {} if first is None else _kept_values(mission, before, *first)
    theta, known = [], []
    for parameter in model.parameters:
        key = parameter.symbol, parameter.name
        ranges = before.values.get(key, ())
        if len(ranges) == 1:
            theta.append(float(ranges[0].low + ranges[0].high) / 2)
            known.append((parameter, theta[-1]))
        else:
            theta.append(later.get(key, _middle(parameter.domain)))
    return replace(
        robot, derivation=derivation, model=model, theta=np.array(theta), known=tuple(known)
    )


def _kept_values(
    mission: MissionFolder, before: RobotBefore, robot: FoundDesign, step: Changes | None
) -> dict[tuple[int, str], float]:
    """The parameter values of kept modules in the first robot."""
    old = module_places(before.word, mission.program.modules)
    new = module_places(robot.claim.word, mission.program.modules)
    place = {new[j]: old[i] for i, j in (() if step is None else step.kept)}
    return {
        (place[value.parameter.symbol], value.parameter.name): float(value)
        for value in robot.parameters
        if value.parameter.symbol in place
    }


def _middle(domain: ir.Interval | ir.Choices) -> float:
    if isinstance(domain, ir.Choices):
        return to_float(domain.values[0])
    return (to_float(domain.lower) + to_float(domain.upper)) / 2
