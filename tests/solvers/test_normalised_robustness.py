"""Robustness as the least share of what inputs can keep from their bounds, on a gantry."""

from __future__ import annotations

import contextlib
import io
import json
from pathlib import Path

import pytest

from solvers.verifier.verification import Outcome, verify_directory
from srgc.cli import run
from tests.oracles import result_files

SPEC = """\
module B { role base; }
module X { role joint; dof s: prismatic x in [-3, 3] m effort <= 10 N; }
module Y { role joint; dof s: prismatic y in [-3, 3] m effort <= 1000 N; }
module Z { role joint; dof q: revolute z in [-3, 3] effort <= 4 N*m; }
module E { role effector; }
grammar G { start N; all: N -> B Y X Z E; }
semantics G { all {
  this.bridge = move(y, Y.s);
  this.cart = this.bridge * move(x, X.s);
  point(frame: this.bridge, mass: 398 kg);
  point(frame: this.cart, mass: 2 kg);
  rod(frame: this.cart * rot(z, Z.q), axis: x, length: 2 mm, density: 1 kg/m);
  effector(frame: this.cart);
} }
workspace W {
  plane xy;
  bounds box [-3, 3] x [-3, 3] m;
  region S box [-0.001, 0.001] x [-0.001, 0.001] m;
  target T box [0.4, 0.402] x [1.2, 1.202] m;
}
task Go { robot G; workspace W; start in S at rest; reach T at rest; horizon 20 steps of 0.1 s; }
"""
Y_NEEDS = 4 * 400 * (1.2 - 0.001) / 2.0**2
"""N, of the bridge from rest to rest in 2 s: half the time forwards, half of it backwards.

Where it may creep at the end, it is less by a thousandth at most."""


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    scratch = tmp_path_factory.mktemp("gantry")
    (scratch / "g.srg").write_text(SPEC, encoding="utf-8")
    text = io.StringIO()
    with contextlib.redirect_stdout(text), contextlib.redirect_stderr(io.StringIO()):
        assert run(["synth", str(scratch / "g.srg"), "-o", str(scratch / "out"), "-q"]) == 0
    (scratch / "printed").write_text(text.getvalue(), encoding="utf-8")
    return scratch / "out"


def peaks(folder: Path) -> list[float]:
    rows = result_files.read(folder)["inputs"]
    return [max(abs(float(row[j])) for row in rows) for j in range(3)]


def test_the_weakest_share_is_as_large_as_can_be(folder: Path) -> None:
    """With margins in newtons the bridge might use all but 10 N of its thousand."""
    bridge, cart, _ = peaks(folder)
    assert 0.999 * Y_NEEDS <= bridge <= 1.01 * Y_NEEDS
    assert 1 - cart / 10 >= 1 - bridge / 1000


def test_what_is_said_of_it(folder: Path) -> None:
    design = json.loads((folder / "design.json").read_text(encoding="utf-8"))
    bridge, cart, turn = peaks(folder)
    assert design["robustness_share"] == pytest.approx(1 - bridge / 1000, rel=1e-12)
    least = min(1000 - bridge, 10 - cart)
    by_unit = {each["unit"]: each["margin"] for each in design["robustness_by_unit"]}
    assert by_unit == pytest.approx({"N": least, "N*m": 4 - turn}, rel=1e-12)
    said = (folder.parent / "printed").read_text(encoding="utf-8").splitlines()
    share = 100 * (1 - bridge / 1000)
    # Beside the share stands what is left of that very bound.
    assert f"robustness: {share:.4g} % ({1000 - bridge:.4g} N, {4 - turn:.4g} N*m)" in said
    picture = (folder / "figures" / "workspace.svg").read_text(encoding="utf-8")
    assert f"robustness {share:.4g} %" in picture
    assert verify_directory(folder).outcome is Outcome.VALID


@pytest.mark.parametrize(
    ("field", "value"),
    [
        ("robustness_share", 0.9),
        ("robustness_share", None),
        ("robustness_by_unit", [{"unit": "N", "margin": 9.9}, {"unit": "N*m", "margin": 4.0}]),
        ("robustness_by_unit", [{"unit": "N", "margin": 9.9}]),
        ("robustness_by_unit", [["unit", "margin"], 3]),
        ("robustness_by_unit", "N"),
    ],
)
def test_another_robustness_is_refuted(folder: Path, field: str, value: object) -> None:
    path = folder / "design.json"
    before = path.read_text(encoding="utf-8")
    path.write_text(json.dumps(json.loads(before) | {field: value}), encoding="utf-8")
    report = verify_directory(folder)
    path.write_text(before, encoding="utf-8")
    assert report.outcome is Outcome.REFUTED
    assert "design.json states" in str(report.reason)


def test_older_results_say_nothing_of_it(folder: Path) -> None:
    path = folder / "design.json"
    before = path.read_text(encoding="utf-8")
    content = json.loads(before)
    del content["robustness_share"], content["robustness_by_unit"]
    path.write_text(json.dumps(content), encoding="utf-8")
    report = verify_directory(folder)
    path.write_text(before, encoding="utf-8")
    assert report.outcome is Outcome.VALID
