"""The starter files of the package, by kind."""

from __future__ import annotations

import re
import shlex
from collections.abc import Mapping
from difflib import get_close_matches
from importlib.resources import files
from pathlib import Path
from types import MappingProxyType

from srgc.faults import UsageFault

STARTERS: Mapping[str, str] = MappingProxyType(
    {
        "planar": "an arm in the plane, around a tilted obstacle; explains the language",
        "branching": "two arms and two hands on a torso, a task for either hand",
        "space": "a crane in space, against gravity",
        "kit": "an arm of drives, tubes and a gripper with ports, in space",
    }
)
"""Maps each kind to what its file is about."""


def starter(kind: str) -> str:
    """The text of a starter file.

    Raises:
        UsageFault: there is no such kind.
    """
    if kind not in STARTERS:
        near = get_close_matches(kind, STARTERS, n=1)
        meant = f"; did you mean `{near[0]}`?" if near else ""
        raise UsageFault(f"there is no starter `{kind}`: choose {', '.join(STARTERS)}{meant}")
    return files(__package__).joinpath(f"{kind}.srg").read_text(encoding="utf-8")


def list_of_starters() -> str:
    """The kinds, one per line, and how to continue."""
    width = max(map(len, STARTERS))
    rows = [f"{kind:{width}}  {about}" for kind, about in STARTERS.items()]
    return "\n".join([*rows, "", "`srgc new planar` writes planar.srg."])


def next_steps(path: Path, text: str) -> str:
    """What was written, and the next commands to run."""
    task = re.findall(r"^task (\w+)", text, re.MULTILINE)[0]
    file, folder = shlex.quote(str(path)), f"out/{task}"
    steps = {
        f"srgc check {file}": "find mistakes; again after every change",
        f"srgc synth {file}": f"find a robot; results in {folder}",
        f"srgc verify {folder}": "check the results independently",
        f"srgc report {folder}": "see them: a page for the browser",
    }
    width = max(map(len, steps))
    rows = [f"  {command:{width}}  {purpose}" for command, purpose in steps.items()]
    return "\n".join([f"{path} written.  Next:", *rows])
