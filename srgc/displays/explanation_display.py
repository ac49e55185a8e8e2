"""An explanation of a verdict, with source lines and carets, coloured."""

from __future__ import annotations

from solvers.explanation.explanation import Explanation
from srgc.displays.coloured_text import coloured
from srgc.render.html_block import block
from srgc.text_reports.why_report import why_text


def explanation_html(found: Explanation) -> str:
    """A display of an explanation, as ``srgc why`` prints it."""
    return block(coloured(why_text(found, colour=True)))
