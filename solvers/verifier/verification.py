"""The independent verifier: it reads the spec again, recomputes everything and trusts no searcher.

It shares only the compiler and the validated integration with the searchers.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path

from compiler.robots.robot import RobotModel
from grammar_lang import ir
from solvers.verdict import Claimed
from solvers.verifier.claims.agreement import disagreement, misstated_formula
from solvers.verifier.claims.certificate import (
    CertificateError,
    Claim,
    FoundClaim,
    ImpossibleClaim,
    control_of,
    verdict_of,
)
from solvers.verifier.claims.claimed_inputs import (
    claimed_margins,
    misstated_robustness,
)
from solvers.verifier.claims.further_claims import unknown_claims
from solvers.verifier.claims.spec_copy import ClaimedTask, claimed_task, read_claim
from solvers.verifier.found_check import check_found
from solvers.verifier.proofs.checked_condition import CheckedCondition, decisive
from solvers.verifier.proofs.scene import UNWATCHED, Watch
from solvers.verifier.refutations.solver_process import DisagreementError, named_solvers
from solvers.verifier.report import Outcome, Refused, Report

__all__ = ["Expected", "Outcome", "Report", "verify_directory"]


@dataclass(frozen=True, slots=True)
class Expected:
    """What a certificate has to be about; None stands for anything."""

    task: str | None = None
    verdict: Claimed | None = None

    def differs(self, claim: Claim) -> str | None:
        """How the claim differs from what was expected, or None."""
        if self.task not in (None, claim.task):
            return f"the certificate is about task `{claim.task}`, not `{self.task}`"
        verdict = verdict_of(claim)
        if self.verdict not in (None, verdict):
            return f"the certificate says {verdict}, not {self.verdict}"
        return None


ANYTHING = Expected()


def verify_directory(
    folder: Path,
    spec: Path | None = None,
    trust: str | None = None,
    watch: Watch = UNWATCHED,
    expected: Expected = ANYTHING,
) -> Report:
    """Check the certificate of a result folder.

    Args:
        folder: a folder written by ``srgc synth``.
        spec: a spec file that the result must be about, in addition to the folder's own copy.
        trust: names of SMT solvers, separated by commas. Each runs every refutation script again,
            in a process of its own; ``unsat`` is accepted if all of them answer it.
        watch: receives progress: the steps of the motion, or the structures, that are done.
        expected: what the certificate must be about; a certificate about anything else is not
            judged.
    """
    if not (folder / "certificate.json").is_file():
        return Report(
            Outcome.UNDECIDED, None, None, f"there is no certificate in {folder}: nothing to verify"
        )
    claim: Claim | None = None
    try:
        claim = read_claim(folder)
        report = _as_expected(folder, claim, spec, trust, watch, expected)
    except OSError as error:
        reason = f"the results cannot be read: {error.strerror}"
        report = Report(Outcome.UNDECIDED, None, None, reason)
    except DisagreementError as error:
        report = Report(Outcome.DISAGREEMENT, None, None, str(error))
    except UnicodeDecodeError:
        report = Report(Outcome.REFUTED, None, None, "the certificate is not UTF-8")
    except CertificateError as error:
        report = Report(Outcome.REFUTED, None, None, str(error))
    except Refused as refusal:
        report = Report(refusal.outcome, None, None, str(refusal))
    if claim is None:
        return report
    return replace(
        report,
        verdict=verdict_of(claim),
        task=claim.task,
        spec=claim.spec,
        spec_sha256=claim.spec_sha256,
        control=_control(claim),
    )


def _control(claim: Claim) -> str | None:
    """What drives the robot of a claim; None if nothing does."""
    return control_of(claim) if isinstance(claim, FoundClaim) and any(claim.inputs) else None


def _as_expected(
    folder: Path,
    claim: Claim,
    spec: Path | None,
    trust: str | None,
    watch: Watch,
    expected: Expected,
) -> Report:
    """The report on a claim, or an ``UNEXPECTED`` one if the claim is not about what was asked."""
    other = expected.differs(claim)
    if other is not None:
        return Report(Outcome.UNEXPECTED, None, None, other)
    return _judged(folder, claimed_task(folder, claim, spec), trust, watch)


def _judged(folder: Path, claimed: ClaimedTask, trust: str | None, watch: Watch) -> Report:
    """The report on a claim; unless it is refuted, ``design.json`` has to agree with the claim."""
    claim, program, task, cells = claimed.claim, claimed.program, claimed.task, claimed.cells
    if isinstance(claim, FoundClaim):
        model, report = check_found(claim, program, task, cells, watch)
        if report.outcome is Outcome.VALID:
            further = _of_all_robots(folder, claim, program, claimed.asked, model, report, watch)
            report = replace(report, conditions=(*report.conditions, *further))
    else:
        model, report = None, _impossible(folder, claim, program, task, trust, watch)
    if report.outcome is not Outcome.REFUTED:
        reason = disagreement(folder, claim, program, task, cells, model)
        if reason is None and model is not None and report.outcome is Outcome.VALID:
            reason = misstated_formula(folder, task, report.conditions)
            if reason is None and isinstance(claim, FoundClaim):
                margins = claimed_margins(claim, model, task, report.conditions)
                reason = misstated_robustness(folder, margins)
        if reason is not None:
            raise Refused(reason)
    return report


def _of_all_robots(
    folder: Path,
    claim: FoundClaim,
    program: ir.Program,
    task: ir.Task,
    model: RobotModel | None,
    report: Report,
    watch: Watch,
) -> tuple[CheckedCondition, ...]:
    """The conditions that a valid claim of a robot states about all robots: a bound, objectives."""
    if model is None or (claim.bound is None and claim.objectives is None):
        return ()
    # Imported here, since other claims do not need it and should not wait for it.
    from solvers.verifier.refutations.further_check import further_conditions

    margins = claimed_margins(claim, model, task, report.conditions)
    return further_conditions(
        folder, claim, program, task, model, margins, report.conditions, watch
    )


def _impossible(
    folder: Path,
    claim: ImpossibleClaim,
    program: ir.Program,
    task: ir.Task,
    trust: str | None,
    watch: Watch,
) -> Report:
    # Imported here, since `found` does not need them and should not wait for them.
    from solvers.verifier.refutations.impossibility_check import check_impossible
    from solvers.verifier.refutations.structure_evidence import trusted_text

    unknown = decisive(unknown_claims(claim.claims))
    if unknown is not None:
        return Report(Outcome.UNDECIDED, "impossible", None, unknown.reason)
    solvers = named_solvers(trust)
    found = check_impossible(folder, claim, program, task, solvers, watch)
    if isinstance(found, str):
        return Report(Outcome.REFUTED, "impossible", None, found)
    if found.complete:
        return Report(Outcome.VALID, "impossible", "validated", None)
    scripts = f"of {found.structures - found.by_boxes} of {found.structures} structures"
    if solvers:
        who = trusted_text(solvers)
        verb = "answers" if len(solvers) == 1 else "answer"
        said = f"{who} {verb} unsat to the scripts {scripts}, boxes prove the others"
        return Report(Outcome.VALID, "impossible", who, said if found.by_boxes else None)
    reason = f"no solver has run on the scripts {scripts}; --trust z3 runs z3 on them"
    return Report(Outcome.UNCHECKED, "impossible", None, reason)
