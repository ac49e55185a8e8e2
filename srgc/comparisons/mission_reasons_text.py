"""Why a mission has its verdict, as text or as JSON."""

from __future__ import annotations

import json
from collections.abc import Iterator
from dataclasses import asdict
from fractions import Fraction
from typing import Any

from compiler.expressions.exact_numbers import exact_text
from grammar_lang.diagnostics.wording import counted
from solvers.verifier.missions.no_other_robots import LeftRobots
from srgc.comparisons.mission_reasons import MissionReasons, TaskReasons
from srgc.results.stated_objectives import short

MOST_SAID = 6
"""The number of statements to print for a task; JSON has all of them."""
MOST_NAMED = 3
"""The number of robots to name for one reason."""
ENDED = {
    "time": "the time limit ended the search",
    "motions": "the search ended at its limit of robots without a motion",
    "structures": "there are too many structures to compare them",
    "cuts": "the search ended at its limit of boxes of parameters",
    "parameters": "the robots that were found do not agree in their parameters",
    "modules": "no bound on modules is asked for",
}
"""Maps each reason why a search ended to words."""


def mission_reasons_text(found: MissionReasons) -> str:
    """The explanation for people; ends with a line break."""
    blocks = [_head(found), *(_task(found, each) for each in found.tasks)]
    blocks += _undecided(found)
    blocks += filter(None, [_ending(found)])
    return "\n\n".join(blocks) + "\n"


def _head(found: MissionReasons) -> str:
    mission = found.mission
    name = mission.mission.name
    if mission.verdict != "found":
        return f"mission {name}: {mission.verdict} ({mission.design['reason']})"
    if mission.cost is None:
        return "; ".join([f"mission {name}: found, one robot", *_objectives(found)])
    cost, least = mission.cost, mission.least or Fraction(0)
    said = "proved least" if least == cost else f"none less than {exact_text(least)}"
    return f"mission {name}: found, changes {exact_text(cost)}, {said}"


def _objectives(found: MissionReasons) -> Iterator[str]:
    """The value of each objective for the one robot, and what is proved about other robots."""
    for each in found.mission.design["objectives"]:
        name = each["objective"].removeprefix("sum(").removesuffix(")")
        value, least = float(each["value"]), float(each["least"])
        said = f"{name} {short(value)} {each['unit']}".rstrip()
        if least >= value:
            yield f"{said}, proved least"
        elif least > 0:
            yield f"{said}, none less than {short(least)} {each['unit']}".rstrip()
        else:
            yield f"{said}, not proved least"


def _task(found: MissionReasons, each: TaskReasons) -> str:
    said = list(each.says)
    if not said:
        return f"task {each.task}: no robot is refuted"
    lines = [f"task {each.task}: {_counts(each)}"]
    lines += [f"  {line}" for line in said[:MOST_SAID]]
    if len(said) > MOST_SAID:
        lines.append(f"  and {len(said) - MOST_SAID} more")
    lines += [f"  {line}" for line in _without(found, each)]
    return "\n".join(lines)


def _counts(each: TaskReasons) -> str:
    own = each.refuted
    parts = [
        f"{counted(own.structures, 'structure')} refuted" if own.structures else "",
        counted(len(own.lemmas), "lemma") if own.lemmas else "",
        f"{_boxes(own.boxes)} of parameters refuted" if own.boxes else "",
        "all robots refuted by its workspace" if own.separated else "",
    ]
    return ", ".join(part for part in parts if part)


def _boxes(count: int) -> str:
    return f"{count} {'box' if count == 1 else 'boxes'}"


def _without(found: MissionReasons, each: TaskReasons) -> Iterator[str]:
    if each.without is None:
        return
    if each.without.robots is not None:
        cost = exact_text(each.without.robots.cost)
        yield f"without that, robots that cost {cost} would be left"
    elif each.without.one_left is not None:
        yield (
            "without that, some robot would be left"
            if each.without.one_left
            else "also without that no robot is left"
        )


