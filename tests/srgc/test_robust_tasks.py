"""Tasks with disturbances, from the specification to the verifier's answer."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import pytest

from tests.conftest import ROOT
from tests.oracles.result_files import alter_spec
from tests.oracles.small_specs import TURNER

pytestmark = pytest.mark.usefixtures("without_pictures")


CLAUSES = "robust start 0.2 deg, 0.1 deg/s; robust effort 0.5 %;"
SHAKEN = TURNER.replace("  horizon", f"  {CLAUSES}\n  horizon")


@pytest.fixture(scope="module")
def shaken(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder of a run: a link of free length that is shaken and turns by a right angle."""
    from srgc.cli import run

    folder = tmp_path_factory.mktemp("shaken")
    (folder / "shaken.srg").write_text(SHAKEN, encoding="utf-8")
    assert run(["synth", str(folder / "shaken.srg"), "-o", str(folder / "out")]) == 0
    return folder


@pytest.fixture
def copied(shaken: Path, tmp_path: Path) -> Path:
    shutil.copytree(shaken / "out", tmp_path / "out")
    # It names the specification that is about to be altered.
    (tmp_path / "out" / "design.json").unlink()
    return tmp_path / "out"


def margins(srgc, folder):
    found = json.loads(srgc("verify", folder, "--json").out)
    return found, {each["name"]: each["margin"] for each in found["findings"]}


def test_found_and_verified(srgc, shaken):
    ran = srgc("verify", shaken / "out")
    assert ran.out.startswith("valid: found, level validated\n")
    assert ran.status == 0


def test_the_same_report_by_two_processes(srgc, shaken, tmp_path):
    """Of what holds, and of what does not: the planned motion goes on beside the disturbed ones."""
    alone, beside = (srgc("verify", shaken / "out", "--jobs", jobs) for jobs in ("1", "2"))
    assert (beside.status, beside.out) == (0, alone.out)
    wider = tmp_path / "wider"
    shutil.copytree(shaken / "out", wider)
    (wider / "design.json").unlink()
    alter_spec(wider, "0.2 deg, 0.1 deg/s", "20 deg, 10 deg/s", sign=True)
    alone, beside = (srgc("verify", wider, "--jobs", jobs) for jobs in ("1", "2"))
    assert alone.status != 0
    assert (beside.status, beside.out) == (alone.status, alone.out)


@pytest.mark.slow
def test_ten_seconds_between_obstacles(srgc, tmp_path):
    """Room that is the same everywhere, as wide as the tube at the end, leaves no way there."""
    text = (ROOT / "specs" / "planar_arm.srg").read_text(encoding="utf-8")
    robust = "  robust start 0.1 deg;\n  robust effort 0.5 %;\n"
    assert text.count("  effort <=") == 1
    shaken = text.replace("  effort <=", f"{robust}  effort <=")
    (tmp_path / "arm.srg").write_text(shaken, encoding="utf-8")
    assert srgc("synth", tmp_path / "arm.srg", "-o", tmp_path / "out").status == 0
    assert srgc("verify", tmp_path / "out").status == 0


def test_margins_are_those_of_disturbed_motions(srgc, copied):
    """Without disturbances the same design has more of them, but for what is about the plan."""
    answer, shaky = margins(srgc, copied)
    assert (answer["outcome"], answer["level"]) == ("valid", "validated")
    alter_spec(copied, CLAUSES, "", sign=True)
    _, calm = margins(srgc, copied)
    assert shaky.keys() == calm.keys()
    for name in ("target T", "bounds", "range of JO.q"):
        assert shaky[name] < calm[name]
    for name in ("start S", "cell path", "effort (N*m)"):
        assert shaky[name] == pytest.approx(calm[name])


def test_larger_disturbances_than_those_proved(srgc, copied):
    alter_spec(copied, "0.2 deg,", "9 deg,", sign=True)
    ran = srgc("verify", copied)
    assert ran.status == 1
    assert ran.out.startswith("refuted: target T: violated by a disturbed motion at 2 s\n")


