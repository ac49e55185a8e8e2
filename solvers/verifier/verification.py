"""The independent verifier: re-reads the spec, recomputes everything, believes no searcher.

It shares the compiler and the validated integration with the searchers, and nothing else.
"""

from __future__ import annotations

from pathlib import Path

from grammar_lang import ir
from solvers.verifier.claims.certificate import CertificateError, FoundClaim, ImpossibleClaim
from solvers.verifier.claims.claimed_task import ClaimedTask, claimed_task
from solvers.verifier.claims.design_agreement import disagreement
from solvers.verifier.claims.formula_agreement import misstated_formula
from solvers.verifier.claims.outcome import Outcome, Refused
from solvers.verifier.found_check import check_found
from solvers.verifier.proofs.watch import UNWATCHED, Watch
from solvers.verifier.report import Report

__all__ = ["Outcome", "Report", "verify_directory"]


def verify_directory(
    folder: Path, spec: Path | None = None, trust: str | None = None, watch: Watch = UNWATCHED
) -> Report:
    """Check the certificate of a result folder.

    Args:
        folder: a folder written by ``srgc synth``.
        spec: a spec file the result must be about, besides its own copy.
        trust: ``"z3"`` runs refutation scripts again in a z3 process and believes its ``unsat``.
        watch: told of the steps of the motion, or of the structures, that are done.
    """
    path = folder / "certificate.json"
    if not path.is_file():
        return Report(
            Outcome.UNDECIDED, None, None, f"there is no certificate in {folder}: nothing to verify"
        )
    try:
        return _judged(folder, claimed_task(folder, spec), trust, watch)
    except OSError as error:
        reason = f"the certificate cannot be read: {error.strerror}"
        return Report(Outcome.UNDECIDED, None, None, reason)
    except UnicodeDecodeError:
        return Report(Outcome.REFUTED, None, None, "the certificate is not UTF-8")
    except CertificateError as error:
        return Report(Outcome.REFUTED, None, None, str(error))
    except Refused as refusal:
        return Report(refusal.outcome, None, None, str(refusal))


def _judged(folder: Path, claimed: ClaimedTask, trust: str | None, watch: Watch) -> Report:
    """The report on a claim; then whether ``design.json`` says the same."""
    claim, program, task, cells = claimed.claim, claimed.program, claimed.task, claimed.cells
    if isinstance(claim, FoundClaim):
        model, report = check_found(claim, program, task, cells, watch)
    else:
        model, report = None, _impossible(folder, claim, program, task, trust, watch)
    if report.outcome is not Outcome.REFUTED:
        reason = disagreement(folder, claim, program, task, cells, model)
        if reason is None and model is not None and report.outcome is Outcome.VALID:
            reason = misstated_formula(folder, task, report.findings)
        if reason is not None:
            raise Refused(reason)
    return report


def _impossible(
    folder: Path,
    claim: ImpossibleClaim,
    program: ir.Program,
    task: ir.Task,
    trust: str | None,
    watch: Watch,
) -> Report:
    # Not for `found`, whose check should not wait for it.
    from solvers.verifier.refutations.impossibility_check import check_impossible

    found = check_impossible(folder, claim, program, task, trust, watch)
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
