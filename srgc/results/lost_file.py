"""A result folder that lacks its claim or its ``design.json``: what is lost, and how to restore it.

A run leaves both for *found* and *impossible*, so a folder with only one of them has lost the
other.  After *unknown* there is no claim.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

from grammar_lang.files.file_tree import visible
from solvers.verdict import MISSION
from srgc.faults import UsageFault
from srgc.results.folder_writer import JOURNAL
from srgc.results.no_robot import no_robot
from srgc.results.result_folder import json_object

CERTIFICATE, DESIGN = "certificate.json", "design.json"
CLAIMS = MISSION, CERTIFICATE
GOES_ON = "the `srgc synth` that began it goes on from there"
NO_RESULTS = "name a folder with results: `srgc synth SPEC -o FOLDER` writes one"


@dataclass(frozen=True, slots=True)
class LostFile:
    """A file that a finished run has written and that is gone.

    ``verdict`` is that of ``design.json``, None if this is the lost file; ``command`` wrote it.
    """

    name: str
    verdict: str | None
    command: str

    @property
    def restored(self) -> str:
        """How to get the file again, without its name."""
        where = "into another folder" if self.name == DESIGN else "again"
        return f"the same {self.command} {where} writes"

    def fault(self, folder: Path) -> UsageFault:
        """The error of a command that needs the file."""
        because = "which this command needs"
        if self.verdict is not None:
            because = f"although its verdict is {self.verdict}"
        return UsageFault(
            f"{folder} has lost its {self.name}, {because}", hint=f"{self.restored} it"
        )


def lost_file(folder: Path) -> LostFile | None:
    """The file that a result folder has lost; None if it has both, or is not of a finished run.

    Raises:
        UsageFault: the file that is left cannot be read, or is no JSON object.
    """
    claims = [name for name in CLAIMS if (folder / name).is_file()]
    has_design = (folder / DESIGN).is_file()
    if has_design == bool(claims):
        return None
    if claims:
        content = json_object(folder / claims[0])
        return None if _begun(folder) else LostFile(DESIGN, None, _command(folder, content))
    content = json_object(folder / DESIGN)
    verdict = content.get("verdict")
    if verdict not in ("found", "impossible"):
        return None
    name = CERTIFICATE if content.get("mission") is None else MISSION
    return LostFile(name, verdict, _command(folder, content))


def _command(folder: Path, content: dict[str, Any]) -> str:
    """The command that wrote a folder, with the name of its spec if that is known."""
    if folder.parent.name == "tasks" and (folder.parent.parent / MISSION).is_file():
        return f"run that wrote {visible(str(folder.parent.parent))}"
    if content.get("origin") is not None or content.get("posed") is not None:
        return "`srgc evolve`"
    spec = content.get("spec")
    return f"`srgc synth {visible(spec)}`" if isinstance(spec, str) else "`srgc synth`"


def no_certificate(folder: Path) -> UsageFault:
    """The error about a folder without a certificate, for a command that needs its robot."""
    lost = lost_file(folder)
    if lost is not None and lost.verdict != "impossible":
        return lost.fault(folder)
    verdict = json_object(folder / DESIGN, needed=False).get("verdict")
    if verdict is not None:
        return no_robot(folder, verdict)
    return UsageFault(f"{folder} has no certificate: it holds no finished results{_how(folder)}")


def no_design(folder: Path) -> UsageFault:
    """The error about a folder without ``design.json``."""
    lost = lost_file(folder)
    if lost is not None:
        return lost.fault(folder)
    return UsageFault(f"{folder} has no design.json: it holds no finished results{_how(folder)}")


def next_after(folder: Path) -> str | None:
    """The advice for a folder that cannot be reported or explained yet; None for any other."""
    try:
        lost = lost_file(folder)
    except UsageFault:
        return None
    if lost is not None:
        return f"{lost.restored} {lost.name}"
    if _begun(folder):
        return GOES_ON
    return None if any((folder / name).is_file() for name in (DESIGN, *CLAIMS)) else NO_RESULTS


def _begun(folder: Path) -> bool:
    """Whether a run has begun in a folder and not ended."""
    return not (folder / DESIGN).is_file() and (folder / JOURNAL).is_file()


def _how(folder: Path) -> str:
    return f"; {GOES_ON}" if _begun(folder) else ""
