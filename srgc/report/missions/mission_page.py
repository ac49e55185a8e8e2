"""The page about a mission: its sections and their order."""

from __future__ import annotations

from pathlib import Path

from solvers.verifier.proofs.scene import UNWATCHED, Watch
from srgc.report.html_page import html_page
from srgc.report.missions.mission_check_section import mission_check_section
from srgc.report.missions.mission_evidence import MissionEvidence, read_mission_evidence
from srgc.report.missions.mission_verdict import mission_head, mission_proved_section
from srgc.report.missions.motions_section import motions_section
from srgc.report.missions.robots_section import robots_section
from srgc.report.missions.tasks_section import earlier_section, refuted_section, tasks_section

SECTIONS = (
    motions_section,
    mission_proved_section,
    robots_section,
    tasks_section,
    refuted_section,
    earlier_section,
    mission_check_section,
)
"""The sections after the head, the motions first; each is empty if there is nothing to show."""


def mission_page(folder: Path, *, verify: bool = True, watch: Watch = UNWATCHED) -> str:
    """The page of a folder of a mission; the same folder gives the same text.

    Args:
        folder: a folder that ``srgc synth --mission`` or ``srgc evolve`` has written.
        verify: whether to check its claim again; the page states the outcome.
        watch: told about the progress of the check.

    Raises:
        UsageFault: there are no results, or they or the spec have been altered.
    """
    return page_of_mission(read_mission_evidence(folder, verify=verify, watch=watch))


def page_of_mission(evidence: MissionEvidence) -> str:
    """The whole page."""
    title = f"{evidence.mission.mission.name}: {evidence.mission.verdict}"
    rest = [section(evidence) for section in SECTIONS]
    return html_page(title, mission_head(evidence), rest)
