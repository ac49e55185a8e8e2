"""``docs/take-away.md``: its commands run, and its program prints what the page shows."""

from __future__ import annotations

import shlex
import shutil
from collections.abc import Callable
from pathlib import Path

import pytest

from srgc.cli import run
from tests.oracles import pages
from tests.oracles.found_folders import claim_found
from tests.oracles.small_specs import TURNER, replaced
from tests.srgc.conftest import ROOT

PAGE = (ROOT / "docs" / "take-away.md").read_text(encoding="utf-8")


def only(kind: str) -> str:
    (block,) = (block for block in pages.blocks(PAGE) if block.kind == kind)
    return block.body


POLE = replaced(TURNER, " and starts with B eps JO", "")


def test_the_program_replays_a_robot_that_cannot_move(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    folder = claim_found(tmp_path / "out" / "arm", POLE, "B eps L eps EN", ["1.5"])
    rows = "".join(f"{i / 5},1.5,0\n" for i in range(11))
    (folder / "trajectory.csv").write_text(f"t,e1_x,e1_y\n{rows}", encoding="utf-8")
    assert run(["export", str(folder), "--to", "mjcf", "-o", "arm.xml"]) == 0
    exec(compile(only("python"), "take-away.md", "exec"), {})
    assert capsys.readouterr().out == only("text")


def test_the_page_does_what_it_says(
    made: Callable[[str], Path],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.chdir(tmp_path)
    synth, *exports = [shlex.split(line, comments=True) for line in only("sh").splitlines()]
    assert synth == ["srgc", "synth", "specs/planar_arm.srg", "-o", "out/arm"]
    shutil.copytree(made("planar_arm") / "out", tmp_path / "out" / "arm")
    assert len(exports) == 2
    for command in exports:
        assert run(command[1:]) == 0
        assert (tmp_path / command[-1]).is_file()
    capsys.readouterr()
    exec(compile(only("python"), "take-away.md", "exec"), {})
    assert capsys.readouterr().out == only("text")
