"""How to check a mission without its page, and the exact files that the page is about."""

from __future__ import annotations

import shlex
from collections.abc import Iterator

from srgc.report.missions.mission_evidence import MissionEvidence
from srgc.report.proof import identity, own_check, search_options


def mission_check_section(evidence: MissionEvidence) -> str:
    """Commands, digests, versions and the specification itself."""
    return own_check(
        "This page proves nothing; what stands beside it does.", list(_commands(evidence)), "",
        identity(
            evidence.mission.design, evidence.files, evidence.digests,
            checked=evidence.report is not None,
        ),
        evidence.mission.program,
    )  # fmt: skip


def _commands(evidence: MissionEvidence) -> Iterator[tuple[str, str]]:
    mission = evidence.mission
    if mission.verdict != "unknown":
        yield "srgc verify .", "check the claim, and every design"
        if not mission.evolved:
            expected = f"--mission {mission.mission.name} --expect {mission.verdict}"
            yield f"srgc verify . --spec PATH {expected}", "and that it is about your file"
    yield "srgc why .", "what rules robots out"
    if mission.robots:
        last = mission.mission.tasks[-1]
        yield "srgc evolve . FILE --task TASK", f"rebuild the robot of {last} for another task"
    if not mission.evolved:
        path = shlex.quote(f"spec/{mission.design['spec']}")
        yield (
            f"srgc synth {path} --mission {mission.mission.name} -o again"
            + search_options(mission.design),
            "search again",
        )
