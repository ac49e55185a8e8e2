"""``srgc import cobra``: import a task of CoBRA as a workspace and a task, with its modules."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from srgc.imports.cobra.base_place import floor_module
from srgc.imports.cobra.carried_set import CarriedSet, carried_set
from srgc.imports.cobra.goal_clauses import Clauses, goal_clauses
from srgc.imports.cobra.mesh_obstacles import MeshObstacles
from srgc.imports.cobra.objectives import objectives
from srgc.imports.cobra.obstacle_sets import obstacle_sets
from srgc.imports.cobra.pose_data import ToleratedPose
from srgc.imports.cobra.region_sets import RegionSets
from srgc.imports.cobra.rule_clauses import Rules, avoid_clauses, rules_of, tool_clauses
from srgc.imports.cobra.task_data import TaskData, read_task
from srgc.imports.comment_lines import comment_lines, printable
from srgc.imports.json_place import json_file
from srgc.imports.names import Names
from srgc.imports.quantities import Quantities, decimal_text
from srgc.imports.source_files import SourceFiles, source_files
from srgc.imports.spec_text import canonical_text, modules_text
from srgc.imports.written_import import Imported, mesh_folder

ROOM = 1.0
"""How far the bounds extend beyond what the task names (m), before rounding to half a metre."""
STEP = 0.1
"""The default duration of a step (s)."""
STEPS_A_LEG = 20
"""The number of steps for the way from one goal to the next."""
MOST_MODULES = 8
ENOUGH = {"revolute": "1000 N*m", "prismatic": "10000 N"}
"""Effort limits for tasks whose modules have none, by kind of joint."""


@dataclass(frozen=True, slots=True)
class TaskOptions:
    """The options of an import; see :func:`cobra_import`."""

    modules: Path | None = None
    name: str | None = None
    base: str | None = None
    any_order: bool = False
    cost: str | None = None
    pieces: int | None = None
    detail: float | None = None
    stem: str | None = None


def cobra_import(
    file: Path,
    *,
    modules: Path | None = None,
    name: str | None = None,
    exact: bool = False,
    base: str | None = None,
    any_order: bool = False,
    cost: str | None = None,
    pieces: int | None = None,
    detail: float | None = None,
    stem: str | None = None,
) -> Imported:
    """The spec of a task.

    Args:
        file: a task in CoBRA's schema.
        modules: a module set of Timor, whose modules are written with the task, or a spec with a
            grammar from ports, which the task includes; if None, Timor's geometric primitives from
            the library.
        name: the prefix of the names of modules.
        exact: keep angles and lengths as they are.
        base: the module of the set that is the base; if None, the first one.
        any_order: leave the order of goals open if the task does.
        cost: a cost function of CoBRA, such as ``cyc`` or ``mass,cyc``; if None, the one in the
            file.
        pieces: the most convex pieces of a mesh.
        detail: the share of the volume of a mesh that its pieces may add.
        stem: the name of the spec without its extension, from which the folder of meshes is named;
            if None, the name of the task.

    Raises:
        UsageFault: a file cannot be read, or violates the schema.
    """
    files = source_files(file)
    place = json_file(files)
    task = read_task(place)
    called = Names().name(task.id.rpartition("/")[2], "task").lower()
    stem = called if stem is None else stem
    options = TaskOptions(modules, name, base, any_order, cost, pieces, detail, stem)
    carried = carried_set(modules, name=name, base=base, stem=stem)
    made = _Written(task, carried, options, files, Quantities(exact))
    blocks = made.blocks()
    modules_blocks = modules_text(carried.modules, exact=exact)
    remarks = [*task.remarks, *made.remarks, *carried.modules.remarks]
    remarks += [f"{unread}: an unknown key" for unread in place.unread.places]
    head = [made.title(file), *carried.modules.comments[:1]]
    if remarks:
        head += ["", "Not carried over, or changed:", *(f"- {line}" for line in remarks)]
    text = canonical_text([comment_lines(head), carried.head, *modules_blocks, *blocks])
    return Imported(called, text, {**carried.files, **made.meshes.written}, tuple(remarks))


@dataclass(slots=True)
class _Written:
    task: TaskData
    carried: CarriedSet
    options: TaskOptions
    files: SourceFiles
    write: Quantities
    remarks: list[str] = field(default_factory=list)
    names: Names = field(default_factory=lambda: Names(ignore_case=True))
    meshes: MeshObstacles = field(init=False)

    def __post_init__(self) -> None:
        self.meshes = MeshObstacles(
            self.files,
            self.names,
            self.remarks,
            self.write,
            self.options.pieces,
            self.options.detail,
            mesh_folder(self.options.stem or "task"),
        )

    def title(self, file: Path) -> str:
        """The title line of the spec, with the source of the task."""
        by = f", by {', '.join(self.task.authors)}" if any(self.task.authors) else ""
        return f"Task {self.task.id} of CoBRA{by}, imported from {file.name}."

    def blocks(self) -> list[str]:
        """The blocks of the floor, the grammar, the workspace and the task."""
        rules = rules_of(self.task, self.remarks, accel=self.carried.accel)
        obstacles, avoided, points = self._obstacles(rules)
        base = self._base()
        bounds = self._bounds(points, base)
        sets = RegionSets(bounds, self.remarks, self.write)
        goals = goal_clauses(self.task, sets, self.names, any_order=self.options.any_order)
        kept = self._kept(goals, sets)
        called = _title(self.task)
        floor = Names(self.carried.listed).name("Floor")
        grammar = Names(self.carried.listed).camel(f"{called} Arms")
        carried = ", ".join(self.carried.listed)
        return [
            floor_module(floor, base, self.carried.ground, self.remarks),
            f"grammar {grammar} from ports {{ start {floor}; with {carried}; }}",
            self._workspace(called, sets.box(bounds), goals, obstacles),
            self._task(
                called, grammar, [*goals.lines, *kept, *avoid_clauses(rules, avoided)], goals
            ),
        ]

    # --- Surroundings -----------------------------------------------------------------------------

    def _obstacles(self, rules: Rules) -> tuple[list[str], list[str], list[NDArray[np.float64]]]:
        """Statements and names of obstacles, and points that the bounds have to contain."""
        lines, named, points = list[str](), list[str](), list[NDArray[np.float64]]()
        if not rules.obstacles:
            return lines, named, points
        for obstacle in self.task.obstacles:
            for each in obstacle_sets(obstacle, self.names, self.write):
                behind = f"  // {printable(each.comment)}" if each.comment else ""
                lines.append(f"obstacle {each.name} {each.text};{behind}")
                named.append(each.name)
                points.append(each.points)
            for called, statement, corners in self.meshes.statements(obstacle):
                lines.append(statement)
                named.append(called)
                points.append(corners)
        return lines, named, points

    def _base(self) -> ToleratedPose | None:
        found = [each.pose for each in self.task.constraints if each.kind == "basePlacement"]
        if len(found) > 1:
            self.remarks.append(f"{len(found)} base placements: the first one counts")
        if not found:
            self.remarks.append("the base may stand anywhere; here it stands at the origin")
        return found[0] if found else None

    def _bounds(
        self, points: Sequence[NDArray[np.float64]], base: ToleratedPose | None
    ) -> NDArray[np.float64]:
        """A box (3, 2) around the goals, the base and the given points."""
        poses = [pose.at for goal in self.task.goals for pose in goal.poses]
        places = [*poses, np.zeros(3) if base is None else base.at]
        every = np.vstack([*places, *points])
        low = np.floor((every.min(axis=0) - ROOM) * 2) / 2
        high = np.ceil((every.max(axis=0) + ROOM) * 2) / 2
        return np.column_stack([low, high])

    # --- The blocks -------------------------------------------------------------------------------

    def _workspace(self, called: str, bounds: str, goals: Clauses, obstacles: list[str]) -> str:
        target = _last_region(goals)
        lines = [f"workspace {called} {{", "space xyz;", f"bounds {bounds};  // a choice"]
        for name, text in goals.regions.items():
            lines.append(f"{'target' if name == target else 'region'} {name} {text};")
        return "\n".join([*lines, *obstacles, "}"])

    def _kept(self, goals: Clauses, sets: RegionSets) -> list[str]:
        """Formulas for conditions on the tool that hold at all times; adds their regions."""
        found = list[str]()
        for text, turned in tool_clauses(self.task.constraints, sets):
            name = self.names.name("Kept")
            goals.regions[name] = text
            found.append(f"satisfy always {name}{turned};")
        return found

    def _task(self, called: str, grammar: str, clauses: list[str], goals: Clauses) -> str:
        gravity = ", ".join(map(decimal_text, self.task.gravity))
        lines = [f"task {called} {{", f"robot {grammar};", f"workspace {called};", *clauses]
        lines += [
            f"effort <= {ENOUGH[kind]};  // a choice: a module has no bound"
            for kind in sorted(self.carried.unbounded)
        ]
        if any(self.task.gravity):
            lines.append(f"gravity ({gravity}) m/s^2;")
        lines += self._choices(goals)
        return "\n".join([*lines, "}"])

    def _choices(self, goals: Clauses) -> Iterator[str]:
        described = self.task.cost if self.options.cost is None else self.options.cost
        wanted = objectives(described, self.remarks)
        legs = max(goals.stops - 1, 1)
        steps = legs * STEPS_A_LEG + math.ceil(goals.least_time / STEP)
        most = "at most " if "time" in wanted else ""
        yield f"horizon {most}{steps} steps of {decimal_text(STEP)} s;  // a choice"
        yield f"modules <= {MOST_MODULES};  // a choice"
        if wanted:
            yield f"minimize {' then '.join(wanted)};"


def _title(task: TaskData) -> str:
    """The name of the workspace and the task."""
    called = Names().camel(task.name or task.id.rpartition("/")[2])
    return called if called[:1].isalpha() else f"Task{called.lstrip('_')}"


def _last_region(goals: Clauses) -> str:
    """The region that is reached last, empty if there is none."""
    reached = [line.split()[1].rstrip(";") for line in goals.lines if line.startswith("reach ")]
    return reached[-1] if reached else ""
