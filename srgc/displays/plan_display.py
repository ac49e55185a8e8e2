"""A plan: the cells of the workspace with the path, and its steps."""

from __future__ import annotations

from srgc.displays.coloured_text import coloured
from srgc.displays.figure import image
from srgc.render.html_block import block, head
from srgc.text_reports.plan_report import PlanReport

_MARKS = {"found": ("found", "good"), "impossible": ("impossible", "bad")}


def plan_html(report: PlanReport, title: str) -> str:
    """A display of a plan."""
    mark = _MARKS.get(report.verdict, (report.verdict, "open"))
    picture = image(report.picture(title), f"the cells of {report.workspace.name}")
    return block(head(title, *mark), f'<div class="side">{picture}{coloured(report.text)}</div>')
