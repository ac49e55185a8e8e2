"""The evidence of a report: the content of a result folder, and what is proved about it now."""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from compiler.tasks.obstacle_pieces import expanded
from compiler.workspaces.abstraction import Abstraction, abstract
from compiler.workspaces.map_header import MapFault
from grammar_lang import ir
from solvers.explanation.conflict import Conflict
from solvers.explanation.explanation import foremost, quick_conflict
from solvers.run_context import RunContext
from solvers.verifier.claims.certificate import CertificateError, Claim, from_text
from solvers.verifier.claims.spec_copy import bounded_bytes, bounded_text, evidence_bytes, files_of
from solvers.verifier.proofs.enclosure import EnclosureFailure
from solvers.verifier.proofs.scene import UNWATCHED, Watch
from solvers.verifier.report import Outcome, Report
from solvers.verifier.verification import verify_directory
from srgc.faults import UsageFault
from srgc.report.front_motions import FrontMotion, front_motions
from srgc.report.nearest_robot import NearestRobot, nearest_robot
from srgc.report.tables import Evaluation, Trajectory, evaluations, planned_trajectory
from srgc.results.found_design import FoundDesign, FoundRecord, found_design, found_record
from srgc.results.result_folder import json_object
from srgc.results.stated_objectives import Objective, stated_objectives
from srgc.results.why_folder import TriedFolder, tried_folder

if TYPE_CHECKING:
    from solvers.verifier.certified_tube import CertifiedTube


@dataclass(frozen=True, slots=True)
class CoveringSize:
    """The number of boxes of ``parameters`` in a covering, and of ``coordinates`` in all of them.

    ``by_drives`` of the former are refuted by the limits of the drives, the others by poses alone.
    """

    parameters: int
    coordinates: int
    by_drives: int


@dataclass(frozen=True, slots=True)
class Evidence:
    """A result folder as a report needs it.

    Attributes:
        folder: its path.
        design: ``design.json``, whose fields docs/reference/results.md lists.
        program: the program of the folder's copy of the spec, as written.
        task: its task, as written.
        workspace: the workspace of the task, with maps of obstacles as regions.
        cells: the cells of that workspace; for a design, with the cuts that its path needs.
        files: the files of the spec by their paths; ``design["spec"]`` is the main one.
        claim: the certificate; None if there is none (unknown).
        found: the design; None unless the verdict is ``found``.  ``found.program`` is as written;
            so is ``found.task``, but for the number of steps, which is that of the motion.
        record: how the design was found; None if ``found`` is None.
        trajectory: its sampled motion, from the certificate; None if ``found`` is None.
        nearest: after ``unknown``, the motion that came nearest to a design, if it was kept.
        tube: the enclosure of its motion; None without a design, if it was not computed, or if
            that failed.
        report: the verifier's present report on the folder; None if it was not asked.
        conflicts: the lines of the spec that rule robots out, after ``impossible`` if they can be
            found quickly.
        evaluations: the evaluations of the parameter search, in order.
        landscape: the grid of ``srgc landscape``, if there is one.
        pareto: ``pareto.json`` of ``synth --all``, else empty.
        objectives: the statements of ``design.json`` about the objectives of the task.
        front: for a task with objectives, the motions of the designs that no other dominates.
        log: ``log.json``, empty if there is none.
        coverings: the sizes of ``proofs/NNNN.boxes`` by their paths.
        digests: SHA-256 of ``design.json`` and ``certificate.json``.
    """

    folder: Path
    design: Mapping[str, Any]
    program: ir.Program
    task: ir.Task
    workspace: ir.Workspace
    cells: Abstraction
    files: Mapping[str, bytes]
    claim: Claim | None
    found: FoundDesign | None
    record: FoundRecord | None
    trajectory: Trajectory | None
    nearest: NearestRobot | None
    tube: CertifiedTube | None
    report: Report | None
    conflicts: tuple[Conflict, ...]
    evaluations: tuple[Evaluation, ...]
    landscape: tuple[Evaluation, ...]
    pareto: Mapping[str, Any]
    objectives: tuple[Objective, ...]
    front: tuple[FrontMotion, ...]
    log: Mapping[str, Any]
    coverings: Mapping[str, CoveringSize]
    digests: Mapping[str, str]

    @property
    def verdict(self) -> str:
        """``found``, ``impossible`` or ``unknown``, according to the folder."""
        return str(self.design["verdict"])


# --- The structures that were tried, equal robots together ----------------------------------------


GROUPS = ("found", "unresolved", "inadmissible", "refuted")
"""Verdicts in the order in which they are shown."""


