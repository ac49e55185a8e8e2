"""The syntheses of the case study: result folders, what the search told, and the check."""

from __future__ import annotations

import json
import re
import subprocess
import sys
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any, Literal

from timing import ROOT, SRGC

import srgc
from paper.kept_records import digest, kept

ARM, PUBLISHED, PUBLISHED_BODY = "planar_arm", "planar_arm_paper", "planar_arm_body_paper"
"""The case study; the published lengths in it; these, held against the obstacle as a whole arm."""
STATUSES = {0: "found", 3: "impossible"}
_LINE = re.compile(r"^\[ *[\d.]+ s\] (.*)$")


@dataclass(frozen=True)
class Synthesis:
    """A result folder, what the search told line by line, and what the verifier says.

    ``margins`` are those of the conditions that a design is proved to fulfil, by their names.
    """

    folder: Path
    told: tuple[str, ...]
    outcome: str
    level: str | None
    margins: dict[str, float]

    @cached_property
    def design(self) -> dict[str, Any]:
        """``design.json``."""
        content: dict[str, Any] = json.loads((self.folder / "design.json").read_text("utf-8"))
        return content

    @property
    def lengths(self) -> tuple[float, ...]:
        """The parameters, in m."""
        return tuple(each["value"] for each in self.design["parameters"])

    def picture(self, name: str) -> str:
        """A figure that the synthesis wrote, as SVG."""
        return (self.folder / "figures" / f"{name}.svg").read_text(encoding="utf-8")


def synthesis(folder: Path, spec: str) -> Synthesis:
    """The synthesis of a shipped specification, run where it is not kept in the folder.

    Raises:
        SystemExit: it came to no verdict.
    """
    place, record = folder / spec, folder / f"{spec}.json"
    if not (place / "design.json").exists():
        record.unlink(missing_ok=True)
    content = kept(record, {"spec": digest(spec)}, lambda: _synthesised(place, spec))
    return Synthesis(place, tuple(content.pop("told")), **content)


def _synthesised(place: Path, spec: str) -> dict[str, Any]:
    print(f"srgc synth specs/{spec}.srg", file=sys.stderr, flush=True)
    command = [*SRGC, "synth", str(ROOT / "specs" / f"{spec}.srg"), "-o", str(place.resolve())]
    run = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    if run.returncode not in STATUSES:
        raise SystemExit(f"srgc synth specs/{spec}.srg: status {run.returncode}\n{run.stderr}")
    return record_of(place, run.stderr, STATUSES[run.returncode])


def record_of(place: Path, progress: str, verdict: str) -> dict[str, Any]:
    """What is kept of a result folder: the lines of progress without times, and the check."""
    expected: Literal["found", "impossible"] = "found" if verdict == "found" else "impossible"
    checked = srgc.verify(place, expect=expected, trust="z3")
    return {
        "told": [found[1] for found in map(_LINE.match, progress.splitlines()) if found],
        "outcome": checked.outcome.value,
        "level": checked.level,
        "margins": checked.margins,
    }
