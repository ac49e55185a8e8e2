"""Round obstacles and targets: motions keep to the sets, refutations hold for the sets."""

from __future__ import annotations

import contextlib
import io
from pathlib import Path

import numpy as np
import pytest

from solvers.verifier.verification import Outcome, verify_directory
from srgc.cli import run
from tests.oracles import result_files

GANTRY = """\
module B { role base; }
module X { role joint; dof s: prismatic x in [-3, 3] m; }
module Y { role joint; dof s: prismatic y in [-3, REACH] m; }
module E { role effector; }
grammar G { start N; all: N -> B X Y E; }
semantics G { all {
  this.bridge = move(x, X.s);
  this.cart = this.bridge * move(y, Y.s);
  point(frame: this.bridge, mass: 3 kg);
  point(frame: this.cart, mass: 2 kg);
  effector(frame: this.cart);
} }
workspace W {
  plane xy;
  bounds box [-4, 4] x [-4, 4] m;
  REGIONS
}
task Go { robot G; workspace W; start in S at rest; reach T; AVOID
  effort <= 50 N; horizon 20 steps of 0.2 s; }
"""
FOUND, IMPOSSIBLE, UNKNOWN = 0, 3, 4


def synthesised(folder: Path, reach: str, regions: str, avoid: str = "") -> int:
    text = GANTRY.replace("REACH", reach).replace("REGIONS", regions).replace("AVOID", avoid)
    (folder / "g.srg").write_text(text, encoding="utf-8")
    with contextlib.redirect_stdout(io.StringIO()), contextlib.redirect_stderr(io.StringIO()):
        return run(["synth", str(folder / "g.srg"), "-o", str(folder / "out"), "-q"])


def places(folder: Path) -> np.ndarray:
    """The cart at 50 instants of every step: constant forces on each axis, by hand."""
    certificate = result_files.read(folder)
    state = np.array([float(x) for x in certificate["start"]])
    found = []
    for row in certificate["inputs"]:
        pull = np.array([float(x) for x in row]) / [5, 2]
        times = np.linspace(0, 0.2, 51)[:, None]
        found.extend(state[:2] + state[2:] * times + pull * times**2 / 2)
        state = np.concatenate([found[-1], state[2:] + 0.2 * pull])
    return np.array(found)


def to_segment(at: np.ndarray, one: np.ndarray, other: np.ndarray) -> np.ndarray:
    axis = other - one
    share = np.clip((at - one) @ axis / (axis @ axis), 0, 1)
    return np.asarray(np.linalg.norm(at - one - share[:, None] * axis, axis=1))


def test_a_motion_between_round_obstacles_into_a_ball(tmp_path: Path) -> None:
    regions = """region S ball (-1, -1) m radius 10 cm;
      target T capsule (1, 1), (1.3, 0.9) m radius 6 cm;
      obstacle O ball (0, 0.1) m radius 40 cm;
      obstacle P capsule (0.9, -1), (1.2, 0.4) m radius 8 cm;"""
    assert synthesised(tmp_path, "3", regions, "avoid O, P with effector, margin 1 cm;") == FOUND
    assert verify_directory(tmp_path / "out").outcome is Outcome.VALID
    at = places(tmp_path / "out")
    assert np.linalg.norm(at[0] - [-1, -1]) < 0.1
    assert to_segment(at[-1:], np.array([1, 1]), np.array([1.3, 0.9]))[0] < 0.06
    assert np.linalg.norm(at - [0, 0.1], axis=1).min() > 0.41
    assert to_segment(at, np.array([0.9, -1]), np.array([1.2, 0.4])).min() > 0.09


@pytest.mark.parametrize(
    ("height", "possible"),
    # Of a ball of 20 cm the cart gets to the lowest 1 mm, and to none of it.
    [("1.199", True), ("1.201", False), ("1.3", False)],
)
def test_only_what_the_whole_ball_rules_out_is_impossible(
    tmp_path: Path, height: str, *, possible: bool
) -> None:
    regions = f"""region S box [-0.1, 0.1] x [-0.1, 0.1] m;
      target T ball (0.13, {height}) m radius 20 cm;"""
    outcome = synthesised(tmp_path, "1", regions)
    assert outcome in ({FOUND, UNKNOWN} if possible else {IMPOSSIBLE})
    if outcome == IMPOSSIBLE:
        assert verify_directory(tmp_path / "out").outcome is Outcome.VALID


def test_a_gap_beside_a_ball_is_no_wall(tmp_path: Path) -> None:
    """A corridor that is closed by the polygon about a ball, whose corners are 2 % farther out."""
    slope = np.tan(np.radians(11.25))
    width = 0.5 * np.hypot(1, slope)
    regions = f"""region S box [-1.3, -1.1] x [-0.35, -0.15] m;
      target T box [1.1, 1.3] x [0.15, 0.35] m;
      obstacle Over polytope {{ y - {slope:.6f} * x >= {width:.6f}; y <= 4; x <= 4; x >= -4 }} m;
      obstacle Under polytope {{ y - {slope:.6f} * x <= -{width:.6f}; y >= -4; x <= 4; x >= -4 }} m;
      obstacle O ball (0, 0) m radius 49.5 cm;"""
    avoid = "avoid Over, Under, O with effector;"
    assert synthesised(tmp_path, "3", regions, avoid) in {FOUND, UNKNOWN}


@pytest.mark.parametrize(
    ("regions", "clause", "at"),
    [
        ("region R ball (1, 1) m radius 1 m;", "avoid R with effector;", "R with effector"),
        ("obstacle R ball (1, 1) m radius 1 m;", "satisfy eventually R;", "R;"),
        ("region R ball (1, 1) m radius 1 m;", "satisfy eventually R;", "R;"),
        ("region R ball (1, 1) m radius 0 m;", "", "0 m"),
        ("region R capsule (1, 1), (1, 1) m radius 1 m;", "", "capsule (1, 1)"),
        ("region R ball (1, 1, 1) m radius 1 m;", "", "(1, 1, 1)"),
        ("region R ball (1, 1) m radius 1 kg;", "", "1 kg"),
    ],
)
def test_what_is_wrong_with_round_regions(
    tmp_path: Path, regions: str, clause: str, at: str, capsys: pytest.CaptureFixture[str]
) -> None:
    both = "region S box [-0.1, 0.1] x [-0.1, 0.1] m; target T box [1, 2] x [1, 2] m;"
    text = GANTRY.replace("REACH", "3").replace("REGIONS", f"{both}\n  {regions}")
    (tmp_path / "g.srg").write_text(text.replace("AVOID", clause), encoding="utf-8")
    assert run(["check", str(tmp_path / "g.srg")]) == 1
    said = capsys.readouterr().out
    assert "error" in said
    line = next(line for line in said.splitlines() if "^" in line)
    source = said.splitlines()[said.splitlines().index(line) - 1]
    assert source[line.index("^") :].startswith(at.split(" with", maxsplit=1)[0])
