"""The independent verifier: re-reads the spec, recomputes everything, believes no searcher.

It shares the compiler and the validated integration with the searchers, and nothing else.
"""

from __future__ import annotations

from pathlib import Path

from compiler.checks.supported import unsupported
from compiler.geometry.abstraction import Abstraction, abstract
from compiler.geometry.refinement import Cut
from compiler.maps.map_fault import MapFault
from compiler.maps.obstacle_pieces import expanded
from grammar_lang import ir
from solvers.verifier.claims.certificate import (
    CertificateError,
    Claim,
    FoundClaim,
    ImpossibleClaim,
    exact_cuts,
    from_text,
)
from solvers.verifier.claims.design_agreement import disagreement
from solvers.verifier.claims.formula_agreement import misstated_formula
from solvers.verifier.claims.outcome import Outcome, Refused
from solvers.verifier.claims.spec_copy import difference_from, read_copy
from solvers.verifier.found_check import check_found
from solvers.verifier.report import Report

__all__ = ["Outcome", "Report", "verify_directory"]


def verify_directory(folder: Path, spec: Path | None = None, trust: str | None = None) -> Report:
    """Check the certificate of a result folder.

    Args:
        folder: a folder written by ``srgc synth``.
        spec: a spec file the result must be about, besides its own copy.
        trust: ``"z3"`` runs refutation scripts again in a z3 process and believes its ``unsat``.
    """
    path = folder / "certificate.json"
    if not path.is_file():
        return Report(
            Outcome.UNDECIDED, None, None, f"there is no certificate in {folder}: nothing to verify"
        )
    try:
        claim = from_text(path.read_text(encoding="utf-8"))
        program = _spec_of(folder, claim, spec)
        return _judged(folder, claim, program, trust)
    except OSError as error:
        reason = f"the certificate cannot be read: {error.strerror}"
        return Report(Outcome.UNDECIDED, None, None, reason)
    except UnicodeDecodeError:
        return Report(Outcome.REFUTED, None, None, "the certificate is not UTF-8")
    except CertificateError as error:
        return Report(Outcome.REFUTED, None, None, str(error))
    except Refused as refusal:
        return Report(refusal.outcome, None, None, str(refusal))


def _spec_of(folder: Path, claim: Claim, other: Path | None) -> ir.Program:
    """The program of the folder's own copy of the spec, whose digest the claim must name."""
    program, files = read_copy(folder / "spec", claim.spec, claim.spec_sha256)
    if other is not None:
        try:
            path = difference_from(files, claim.spec, other)
        except OSError as error:
            raise Refused(f"{other}: {error.strerror}", Outcome.UNDECIDED) from None
        if path is not None:
            where = "" if path == claim.spec else f" in `{path}`"
            raise Refused(f"the certificate is not about {other}: the files differ{where}")
    return program


def _judged(folder: Path, claim: Claim, program: ir.Program, trust: str | None) -> Report:
    """The report on a claim; then whether ``design.json`` says the same."""
    task = program.tasks.get(claim.task)
    if task is None:
        raise Refused(f"the spec has no task `{claim.task}`")
    for clause in unsupported(task):
        raise Refused(f"not verified: {clause.message}", Outcome.UNDECIDED)
    try:
        program, task = expanded(program, task)
    except MapFault as fault:
        raise Refused(f"the spec has errors: {fault.message}") from None
    cells = _cells(program.workspaces[task.workspace])
    if isinstance(claim, FoundClaim):
        cells = _cut(cells, claim)
        model, report = check_found(claim, program, task, cells)
    else:
        model, report = None, _impossible(folder, claim, program, task, trust)
    if report.outcome is not Outcome.REFUTED:
        reason = disagreement(folder, claim, program, task, cells, model)
        if reason is None and model is not None and report.outcome is Outcome.VALID:
            reason = misstated_formula(folder, task, report.findings)
        if reason is not None:
            raise Refused(reason)
    return report


def _cells(workspace: ir.Workspace) -> Abstraction:
    """The cells of the spec's workspace, which has errors where it has none."""
    try:
        return abstract(workspace)
    except ValueError as error:
        raise Refused(f"the spec has errors: {error}") from None


def _cut(cells: Abstraction, claim: FoundClaim) -> Abstraction:
    """The cells after the cuts of a claim, which are made in turn."""
    cuts = [Cut(cell, half_space) for cell, half_space in exact_cuts(claim.cuts)]
    if any(len(cut.half_space.normal) != cells.dimension for cut in cuts):
        raise Refused(f"a cut of a cell is not given by {cells.dimension} coordinates")
    try:
        return cells.cut(cuts)
    except ValueError as error:
        raise Refused(f"the cells cannot be cut as claimed: {error}") from None


def _impossible(
    folder: Path, claim: ImpossibleClaim, program: ir.Program, task: ir.Task, trust: str | None
) -> Report:
    # Not for `found`, whose check should not wait for it.
    from solvers.verifier.refutations.impossibility_check import check_impossible

    found = check_impossible(folder, claim, program, task, trust)
    if isinstance(found, str):
        return Report(Outcome.REFUTED, "impossible", None, found)
    if found.complete:
        return Report(Outcome.VALID, "impossible", "validated", None)
    shares = (
        f"{found.by_boxes} of {found.structures} structures are proved by boxes, "
        "the rest rest on z3"
        if found.by_boxes
        else None
    )
    if trust == "z3":
        return Report(Outcome.VALID, "impossible", "z3", shares)
    reason = f"{shares or 'only z3 decided'}; see --trust z3"
    return Report(Outcome.ASSUMING_Z3, "impossible", "z3", reason)
