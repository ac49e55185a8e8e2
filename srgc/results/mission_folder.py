"""Reads the folder of a mission: its claim, its robots, and the changes between them.

Whatever the certificates determine is computed from them; ``design.json`` has to agree.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from math import isclose, isfinite
from pathlib import Path
from typing import Any

from compiler.expressions.exact_numbers import exact_text, rational_bounds
from compiler.missions.parameter_ranges import Range, Ranges, single
from compiler.missions.robot_changes import Built, Changes, built, built_of, changes
from compiler.workspaces.map_header import MapFault
from grammar_lang import ir
from solvers.verdict import MISSION
from solvers.verifier.claims.certificate import CertificateError, exact
from solvers.verifier.claims.mission_claim import MissionClaim, mission_from_text
from solvers.verifier.claims.spec_copy import bounded_text, read_copy
from solvers.verifier.missions.robot_before import posed_mission
from srgc.faults import UsageFault
from srgc.paths import no_folder
from srgc.results.folder_writer import refuse_links
from srgc.results.found_design import FoundDesign, found_design
from srgc.results.lost_file import no_design
from srgc.results.mission_files import change_entry
from srgc.results.result_folder import json_object
from srgc.results.undecided_robots import StatedUndecided, stated_undecided
from srgc.version import VERSION

Word = tuple[str, ...]
FROM = "from"
"""The source of a robot that the first task names by ``from``."""


@dataclass(frozen=True, slots=True)
class RobotBefore:
    """The existing robot before the first task; ``source``: ``from``, or the name of a folder.

    ``values`` maps symbol and name of each known parameter to the ranges of its value.
    """

    word: Word
    values: Mapping[tuple[int, str], Ranges]
    source: str


@dataclass(frozen=True, slots=True)
class TaskRefutations:
    """The refutations in one task, whatever happened in the others.

    ``reasons`` has each reason with the number of structures and the word of one of them; ``boxes``
    is the number of refuted parameter boxes of structures that are not refuted as a whole.
    """

    task: str
    structures: int
    lemmas: tuple[str, ...]
    boxes: int
    separated: bool
    reasons: tuple[tuple[str, int, Word], ...]


@dataclass(frozen=True, slots=True)
class MissionFolder:
    """A result folder of a mission.

    Attributes:
        folder: its path.
        design: the content of its ``design.json``.
        claim: the claim in its ``mission.json``; None if the verdict is unknown.
        program: the program of the folder's copy of the spec.
        mission: the mission, or the mission of one step from an existing robot.
        robots: the designs of its tasks in order; empty unless the verdict is found.
        before: the existing robot before the first task, if any.
        steps: the changes before each task; None before the first one without an existing robot.
        refuted: the refutations in each task.
        undecided: the robots that are neither found nor refuted, grouped by reason.
    """

    folder: Path
    design: Mapping[str, Any]
    claim: MissionClaim | None
    program: ir.Program
    mission: ir.Mission
    robots: tuple[FoundDesign, ...]
    before: RobotBefore | None
    steps: tuple[Changes | None, ...]
    refuted: tuple[TaskRefutations, ...]
    undecided: tuple[StatedUndecided, ...] = ()

    @property
    def verdict(self) -> str:
        """``found``, ``impossible`` or ``unknown``."""
        return str(self.design["verdict"])

    @property
    def cost(self) -> Fraction | None:
        """The total cost of the changes; None without robots, and for a mission with one robot."""
        if self.verdict != "found" or self.mission.prices is None:
            return None
        return sum((step.cost for step in self.steps if step is not None), Fraction(0))

    @property
    def least(self) -> Fraction | None:
        """The cost below which no robots are claimed to exist; None whenever ``cost`` is None."""
        if self.cost is None or self.claim is None or self.claim.least is None:
            return None
        return exact(self.claim.least)

    @property
    def evolved(self) -> bool:
        """Whether it is one step from the robot of another result."""
        return self.claim.posed is not None if self.claim else self.design.get("history", 0) > 0

    def of_task(self, task: str) -> Path:
        """The folder of the design for a task."""
        return self.folder / "tasks" / task


def mission_folder(folder: Path) -> MissionFolder:
    """Read the folder of a mission.

    Raises:
        UsageFault: it has no results of a mission, or they or the spec have been altered.
    """
    if not folder.is_dir():
        raise no_folder(folder)
    refuse_links(folder)
    path = folder / "design.json"
    if not path.exists():
        raise no_design(folder)
    design = {"differs": []} | json_object(path)  # missing in earlier results
    try:
        return _read(folder, design)
    except OSError as error:
        raise UsageFault(f"{folder}: the results cannot be read: {error.strerror}") from None
    except UnicodeDecodeError:
        raise UsageFault(f"{folder}: the claim of the mission is not UTF-8") from None
    except (CertificateError, MapFault) as error:
        raise UsageFault(f"{folder}: {error}") from None
    except (ArithmeticError, ValueError, LookupError, TypeError, AttributeError):
        raise UsageFault(f"{path} is not what `srgc synth --mission` writes") from None


def _read(folder: Path, design: Mapping[str, Any]) -> MissionFolder:
    if design["version"] != VERSION:
        raise UsageFault(
            f"{folder} holds results of srgc {design['version']}; this is {VERSION}: "
            "run `srgc synth` again"
        )
    claim = None
    if (folder / MISSION).is_file():
        claim = mission_from_text(bounded_text(folder / MISSION))
    if design["verdict"] not in ("found", "impossible", "unknown"):
        raise ValueError(design["verdict"])
    _check_texts(design)
    _check_alike(folder, design, claim)
    program, _ = read_copy(folder / "spec", design["spec"], design["spec_sha256"])
    mission = _mission(design, claim, program)
    before = _before(mission, design, claim, program)
    robots: tuple[FoundDesign, ...] = ()
    if claim is not None and claim.kind == "found":
        robots = tuple(found_design(folder / "tasks" / name) for name in mission.tasks)
        _check_same_spec(folder, claim, mission, robots)
    steps = _steps(mission, robots, before, program)
    refuted = tuple(map(_refuted, design["refuted"]))
    undecided = stated_undecided(design, mission.tasks)
    found = MissionFolder(
        folder, design, claim, program, mission, robots, before, steps, refuted, undecided
    )
    _check_robots(found)
    return found


def _check_texts(design: Mapping[str, Any]) -> None:
    """Check the types of entries that are displayed unchanged."""
    texts = ("mission", "task", "spec", "spec_sha256", "kind", "version")
    if not all(isinstance(design[name], str) for name in texts):
        raise TypeError(texts)
    if not isinstance(design["reason"], str | None) or not isinstance(design["iterations"], dict):
        raise TypeError("reason")
    for name in ("undecided", "history", "seed"):
        if not isinstance(design[name], int) or design[name] < 0:
            raise TypeError(name)
    for each in design["objectives"]:
        amounts = (each["value"], each["least"])
        if not all(isinstance(value, int | float) and isfinite(value) for value in amounts):
            raise TypeError(amounts)
        if not isinstance(each["objective"], str) or not isinstance(each["unit"], str):
            raise TypeError(each)
    for each in design["differs"]:
        for said in (each["module"], *each["what"]):
            _text(said)


def _check_alike(folder: Path, design: Mapping[str, Any], claim: MissionClaim | None) -> None:
    """Check that ``design.json`` and the claim agree.

    Raises:
        UsageFault: they differ, or one of them is missing.
    """
    if claim is None:
        if design["verdict"] != "unknown":
            raise UsageFault(f"{folder} has no {MISSION}, and its verdict is not unknown")
        return
    said = {
        "verdict": claim.kind, "mission": claim.mission, "spec": claim.spec,
        "spec_sha256": claim.spec_sha256, "cost": _double(claim.cost),
        "objectives": [
            (each.objective, _double(each.value), _double(each.least)) for each in claim.objectives
        ],
    }  # fmt: skip
    if claim.kind == "found":
        said["least"] = _double(claim.least)
    stated = dict(design) | {
        "objectives": [
            (each["objective"], each["value"], each["least"]) for each in design["objectives"]
        ]
    }
    for name, value in said.items():
        if stated[name] != value:
            raise UsageFault(f"{folder}: design.json and {MISSION} differ in `{name}`")


def _double(value: str | None) -> float | None:
    return None if value is None else float(exact(value))


def _mission(
    design: Mapping[str, Any], claim: MissionClaim | None, program: ir.Program
) -> ir.Mission:
    """The mission that the folder is about."""
    name = design["mission"]
    if claim is not None and claim.posed is not None:
        if name not in program.tasks:
            raise CertificateError(f"the spec has no task `{name}`")
        return posed_mission(name, claim.posed, program)
    if claim is None and design["existing"] is not None and design["history"]:
        # Only claims state prices; nothing about an unknown step is computed with them.
        return ir.Mission(program.tasks[name].name, (name,), ir.Prices())
    if name not in program.missions:
        raise CertificateError(f"the spec has no mission `{name}`")
    return program.missions[name]


def _before(
    mission: ir.Mission,
    design: Mapping[str, Any],
    claim: MissionClaim | None,
    program: ir.Program,
) -> RobotBefore | None:
    """The robot before the first task, from the claim or from the spec."""
    origin = program.tasks[mission.tasks[0]].origin
    if claim is not None and claim.posed is not None and claim.existing is not None:
        stated = claim.existing
        known = {(each.symbol, each.name): exact(each.value) for each in stated.parameters}
        return _known(stated.word, known, stated.source)
    if origin is not None and mission.prices is not None:
        values: dict[tuple[int, str], Ranges] = {
            (each.symbol, each.name): (Range(*rational_bounds(each.value)),)
            for each in origin.fixed
        }
        return RobotBefore(origin.word, values, FROM)
    existing = design["existing"]
    if claim is None and existing is not None:
        known = {
            (each["symbol"], each["name"]): exact(each["value"]) for each in existing["parameters"]
        }
        return _known(tuple(map(str, existing["word"])), known, str(existing["source"]))
    return None


def _known(word: Word, values: Mapping[tuple[int, str], Fraction], source: str) -> RobotBefore:
    return RobotBefore(word, {key: single(value) for key, value in values.items()}, source)


def _check_same_spec(
    folder: Path, claim: MissionClaim, mission: ir.Mission, robots: Sequence[FoundDesign]
) -> None:
    """Check that the designs are for the tasks of the mission, with this spec."""
    for name, found in zip(mission.tasks, robots, strict=True):
        theirs = found.claim.task, found.claim.spec, found.claim.spec_sha256
        if theirs != (name, claim.spec, claim.spec_sha256):
            raise UsageFault(f"{folder}: the design below tasks/{name} is about another task")


def _steps(
    mission: ir.Mission,
    robots: Sequence[FoundDesign],
    before: RobotBefore | None,
    program: ir.Program,
) -> tuple[Changes | None, ...]:
    """The changes before each task, computed from the certificates."""
    if mission.prices is None:
        return (None,) * len(robots)
    last: Built | None = None
    if before is not None:
        last = built(before.word, program.modules, before.values)
    found: list[Changes | None] = []
    for robot in robots:
        here = built_of(robot.derivation.word, program.modules, robot.parameters)
        found.append(None if last is None else changes(last, here, mission.prices, mission.free))
        last = here
    return tuple(found)


def _refuted(entry: Mapping[str, Any]) -> TaskRefutations:
    """The refutations in a task, as ``design.json`` counts them."""
    reasons = tuple(
        (_text(each["reason"]), _count(each["robots"]), tuple(map(_text, each["word"])))
        for each in entry["reasons"]
    )
    return TaskRefutations(
        _text(entry["task"]),
        _count(entry["structures"]),
        tuple(map(_text, entry["lemmas"])),
        _count(entry["boxes"]),
        bool(entry["separated"]),
        reasons,
    )


def _text(value: Any) -> str:
    if not isinstance(value, str):
        raise TypeError(value)
    return value


def _count(value: Any) -> int:
    if not isinstance(value, int) or value < 0:
        raise TypeError(value)
    return value


def _check_robots(found: MissionFolder) -> None:
    """Check that ``design.json`` describes the robots as their certificates do.

    Raises:
        UsageFault: it does not.
    """
    said = [
        {
            "task": name,
            "folder": f"tasks/{name}",
            "word": list(robot.derivation.word),
            "parameters": [value.describe() for value in robot.parameters],
            "changes": None if step is None else change_entry(step),
        }
        for name, robot, step in zip(found.mission.tasks, found.robots, found.steps, strict=False)
    ]
    stated = [
        {name: each[name] for name in each if name != "robustness"}
        for each in found.design["robots"]
    ]
    left = [each["robustness"] for each in found.design["robots"]]
    known = [float(exact(robot.claim.robustness)) for robot in found.robots]
    if stated != said or not all(map(isclose, left, known)):
        path = found.folder / "design.json"
        raise UsageFault(f"{path}: its robots are not those of the certificates")
    claim = found.claim
    if claim is not None and _double(claim.cost) != (
        None if found.cost is None else float(found.cost)
    ):
        raise UsageFault(
            f"{found.folder}: the changes cost {exact_text(found.cost or Fraction(0))}"
        )
    tasks = [each.task for each in found.refuted]
    if tasks and tasks != list(found.mission.tasks):
        raise UsageFault(f"{found.folder / 'design.json'} is about the tasks of another mission")
