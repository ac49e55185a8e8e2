"""Tasks with formulas, from file to certificate; what is found is judged by exact arithmetic."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator
from fractions import Fraction
from math import atan, cos, sin, sqrt
from pathlib import Path

import pytest

from tests.oracles import result_files
from tests.oracles.small_specs import SLIDER, TURNER, replaced
from tests.oracles.some_cases import some
from tests.srgc.conftest import Ran

pytestmark = pytest.mark.usefixtures("without_pictures")


Run = Callable[..., Ran]
STEP = Fraction(1, 5)
FINE = 50
"""A step is looked at so many times."""


def with_formulas(text: str, *clauses: str) -> str:
    text = text.replace("effort <= 10 N;", "effort <= 40 N;")
    return replaced(text, "  reach T;\n", "".join(f"  satisfy {clause};\n" for clause in clauses))


def found(srgc: Run, folder: Path, text: str) -> Path:
    """The result folder of a spec that is found and valid."""
    spec = folder / "spec.srg"
    spec.write_text(text, encoding="utf-8")
    out = folder / "out"
    ran = srgc("synth", spec, "-o", out)
    assert ran.status == 0, ran.out + ran.err
    verified = srgc("verify", out)
    assert verified.status == 0, verified.out
    assert "satisfy" in verified.out
    return out


def slides(out: Path) -> Iterator[tuple[Fraction, Fraction]]:
    """Exact times and places of the mass on the rail: x'' = u / (1 kg), u held over each step."""
    claim = result_files.read(out)
    q, v = (Fraction(text) for text in claim["start"])
    for number, row in enumerate(claim["inputs"]):
        u = Fraction(row[0])
        for part in range(FINE):
            t = STEP * part / FINE
            yield STEP * number + t, q + v * t + u * t * t / 2
        q, v = q + v * STEP + u * STEP * STEP / 2, v + u * STEP
    yield STEP * len(claim["inputs"]), q


S, T = (Fraction(1, 10), Fraction(1, 2)), (Fraction(2), Fraction(5, 2))


def inside(place: Fraction, region: tuple[Fraction, Fraction]) -> bool:
    return region[0] <= place <= region[1]


def test_there_in_time_and_back_for_a_while(srgc: Run, tmp_path: Path) -> None:
    formula = "eventually[0 s, 1 s] T and last[0.5 s] S"
    out = found(srgc, tmp_path, with_formulas(SLIDER, formula))
    motion = list(slides(out))
    assert any(inside(place, T) for time, place in motion if time <= 1)
    assert all(inside(place, S) for time, place in motion if time >= Fraction(3, 2))
    (stated,) = json.loads((out / "design.json").read_text())["satisfy"]
    # The sampled robustness is no less than what is certified, and not much more.
    there = max(min(p - T[0], T[1] - p) for time, p in motion if time <= 1)
    back = min(min(p - S[0], S[1] - p) for time, p in motion if time >= Fraction(3, 2))
    dense = float(min(there, back, Fraction(1, 5)))
    assert 0 < stated["robustness"] <= dense + 1e-9
    assert stated["robustness"] >= 0.8 * dense - 1e-3


def test_never_there_until_it_was_somewhere_else(srgc: Run, tmp_path: Path) -> None:
    text = replaced(SLIDER, "  target T", "  region W box [2.8, 3.2] x [-0.2, 0.2] m;\n  target T")
    text = text.replace("in [0, 3] m", "in [0, 3.5] m").replace("10 steps", "16 steps")
    text = with_formulas(text, "eventually W", "not S until W or eventually[2 s, 3.2 s] S")
    motion = list(slides(found(srgc, tmp_path, text)))
    away = (Fraction(14, 5), Fraction(16, 5))
    assert any(inside(place, away) for _, place in motion)
    first = next(time for time, place in motion if inside(place, away))
    returns = any(inside(place, S) for time, place in motion if time >= 2)
    assert returns or all(not inside(place, S) for time, place in motion if time < first)


def test_a_window_between_samples_is_kept_at_every_instant(srgc: Run, tmp_path: Path) -> None:
    """Its ends, 0.73 s and 0.91 s, are no samples."""
    text = with_formulas(SLIDER, "always[0.73 s, 0.91 s] T", "not T until not S", "last[0 s] S")
    motion = list(slides(found(srgc, tmp_path, text)))
    window = [p for t, p in motion if Fraction(73, 100) <= t <= Fraction(91, 100)]
    assert window
    assert all(inside(place, T) for place in window)
    assert inside(motion[-1][1], S)


def test_a_turn_there_and_back(srgc: Run, tmp_path: Path) -> None:
    formula = "eventually[0 s, 2 s] (T by effector 1 and eventually S by effector 1)"
    text = with_formulas(TURNER, formula)
    out = found(srgc, tmp_path, text.replace("10 steps", "16 steps"))
    rows = (out / "trajectory.csv").read_text().splitlines()
    names = rows[0].split(",")
    x, y = names.index("e1_x"), names.index("e1_y")
    tips = [tuple(map(float, (row.split(",")[x], row.split(",")[y]))) for row in rows[1:]]
    there = [i for i, (a, b) in enumerate(tips) if abs(a) <= 0.3 and 1.2 <= b <= 1.9]
    back = [i for i, (a, b) in enumerate(tips) if abs(b) <= 0.3 and 1.2 <= a <= 1.9]
    assert min(there) <= 10
    assert max(back) > min(there)


def test_a_formula_beside_reach_and_avoid(srgc: Run, tmp_path: Path) -> None:
    """The way round the other side: W lies beyond the obstacle's shadow."""
    region = "  region W box [-0.9, -0.3] x [-0.9, 0.9] m;\n  target T"
    text = replaced(TURNER, "  target T", region)
    text = text.replace("  reach T;", "  reach T;\n  satisfy eventually W by effector 1;")
    text = text.replace("10 steps", "20 steps").replace("box [-1, 3]", "box [-2.5, 3]", 1)
    out = found(srgc, tmp_path, text.replace("[-1, 3] m", "[-2.5, 3] m"))
    design = json.loads((out / "design.json").read_text())
    assert any(name.split(".")[0] == "W" for name in design["path"][0])
    assert design["path"][0][-1].split(".")[0] == "T"


