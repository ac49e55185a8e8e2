"""What the verifier answers, and why."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from solvers.verifier.claims.outcome import Outcome
from solvers.verifier.proofs.finding import Finding
from solvers.verifier.proofs.tube_checks import Status


@dataclass(frozen=True, slots=True)
class Report:
    """What was checked and found; ``level`` is that of the weakest evidence."""

    outcome: Outcome
    verdict: str | None
    level: str | None
    reason: str | None
    findings: tuple[Finding, ...] = ()


def concluded(findings: Sequence[Finding]) -> Report:
    """One violated condition refutes, one open condition leaves open."""
    failed = next((f for f in findings if f.status is Status.FAILS), None)
    open_one = next((f for f in findings if f.status is Status.UNDECIDED), None)
    if failed is not None:
        reason = f"{failed.name}: violated{_at(failed)}"
        return Report(Outcome.REFUTED, "found", None, reason, tuple(findings))
    if open_one is not None:
        reason = f"{open_one.name}: not decided{_at(open_one)}"
        return Report(Outcome.UNDECIDED, "found", None, reason, tuple(findings))
    return Report(Outcome.VALID, "found", "validated", None, tuple(findings))


def _at(finding: Finding) -> str:
    return "" if finding.time is None else f" at {finding.time:.4g} s"
