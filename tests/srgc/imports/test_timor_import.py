"""``srgc import timor``: ends of modules as ports, what stays open, what numbers become."""

from __future__ import annotations

import json
import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import srgc as interface
from srgc.imports.timor.timor_import import timor_import
from tests.conftest import ROOT
from tests.oracles.timor_sets import blocks, limits_of, ports_of

KIT = ROOT / "specs" / "imports" / "scara_modules"
IDENTITY = np.eye(4).tolist()
FLIPPED = np.diag([1.0, -1.0, -1.0, 1.0]).tolist()


def end(name: str, gender: str, kind: str = "flange", size: Any = (8,)) -> dict[str, Any]:
    pose = IDENTITY if gender == "m" else FLIPPED
    return {"ID": name, "gender": gender, "type": kind, "size": list(size), "pose": pose}


def body(name: str, *ends: dict[str, Any], mass: float = 1.0) -> dict[str, Any]:
    inertia = (0.01 * np.eye(3)).tolist()
    return {"ID": name, "mass": mass, "r_com": [0, 0, 0], "inertia": inertia, "connectors": [*ends]}


def module(name: str, *bodies: dict[str, Any], joints: Any = ()) -> dict[str, Any]:
    return {"header": {"ID": name, "name": f"the {name}"}, "bodies": [*bodies], "joints": [*joints]}


def joint(**changed: Any) -> dict[str, Any]:
    limits = {"positionLower": -1.0, "positionUpper": 1.0}
    return {"ID": "j", "parent": "a", "child": "b", "limits": limits, **changed}


BASE = module("base", body("foot", end("floor", "f", "base", (1,)), end("top", "m")))
TOOL = module("tool", body("grip", end("near", "f"), end("tip", "m", "eef", ())))


def imported(tmp_path: Path, *modules: dict[str, Any], **options: Any) -> tuple[str, list[str]]:
    """The text and the remarks; `srgc check` finds nothing but modules left over, and few words."""
    file = tmp_path / "modules.json"
    file.write_text(json.dumps([*modules]), encoding="utf-8")
    found = timor_import(file, **options)
    spec = tmp_path / "kit.srg"
    spec.write_text(found.text, encoding="utf-8")
    findings = interface.check(spec)
    left_over = any("nothing carries" in each for each in found.remarks)
    allowed = {"SRG0403", "SRG0408"} if left_over else {"SRG0408"}
    assert {each.code.value for each in findings} <= allowed
    return found.text, list(found.remarks)


def words(tmp_path: Path, srgc: Callable[..., Any], count: int) -> list[str]:
    ran = srgc("words", tmp_path / "kit.srg", "--limit", count)
    assert ran.status in (0, 4)
    return ran.out.splitlines()


def test_the_end_towards_the_base_is_female(tmp_path: Path) -> None:
    link = module("link", body("rod", end("far", "m"), end("near", "f")))
    text, _ = imported(tmp_path, BASE, link, TOOL)
    assert ports_of(blocks(text)["Link"]) == {
        "in": ("Flange_8", "female"),
        "out": ("Flange_8", "male"),
    }
    assert "// the link (ID link): in is its connector near, out far." in text
    assert "start Base;\n  with Link, Tool;" in text


def test_hermaphroditic_ends_make_a_module_for_each(
    tmp_path: Path, srgc: Callable[..., Any]
) -> None:
    base = module("base", body("foot", end("floor", "f", "base"), end("top", "h")))
    link = module("link", body("rod", end("one", "h"), end("two", "h")))
    tool = module("tool", body("grip", end("near", "h"), end("tip", "m", "eef")))
    text, remarks = imported(tmp_path, base, link, tool)
    assert ports_of(blocks(text)["Link_one"]) == {
        "in": ("Flange_8", None),
        "out": ("Flange_8", None),
    }
    assert any("one, two" in each for each in remarks)
    assert words(tmp_path, srgc, 3) == ["Base Tool", "Base Link_one Tool", "Base Link_two Tool"]


def test_any_end_mounts_a_male_end_on_a_female_one(tmp_path: Path) -> None:
    link = module("link", body("rod", end("near", "f"), end("far", "m")))
    turned = module("turned", body("rod", end("near", "f"), end("side", "f"), end("far", "m")))
    text, _ = imported(tmp_path, BASE, link, turned, TOOL, any_end=True)
    found = {
        name: ports_of(block)["in"][1] for name, block in blocks(text).items() if "Link" in name
    }
    assert found == {"Link_near": "female", "Link_far": "male"}


