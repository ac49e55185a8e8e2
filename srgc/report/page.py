"""The page about a result: its sections and their order."""

from __future__ import annotations

from pathlib import Path

from solvers.verifier.proofs.scene import UNWATCHED, Watch
from srgc.report.animation import motion_section
from srgc.report.charts import charts_section
from srgc.report.controller import gains_section, width_section
from srgc.report.evidence import Evidence, read_evidence
from srgc.report.history import history_section
from srgc.report.html_page import html_page
from srgc.report.missions.mission_page import mission_page
from srgc.report.nearest import nearest_section
from srgc.report.objectives import objectives_section
from srgc.report.proof import check_section, margins_section
from srgc.report.robot_and_word import change_section, derivation_section, robot_section
from srgc.report.verdict import proved_section, verdict_head
from srgc.report.what_next import next_section
from srgc.report.why_not import why_not_section
from srgc.results.mission_refusal import is_mission_folder

SECTIONS = (
    motion_section,
    nearest_section,
    next_section,
    proved_section,
    objectives_section,
    charts_section,
    width_section,
    gains_section,
    margins_section,
    robot_section,
    change_section,
    history_section,
    why_not_section,
    check_section,
    derivation_section,
)
"""After the head: the motion first, then what it rests on, the derivation last."""


def report_page(folder: Path, *, verify: bool = True, watch: Watch = UNWATCHED) -> str:
    """The page of a result folder; the same folder gives the same text.

    Args:
        folder: a folder that ``srgc synth`` or ``srgc evolve`` has written, with any verdict.
        verify: whether to check its certificate again; the page states the outcome.
        watch: told about the progress of the check.

    Raises:
        UsageFault: there are no results, or they or the spec have been altered.
    """
    if is_mission_folder(folder):
        return mission_page(folder, verify=verify, watch=watch)
    return page_of(read_evidence(folder, verify=verify, watch=watch))


def page_of(evidence: Evidence) -> str:
    """The whole page."""
    rest = [section(evidence) for section in SECTIONS]
    return html_page(f"{evidence.task.name}: {evidence.verdict}", verdict_head(evidence), rest)
