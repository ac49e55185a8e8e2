"""How to check a mission without its page, and the exact files that the page is about."""

from __future__ import annotations

import hashlib
import shlex
from collections.abc import Iterator
from importlib.metadata import version

from srgc.report.missions.mission_evidence import MissionEvidence
from srgc.report.proof import own_check
from srgc.version import VERSION


def mission_check_section(evidence: MissionEvidence) -> str:
    """Commands, digests, versions and the specification itself."""
    return own_check(
        "This page proves nothing; what stands beside it does.", list(_commands(evidence)), "",
        _identity(evidence), evidence.mission.program,
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
        seed = f" --seed {mission.design['seed']}" if mission.design["seed"] else ""
        yield (
            f"srgc synth {path} --mission {mission.mission.name} -o again{seed}",
            "search again",
        )


def _identity(evidence: MissionEvidence) -> Iterator[tuple[str, str]]:
    design = evidence.mission.design
    yield "SHA-256 of the specification and what it includes", design["spec_sha256"]
    for name, content in evidence.files.items():
        yield f"SHA-256 of spec/{name}", hashlib.sha256(content).hexdigest()
    for name, digest in evidence.digests.items():
        yield f"SHA-256 of {name}", digest
    yield "made by", f"srgc {design['version']}"
    checked = "not checked" if evidence.report is None else "checked by"
    flint = f", python-flint {version('python-flint')}" if evidence.report is not None else ""
    yield checked, f"srgc {VERSION}{flint}"
