"""Motions under gravity that leave themselves without feedback are found, and proved with it."""

from __future__ import annotations

from pathlib import Path

import pytest

from solvers.verifier.verification import Outcome, verify_directory
from srgc.cli import run
from tests.oracles import result_files
from tests.oracles.gravity_tasks import PLANAR, SPATIAL


@pytest.mark.slow
@pytest.mark.parametrize("text", [PLANAR, SPATIAL], ids=["planar", "spatial"])
def test_an_unstable_motion_is_found_with_feedback(text: str, tmp_path: Path) -> None:
    path, folder = tmp_path / "task.srg", tmp_path / "out"
    path.write_text(text, encoding="utf-8")
    assert run(["synth", str(path), "-q", "-o", str(folder)]) == 0
    assert verify_directory(folder).outcome is Outcome.VALID
    assert [claim["kind"] for claim in result_files.read(folder)["claims"]] == ["controller"]