def test_outputs_of_a_fork_may_stay_open(tmp_path: Path, srgc: Callable[..., Any]) -> None:
    fork = module("fork", body("y", end("near", "f"), end("left", "m"), end("right", "m")))
    text, _ = imported(tmp_path, BASE, fork, TOOL)
    assert ports_of(blocks(text)["OpenFlange"]) == {"in": ("Flange_8", "female")}
    assert set(ports_of(blocks(text)["Fork"])) == {"in", "left", "right"}
    assert "Base Fork OpenFlange Tool" in words(tmp_path, srgc, 9)


def test_a_set_without_tools_works_at_its_open_end(tmp_path: Path) -> None:
    link = module("link", body("rod", end("near", "f"), end("far", "m")))
    text, _ = imported(tmp_path, BASE, link)
    assert "role effector;" in blocks(text)["OpenFlange"]


def test_sizes_and_types_keep_modules_apart(tmp_path: Path) -> None:
    other = module("wide", body("rod", end("near", "f", size=(12.5, "a")), end("far", "m")))
    text, remarks = imported(tmp_path, BASE, other, TOOL)
    assert ports_of(blocks(text)["Wide"])["in"] == ("Flange_12_5_a", "female")
    assert any("nothing carries Wide" in each for each in remarks)


def test_what_joints_have(tmp_path: Path) -> None:
    limits = {
        "positionLower": -math.inf,
        "positionUpper": 2.0,
        "velocity": 3.0,
        "acceleration": math.inf,
        "peakTorque": 40.0,
    }
    turn = joint(limits=limits, gearRatio=50, motorInertia=2e-5, frictionViscous=0.5)
    drive = module("drive", body("a", end("near", "f")), body("b", end("far", "m")), joints=[turn])
    text, remarks = imported(tmp_path, BASE, drive, TOOL)
    (found,) = limits_of(blocks(text)["Drive"])
    assert found == [-1000, 2, 3, math.inf, 40, 50, 2e-5, 0, 0.5]
    assert any("infinite" in each for each in remarks)


def test_passive_and_fixed_joints(tmp_path: Path) -> None:
    bodies = [body("a", end("near", "f")), body("b"), body("c", end("far", "m"))]
    joints = [
        joint(type="prismatic", passive=True),
        joint(ID="k", parent="b", child="c", type="fixed", poseParent=FLIPPED),
    ]
    text, _ = imported(tmp_path, BASE, module("slide", *bodies, joints=joints), TOOL)
    block = blocks(text)["Slide"]
    assert "dof s: prismatic z in [-1, 1] m;" in block or "dof j: prismatic" in block
    assert "torque(" in block
    assert "= 0 N;" in block
    assert block.count("dof ") == 1
    assert "rot(x, 180 deg)" in block


def test_a_joint_that_moves_nothing_is_left_out(tmp_path: Path) -> None:
    bodies = [body("a", end("near", "f"), end("far", "m")), body("b", mass=0.0)]
    bodies[1]["inertia"] = np.zeros((3, 3)).tolist()
    text, remarks = imported(tmp_path, BASE, module("idle", *bodies, joints=[joint()]), TOOL)
    assert "dof " not in blocks(text)["Idle"]
    assert any("moves nothing" in each for each in remarks)


def test_several_bases_are_several_grammars(tmp_path: Path) -> None:
    other = json.loads(json.dumps(BASE).replace('"base"', '"cart"', 1).replace("the base", "cart"))
    text, _ = imported(tmp_path, BASE, other, TOOL, name="Mine")
    assert "grammar MineOnMine_Base from ports" in text
    assert "grammar MineOnMine_Cart from ports" in text


def test_the_shipped_kit(srgc: Callable[..., Any], tmp_path: Path) -> None:
    ran = srgc("import", "timor", KIT, "-o", tmp_path / "kit.srg")
    assert ran.status == 0
    assert srgc("check", tmp_path / "kit.srg").status == 0
    assert srgc("fmt", "--check", tmp_path / "kit.srg").status == 0
    assert words(tmp_path, srgc, 3) == [
        "Column Quill",
        "Column Pivot BeamShort Quill",
        "Column Pivot BeamLong Quill",
    ]
    again = srgc("import", "timor", KIT / "modules.json", "-o", "-")
    assert again.out == (tmp_path / "kit.srg").read_text(encoding="utf-8")


def test_options_of_other_kinds_are_refused(srgc: Callable[..., Any]) -> None:
    ran = srgc("import", "timor", KIT, "--any-order")
    assert ran.status == 2
    assert "--any-order does not go with `srgc import timor`" in ran.err


@pytest.mark.parametrize("kind", ["timor", "cobra"])
def test_a_file_that_is_not_there(kind: str, srgc: Callable[..., Any], tmp_path: Path) -> None:
    assert srgc("import", kind, tmp_path / "none.json").status == 2
    assert srgc("import", kind, tmp_path).status == 2
