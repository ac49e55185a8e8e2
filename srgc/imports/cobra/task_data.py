"""Read the file of a task, by CoBRA's TaskSchema."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Literal, TypeAlias, get_args

from srgc.imports.cobra.pose_data import Frames, ToleratedPose
from srgc.imports.json_place import Place
from srgc.imports.timor.geometry_data import IDENTITY, Geometry, read_geometries

GoalKind: TypeAlias = Literal["at", "reach", "returnTo", "pause", "follow"]
DRAFTS = ("pick", "place", "leave", "cover")
"""Kinds of goals that the schema marks as drafts; no tool evaluates them."""
CONSTRAINTS = (
    *("allGoalsFulfilled", "allGoalsFulfilledInOrder", "alwaysTrue", "collisionFree"),
    *("goalsBySameRobot", "joint", "selfCollisionFree", "validAssembly", "basePlacement"),
    "endEffector",
)
MOST_GOALS, MOST_OBSTACLES = 30, 2000
"""The most goals and obstacles; consecutive goals become nested formulas."""
PARTS = ("q", "dq", "ddq", "tau")


@dataclass(frozen=True, slots=True)
class Goal:
    """A goal: poses to reach one after the other, or a time (s) to pause.

    ``times`` (s) are the times of the poses of a ``follow``, if given.  ``target`` is the ID of the
    goal that a ``returnTo`` returns to, empty for the start.
    """

    id: str
    kind: GoalKind
    poses: Sequence[ToleratedPose]
    times: Sequence[float]
    duration: float
    target: str
    place: Place


@dataclass(frozen=True, slots=True)
class Constraint:
    """A rule that a solution has to keep; ``local`` if it belongs to one goal."""

    kind: str
    place: Place
    local: bool
    margin: float = 0.0
    parts: frozenset[str] = frozenset()
    order: Sequence[str] = ()
    pose: ToleratedPose | None = None


@dataclass(frozen=True, slots=True)
class Obstacle:
    """An obstacle, which must not be touched."""

    id: str
    name: str
    shapes: Sequence[Geometry]
    place: Place


@dataclass(frozen=True, slots=True)
class TaskData:
    """A task; ``remarks`` say what is not read."""

    id: str
    name: str
    gravity: tuple[float, ...]
    authors: Sequence[str]
    obstacles: Sequence[Obstacle]
    goals: Sequence[Goal]
    constraints: Sequence[Constraint]
    cost: str
    remarks: Sequence[str]


def read_task(place: Place) -> TaskData:
    """Read the task of a file.

    Raises:
        UsageFault: the file violates the schema, or an ID occurs twice or is unknown.
    """
    place.keys(("header", "frames", "obstacles", "objects", "constraints", "goals", "costFunction"))
    header = place["header"]
    frames = Frames(place.get("frames", []))
    remarks = list[str]()
    goals = _goals(place["goals"], frames, remarks)
    constraints = [
        _constraint(entry, frames, local=False)
        for entry in place.get("constraints", []).one_or_more()
    ]
    for entry in place["goals"].entries():
        constraints += [
            _constraint(each, frames, local=True)
            for each in entry.get("constraints", []).one_or_more()
        ]
    if objects := len(place.get("objects", []).one_or_more()):
        remarks.append(f"{objects} objects, which the schema calls a draft")
    named = header["ID"] if "ID" in header else header["taskID"]
    return TaskData(
        named.text(),
        header.get("taskName", "").text(),
        header.get("gravity", [0, 0, -9.81]).numbers(3),
        [entry.text() for entry in header.get("author", []).one_or_more()],
        [_obstacle(entry, remarks) for entry in _with_ids(place.get("obstacles", []))],
        goals,
        constraints,
        place.get("costFunction", "").text(),
        remarks,
    )


def _with_ids(place: Place, most: int = MOST_OBSTACLES) -> Sequence[Place]:
    """The entries of a list; IDs that occur twice are rejected."""
    seen = dict[str, Place]()
    for entry in place.one_or_more(most):
        name = entry["ID"].text()
        if name in seen:
            raise entry["ID"].fault(f"{name[:40]!r} is at {seen[name].path} already")
        seen[name] = entry["ID"]
    return place.one_or_more()


def _obstacle(place: Place, remarks: list[str]) -> Obstacle:
    # Older files have a pose of the whole obstacle; Timor does not read it.
    if place.get("pose", IDENTITY).value != IDENTITY:
        remarks.append(f"{place['pose'].path}: a pose of the whole obstacle, beside that of shapes")
    place.keys(("ID", "name", "collision", "visual", "pose", "acknowledgement"))
    name = place.get("name", "").text()
    return Obstacle(place["ID"].text(), name, read_geometries(place["collision"]), place)


def _goals(place: Place, frames: Frames, remarks: list[str]) -> list[Goal]:
    found = list[Goal]()
    for entry in _with_ids(place, MOST_GOALS):
        kind = entry["type"].text()
        kind = kind[:1].lower() + kind[1:]
        if kind in DRAFTS:
            remarks.append(f"{entry.path}: a goal to {kind}, which the schema calls a draft")
        elif kind in get_args(GoalKind):
            found.append(_goal(kind, entry, frames, remarks))  # type: ignore[arg-type]
        else:
            raise entry["type"].fault(
                f"unknown goal `{kind[:40]}`; known are {', '.join(get_args(GoalKind))}"
            )
    known = {goal.id for goal in found}
    for goal in found:
        if goal.target and goal.target not in known:
            raise goal.place["returnToGoal"].fault(f"there is no goal {goal.target[:40]!r}")
    return found


def _goal(kind: GoalKind, place: Place, frames: Frames, remarks: list[str]) -> Goal:
    keys = ["ID", "type", "constraints"]
    poses, times = list[ToleratedPose](), tuple[float, ...]()
    duration, target = 0.0, ""
    match kind:
        case "at" | "reach":
            keys.append("goalPose")
            poses = [frames.pose(place["goalPose"])]
        case "returnTo":
            keys.append("returnToGoal")
            target = place.get("returnToGoal", "").text()
        case "pause":
            keys.append("duration")
            duration = place["duration"].number(least=0.0)
        case "follow":
            keys.append("trajectory")
            poses, times = _trajectory(place["trajectory"], frames)
            remarks += [
                f"{place[key].path}: forces at the effector"
                for key in ("externalForce", "externalTorque")
                if key in place
            ]
            keys += ["externalForce", "externalTorque", "forceTorqueReferenceFrame"]
    place.keys(keys)
    return Goal(place["ID"].text(), kind, poses, times, duration, target, place)


def _trajectory(place: Place, frames: Frames) -> tuple[list[ToleratedPose], tuple[float, ...]]:
    place.keys(("pose", "t"))
    entries = place["pose"].entries()
    if not entries:
        raise place["pose"].fault("expected at least one pose")
    poses = [frames.pose(entry) for entry in entries]
    if "t" not in place:
        return poses, ()
    if isinstance(place["t"].value, list):
        times = place["t"].numbers(len(poses), least=0.0)
    else:
        step = place["t"].number(least=0.0)
        times = tuple(step * number for number in range(len(poses)))
    if any(after <= before for before, after in pairwise(times)):
        raise place["t"].fault("expected times that increase")
    return poses, times


def _constraint(place: Place, frames: Frames, *, local: bool) -> Constraint:
    kind = place["type"].text()
    kind = kind[:1].lower() + kind[1:]
    if kind not in CONSTRAINTS:
        raise place["type"].fault(
            f"unknown constraint `{kind[:40]}`; known are {', '.join(CONSTRAINTS)}"
        )
    keys = {
        "joint": ("parts",),
        "basePlacement": ("pose",),
        "endEffector": ("pose", "v_min", "v_max", "o_min", "o_max"),
        "collisionFree": ("safety_margin",),
        "selfCollisionFree": ("safety_margin",),
        "allGoalsFulfilledInOrder": ("order",),
        "goalsBySameRobot": ("goals",),
    }
    place.keys(("type", *keys.get(kind, ())))
    return Constraint(
        kind,
        place,
        local,
        place.get("safety_margin", 0.0).number(least=0.0),
        _parts(place) if kind == "joint" else frozenset(),
        [entry.text() for entry in place["order"].entries()]
        if kind == "allGoalsFulfilledInOrder"
        else (),
        frames.pose(place["pose"])
        if kind in ("basePlacement", "endEffector") and "pose" in place
        else None,
    )


def _parts(place: Place) -> frozenset[str]:
    parts = place["parts"]
    named = parts.text().split(",") if isinstance(parts.value, str) else [
        entry.text() for entry in parts.entries()
    ]  # fmt: skip
    found = {each.strip().lower() for each in named}
    if unknown := sorted(found - set(PARTS)):
        raise parts.fault(f"unknown limit `{unknown[0][:40]}`; known are {', '.join(PARTS)}")
    return frozenset(found)
