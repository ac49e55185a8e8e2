"""Missions of tasks of all kinds: loads, disturbances, motions for ever, least times."""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise
from pathlib import Path
from typing import Any

from tests.oracles import result_files
from tests.oracles.small_missions import HEAD
from tests.srgc.conftest import Ran

Run = Callable[..., Ran]

ARMS = (
    HEAD.replace("{0.5, 1} m", "[0.4, 1] m")
    + """
workspace W {
  plane xy;
  bounds box [-2, 2] x [-2, 2] m;
  region S box [0.7, 0.9] x [-0.3, 0] m;
  region M box [0.7, 0.95] x [0, 0.3] m;
  obstacle O polytope { x + y >= 1.3; x - y <= 0.6; x + y <= 1.6; x - y >= 0.2; } m;
  target T box [0.3, 0.6] x [0.6, 0.85] m;
}

workspace V {
  plane xy;
  bounds box [-2, 2] x [-2, 2] m;
  region S box [0.4, 0.6] x [-0.5, -0.3] m;
  target T box [0.5, 0.7] x [0.3, 0.5] m;
}

task Plain {
  robot Arm;
  workspace W;
  start in S at rest;
  reach T;
  avoid O with effector;
  effort <= 10 N*m;
  horizon 24 steps of 0.1 s;
  modules <= 6;
}

task Loop {
  robot Arm;
  workspace W;
  start in S at rest;
  satisfy always eventually T and always eventually M;
  repeat;
  effort <= 10 N*m;
  horizon 30 steps of 0.1 s;
  modules <= 6;
}

task Robust {
  robot Arm;
  workspace V;
  start in S at rest;
  reach T;
  robust start 0.2 deg;
  robust mass 2 %;
  effort <= 10 N*m;
  horizon 20 steps of 0.1 s;
  modules <= 6;
}

task Load {
  robot Arm;
  workspace V;
  start in S at rest;
  carry 0.3 kg from S to T;
  reach T;
  effort <= 15 N*m;
  horizon 24 steps of 0.15 s;
  modules <= 6;
}

task Fast {
  robot Arm;
  workspace V;
  start in S at rest;
  reach T;
  effort <= 10 N*m;
  horizon at most 24 steps of 0.1 s;
  modules <= 6;
  minimize time;
}

mission Together {
  tasks Plain, Robust, Load, Fast;
  one robot;
  minimize sum(price);
}

mission Chain {
  tasks Loop, Load, Fast;
  reconfigure change 1 / 2;
  free L.length;
}
"""
)


def solved(srgc: Run, place: Path, mission: str) -> Path:
    spec, folder = place / "arms.srg", place / mission
    spec.write_text(ARMS, encoding="utf-8")
    assert srgc("synth", spec, "--mission", mission, "-o", folder, "-q").status == 0
    assert srgc("verify", folder).status == 0
    return folder


def certificate(folder: Path, task: str) -> dict[str, Any]:
    found: dict[str, Any] = result_files.read(folder / "tasks" / task, "certificate.json")
    return found


def test_one_robot_carries_bears_disturbances_and_is_fast(tmp_path: Path, srgc: Run) -> None:
    """An arm with one joint: base, joint, link and tool cost 14, and no word is shorter."""
    folder = solved(srgc, tmp_path, "Together")
    design = result_files.read(folder, "design.json")
    (price,) = design["objectives"]
    assert price["value"] == price["least"] == 14
    claims = [certificate(folder, task) for task in ("Plain", "Robust", "Load", "Fast")]
    assert all(" ".join(claim["word"]) == "B eps JO eps L eps EN" for claim in claims)
    assert len({claim["parameters"][0]["value"] for claim in claims}) == 1
    # 10 N*m turn a link of 0.7 kg by less than a right angle in less than a second.
    assert claims[3]["steps"] < 12
    assert srgc("verify", folder / "tasks" / "Robust", "--task", "Robust").status == 0


def test_a_chain_with_a_motion_for_ever(tmp_path: Path, srgc: Run) -> None:
    """Half a unit for each length that changes; none has to."""
    folder = solved(srgc, tmp_path, "Chain")
    design = result_files.read(folder, "design.json")
    lengths = [certificate(folder, t)["parameters"][0]["value"] for t in ("Loop", "Load", "Fast")]
    altered = sum(a != b for a, b in pairwise(lengths))
    assert design["cost"] == altered / 2
    assert design["least"] <= design["cost"]
    # The hand of one link is on a circle: 0.7 m from the base meets S and T in both workspaces.
    assert "loop" in result_files.read(folder / "tasks" / "Loop", "design.json")