@pytest.mark.parametrize(
    ("clauses", "status"),
    [
        (("eventually[1 s, 9 s] T and always not T",), 5),
        (("eventually[0 s, 0.02 s] T",), 3),  # too soon for the drives
    ],
)
def test_what_is_not_found(
    srgc: Run, tmp_path: Path, clauses: tuple[str, ...], status: int
) -> None:
    spec = tmp_path / "spec.srg"
    spec.write_text(with_formulas(SLIDER, *clauses), encoding="utf-8")
    assert srgc("synth", spec, "-o", tmp_path / "out").status == status


RAIL = """\
module C { role base; }
module P { role joint; dof d: prismatic x in [-2, 6] m; const mass = 1 kg; }
module EN { role effector; }
grammar G { start N; w: N -> C P EN; }
semantics G {
  w { this.f = move(x, P.d); point(frame: this.f, mass: P.mass); effector(frame: this.f); }
}
workspace W {
  plane xy; bounds box [-2, 6] x [-1, 1] m;
  region A box [-0.5, 0.5] x [-1, 1] m; region B box [0.5, 2] x [-1, 1] m;
}
task T {
  robot G; workspace W; start in A; effort <= 50 N;
  horizon 2 steps of 0.25 s; satisfy always (A or B);
  satisfy next not A;
}
"""
"""From one region to another that touches it, within one step."""


@pytest.mark.parametrize(
    "formula", some(["A and next next not A", "next not A", "last[0 s] not A"], 1)
)
def test_from_inside_to_outside_between_two_samples(
    srgc: Run, tmp_path: Path, formula: str
) -> None:
    out = found(srgc, tmp_path, RAIL.replace("next not A", formula))
    (whole, _) = json.loads((out / "design.json").read_text())["satisfy"]
    # On the common side the tip is on the boundary of both regions.
    assert whole == {"formula": "always (A or B)", "robustness": 0.0}


