"""The verdict in the result folder of a task or mission, and whether it is still up to date."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from grammar_lang.diagnostics.diagnostic import Sink
from grammar_lang.files.file_tree import decoded
from solvers.verdict import MISSION
from srgc.faults import UsageFault
from srgc.language_server.documents.analysis import Analysis
from srgc.language_server.documents.projects import bytes_of
from srgc.results.folder_writer import refuse_other

_LONGEST = 60


@dataclass(frozen=True, slots=True)
class Verdict:
    """A verdict; ``text`` is for the lens; ``stale``: whether it is about another text."""

    kind: str
    text: str
    stale: bool


def folder_of(path: Path, name: str) -> Path:
    """The result folder of a task or a mission: ``out/NAME`` next to the file."""
    return path.parent / "out" / name


def holds_mission(folder: Path) -> bool:
    """Whether the claim in a folder is about a mission, or about a step of ``srgc evolve``."""
    return _plain_bytes(folder / MISSION) is not None


def current_files(analysis: Analysis) -> dict[str, bytes]:
    """The files of a program, as ``synth`` would copy them.

    Editors send texts without byte order mark; if a text is that of the file on disk, the bytes of
    the file count.
    """
    found: dict[str, bytes] = {}
    for number, source in enumerate(analysis.sources):
        data = source.data
        path = analysis.path(number)
        on_disk = None if path is None else bytes_of(path)
        if on_disk not in (None, data) and decoded(on_disk, 0, Sink())[0] == source.text:
            data = on_disk
        found[source.path] = data
    return found


@dataclass(slots=True)
class Verdicts:
    """The verdicts, and which of them were verified since the server was started."""

    _verified: dict[str, tuple[str, str]] = field(default_factory=dict[str, tuple[str, str]])

    def note(self, folder: Path, outcome: str) -> None:
        """Record the outcome of ``srgc verify`` for the present claim in a folder."""
        digest = _digest(folder)
        if digest is not None:
            self._verified[str(folder)] = (digest, outcome)

    def read(self, folder: Path, files: Mapping[str, bytes]) -> Verdict | None:
        """The verdict in a folder, None if there is none.

        Args:
            folder: the result folder.
            files: the present files of the spec.
        """
        design = _design(folder)
        if design is None:
            return None
        from solvers.verifier.claims.certificate import spec_digest

        kind = str(design["verdict"])
        text = _said(kind, design)
        known = self._verified.get(str(folder))
        if known is not None and known[0] == _digest(folder):
            text = f"{text} ({known[1]})"
        stale = design.get("spec_sha256") != spec_digest(files)
        return Verdict(kind, f"stale: {text}" if stale else text, stale)


def _said(kind: str, design: Mapping[str, Any]) -> str:
    word = design.get("word")
    reason = design.get("reason")
    more = ""
    if kind == "found" and isinstance(word, list):
        more = " ".join(map(str, word))
    elif kind == "found" and "mission" in design:
        more = _of_mission(design)
    elif isinstance(reason, str):
        more = " ".join(reason.split())
    if len(more) > _LONGEST:
        more = f"{more[: _LONGEST - 1]}…"
    return f"{kind}: {more}" if more else kind


def _of_mission(design: Mapping[str, Any]) -> str:
    """The cost of a mission's robots, or the word of its only robot."""
    cost, robots = design.get("cost"), design.get("robots")
    if isinstance(cost, int | float):
        return f"changes {cost:g}"
    if isinstance(robots, list) and robots and isinstance(robots[0], dict):
        return " ".join(map(str, robots[0].get("word") or ()))
    return ""


def _design(folder: Path) -> dict[str, Any] | None:
    try:
        content = json.loads(_plain_bytes(folder / "design.json") or b"")
    except (ValueError, RecursionError):
        return None
    return content if isinstance(content, dict) and "verdict" in content else None


def _digest(folder: Path) -> str | None:
    """A digest of a folder's claims: the certificate, or those of a mission and its designs."""
    claim = folder / MISSION if holds_mission(folder) else folder / "certificate.json"
    designs = sorted(folder.glob("tasks/*/certificate.json")) if claim.name == MISSION else []
    found = [_plain_bytes(path) for path in (claim, *designs)]
    if found[0] is None:
        return None
    digests = [hashlib.sha256(data or b"").hexdigest() for data in found]
    return hashlib.sha256("".join(digests).encode()).hexdigest()


def _plain_bytes(path: Path) -> bytes | None:
    """The bytes of a file in a result folder; None if it is a link, or cannot be read."""
    try:
        refuse_other(path, "file")
    except UsageFault:
        return None
    return bytes_of(path)
