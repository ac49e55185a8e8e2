"""The evidence for the page about a mission."""

from __future__ import annotations

import hashlib
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path
from typing import Any

from solvers.verdict import MISSION
from solvers.verifier.claims.lemma_claims import VariantClaim, WeightsClaim
from solvers.verifier.claims.mission_claim import LeafClaim, MissionClaim, TreeClaim
from solvers.verifier.claims.spec_copy import bounded_bytes, files_of
from solvers.verifier.missions.mission_check import MissionReport, verify_mission
from solvers.verifier.proofs.scene import UNWATCHED, Watch
from srgc.report.evidence import CoveringSize, Evidence, covering_size, judged, read_evidence
from srgc.report.missions.line_of_robots import StandingRobot, line_of_robots
from srgc.results.found_design import found_design
from srgc.results.mission_folder import MissionFolder, mission_folder
from srgc.results.mission_refusal import is_mission_folder
from srgc.results.result_folder import json_object


@dataclass(frozen=True, slots=True)
class EarlierRobot:
    """A robot of the history, for a task; ``cost`` is the cost of the changes before it, if any."""

    number: int
    task: str
    spec: str
    word: tuple[str, ...]
    values: tuple[str, ...]
    cost: Fraction | None


@dataclass(frozen=True, slots=True)
class TaskCoverings:
    """The number of coverings of a task, and their total size."""

    coverings: int
    size: CoveringSize


@dataclass(frozen=True, slots=True)
class MissionEvidence:
    """A folder of a mission as its page needs it.

    Attributes:
        mission: the content of the folder.
        tasks: the evidence about each design, in the order of the tasks; empty without robots.
        line: the robots in order, equal successive ones merged, after the existing robot.
        report: the verifier's present report on the folder; None if it was not asked.
        coverings: the coverings that refute robots, by the name of the task.
        earlier: the robots of the history, the oldest first.
        files: the files of the spec by their paths.
        log: ``log.json``, empty if there is none.
        digests: SHA-256 of ``design.json`` and ``mission.json``.
    """

    mission: MissionFolder
    tasks: tuple[Evidence, ...]
    line: tuple[StandingRobot, ...]
    report: MissionReport | None
    coverings: Mapping[str, TaskCoverings]
    earlier: tuple[EarlierRobot, ...]
    files: Mapping[str, bytes]
    log: Mapping[str, Any]
    digests: Mapping[str, str]


def read_mission_evidence(
    folder: Path, *, verify: bool, watch: Watch = UNWATCHED
) -> MissionEvidence:
    """Read the evidence for the page about a mission.

    Args:
        folder: a folder that ``srgc synth --mission`` or ``srgc evolve`` has written, with any
            verdict.
        verify: whether to check its claim again, and to enclose the motions.
        watch: told about the progress of the check.

    Raises:
        UsageFault: there are no results of a mission, or they or the spec have been altered.
    """
    mission = mission_folder(folder)
    report = verify_mission(folder, watch=watch) if verify and mission.claim is not None else None
    checked = {} if report is None else dict(report.tasks)
    tasks = tuple(
        judged(read_evidence(mission.of_task(name), verify=False), checked.get(name))
        for name, _ in zip(mission.mission.tasks, mission.robots, strict=False)
    )
    paths = (folder / "design.json", folder / MISSION)
    return MissionEvidence(
        mission,
        tasks,
        line_of_robots(mission),
        report,
        {} if mission.claim is None else _coverings(folder, mission.claim),
        tuple(_earlier(folder)),
        files_of(mission.program.sources),
        json_object(folder / "log.json", needed=False),
        {
            path.name: hashlib.sha256(bounded_bytes(path)).hexdigest()
            for path in paths
            if path.is_file()
        },
    )


def _coverings(folder: Path, claim: MissionClaim) -> dict[str, TaskCoverings]:
    """The sizes of the coverings of each task that exist."""
    names: dict[str, dict[str, None]] = {}
    for task in claim.tasks:
        known = names.setdefault(task.task, {})
        known.update((each.boxes, None) for each in task.structures if each.boxes is not None)
        for lemma in task.lemmas:
            if isinstance(lemma, VariantClaim | WeightsClaim) and lemma.boxes is not None:
                known[lemma.boxes] = None
    for boxes in claim.boxes:
        for leaf in _leaves(boxes.tree):
            if 0 <= leaf.task < len(claim.tasks):
                names[claim.tasks[leaf.task].task][leaf.boxes] = None
    return {task: _sizes(folder, known) for task, known in names.items()}


def _sizes(folder: Path, names: Mapping[str, None]) -> TaskCoverings:
    found = [size for name in names if (size := covering_size(folder, name)) is not None]
    return TaskCoverings(
        len(found),
        CoveringSize(
            sum(size.parameters for size in found),
            sum(size.coordinates for size in found),
            sum(size.by_drives for size in found),
        ),
    )


def _leaves(tree: TreeClaim) -> Iterator[LeafClaim]:
    if isinstance(tree, LeafClaim):
        yield tree
    elif tree is not None:
        for part in tree.parts:
            yield from _leaves(part)


# --- The history of an evolved result -------------------------------------------------------------


def _earlier(folder: Path) -> Iterator[EarlierRobot]:
    """The robots of the results in ``history``, with all robots of each result."""
    top = folder / "history"
    numbers = sorted(int(path.name) for path in top.glob("*") if path.name.isdecimal())
    for number in numbers:
        place = top / str(number)
        if not is_mission_folder(place):
            yield _of_design(place, number, None)
            continue
        mission = mission_folder(place)
        for task, step in zip(mission.mission.tasks, mission.steps, strict=False):
            cost = None if step is None else step.cost
            yield _of_design(mission.of_task(task), number, cost)


def _of_design(folder: Path, number: int, cost: Fraction | None) -> EarlierRobot:
    found = found_design(folder)
    values = tuple(
        f"{value.parameter.module}.{value.parameter.name} = {float(value):.5g} "
        f"{value.parameter.unit}"
        for value in found.parameters
    )
    claim = found.claim
    return EarlierRobot(number, claim.task, claim.spec, claim.word, values, cost)
