"""The genetic search that ``modular_search.py`` compares with; runs where Timor is installed.

    python genetic_search.py TASK.json

Reads a task, prints one JSON object. The search is Timor's own class (Külz & Althoff, *Optimizing
modular robot composition: a lexicographic genetic algorithm approach*, 2024) with its operators and
its default parameters, on Timor's geometric primitives. What is compared lexicographically is what
that paper describes, written anew here: goals within the length of all modules, goals that inverse
kinematics reaches, goals reached without collision and within the static torques, a path between
them, then the objectives of the task. Base placements (Mayer & Althoff, *Holistic optimization of
modular robots*, 2025) are further base modules, one for each place.

Paths are OMPL's RRT-Connect, simplified by OMPL; TOPP-RA times them within rates and torques.
"""

from __future__ import annotations

import json
import sys
import time
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

import pinocchio as pin  # noqa: E402
import pygad  # noqa: E402
import toppra  # noqa: E402
from hppfcl import Box, CollisionRequest, CollisionResult, Transform3f, collide  # noqa: E402
from ompl import base as ob  # noqa: E402
from ompl import geometric as og  # noqa: E402
from ompl import util as ou  # noqa: E402
from timor import ModulesDB  # noqa: E402
from timor.configuration_search.GA import GA  # noqa: E402
from timor.utilities.dtypes import Lexicographic  # noqa: E402
from timor.utilities.file_locations import get_module_db_files  # noqa: E402

RESTARTS = 30  # of inverse kinematics, for each goal
CHOICES = 4  # configurations of each goal between which paths are sought
PATH_SECONDS = 1.0
HALF_TURN = np.pi
IDENTIFIERS = {"ID", "name", "parent", "child"}


# --- the modules ---------------------------------------------------------------------------------


def modules(task: dict[str, Any]) -> ModulesDB:
    """The revolute joint, the tubes, the end effector, and a base for each placement."""
    file = get_module_db_files("geometric_primitive_modules")
    described = json.loads(Path(file).read_text())
    wanted = {"J2", "i_15", "i_30", "i_45", "l_15", "l_30", "l_45", "eef"}
    kept = [m for m in described["modules"] if m["header"]["ID"] in wanted]
    base = next(m for m in described["modules"] if m["header"]["ID"] == "base")
    kept += [renamed(base, str(number)) for number in range(len(task["placements"]))]
    described["modules"] = kept
    return ModulesDB.from_json_data(described, name="primitives", validate=False)


def longest(name: str) -> float:
    """Metres between the ends of a module, at most; tubes are named after their centimetres."""
    if name.endswith("base"):
        return 0.05 * 2**0.5
    fixed = {"J2": 0.3, "eef": 0.04}
    return fixed[name] if name in fixed else int(name[2:]) / 100 + 0.1 * (name[0] == "l")


def renamed(module: Any, name: str) -> Any:
    """A copy of a module whose identifiers begin with another name."""
    if isinstance(module, dict):
        return {
            key: name + value if key in IDENTIFIERS else renamed(value, name)
            for key, value in module.items()
        }
    return [renamed(part, name) for part in module] if isinstance(module, list) else module


# --- one robot in the scene ----------------------------------------------------------------------


