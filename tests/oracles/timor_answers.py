"""What Timor says of module sets; runs where Timor is installed, and knows nothing of this project.

    python timor_answers.py < QUESTION.json

Prints one JSON object: which connectors fit, and of assemblies in a row the frame of the tool, the
mass matrix with the inertia of rotors, and the efforts at no acceleration, without friction.
"""

from __future__ import annotations

import json
import sys
import types
from pathlib import Path
from typing import Any

import numpy as np


def without_download() -> None:
    """Timor fetches schemata and module sets when it is imported; neither is needed."""
    module: Any = types.ModuleType("timor.utilities.download_data")
    module.download_schemata = lambda folder: {}
    module.download_additional_robots = lambda folder, robots: None
    sys.modules[module.__name__] = module


without_download()

import timor_sample_robots  # noqa: E402
from timor import ModuleAssembly, ModulesDB  # noqa: E402
from timor.task import Task as of_tasks  # noqa: E402, N813
from timor.utilities.frames import FrameTree  # noqa: E402
from timor.utilities.tolerated_pose import ToleratedPose  # noqa: E402
from timor.utilities.transformation import Transformation  # noqa: E402


def shipped() -> dict[str, str]:
    """The module sets that come with Timor."""
    folder = Path(next(iter(timor_sample_robots.__path__)))
    return {each.parent.name: str(each) for each in sorted(folder.glob("*/modules.json"))}


def pairs(db: Any) -> list[list[str]]:
    """Connectors that fit, each pair both ways round."""
    found = set()
    for one, mine, other, theirs in db.possible_connections:
        found.add((one.id, mine.own_id, other.id, theirs.own_id))
        found.add((other.id, theirs.own_id, one.id, mine.own_id))
    return [list(each) for each in sorted(found)]


def limits(db: Any) -> list[list[Any]]:
    """What each joint has."""
    found = []
    for joint in db.all_joints:
        low, high = (float(value) for value in joint.limits.ravel())
        values = [low, high, joint.velocity_limit, joint.acceleration_limit, joint.torque_limit]
        values += [joint.gear_ratio, joint.motor_inertia]
        values += [joint.friction_coulomb, joint.friction_viscous]
        found.append([joint.in_module.id, joint._id, str(joint.type), *values])
    return sorted(found)


def robot(db: Any, asked: dict[str, Any]) -> dict[str, Any]:
    """The answers about one assembly at several states."""
    if "connections" in asked:
        made = ModuleAssembly(
            db, asked["modules"], [tuple(c) for c in asked["connections"]], tuple(asked["base"])
        ).robot
    else:
        made = ModuleAssembly.from_serial_modules(db, asked["modules"]).robot
    n = made.dof
    made.model.gravity.linear = np.array(asked["gravity"])
    found: dict[str, Any] = {"dof": n, "mass": made.mass, "states": []}
    for coordinates, rates in asked["states"]:
        q, dq = np.array(coordinates), np.array(rates)
        bias = made.id(q, dq, np.zeros(n), friction=False)
        columns = [made.id(q, dq, column, friction=False) - bias for column in np.eye(n)]
        frame = made.fk(q).homogeneous
        found["states"].append(
            {
                "frame": frame.tolist(),
                "mass_matrix": np.array(columns).T.tolist(),
                "bias": np.atleast_1d(bias).tolist(),
            }
        )
    return found


def tolerated(poses: list[dict[str, Any]], frames: dict[str, Any]) -> list[list[bool]]:
    """Of each pose with tolerances whether candidates are within them."""
    found = []
    for asked in poses:
        pose = ToleratedPose.from_json_data(
            asked["pose"], frames=FrameTree.from_json_data(frames), annonymousFrame=True
        )
        candidates = map(Transformation, asked["candidates"])
        found.append([bool(pose.valid(candidate)) for candidate in candidates])
    return found


class AnyTask:
    """Stands for the schemata, which would have to be fetched."""

    def is_valid(self, content: object) -> bool:
        return True


def judged(db: Any, asked: dict[str, Any]) -> dict[str, Any]:
    """Which goals the samples of a motion are at, and which samples touch something."""
    of_tasks.get_schema_validator = lambda file: ({}, AnyTask())
    file = Path(asked["task"])
    content = json.loads(file.read_text())
    for obstacle in content["obstacles"]:
        for shape in obstacle["collision"]:
            if "file" in shape["parameters"]:
                shape["parameters"]["file"] = str(file.parent / shape["parameters"]["file"])
    content.pop("costFunction", None)
    task = of_tasks.Task.from_json_data(content)
    made = ModuleAssembly.from_serial_modules(db, asked["modules"]).robot
    made.set_base_placement(Transformation(asked["base"]))
    found: dict[str, Any] = {"goals": {goal.id: [] for goal in task.goals}, "touching": []}
    for number, q in enumerate(asked["samples"]):
        pose = made.fk(np.array(q))
        for goal in task.goals:
            if goal.goal_pose.valid(pose):
                found["goals"][goal.id].append(number)
        if made.has_collisions(task) or made.has_self_collision():
            found["touching"].append(number)
    low, high = made.joint_limits
    samples = np.array(asked["samples"])
    found["in range"] = bool(np.all((low <= samples) & (samples <= high)))
    return found


def main() -> None:
    question = json.load(sys.stdin)
    if "tolerated" in question:
        sys.stdout.write(json.dumps(tolerated(question["tolerated"], question["frames"])))
        return
    if "set" not in question:
        sys.stdout.write(json.dumps(shipped()))
        return
    db = ModulesDB.from_json_file(Path(question["set"]), validate=False)
    if "task" in question:
        sys.stdout.write(json.dumps(judged(db, question)))
        return
    sys.stdout.write(
        json.dumps(
            {
                "pairs": pairs(db),
                "limits": limits(db),
                "robots": [robot(db, asked) for asked in question["assemblies"]],
            }
        )
    )


if __name__ == "__main__":
    main()