def test_a_plan_says_that_it_leaves_them_out(srgc, spec):
    path = spec(SHAKEN)
    assert srgc("check", path).status == 0
    ran = srgc("plan", path)
    assert ran.status == 0
    assert ran.err == "note: a plan is not about motions: `robust` is left out\n"
    assert srgc("plan", spec(TURNER)).err == ""


@pytest.mark.slow
@pytest.mark.parametrize(("radius", "proved"), [("20 deg", False), ("12 deg", True)])
def test_too_much_for_any_room_is_unknown_with_the_reason(srgc, spec, tmp_path, radius, proved):
    text = SHAKEN.replace("0.2 deg,", f"{radius},").replace("horizon", "modules <= 4;\n  horizon")
    text = text.replace("robust start", "control open loop; robust start")
    ran = srgc("synth", spec(text), "-o", tmp_path / "out")
    assert ran.status == 4
    assert "no motion was found that leaves disturbed ones the clearance" in ran.out
    # Of more than a motion can leave from the beginning nothing is tried to be proved.
    outgrown = "the enclosure of the disturbed motions outgrows the margin of `"
    assert (outgrown in ran.out and "` at " in ran.out) is proved


@pytest.mark.slow
def test_the_example_is_found_and_verified(srgc, made):
    """Two links that differ, a thick obstacle, and disturbances of a cheap drive."""
    folder = made("robust_arm") / "out"
    assert srgc("verify", folder).status == 0
    lengths = [
        float(p["value"]) for p in json.loads((folder / "design.json").read_text())["parameters"]
    ]
    assert lengths[0] > lengths[1] + 0.1


SIX = """\
module B { role base; }
module Z { role joint; dof q: revolute z in [-150, 150] deg; }
module Y { role joint; dof q: revolute y in [-110, 110] deg; }
module X { role joint; dof q: revolute x in [-150, 150] deg; }
module L { role link; const length = 0.3 m; const mass = 1 kg; }
module EN { role effector; const mass = 0.5 kg; }
edge eps;
grammar Six {
  start N;
  base: N -> B;
  turn: N -> N eps Z; lift: N -> N eps Y; roll: N -> N eps X; link: N -> N eps L;
  tool: N -> N eps EN;
  accept matches B eps Z eps L eps Y eps L eps X eps L eps Z eps L eps Y eps L eps X eps EN;
}
semantics Six {
  base { this.frame = world * move(z, 0.3 m); }
  turn { this.frame = N.frame * rot(z, Z.q); }
  lift { this.frame = N.frame * rot(y, Y.q); }
  roll { this.frame = N.frame * rot(x, X.q); }
  link { this.frame = N.frame * move(x, L.length) * rot(x, 20 deg);
         solid(frame: N.frame, mass: L.mass, com: (L.length / 2, 0, 0.01 m),
           inertia: (0.002 kg*m^2, 0.009 kg*m^2, 0.01 kg*m^2, 0.001 kg*m^2, 0, 0)); }
  tool { this.frame = N.frame * move(y, 0.1 m); point(frame: this.frame, mass: EN.mass);
         effector(frame: this.frame); }
}
workspace Room {
  space xyz;
  bounds box [-2, 2] x [-2, 2] x [-2, 2] m;
  region S box [1.3, 1.6] x [-0.1, 0.3] x [0.1, 0.5] m;
  target T box [1.3, 1.6] x [0.1, 0.5] x [0.1, 0.5] m;
}
task Move {
  robot Six;
  workspace Room;
  start in S at rest;
  reach T;
  effort <= 10 N*m;
  horizon 4 steps of 0.1 s;
  robust start 0.01 deg, 0.01 deg/s;
  gravity (0, 0, -1) m/s^2;
}
"""


@pytest.mark.slow
def test_six_joints_in_space_have_an_answer(srgc, spec, tmp_path):
    """Their second derivatives are not made; what is found without them is valid."""
    folder = tmp_path / "out"
    found = srgc("synth", spec(SIX), "-q", "-o", folder)
    assert found.status in (0, 4)
    if found.status == 0:
        assert srgc("verify", folder).status == 0
