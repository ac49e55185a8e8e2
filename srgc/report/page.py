"""The page: all sections with their styles and scripts in one HTML file that loads nothing."""

from __future__ import annotations

import re
from collections.abc import Sequence
from importlib.resources import files
from pathlib import Path

from solvers.verifier.proofs.scene import UNWATCHED, Watch
from srgc.render.html_text import text
from srgc.render.svg import marks_style
from srgc.report.animation import motion_section
from srgc.report.charts import charts_section
from srgc.report.controller import gains_section, width_section
from srgc.report.evidence import Evidence, read_evidence
from srgc.report.history import history_section
from srgc.report.nearest import nearest_section
from srgc.report.objectives import objectives_section
from srgc.report.proof import check_section, margins_section
from srgc.report.robot_and_word import change_section, robot_section
from srgc.report.verdict import verdict_section
from srgc.report.why_not import why_not_section

SECTIONS = (
    robot_section,
    objectives_section,
    change_section,
    motion_section,
    charts_section,
    width_section,
    gains_section,
    margins_section,
    nearest_section,
    history_section,
    why_not_section,
    check_section,
)
"""After the verdict; the first one only where there is a robot."""
POLICY = (
    "default-src 'none'; style-src 'unsafe-inline'; script-src 'unsafe-inline'; "
    "img-src data:; base-uri 'none'; form-action 'none'"
)
"""What a browser lets the page do: nothing is loaded, nothing is sent."""


def report_page(folder: Path, *, verify: bool = True, watch: Watch = UNWATCHED) -> str:
    """The page of a result folder; the same folder gives the same text.

    Args:
        folder: one that ``srgc synth`` has written, with any verdict.
        verify: whether to check its certificate again; the page says what comes of it.
        watch: told how far that check has come.

    Raises:
        UsageFault: there are no results, or they or the spec have been altered.
    """
    return page_of(read_evidence(folder, verify=verify, watch=watch))


def page_of(evidence: Evidence) -> str:
    """The whole page."""
    head = verdict_section(evidence)
    sections = SECTIONS if evidence.found is not None else SECTIONS[1:]
    rest = [section(evidence) for section in sections]
    body = _with_contents(head, [section for section in rest if section])
    title = f"{evidence.task.name}: {evidence.verdict}"
    return (
        '<!DOCTYPE html>\n<html lang="en">\n<head>\n<meta charset="utf-8">\n'
        f'<meta http-equiv="Content-Security-Policy" content="{text(POLICY)}">\n'
        '<meta name="viewport" content="width=device-width, initial-scale=1">\n'
        '<meta name="color-scheme" content="light dark">\n'
        f"<title>{text(title)}</title>\n<style>\n{_assets('.css')}</style>\n</head>\n"
        f"<body>\n<main>{body}</main>\n<script>\n{_assets('.js')}</script>\n</body>\n</html>\n"
    )


_TITLE = re.compile('<section id="([a-z-]+)"[^>]*><h2>(.*?)</h2>', re.DOTALL)


def _with_contents(head: str, rest: Sequence[str]) -> str:
    """All sections, with links to them behind the head of the page."""
    titles = [found.groups() for section in rest for found in _TITLE.finditer(section)]
    links = "".join(f'<li><a href="#{name}">{title}</a></li>' for name, title in titles)
    contents = f'<nav class="screen-only" aria-label="Sections"><ul>{links}</ul></nav></header>'
    return head.replace("</header>", contents, 1) + "".join(rest)


def _assets(ending: str) -> str:
    """All styles or all scripts, in order; the styles of marks come first."""
    folder = files("srgc.report") / "assets"
    found = (each for each in folder.iterdir() if each.name.endswith(ending))
    parts = [each.read_text("utf-8") for each in sorted(found, key=lambda each: each.name)]
    return "".join([marks_style() if ending == ".css" else "", *parts])