def test_where_poses_reach_cells_only_at_their_boundary(srgc: Run, tmp_path: Path) -> None:
    """So many cells that one of their sides is on the rail: plans are tried all the same."""
    spec = tmp_path / "spec.srg"
    spec.write_text(RAIL, encoding="utf-8")
    ran = srgc("synth", spec, "-o", tmp_path / "out", "--cells", "40")
    assert ran.status == 4
    assert "robustness" in ran.out


FORK = """\
module Foot { role base; }
module Turn { role joint; dof q: revolute z in [-170, 170] deg rate in [-3, 3] rad/s; }
module Bar { role link; const length = 1 m; const spread = 0.2 m; const mass = 0.5 kg; }
module Left { role effector; }
module Right { role effector; }
grammar G { start R; whole: R -> Foot Turn Bar Left Right; }
semantics G {
  whole {
    this.hub = world * rot(z, Turn.q);
    this.tip = this.hub * move(x, Bar.length);
    point(frame: this.tip, mass: Bar.mass);
    effector(frame: this.tip * move(y, Bar.spread));
    effector(frame: this.tip * move(y, -Bar.spread));
  }
}
workspace W {
  plane xy; bounds box [-1.5, 1.5] x [-1.5, 1.5] m;
  region Home box [0.9, 1.1] x [0.1, 0.35] m;
  region A box [0.5, 0.75] x [0.7, 0.95] m;
  region B box [0.4, 0.65] x [0.75, 1] m;
}
task T {
  robot G; workspace W; start in Home by effector 1 at rest; effort <= 20 N*m;
  satisfy not B by effector 2 until A by effector 1;
  satisfy eventually[0 s, 1 s] A by effector 1 and last[0.2 s] B by effector 2;
  horizon 15 steps of 0.1 s;
}
"""


def test_one_effector_goes_on_when_the_other_has_work_left(srgc: Run, tmp_path: Path) -> None:
    """The first is done in A, and has to leave it before the second one can be in B."""
    out = found(srgc, tmp_path, FORK)
    rows = (out / "trajectory.csv").read_text().splitlines()
    last = float(rows[-1].split(",")[rows[0].split(",").index("q1")])
    first = cos(last) - 0.2 * sin(last), sin(last) + 0.2 * cos(last)
    other = cos(last) + 0.2 * sin(last), sin(last) - 0.2 * cos(last)
    assert 0.4 <= other[0] <= 0.65
    assert 0.75 <= other[1] <= 1
    assert not (0.5 <= first[0] <= 0.75 and 0.7 <= first[1] <= 0.95)


def test_where_effectors_start_follows_from_one_another(srgc: Run, tmp_path: Path) -> None:
    """Paths of the second effector from B on are shortest, and it is not there at first."""
    clauses = FORK[FORK.index("  satisfy") : FORK.index("  horizon")]
    then = "A by effector 1 and eventually (B by effector 2 and eventually Home by effector 2)"
    out = found(srgc, tmp_path, FORK.replace(clauses, f"  satisfy eventually ({then});\n"))
    rows = [row.split(",") for row in (out / "trajectory.csv").read_text().splitlines()]
    angles = [float(row[rows[0].index("q1")]) for row in rows[1:]]
    first, other = ([angle + sign * atan(0.2) for angle in angles] for sign in (1, -1))
    in_a, in_b = (0.5, 0.75, 0.7, 0.95), (0.4, 0.65, 0.75, 1)
    one = next(i for i, angle in enumerate(first) if at(angle, in_a))
    two = next(i for i, angle in enumerate(other) if i >= one and at(angle, in_b))
    assert any(at(angle, (0.9, 1.1, 0.1, 0.35)) for angle in other[two:])


def at(angle: float, box: tuple[float, float, float, float]) -> bool:
    """Whether a tip of the fork, whose direction is given, is in a box; 1e-9 m for the text."""
    x, y = sqrt(1.04) * cos(angle), sqrt(1.04) * sin(angle)
    return box[0] - 1e-9 <= x <= box[1] + 1e-9 and box[2] - 1e-9 <= y <= box[3] + 1e-9