class Placed:
    """An assembly of modules at its place among the obstacles."""

    def __init__(self, assembly: Any, task: dict[str, Any], rng: np.random.Generator) -> None:
        self.robot = assembly.robot
        self.task = task
        self.rng = rng
        self.names = tuple(assembly.original_module_ids)
        number = next(int(n.removesuffix("base")) for n in self.names if n.endswith("base"))
        turn = np.deg2rad(task["turn"])
        place = np.eye(4)
        place[:2, :2] = [[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]]
        place[:3, 3] = self.place = np.array(task["placements"][number])
        self.robot.set_base_placement(place)
        self.low, self.high = self.robot.joint_limits
        self.low = np.maximum(self.low, -HALF_TURN)
        self.high = np.minimum(self.high, HALF_TURN)
        self.walls = [
            (Box(*np.subtract(high, low)), Transform3f(np.eye(3), np.add(high, low) / 2))
            for low, high in task["obstacles"]
        ]
        self.request = CollisionRequest()

    def tip(self, q: np.ndarray) -> np.ndarray:
        model, data = self.robot.model, self.robot.data
        pin.framesForwardKinematics(model, data, q)
        return np.array(data.oMf[self.robot.tcp].translation)

    def free(self, q: np.ndarray) -> bool:
        """Whether no body touches another one or an obstacle."""
        if self.robot.has_self_collision(np.asarray(q, dtype=float)):
            return False
        for shape, moved in zip(
            self.robot.collision_objects, self.robot.collision_data.oMg, strict=True
        ):
            at = moved.homogeneous
            mine = Transform3f(at[:3, :3], at[:3, 3])
            for wall, there in self.walls:
                if collide(shape.geometry, mine, wall, there, self.request, CollisionResult()):
                    return False
        return True

    def held(self, q: np.ndarray) -> bool:
        """Whether the torques against gravity are within the limits of the joints."""
        torques = np.abs(self.robot.static_torque(q))
        return bool(np.all(torques <= self.robot.joint_torque_limits))

    def reached(self, goal: list[list[float]]) -> list[np.ndarray]:
        """Configurations whose tip is in the box of a goal: damped Gauss-Newton, restarted."""
        model, data = self.robot.model, self.robot.data
        low, high = np.array(goal)
        found = []
        for _ in range(RESTARTS):
            q = self.rng.uniform(self.low, self.high)
            for _ in range(60):
                error = np.clip(self.tip(q), low + 1e-3, high - 1e-3) - self.tip(q)
                if not np.any(error):
                    break
                pin.computeJointJacobians(model, data, q)
                rows = pin.getFrameJacobian(
                    model, data, self.robot.tcp, pin.ReferenceFrame.LOCAL_WORLD_ALIGNED
                )[:3]
                step = rows.T @ np.linalg.solve(rows @ rows.T + 1e-6 * np.eye(3), error)
                q = np.clip(
                    q + step * min(1.0, 0.5 / max(np.abs(step).max(), 1e-12)), self.low, self.high
                )
            tip = self.tip(q)
            if np.all(tip >= low) and np.all(tip <= high):
                found.append(q)
        return found

    def path(self, start: np.ndarray, end: np.ndarray) -> np.ndarray | None:
        """Waypoints without collision, by RRT-Connect and OMPL's simplification."""
        count = len(start)
        space = ob.RealVectorStateSpace(count)
        bounds = ob.RealVectorBounds(count)
        for i in range(count):
            bounds.setLow(i, float(self.low[i]))
            bounds.setHigh(i, float(self.high[i]))
        space.setBounds(bounds)
        setup = og.SimpleSetup(space)
        setup.setStateValidityChecker(lambda state: self.free([state[i] for i in range(count)]))
        setup.getSpaceInformation().setStateValidityCheckingResolution(0.01)
        first, last = space.allocState(), space.allocState()
        for i in range(count):
            first[i], last[i] = float(start[i]), float(end[i])
        setup.setStartAndGoalStates(first, last)
        setup.setPlanner(og.RRTConnect(setup.getSpaceInformation()))
        setup.solve(PATH_SECONDS)
        if not setup.haveExactSolutionPath():
            return None
        setup.simplifySolution(PATH_SECONDS)
        states = setup.getSolutionPath().getStates()
        points = np.array([[state[i] for i in range(count)] for state in states])
        apart = np.r_[True, np.abs(np.diff(points, axis=0)).max(axis=1) > 1e-6]
        return points[apart]

    def duration(self, points: np.ndarray) -> float | None:
        """Seconds of the fastest motion along waypoints, with stops at its ends (TOPP-RA)."""
        if len(points) < 2:
            return 0.0
        along = np.r_[0, np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1))]
        way = toppra.SplineInterpolator(along / along[-1], points)
        rates = np.array(self.robot.joint_velocity_limits)
        torques = np.array(self.robot.joint_torque_limits)
        model, data = self.robot.model, self.robot.data
        limits = [
            toppra.constraint.JointVelocityConstraint(np.c_[-rates, rates]),
            toppra.constraint.JointTorqueConstraint(
                lambda q, v, a: pin.rnea(model, data, q, v, a),
                np.c_[-torques, torques],
                np.zeros(len(rates)),
            ),
        ]
        timed = toppra.algorithm.TOPPRA(limits, way).compute_trajectory(0, 0)
        return None if timed is None else float(timed.duration)

    def fastest(self, starts: list[np.ndarray], ends: list[np.ndarray]) -> float | None:
        """Seconds of the fastest of some paths between two goals; none where no path was found."""
        pairs = sorted(
            ((np.abs(a - b).max(), i, j) for i, a in enumerate(starts) for j, b in enumerate(ends)),
        )[:CHOICES]
        times = []
        for _, i, j in pairs:
            points = self.path(starts[i], ends[j])
            if points is not None:
                seconds = self.duration(points)
                if seconds is not None:
                    times.append(seconds)
        return min(times, default=None)


