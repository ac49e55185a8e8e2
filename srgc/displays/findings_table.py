"""Findings with source lines and carets, coloured."""

from __future__ import annotations

from grammar_lang.findings.render import to_text
from srgc.displays.coloured_text import coloured
from srgc.faults import MOST_FINDINGS, Checked
from srgc.render.html_block import block, head
from srgc.text_reports.check_summary import summary


def findings_html(checked: Checked) -> str:
    """A display of findings, as ``srgc check`` prints them."""
    said = summary([checked])
    if not checked.diagnostics:
        return block(head(said, "✓", "good"))
    found = to_text(checked.diagnostics, checked.sources, colour=True, most=MOST_FINDINGS)
    mark = ("✓", "good") if checked.program is not None else ("✗", "bad")
    return block(head(said, *mark), coloured(found))
