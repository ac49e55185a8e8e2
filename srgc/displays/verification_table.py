"""The verifier's answer as a table of conditions."""

from __future__ import annotations

from math import isfinite

from solvers.verifier.proofs.finding import Finding
from solvers.verifier.proofs.tube_checks import Status
from solvers.verifier.report import Report
from srgc.render.html_block import block, head, table
from srgc.render.html_text import number, text, with_unit
from srgc.text_reports.verification_report import by_map, in_order

_COLOURS = {Status.HOLDS: "good", Status.FAILS: "bad", Status.UNDECIDED: "open"}
_OUTCOMES = {"valid": "good", "refuted": "bad"}


def verification_html(report: Report) -> str:
    """A display of the answer: what was claimed, and every condition with its margin."""
    outcome = report.outcome.value
    level = f"level {report.level}" if report.level else ""
    said = ", ".join(filter(None, [report.verdict, level, report.reason]))
    return block(head(said, outcome, _OUTCOMES.get(outcome, "open")), conditions_table(report))


def conditions_table(report: Report) -> str:
    """The conditions in the order of ``srgc verify``; nothing without any."""
    rows = [_row(finding) for finding in by_map(in_order(report.findings))]
    names = ["", "condition", "margin", "time", "place", "how"]
    return table(names, rows, (2, 3)) if rows else ""


def _row(finding: Finding) -> list[str]:
    status = finding.status.value
    mark = f'<span class="{_COLOURS[finding.status]}">{text(status)}</span>'
    margin = with_unit(finding.margin, finding.unit) if isfinite(finding.margin) else ""
    time = "" if finding.time is None else f"{number(finding.time)} s"
    place = ", ".join(number(x) for x in finding.place)
    level = finding.level if finding.status is Status.HOLDS else ""
    return [mark, text(finding.name), text(margin), text(time), text(place), text(level)]
