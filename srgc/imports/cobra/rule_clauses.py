"""Convert constraints of a task to clauses on obstacles, and remarks on limits."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from srgc.imports.cobra.region_sets import RegionSets
from srgc.imports.cobra.task_data import Constraint, TaskData
from srgc.imports.quantities import decimal_text

LIMITS = {
    "q": "ranges of joints",
    "dq": "rates of joints",
    "ddq": "accelerations of joints",
    "tau": "efforts of joints",
}


@dataclass(frozen=True, slots=True)
class Rules:
    """Whether obstacles and self-collisions are avoided, and with which margin (m)."""

    obstacles: bool
    itself: bool
    margin: float


def rules_of(task: TaskData, remarks: list[str], *, accel: bool) -> Rules:
    """What the constraints demand, with remarks where this task demands more or less."""
    kinds = {each.kind for each in task.constraints}
    margins = [each.margin for each in task.constraints if each.kind == "collisionFree"]
    for each in task.constraints:
        if each.local and each.kind in ("collisionFree", "selfCollisionFree", "joint"):
            remarks.append(f"{each.place.path}: a rule of one goal became one of the whole task")
        elif each.local:
            remarks.append(f"{each.place.path}: a rule of one goal")
        if each.kind == "selfCollisionFree" and each.margin:
            remarks.append(
                f"{each.place['safety_margin'].path}: a margin between bodies of a robot"
            )
    if "allGoalsFulfilled" not in kinds and "allGoalsFulfilledInOrder" not in kinds:
        remarks.append("the task does not ask for all of its goals; this one does")
    parts = {part for each in task.constraints for part in each.parts}
    bound = [LIMITS[part] for part in ("q", "dq", "tau") if part not in parts]
    bound += [LIMITS["ddq"]] if accel and "ddq" not in parts else []
    if bound:
        remarks.append(
            f"{', '.join(bound)} bind here, as modules have them; the task leaves them open"
        )
    if task.obstacles and "collisionFree" not in kinds:
        remarks.append("the task does not forbid to touch obstacles: they are left out")
    return Rules(
        "collisionFree" in kinds,
        bool(kinds & {"collisionFree", "selfCollisionFree"}),
        max(margins, default=0.0),
    )


def avoid_clauses(rules: Rules, obstacles: Sequence[str]) -> Iterator[str]:
    """The clauses on what no body may touch."""
    margin = f", margin {decimal_text(rules.margin * 1000)} mm" if rules.margin else ""
    if rules.itself:
        yield "avoid self with body;"
    if obstacles:
        yield f"avoid {', '.join(obstacles)} with body{margin};"


def tool_clauses(constraints: Sequence[Constraint], sets: RegionSets) -> Iterator[tuple[str, str]]:
    """For each pose that the tool keeps, its region, and its clauses on orientation."""
    for each in constraints:
        if each.kind != "endEffector" or each.local:
            continue
        for key in ("v_min", "v_max", "o_min", "o_max"):
            if key in each.place:
                sets.remarks.append(f"{each.place[key].path}: the speed of the tool")
        if each.pose is not None:
            yield sets.region(each.pose, flat=True), sets.turned(each.pose)
