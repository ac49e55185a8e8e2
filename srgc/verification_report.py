"""The verifier's answer as plain text."""

from __future__ import annotations

from math import isfinite

from solvers.verifier import Outcome, Report


def verification_text(report: Report) -> str:
    """The verifier's answer with all margins."""
    head = report.outcome.value
    if report.verdict is not None and report.outcome in (Outcome.VALID, Outcome.ASSUMING_Z3):
        level = f", level {report.level}" if report.level else ""
        head = f"{head}: {report.verdict}{level}"
    if report.reason:
        head = f"{head}: {report.reason}"
    lines = [head]
    for finding in sorted(report.findings, key=lambda f: f.margin):
        where = "" if finding.time is None else f"  at {finding.time:.3f} s"
        if finding.place:
            where += " (" + ", ".join(f"{x:.4f}" for x in finding.place) + ")"
        unit = "" if finding.unit == "1" else f" {finding.unit}"
        margin = f"margin {finding.margin:.6g}{unit}"
        if not isfinite(finding.margin):
            margin, where = "", where.lstrip()
        lines.append(f"  {finding.status.value:<9} {finding.name:<34} {margin}{where}".rstrip())
    return "\n".join(lines)
