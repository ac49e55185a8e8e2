"""``docs/how-to/export.md``: what a page's session does not run, and its program elsewhere."""

from __future__ import annotations

import re
import shlex
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from srgc.cli import run
from tests.oracles import pages
from tests.oracles.found_folders import claim_found
from tests.oracles.small_specs import TURNER, replaced
from tests.srgc.conftest import ROOT

PAGE = (ROOT / "docs" / "how-to" / "export.md").read_text(encoding="utf-8")


NUMBER = re.compile(r"-?\d+(?:\.\d+)?(?:e[-+]?\d+)?")
"""What depends on the machine, or on the version of a library."""


def program() -> tuple[str, str]:
    """The program of the page and what it prints."""
    blocks = pages.blocks(PAGE)
    (number,) = (i for i, block in enumerate(blocks) if block.kind == "python")
    assert blocks[number + 1].kind == "text"
    return blocks[number].body, blocks[number + 1].body


POLE = replaced(TURNER, " and starts with B eps JO", "")


def test_the_program_replays_a_robot_that_cannot_move(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    folder = claim_found(tmp_path / "out" / "arm", POLE, "B eps L eps EN", ["1.5"])
    assert run(["export", str(folder), "--to", "mujoco", "-o", "arm_mujoco"]) == 0
    capsys.readouterr()
    content, output = program()
    exec(compile(content, "export.md", "exec"), {})
    assert capsys.readouterr().out == output


def test_the_script_prints_what_the_page_shows(
    made: Callable[[str], Path], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    blocks = pages.blocks(PAGE)
    (number,) = (i for i, block in enumerate(blocks) if block.kind == "sh")
    program, *arguments = shlex.split(blocks[number].body)
    assert (program, arguments) == ("python", ["arm_mujoco/replay.py"])
    folder = str(made("planar_arm") / "out")
    assert run(["export", folder, "--to", "mujoco", "-o", "arm_mujoco"]) == 0
    ran = subprocess.run([sys.executable, *arguments], check=True, capture_output=True, text=True)
    assert NUMBER.sub("#", ran.stdout) == NUMBER.sub("#", blocks[number + 1].body)