# --- the search ----------------------------------------------------------------------------------


class Fitness:
    """What is compared lexicographically, larger is better; remembers the best and the work."""

    def __init__(self, task: dict[str, Any]) -> None:
        self.task = task
        self.began = time.process_time()
        self.looked_at = 0
        self.best: tuple[float, ...] | None = None
        self.answer: dict[str, Any] = {"found": False}

    def __call__(self, assembly: Any, search: pygad.GA, index: int) -> Lexicographic:
        self.looked_at += 1
        rng = np.random.default_rng(self.looked_at)
        placed = Placed(assembly, self.task, rng)
        values, seconds = self.values(placed)
        if self.best is None or values > self.best:
            self.best = values
            if seconds is not None:
                self.answer = {
                    "found": True,
                    "modules": placed.names,
                    "time": seconds,
                    "after": time.process_time() - self.began,
                }
        return Lexicographic(*values)

    def values(self, placed: Placed) -> tuple[tuple[float, ...], float | None]:
        count = len(placed.names)
        within = count <= self.task["modules"]
        lacking = sum(self.too_short(placed, goal) for goal in self.task["goals"])
        if not within or lacking > 0 or placed.robot.dof == 0:
            return (float(within), -lacking, 0, 0, 0, -count, 0), None
        reached = [placed.reached(goal) for goal in self.task["goals"]]
        kinematic = sum(bool(found) for found in reached)
        good = [[q for q in found if placed.held(q) and placed.free(q)] for found in reached]
        good_count = sum(bool(found) for found in good)
        seconds = placed.fastest(*good) if good_count == len(good) else None
        objectives = {"modules": float(count), "time": np.inf if seconds is None else seconds}
        order = [-objectives[name] for name in self.task["minimize"]]
        head = (1.0, 0.0, float(kinematic), float(good_count), float(seconds is not None))
        return (*head, *order), seconds

    def too_short(self, placed: Placed, goal: list[list[float]]) -> float:
        """Metres that the modules in a straight line lack towards a goal."""
        reach = sum(longest(name) for name in placed.names)
        nearest = np.clip(placed.place, *goal)
        return max(0.0, float(np.linalg.norm(nearest - placed.place)) - reach)


def main() -> None:
    task = json.loads(Path(sys.argv[1]).read_text())
    ou.setLogLevel(ou.LOG_NONE)
    toppra.setup_logging("ERROR")
    ou.RNG.setSeed(task["seed"] + 1)
    np.random.seed(task["seed"])  # noqa: NPY002 - Timor's selection draws from it
    fitness = Fitness(task)
    search = GA(modules(task), task["hyperparameters"], rng=np.random.default_rng(task["seed"]))
    search.optimize(
        fitness, progress_bar=False, timeout=task["seconds"], save_best_solutions=False,
        selection_type="rank",
    )  # fmt: skip
    spent = time.process_time() - fitness.began
    print(json.dumps({**fitness.answer, "looked at": fitness.looked_at, "cpu": spent}))


if __name__ == "__main__":
    main()
