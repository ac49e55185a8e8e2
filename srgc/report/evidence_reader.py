"""From a result folder to the evidence of its report.

The folder is refused where ``srgc why`` and ``srgc export`` refuse it.  What can be read of it is
reported, whatever the verifier says: the page then says that, too.
"""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from compiler.tasks.obstacle_pieces import expanded
from compiler.workspaces.abstraction import abstract
from compiler.workspaces.map_fault import MapFault
from solvers.explanation.conflict import Conflict
from solvers.explanation.explanation import foremost, quick_conflict
from solvers.run_context import RunContext
from solvers.verifier.claims.certificate import CertificateError, Claim, from_text
from solvers.verifier.claims.spec_copy import bounded_bytes, bounded_text, evidence_bytes, files_of
from solvers.verifier.proofs.enclosure import EnclosureFailure
from solvers.verifier.proofs.watch import UNWATCHED, Watch
from solvers.verifier.report import Outcome, Report
from solvers.verifier.verification import verify_directory
from srgc.faults import UsageFault
from srgc.report.evaluation_table import evaluations
from srgc.report.evidence import CoveringSize, Evidence
from srgc.report.structure_groups import GROUPS
from srgc.report.trajectory import planned_trajectory
from srgc.results.found_design import FoundDesign, found_design, found_record
from srgc.results.result_folder import json_object
from srgc.results.why_folder import TriedFolder, tried_folder

if TYPE_CHECKING:
    from solvers.verifier.certified_tube import CertifiedTube


def read_evidence(folder: Path, *, verify: bool, watch: Watch = UNWATCHED) -> Evidence:
    """All that the report of a result folder is made of.

    Args:
        folder: one that ``srgc synth`` has written, with any verdict.
        verify: whether to check the certificate again, and to enclose the motion.
        watch: told how far the check has come.

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
        _tube(folder, report) if found is not None else None,
        report,
        quick_conflicts(tried) if verify else (),
        evaluations(folder / "evaluations.csv"),
        evaluations(folder / "landscape.csv"),
        pareto,
        json_object(folder / "log.json", needed=False),
        _coverings(folder, design),
        _digests(folder),
    )


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
    """The certificate; none after ``unknown``, and none that cannot be read."""
    if found is not None:
        return found.claim
    try:
        return from_text(bounded_text(folder / "certificate.json"))
    except (OSError, UnicodeDecodeError, CertificateError):
        return None  # the verifier says which of these it is


def _tube(folder: Path, report: Report | None) -> CertifiedTube | None:
    """The enclosure of a motion that is proved; it takes as long as the proof."""
    if report is None or report.outcome is not Outcome.VALID:
        return None
    from solvers.verifier.certified_tube import certified_tube

    try:
        return certified_tube(folder)
    except EnclosureFailure:
        return None  # the proof went through with another subdivision of the motion


# --- files beside the certificate -----------------------------------------------------------------


def quick_conflicts(folder: TriedFolder) -> tuple[Conflict, ...]:
    """The conflict of one refuted robot, or of all of them, of a folder that says impossible.

    None is sought where poses of whole bodies are asked for, which takes seconds.
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
    """Raise unless ``design.json`` says what was tried as ``srgc synth`` does.

    What the certificate determines is held against it elsewhere.

    Raises:
        UsageFault: it does not.
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
    """The same for ``pareto.json``, which may be empty.

    Raises:
        UsageFault: it is not what ``srgc synth`` writes.
    """
    if not all(_all(content.get(name, []), _is_design) for name in ("designs", "dominated")):
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
    """Whether the robot that a structure is again was tried before, itself no repetition."""
    same = tried[number].get("same_robot_as")
    if same is None:
        return True
    return isinstance(same, int) and 0 <= same < number and tried[same].get("same_robot_as") is None


def _is_counterexample(one: Mapping[str, Any]) -> bool:
    return (
        isinstance(one.get("structure"), int)
        and _is_word(one.get("cells"))
        and all(
            each is None or _is_number(each) for each in (one.get("time"), one.get("robustness"))
        )
    )


def _is_formula(one: Mapping[str, Any]) -> bool:
    value = one.get("robustness")
    return value is None or _is_number(value)


def _is_design(one: Mapping[str, Any]) -> bool:
    return (
        all(_is_number(one.get(name)) for name in ("structure", "modules", "total_length"))
        and _is_number(one.get("robustness"))
        and _is_word(one.get("word"))
        and isinstance(one.get("folder"), str)
    )


def _is_word(word: Any) -> bool:
    return isinstance(word, list) and all(isinstance(each, str) for each in word)


def _is_number(value: Any) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool)


HEADER = "boxes 1\n"


def covering_size(folder: Path, name: str) -> CoveringSize | None:
    """The size of the covering in a file of a result folder; None where there is none."""
    try:
        content = evidence_bytes(folder, name).decode("ascii")
    except (OSError, UnicodeDecodeError):
        return None
    if not content.startswith(HEADER):
        return None
    tree = content.removeprefix(HEADER)
    drives = tree.count("!")
    return CoveringSize(tree.count("|") + drives, tree.count("."), drives)
