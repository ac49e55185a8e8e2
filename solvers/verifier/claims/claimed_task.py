"""What a claim is about: the folder's own copy of the spec, its task, its cells."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from compiler.checks.supported import unsupported
from compiler.tasks.obstacle_pieces import expanded
from compiler.workspaces.abstraction import Abstraction, abstract
from compiler.workspaces.map_fault import MapFault
from compiler.workspaces.refinement import Cut
from grammar_lang import ir
from solvers.verifier.claims.certificate import Claim, FoundClaim, exact_cuts, from_text
from solvers.verifier.claims.spec_copy import bounded_text, difference_from, read_copy
from solvers.verifier.report import Outcome, Refused


@dataclass(frozen=True, slots=True)
class ClaimedTask:
    """A claim with the program and the task that it is about; ``cells`` are cut as it says."""

    claim: Claim
    program: ir.Program
    task: ir.Task
    cells: Abstraction


def read_claim(folder: Path) -> Claim:
    """What the certificate of a result folder claims.

    Raises:
        CertificateError: the certificate is none.
        OSError, UnicodeDecodeError: it cannot be read.
    """
    return from_text(bounded_text(folder / "certificate.json"))


def claimed_task(folder: Path, claim: Claim, spec: Path | None = None) -> ClaimedTask:
    """A claim with what it is about.

    Args:
        folder: the result folder that it is from.
        claim: the claim.
        spec: a spec file it must be about, besides the folder's own copy.

    Raises:
        CertificateError: the copy of the spec is not the one that is claimed.
        Refused: it is about another spec, or cannot be judged.
        OSError: the copy cannot be read.
    """
    program = _spec_of(folder, claim, spec)
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
    return ClaimedTask(claim, program, task, cells)


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