def _ending(found: MissionReasons) -> str:
    """What remains, and what the user can do."""
    mission = found.mission
    if mission.verdict == "unknown":
        return "\n".join(_open_end(found))
    if found.left is None:
        return ""
    cost = exact_text(found.left.cost)
    if mission.verdict == "found":
        return f"the cheapest robots that are left cost {cost}: those of the design, or as dear"
    most = mission.mission.most
    allowed = "" if most is None else f", and at most {exact_text(most)} is allowed"
    rows = _chain(found, found.left)
    return "\n".join([f"the cheapest robots that are left would cost {cost}{allowed}", *rows])


def _open_end(found: MissionReasons) -> Iterator[str]:
    """How much is undecided, what ended the search, and what the user can do about it."""
    design = found.mission.design
    undecided, ended, first = design["undecided"], design.get("ended_by"), design.get("try_first")
    said = [f"{counted(undecided, 'robot')} undecided"] if undecided else []
    if ended is not None:
        said.append(ENDED.get(ended, "the search ended early"))
    yield "; ".join(said) or "the search ended early"
    if first is not None:
        yield f"try first: {first}"


def _undecided(found: MissionReasons) -> Iterator[str]:
    """The robots that are neither found nor refuted, task by task, with the reasons."""
    for task, each in found.undecided.items():
        lines = [f"undecided {_in(task)}:"]
        for one in each[:MOST_SAID]:
            lines.append(f"  {one.says(MOST_NAMED)}")
            if one.try_first is not None:
                lines.append(f"    try first: {one.try_first}")
        if len(each) > MOST_SAID:
            lines.append(f"  and {len(each) - MOST_SAID} more reasons")
        yield "\n".join(lines)


def _in(task: str | None) -> str:
    return "in all tasks together" if task is None else f"in {task}"


def _chain(found: MissionReasons, left: LeftRobots) -> Iterator[str]:
    names = found.mission.mission.tasks
    width = max(map(len, names))
    for task, modules in zip(names, left.robots, strict=True):
        yield f"  {task:<{width}}  {' '.join(modules)}"


def mission_reasons_json(found: MissionReasons) -> str:
    """The explanation as JSON."""
    mission = found.mission
    content = {
        "verdict": mission.verdict,
        "reason": mission.design["reason"],
        "mission": mission.mission.name,
        "kind": mission.design["kind"],
        "cost": None if mission.cost is None else float(mission.cost),
        "least": None if mission.least is None else float(mission.least),
        "most": None if mission.mission.most is None else float(mission.mission.most),
        "undecided": mission.design["undecided"],
        "ended_by": mission.design.get("ended_by"),
        "try_first": mission.design.get("try_first"),
        "open": [
            asdict(each) | {"words": [list(word) for word in each.words]}
            for each in mission.undecided
        ],
        "tasks": [_entry(found, each) for each in found.tasks],
        "left": _left_entry(found, found.left),
    }
    return json.dumps(content, indent=1, ensure_ascii=False) + "\n"


def _entry(found: MissionReasons, each: TaskReasons) -> dict[str, Any]:
    own, without = each.refuted, each.without
    return {
        "task": own.task,
        "structures": own.structures,
        "lemmas": list(own.lemmas),
        "boxes": own.boxes,
        "separated": own.separated,
        "reasons": [
            {"reason": reason, "robots": count, "word": list(word)}
            for reason, count, word in own.reasons
        ],
        "without": None
        if without is None
        else {"robots": _left_entry(found, without.robots), "one_left": without.one_left},
    }


def _left_entry(found: MissionReasons, left: LeftRobots | None) -> dict[str, Any] | None:
    if left is None:
        return None
    return {
        "cost": float(left.cost),
        "robots": [
            {"task": task, "modules": list(modules)}
            for task, modules in zip(found.mission.mission.tasks, left.robots, strict=True)
        ],
    }
