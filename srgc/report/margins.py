"""What was proved, condition by condition, the smallest margin first."""

from __future__ import annotations

import math
from collections.abc import Sequence

from solvers.verifier.proofs.checked_condition import Finding
from solvers.verifier.proofs.tube_checks import Status
from srgc.render.html_text import number, text, with_unit
from srgc.report.evidence import Evidence
from srgc.text_reports.verification_report import by_map, in_order

DECADES = 6
"""So many powers of ten has the scale of the bars; what is smaller has the shortest bar."""
WORDS = {Status.HOLDS: "holds", Status.FAILS: "violated", Status.UNDECIDED: "not decided"}


def margins_section(evidence: Evidence) -> str:
    """The table of findings; nothing where the verifier has none."""
    report = evidence.report
    if report is None or not report.findings:
        return ""
    findings = list(by_map(in_order(report.findings)))
    rows = "".join(_row(finding, findings) for finding in findings)
    return (
        '<section id="margins"><h2>Margins</h2>'
        "<p>By how much each condition holds, at the instant at which it is closest to being "
        "violated. Bars are logarithmic, each unit to its own scale. "
        '<span class="screen-only">Choose a time to see the robot there.</span></p>'
        '<div class="scroll"><table class="margins"><thead><tr><th>condition</th>'
        '<th class="figure">margin</th><th class="bar" aria-label="size"></th>'
        "<th>closest at</th><th>where</th><th>known</th></tr></thead>"
        f"<tbody>{rows}</tbody></table></div></section>"
    )


def _row(finding: Finding, among: Sequence[Finding]) -> str:
    name = text(finding.name)
    if finding.status is not Status.HOLDS:
        name = f'<strong class="bad">{WORDS[finding.status]}:</strong> {name}'
        if finding.why:
            name += f'<br><span class="soft">{text(finding.why)}</span>'
    margin = with_unit(finding.margin, finding.unit) if math.isfinite(finding.margin) else ""
    place = ", ".join(number(x) for x in finding.place)
    level = finding.level if finding.status is Status.HOLDS else ""
    return (
        f'<tr class="{_class(finding)}"><td>{name}</td><td class="figure">{text(margin)}</td>'
        f'<td class="bar">{_bar(finding, among)}</td><td>{_when(finding)}</td>'
        f"<td>{f'({place})' if place else ''}</td><td>{level}</td></tr>"
    )


def _class(finding: Finding) -> str:
    return "holds" if finding.status is Status.HOLDS else "broken"


def _when(finding: Finding) -> str:
    if finding.time is None:
        return ""
    return (
        f'<button type="button" class="seek" data-seek="{finding.time!r}">'
        f"{number(finding.time, 5)} s</button>"
    )


def _bar(finding: Finding, among: Sequence[Finding]) -> str:
    """How large a margin is beside the largest one of its unit, in powers of ten."""
    if not math.isfinite(finding.margin) or finding.margin <= 0:
        return ""
    largest = max(
        each.margin for each in among if each.unit == finding.unit and math.isfinite(each.margin)
    )
    part = 1 + math.log10(finding.margin / largest) / DECADES
    return f'<span style="width:{100 * max(part, 0.02):.0f}%"></span>'
