"""The case study judged by the whole arm (row 4.14): one design found, the published one refuted.

Poses and distances are computed here, from angles and lengths as they stand in the results.
"""

from __future__ import annotations

import csv
from collections.abc import Callable
from math import cos, pi, sin
from pathlib import Path

import pytest
import shapely

from solvers.verifier.verification import Outcome, verify_directory
from tests.oracles import result_files
from tests.oracles.result_files import alter_spec
from tests.srgc.conftest import ROOT, Ran

pytestmark = pytest.mark.usefixtures("without_pictures")


Run = Callable[..., Ran]
Made = Callable[[str], Path]

FOUND, PAPER = "planar_arm_body", "planar_arm_body_paper"
OBSTACLE = shapely.box(1.7, 2, 3, 3)
MARGIN = 0.02


def links(lengths: tuple[float, float], q: tuple[float, float]) -> shapely.LineString:
    elbow = (lengths[0] * cos(q[0]), lengths[0] * sin(q[0]))
    angle = q[0] + q[1]
    tip = (elbow[0] + lengths[1] * cos(angle), elbow[1] + lengths[1] * sin(angle))
    return shapely.LineString([(0, 0), elbow, tip])


def test_the_published_arm_is_refuted(srgc: Run, made: Made) -> None:
    place = made(PAPER)
    assert (place / "status").read_text(encoding="utf-8") == "3"
    design = result_files.read(place / "out", "design.json")
    assert design["verdict"] == "impossible"
    (structure,) = design["structures_tried"]
    assert " ".join(structure["word"]) == "B eps JO eps L1 eps JO eps L2 eps EN"
    assert structure["verdict"] == "refuted"
    file = ROOT / "specs" / f"{PAPER}.srg"
    ran = srgc("verify", place / "out", "--spec", file)
    assert ran.status == 0
    assert ran.out.startswith("valid: impossible, level validated")
    assert srgc("verify", place / "out", "--trust", "z3").status == 0


def test_a_margin_is_no_part_of_the_evidence(result: Callable[[str], Path]) -> None:
    """Scripts and coverings leave margins out; an obstacle elsewhere is another matter."""
    folder = result(PAPER)
    (folder / "design.json").unlink()
    alter_spec(folder, "margin 0.02 m", "margin 0.03 m", sign=True)
    assert verify_directory(folder, trust="z3").outcome is Outcome.VALID
    alter_spec(folder, "x <= 3;", "x <= 2;", sign=True)
    report = verify_directory(folder, trust="z3")
    assert report.outcome is Outcome.REFUTED
    assert "0000.boxes does not refute structure 0" in str(report.reason)


@pytest.mark.slow
def test_a_whole_arm_is_found_and_stays_clear(srgc: Run, made: Made) -> None:
    folder = made(FOUND) / "out"
    ran = srgc("verify", folder, "--spec", ROOT / "specs" / f"{FOUND}.srg")
    assert (ran.status, ran.out.splitlines()[0]) == (0, "valid: found, level validated")
    design = result_files.read(folder, "design.json")
    assert " ".join(design["word"]) == "B eps JO eps L eps JO eps L eps EN"
    first, second = (item["value"] for item in design["parameters"])
    assert min(first, second) >= 0.5
    assert max(first, second) <= 5
    with (folder / "trajectory.csv").open(encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))
    poses = [(float(row["q1"]), float(row["q2"])) for row in rows]
    assert len(poses) == 82
    assert all(max(map(abs, pose)) <= pi for pose in poses)
    arms = [links((first, second), pose) for pose in poses]
    assert min(arm.distance(OBSTACLE) for arm in arms) > MARGIN
    for arm, (low, high) in (
        (arms[0], ((0.8, 1.2), (1.0, 1.4))),
        (arms[-1], ((3.5, 4.2), (3.8, 4.5))),
    ):
        tip = arm.coords[-1]
        assert low[0] < tip[0] < low[1]
        assert high[0] < tip[1] < high[1]


THREE_LINKS = """\
module B { role base; }
module JO { role joint; dof q: revolute z in [-180, 180] deg; }
module L { role link; param length in [0.6, 2] m; const density = 1 kg/m; }
module EN { role effector; }
edge eps;
grammar Arm {
  start N;
  base: N -> B;  joint: N -> N eps JO;  link: N -> N eps L;  tool: N -> N eps EN;
  accept matches B eps JO eps L eps JO eps L eps JO eps L eps EN;
}
semantics Arm {
  base { this.frame = world; }
  joint { this.frame = N.frame * rot(z, JO.q); }
  link {
    this.frame = N.frame * move(x, L.length);
    rod(frame: N.frame, axis: x, length: L.length, density: L.density, radius: 0.03 m);
  }
  tool { this.frame = N.frame; effector(frame: N.frame); }
}
workspace Bench {
  plane xy;
  bounds box [-4, 4] x [-4, 4] m;
  region S box [1.8, 2.2] x [-1.4, -1.0] m;
  obstacle O1 polytope { x + y <= 2.1; -x - y <= -1.5; x - y <= 1.9; -x + y <= -0.9; } m;
  obstacle O2 polytope { x + 2*y <= 4.4; -x - 2*y <= -3.4; 2*x - y <= 0.4; -2*x + y <= 0.7; } m;
  target T box [0.7, 1.1] x [2.2, 2.6] m;
}
task Go {
  robot Arm;  workspace Bench;
  start in S at rest;  reach T;
  avoid O1, O2 with body margin 0.02 m;
  bounds with body;
  effort <= 20 N*m;
  horizon 60 steps of 0.1 s;
}
"""
TILTED = (
    shapely.Polygon([(1.2, 0.3), (1.5, 0.6), (2.0, 0.1), (1.7, -0.2)]),
    shapely.Polygon([(0.4, 1.5), (0.84, 1.28), (1.04, 1.68), (0.6, 1.9)]),
)


@pytest.mark.slow
def test_three_links_find_their_way_around_two_tilted_obstacles(tmp_path: Path, srgc: Run) -> None:
    path = tmp_path / "three.srg"
    path.write_text(THREE_LINKS, encoding="utf-8")
    assert srgc("synth", path, "-o", tmp_path / "out").status == 0
    assert srgc("verify", tmp_path / "out").status == 0
    design = result_files.read(tmp_path / "out", "design.json")
    lengths = [item["value"] for item in design["parameters"]]
    with (tmp_path / "out" / "trajectory.csv").open(encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == 61
    for row in rows:
        places, angle = [(0.0, 0.0)], 0.0
        for joint, length in enumerate(lengths, 1):
            angle += float(row[f"q{joint}"])
            x, y = places[-1]
            places.append((x + length * cos(angle), y + length * sin(angle)))
        arm = shapely.LineString(places)
        assert min(arm.distance(obstacle) for obstacle in TILTED) > MARGIN + 0.03 - 1e-6
        assert max(abs(x) for place in places for x in place) < 4