@dataclass(frozen=True, slots=True)
class TriedRobot:
    """A robot that was tried: its first structure, and the structures with the same robot.

    ``evidence`` is a file, or the reason if there is no file; ``reason`` may be empty.
    """

    number: int
    word: tuple[str, ...]
    verdict: str
    evidence: str
    reason: str
    boxes: str | None
    equal: tuple[tuple[int, tuple[str, ...]], ...]


def tried_robots(design: Mapping[str, Any]) -> tuple[TriedRobot, ...]:
    """The distinct robots of ``design.json``, in order."""
    tried = design["structures_tried"]
    equal: dict[int, list[tuple[int, tuple[str, ...]]]] = {}
    for number, one in enumerate(tried):
        if one["same_robot_as"] is not None:
            equal.setdefault(one["same_robot_as"], []).append((number, tuple(one["word"])))
    return tuple(
        TriedRobot(
            number,
            tuple(one["word"]),
            str(one["verdict"]),
            str(one["evidence"]),
            str(one.get("reason", "")),
            one["boxes"],
            tuple(equal.get(number, ())),
        )
        for number, one in enumerate(tried)
        if one["same_robot_as"] is None
    )


# --- From a result folder to the evidence of its report -------------------------------------------
#
# A folder is refused in the same cases as by ``srgc why`` and ``srgc export``.  Everything that can
# be read is reported, whatever the verifier's answer, which the page states.


def read_evidence(folder: Path, *, verify: bool, watch: Watch = UNWATCHED) -> Evidence:
    """Read the evidence for the report of a result folder.

    Args:
        folder: a folder that ``srgc synth`` has written, with any verdict.
        verify: whether to check the certificate again, and to enclose the motion.
        watch: told about the progress of the check.

    Raises:
        UsageFault: there are no results, or they or the spec have been altered.
    """
    tried = tried_folder(folder)
    posed = tried.posed
    design = json_object(folder / "design.json")
    checked_design(design, folder / "design.json")
    try:
        program, task = expanded(posed.program, posed.task)
        workspace = program.workspaces[task.workspace]
        cells = abstract(workspace)
    except (MapFault, ValueError) as error:
        raise UsageFault(f"{folder}: {error}") from None
    found = found_design(folder) if design["verdict"] == "found" else None
    record = trajectory = None
    if found is not None:
        record = found_record(folder, found)
        cells = record.cells
        trajectory = planned_trajectory(found)
    kept = None
    if design["verdict"] == "unknown":
        kept = nearest_robot(folder, design, posed.program, posed.task)
    pareto = json_object(folder / "pareto.json", needed=False)
    checked_designs(pareto, folder / "pareto.json")
    report = verify_directory(folder, watch=watch) if verify else None
    return Evidence(
        folder,
        design,
        posed.program,
        posed.task,
        workspace,
        cells,
        files_of(posed.program.sources),
        _claim(folder, found),
        found,
        record,
        trajectory,
        kept,
        _tube(folder, report) if found is not None else None,
        report,
        quick_conflicts(tried) if verify else (),
        evaluations(folder / "evaluations.csv"),
        evaluations(folder / "landscape.csv"),
        pareto,
        stated_objectives(design, folder / "design.json"),
        front_motions(folder, pareto),
        json_object(folder / "log.json", needed=False),
        _coverings(folder, design),
        _digests(folder),
    )


def judged(evidence: Evidence, report: Report | None) -> Evidence:
    """Evidence that was read without a check, completed by the verifier's report on its folder."""
    return replace(evidence, report=report, tube=_tube(evidence.folder, report))


def _coverings(folder: Path, design: Mapping[str, Any]) -> dict[str, CoveringSize]:
    names = dict.fromkeys(each["boxes"] for each in design["structures_tried"] if each["boxes"])
    sizes = {name: covering_size(folder, name) for name in names}
    return {name: size for name, size in sizes.items() if size is not None}


def _digests(folder: Path) -> dict[str, str]:
    paths = (folder / "design.json", folder / "certificate.json")
    return {
        path.name: hashlib.sha256(bounded_bytes(path)).hexdigest()
        for path in paths
        if path.is_file()
    }


def _claim(folder: Path, found: FoundDesign | None) -> Claim | None:
    """The certificate; None after ``unknown``, or if it cannot be read."""
    if found is not None:
        return found.claim
    try:
        return from_text(bounded_text(folder / "certificate.json"))
    except (OSError, UnicodeDecodeError, CertificateError):
        return None  # the verifier says which of these it is


def _tube(folder: Path, report: Report | None) -> CertifiedTube | None:
    """The enclosure of a motion that is proved; computing it takes as long as the proof."""
    if report is None or report.outcome is not Outcome.VALID:
        return None
    from solvers.verifier.certified_tube import certified_tube

    try:
        return certified_tube(folder)
    except EnclosureFailure:
        return None  # the proof succeeded with another subdivision of the motion


# --- Files next to the certificate ----------------------------------------------------------------


