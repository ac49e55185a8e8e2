"""All that a report is made of: what a result folder holds, and what is proved of it now."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from compiler.workspaces.abstraction import Abstraction
from grammar_lang import ir
from solvers.explanation.conflict import Conflict
from solvers.verifier.claims.certificate import Claim
from solvers.verifier.report import Report
from srgc.report.evaluation_table import Evaluation
from srgc.report.trajectory import Trajectory
from srgc.results.found_design import FoundDesign, FoundRecord

if TYPE_CHECKING:
    from solvers.verifier.certified_tube import CertifiedTube


@dataclass(frozen=True, slots=True)
class CoveringSize:
    """``parameters`` boxes of parameters, with ``coordinates`` boxes of coordinates in all.

    ``by_drives`` of the former are refuted by what the drives can do, the others by poses alone.
    """

    parameters: int
    coordinates: int
    by_drives: int


@dataclass(frozen=True, slots=True)
class Evidence:
    """A result folder as a report needs it.

    Attributes:
        folder: where it is.
        design: ``design.json``, whose fields docs/reference/results.md lists.
        program: the program of the folder's copy of the spec, as written.
        task: the task of it, as written.
        workspace: the workspace of the task, maps of obstacles as regions.
        cells: the cells of that workspace; of a design with the cuts that its path needs.
        files: the files of the spec by their paths; ``design["spec"]`` is the main one.
        claim: the certificate; None where there is none (unknown).
        found: the design; None unless the verdict is ``found``.  ``found.program`` and
            ``found.task`` are as written, too.
        record: how the design was found; None together with ``found``.
        trajectory: its sampled motion, by the certificate; None together with ``found``.
        tube: the enclosure of its motion; None without a design, where it was not computed, or
            where that failed.
        report: what the verifier says of the folder now; None where it was not asked.
        conflicts: which lines of the spec rule robots out, found after ``impossible`` where that
            is quick.
        evaluations: what the search of parameters evaluated, in order.
        landscape: the grid of ``srgc landscape``, where there is one.
        pareto: ``pareto.json`` of ``synth --all``, else empty.
        log: ``log.json``, empty where there is none.
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
    tube: CertifiedTube | None
    report: Report | None
    conflicts: tuple[Conflict, ...]
    evaluations: tuple[Evaluation, ...]
    landscape: tuple[Evaluation, ...]
    pareto: Mapping[str, Any]
    log: Mapping[str, Any]
    coverings: Mapping[str, CoveringSize]
    digests: Mapping[str, str]

    @property
    def verdict(self) -> str:
        """``found``, ``impossible`` or ``unknown``, as the folder says."""
        return str(self.design["verdict"])
