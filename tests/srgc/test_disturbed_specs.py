"""The robots that come with srgc under errors that no open loop bears: found, and verified."""

from __future__ import annotations

import json
import re
from collections.abc import Callable
from pathlib import Path

import pytest

from tests.srgc.conftest import ROOT, Ran

Run = Callable[..., Ran]
HALF = "robust start 0.5 deg, 0.5 deg/s; robust effort 1 % of bound;"
CASES = {
    "one degree": (
        "planar_arm",
        "robust start 1 deg, 1 deg/s; robust effort 1 % of bound;",
        {},
    ),
    "two degrees": (
        "planar_arm",
        "robust start 2 deg, 2 deg/s; robust effort 5 % of bound; robust mass 5 %;",
        {},
    ),
    "a motor": ("motor_arm", HALF, {" at rest;": " rates <= 0.5 rad/s;"}),
    "slides": ("prismatic", HALF, {" at rest;": " rates <= 0.2 rad/s;"}),
    "elbows": ("l_shaped", HALF, {}),
    "two arms": ("two_arm", HALF, {}),
    "two arms, short steps": ("two_arm", HALF, {"8 steps of 0.25 s": "40 steps of 0.05 s"}),
}
"""Specs, what is added, and what is replaced.

No disturbed motion is at rest to 0.001 rad/s.  One hundredth of the bound of ``two_arm`` turns its
light last link by 0.2 rad within one of its own steps while the arm is stretched.
"""


@pytest.mark.slow
@pytest.mark.parametrize("case", CASES)
def test_they_are_found_with_feedback(case: str, srgc: Run, tmp_path: Path) -> None:
    name, clauses, replaced = CASES[case]
    text = (ROOT / "specs" / f"{name}.srg").read_text(encoding="utf-8")
    for before, after in replaced.items():
        # The start is at rest, too.
        head, _, tail = text.rpartition(before)
        assert head
        text = head + after + tail
    end = text.rindex("}")
    spec = tmp_path / f"{name}.srg"
    spec.write_text(f"{text[:end]}  {clauses}\n{text[end:]}", encoding="utf-8")
    ran = srgc("synth", spec, "-o", tmp_path / "out", "--quiet")
    assert ran.status == 0, ran.err
    assert "control: feedback" in ran.out
    certificate = json.loads((tmp_path / "out/certificate.json").read_text(encoding="utf-8"))
    assert certificate["format"] == 4
    told = srgc("verify", tmp_path / "out")
    assert told.status == 0
    # Of whatever may be commanded, not of the planned inputs alone.
    margin = re.search(r"holds +effort \(N\*m\) +margin ([0-9.]+)", told.out)
    assert margin is not None
    assert float(margin.group(1)) > 0
