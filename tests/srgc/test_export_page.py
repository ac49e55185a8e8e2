"""``docs/how-to/export.md``: what a page's session does not run, and its program elsewhere."""

from __future__ import annotations

import json
import re
import shlex
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from srgc.cli import run
from tests.oracles import geared_arm, pages
from tests.oracles.found_folders import claim_found
from tests.oracles.small_specs import TURNER, replaced
from tests.srgc.conftest import ROOT

PAGE = (ROOT / "docs" / "how-to" / "export.md").read_text(encoding="utf-8")


NUMBER = re.compile(r"-?\d+(?:\.\d+)?(?:e[-+]?\d+)?")
"""What depends on the machine, or on the version of a library."""


def program() -> tuple[str, str]:
    """The program of the page and what it prints."""
    blocks = pages.blocks(PAGE)
    (number,) = (i for i, block in enumerate(blocks) if block.kind == "python" and not block.name)
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


def test_the_file_beside_a_urdf_is_as_shown(tmp_path: Path) -> None:
    page = (ROOT / "docs" / "how-to" / "drives.md").read_text(encoding="utf-8")
    word = "Base Shoulder Tube Elbow Tube Hook"
    folder = claim_found(tmp_path / "out", pages.files(page)["lifter.srg"], word, ["0.5", "0.3"])
    assert run(["export", str(folder), "--to", "urdf", "-o", str(tmp_path / "arm.urdf")]) == 0
    written = (tmp_path / "arm.joints.json").read_text(encoding="utf-8")
    [shown] = [block.body for block in pages.blocks(PAGE) if block.kind == "json"]
    assert json.loads(shown)["about"][0] == json.loads(written)["about"][0]
    assert shown.partition(' "joint_limits"')[2] == written.partition(' "joint_limits"')[2]


@pytest.mark.slow
def test_pinocchio_gets_what_is_beside_a_urdf(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    folder = geared_arm.geared_arm(tmp_path / "out")
    assert run(["export", str(folder), "--to", "urdf", "-o", "arm.urdf"]) == 0
    names: dict[str, Any] = {}
    exec(pages.files(PAGE)["arm_in_pinocchio.py"], names)
    model = names["model"]
    assert list(model.gravity.linear) == [0, 0, -9.81]
    places = [model.idx_vs[model.getJointId(name)] for name in geared_arm.JOINTS]
    for found, expected in (
        (model.armature, geared_arm.ARMATURE),
        (model.damping, geared_arm.VISCOUS),
        (model.friction, geared_arm.COULOMB),
    ):
        assert found[places] == pytest.approx(expected, rel=1e-15)
    assert (list(model.rotorInertia), list(model.rotorGearRatio)) == ([0] * 4, [1] * 4)


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
