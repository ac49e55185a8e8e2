"""From a result folder to the evidence of its report.

The folder is refused where ``srgc why`` and ``srgc export`` refuse it.  What can be read of it is
reported, whatever the verifier says: the page then says that, too.
"""

from __future__ import annotations

import hashlib
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from compiler.geometry.abstraction import abstract
from compiler.maps.map_fault import MapFault
from compiler.maps.obstacle_pieces import expanded
from solvers.verifier.claims.bounded_file import bounded_bytes, bounded_text
from solvers.verifier.claims.certificate import CertificateError, Claim, from_text
from solvers.verifier.claims.outcome import Outcome
from solvers.verifier.claims.spec_copy import files_of
from solvers.verifier.proofs.enclosure import EnclosureFailure
from solvers.verifier.proofs.watch import UNWATCHED, Watch
from solvers.verifier.report import Report
from solvers.verifier.verification import verify_directory
from srgc.faults import UsageFault
from srgc.report.covering_size import CoveringSize, covering_size
from srgc.report.design_record import checked_design, checked_designs
from srgc.report.evaluation_table import evaluations
from srgc.report.evidence import Evidence
from srgc.report.planned_trajectory import planned_trajectory
from srgc.report.quick_conflicts import quick_conflicts
from srgc.results.found_design import FoundDesign, found_design
from srgc.results.found_record import found_record
from srgc.results.json_object import json_object
from srgc.results.why_folder import tried_folder

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
