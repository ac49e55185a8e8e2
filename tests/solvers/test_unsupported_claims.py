"""A claim about a task with a clause that is not compiled is never valid, nor refuted."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

from solvers.verifier.verification import Outcome, verify_directory
from tests.oracles.result_files import alter_spec


@pytest.mark.parametrize(("clause", "named"), [("avoid self with body;", "`avoid self`")])
@pytest.mark.parametrize("spec", ["turner", "beyond_reach"])
def test_undecided(result: Callable[[str], Path], spec: str, clause: str, named: str) -> None:
    folder = result(spec)
    text = next((folder / "spec").iterdir()).read_text(encoding="utf-8")
    avoided = "O" if "obstacle O" in text else "T"
    clause = clause.replace("O", avoided)
    assert verify_directory(folder).outcome in (Outcome.VALID, Outcome.UNCHECKED)
    start = next(line for line in text.splitlines() if line.strip().startswith("start in"))
    alter_spec(folder, start, f"{clause} {start}", sign=True)
    report = verify_directory(folder)
    assert report.outcome is Outcome.UNDECIDED
    assert report.reason == f"not verified: {named} cannot be compiled by this version"
