"""The verifier's answer as plain text."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import replace
from math import isfinite

from solvers.verifier.proofs.finding import Finding
from solvers.verifier.verification import Outcome, Report

LEAST_WIDTH = 34
"""Of the column of names."""


def verification_text(report: Report) -> str:
    """The verifier's answer with all margins."""
    head = report.outcome.value
    if report.verdict is not None and report.outcome in (Outcome.VALID, Outcome.ASSUMING_Z3):
        level = f", level {report.level}" if report.level else ""
        head = f"{head}: {report.verdict}{level}"
    if report.reason:
        head = f"{head}: {report.reason}"
    lines = [head]
    shown = list(_by_map(sorted(report.findings, key=lambda f: f.margin)))
    width = max([LEAST_WIDTH, *(len(finding.name) for finding in shown)])
    for finding in shown:
        where = "" if finding.time is None else f"  at {finding.time:.3f} s"
        if finding.place:
            where += " (" + ", ".join(f"{x:.4f}" for x in finding.place) + ")"
        unit = "" if finding.unit == "1" else f" {finding.unit}"
        margin = f"margin {finding.margin:.6g}{unit}"
        if not isfinite(finding.margin):
            margin, where = "", where.lstrip()
        lines.append(
            f"  {finding.status.value:<9} {finding.name:<{width}} {margin}{where}".rstrip()
        )
    return "\n".join(lines)


_PIECE = re.compile(r"(?P<what>.* to \w+)\.\d+")
"""A condition on one piece of a map of obstacles: of regions only these have names with a dot."""


def _by_map(findings: Sequence[Finding]) -> Iterator[Finding]:
    """The findings, of those about the pieces of one map only the first of each status."""
    pieces = [_PIECE.fullmatch(finding.name) for finding in findings]
    kinds = [
        None if piece is None else (piece["what"], finding.status)
        for piece, finding in zip(pieces, findings, strict=True)
    ]
    counts, told = Counter(kinds), set[object]()
    for kind, finding in zip(kinds, findings, strict=True):
        if kind is None or counts[kind] == 1:
            yield finding
        elif kind not in told:
            told.add(kind)
            yield replace(finding, name=f"{finding.name} and {counts[kind] - 1} more pieces")
