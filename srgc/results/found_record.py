"""What ``design.json`` says of a found design beside its certificate, held against that."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

from compiler.tasks.obstacle_pieces import expanded
from compiler.workspaces.abstraction import Abstraction, abstract
from compiler.workspaces.map_fault import MapFault
from compiler.workspaces.refinement import Cut
from grammar_lang import ir
from solvers.verifier.claims.certificate import CertificateError, exact_cuts
from solvers.verifier.claims.design_agreement import disagreement
from srgc.results.found_design import FoundDesign
from srgc.results.json_object import json_object
from srgc.session import UsageFault
from srgc.version import VERSION


@dataclass(frozen=True, slots=True)
class FoundRecord:
    """How a design was found.

    ``structure`` is its number among those tried, ``leader`` the effector that followed its cell
    path, ``robustness`` its rho; ``cells`` are those that the path names.
    """

    seed: int
    structure: int
    leader: int
    robustness: float
    cells: Abstraction


def found_record(folder: Path, found: FoundDesign) -> FoundRecord:
    """What ``design.json`` in a result folder says.

    Raises:
        UsageFault: there is none, it is of another version, or it and the certificate differ.
    """
    content = json_object(folder / "design.json")
    ours, theirs = VERSION, content.get("version")
    if theirs != ours:
        raise UsageFault(
            f"{folder} holds results of srgc {theirs}; this is {ours}: run `srgc synth` again"
        )
    try:
        program, task = expanded(found.program, found.task)
        cells = _cells(found, program, task)
        reason = disagreement(folder, found.claim, program, task, cells, found.model)
    except (CertificateError, MapFault, ValueError) as error:
        raise UsageFault(f"{folder}: {error}") from None
    if reason is not None:
        raise UsageFault(f"{folder}: {reason}")
    return _record(folder, content, cells, len(found.model.effectors))


def _cells(found: FoundDesign, program: ir.Program, task: ir.Task) -> Abstraction:
    """The cells of the claim: those of the workspace, cut as it says."""
    cuts = [Cut(cell, half_space) for cell, half_space in exact_cuts(found.claim.cuts)]
    return abstract(program.workspaces[task.workspace]).cut(cuts)


def _record(
    folder: Path, content: dict[str, Any], cells: Abstraction, effectors: int
) -> FoundRecord:
    try:
        verdicts = [each["verdict"] for each in content["structures_tried"]]
        record = FoundRecord(
            int(content["seed"]),
            verdicts.index("found"),
            int(content["leader"]),
            float(content["robustness"]),
            cells,
        )
    except (KeyError, TypeError, ValueError):
        record = None
    if record is None or not 0 <= record.leader < effectors or record.seed < 0:
        raise UsageFault(f"{folder / 'design.json'} does not say how the design was found")
    return record