def quick_conflicts(folder: TriedFolder) -> tuple[Conflict, ...]:
    """The conflict of one refuted robot, or of all, in a folder with the verdict impossible.

    No conflict is sought if the task constrains whole bodies, because that takes seconds.
    """
    tried, task = folder.tried, folder.posed.task
    if tried is None or tried.verdict != "impossible":
        return ()
    refuted = tried.refuted
    if refuted and (task.bounds_body or any(clause.subject == "body" for clause in task.avoid)):
        return ()
    first = foremost(folder.posed, refuted) if refuted else None
    return quick_conflict(folder.posed, first, RunContext(folder.seed)).conflicts.found


def checked_design(design: Mapping[str, Any], path: Path) -> None:
    """Refuse a ``design.json`` that does not have the form that ``srgc synth`` writes.

    Whatever the certificate determines is compared with it elsewhere.

    Raises:
        UsageFault: it has another form.
    """
    tried = design.get("structures_tried")
    if not (
        isinstance(tried, list)
        and _all(tried, _is_structure)
        and all(_follows(tried, number) for number in range(len(tried)))
        and _all(design.get("counterexamples", []), _is_counterexample)
        and isinstance(design.get("iterations"), dict)
        and all(isinstance(each, int) for each in design["iterations"].values())
        and _all(design.get("satisfy"), _is_formula)
    ):
        raise UsageFault(f"{path} is not what `srgc synth` writes")


def checked_designs(content: Mapping[str, Any], path: Path) -> None:
    """Refuse a ``pareto.json`` of another form than ``srgc synth`` writes; it may be empty.

    Raises:
        UsageFault: it has another form.
    """
    values = None
    if "units" in content:
        names, units = content.get("objectives", []), content["units"]
        words = _is_word(names) and _is_word(units) and len(names) == len(units) > 0
        if not words or not isinstance(content.get("chosen"), int):
            raise UsageFault(f"{path} is not what `srgc synth` writes")
        values = len(units)
    groups = (content.get(name, []) for name in ("designs", "dominated"))
    if not all(_all(group, lambda one: _is_design(one, values)) for group in groups):
        raise UsageFault(f"{path} is not what `srgc synth` writes")


def _all(items: Any, right: Callable[[Any], bool]) -> bool:
    return isinstance(items, list) and all(isinstance(e, dict) and right(e) for e in items)


def _is_structure(one: Mapping[str, Any]) -> bool:
    return (
        _is_word(one.get("word"))
        and one.get("verdict") in GROUPS
        and isinstance(one.get("evidence"), str)
        and (one.get("boxes") is None or isinstance(one["boxes"], str))
        and isinstance(one.get("reason", ""), str)
    )


def _follows(tried: Sequence[Mapping[str, Any]], number: int) -> bool:
    """Whether the structure with the same robot comes earlier and is not itself a repetition."""
    same = tried[number].get("same_robot_as")
    if same is None:
        return True
    return isinstance(same, int) and 0 <= same < number and tried[same].get("same_robot_as") is None


def _is_counterexample(one: Mapping[str, Any]) -> bool:
    return (
        isinstance(one.get("structure"), int)
        and _is_word(one.get("cells"))
        and isinstance(one.get("ordered", True), bool)
        and all(isinstance(one.get(name, 0), int) for name in ("of", "deferred"))
        and all(
            each is None or _is_number(each) for each in (one.get("time"), one.get("robustness"))
        )
    )


def _is_formula(one: Mapping[str, Any]) -> bool:
    value = one.get("robustness")
    return value is None or _is_number(value)


def _is_design(one: Mapping[str, Any], values: int | None) -> bool:
    """Whether an entry has ``values`` values in a list or, for None, the usual ones by name."""
    listed: Any = one.get("values")
    if values is None:
        listed = [one.get(name) for name in ("modules", "total_length", "robustness")]
    return (
        isinstance(listed, list)
        and len(listed) == (values or 3)
        and all(map(_is_number, listed))
        and isinstance(one.get("structure"), int)
        and isinstance(one.get("dominated_by", 0), int)
        and _is_word(one.get("word"))
        and isinstance(one.get("folder", 0), str | None)
    )


def _is_word(word: Any) -> bool:
    return isinstance(word, list) and all(isinstance(each, str) for each in word)


def _is_number(value: Any) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool)


HEADER = "boxes 1\n"


def covering_size(folder: Path, name: str) -> CoveringSize | None:
    """The size of the covering in a file of a result folder; None if there is no covering."""
    try:
        content = evidence_bytes(folder, name).decode("ascii")
    except (OSError, UnicodeDecodeError):
        return None
    if not content.startswith(HEADER):
        return None
    tree = content.removeprefix(HEADER)
    drives = tree.count("!")
    return CoveringSize(tree.count("|") + drives, tree.count("."), drives)
