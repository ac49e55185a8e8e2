"""A robot that starts at rest and could stand there: torques by hand, and what cannot."""

from __future__ import annotations

import contextlib
import io
import shutil
from pathlib import Path

import numpy as np
import pytest

from solvers.verifier.verification import Outcome, Report, verify_directory
from srgc.cli import run
from tests.oracles import result_files
from tests.oracles.small_specs import MOTOR

SPEC = """\
module B { role base; }
module J { role joint; dof q: revolute z in [-170, 170] deg; }
module Upper { role link; const length = 0.6 m; }
module Fore { role link; const length = 0.45 m; }
module E { role effector; }
grammar Pair { start N; all: N -> B I:J Upper K:J Fore E; }
semantics Pair { all {
  this.one = rot(z, I.q);
  this.two = this.one * move(x, Upper.length) * rot(z, K.q);
  rod(frame: this.one, axis: x, length: Upper.length, density: 1 kg/m);
  rod(frame: this.two, axis: x, length: Fore.length, density: 2 kg/m);
  effector(frame: this.two * move(x, Fore.length));
} }
workspace Table { plane xy; bounds box [-3, 3] x [-3, 3] m;
  region S box REGION m;
  target T box [-0.4, 0.4] x [-1.03, -0.75] m; }
task Turn { robot Pair; workspace Table; start in S at rest HELD; reach T; effort <= BOUND;
  gravity (0, -9.81) m/s^2; horizon 12 steps of 0.1 s; }
"""


def synthesised(folder: Path, held: str, region: str, bound: str) -> int:
    text = SPEC.replace("HELD", held).replace("REGION", region).replace("BOUND", bound)
    (folder / "s.srg").write_text(text, encoding="utf-8")
    with contextlib.redirect_stdout(io.StringIO()), contextlib.redirect_stderr(io.StringIO()):
        return run(["synth", str(folder / "s.srg"), "-o", str(folder / "out"), "-q"])


def torques(folder: Path) -> np.ndarray:
    """What holds the two rods where they start, by hand."""
    one, two = (float(x) for x in result_files.read(folder)["start"][:2])
    m, n, weight = 0.6, 0.9, 9.81
    outer = n * 0.225 * weight * np.cos(one + two)
    return np.array([(m * 0.3 + n * 0.6) * weight * np.cos(one) + outer, outer])


def margin(report: Report) -> float:
    (found,) = [each for each in report.conditions if each.name == "start held"]
    return found.margin


FAR = "[0.75, 1.04] x [-0.3, 0.3]"
"""An arm that is stretched out takes 9 N*m; one that is bent takes less."""


@pytest.mark.parametrize("bound", ["7.5 N*m", "8 N*m norm 2"])
def test_the_start_can_be_held(tmp_path: Path, bound: str) -> None:
    assert synthesised(tmp_path, "held", FAR, bound) == 0
    report = verify_directory(tmp_path / "out")
    assert report.outcome is Outcome.VALID
    needed = torques(tmp_path / "out")
    largest = float(bound.split(maxsplit=1)[0])
    size = np.linalg.norm(needed) if "norm" in bound else np.abs(needed).max()
    assert margin(report) == pytest.approx(1 - size / largest, rel=1e-9)
    assert size < largest


OUT = "[0.98, 1.04] x [-0.2, 0.2]"


def test_what_falls_from_its_start_could_not_stand_there(tmp_path: Path) -> None:
    assert synthesised(tmp_path, "held", OUT, "3 N*m") == 3  # stretched out, it takes 9 N*m
    assert verify_directory(tmp_path / "out").outcome is Outcome.VALID
    shutil.rmtree(tmp_path / "out")
    assert synthesised(tmp_path, "", OUT, "3 N*m") == 0
    needed = torques(tmp_path / "out")
    result_files.alter_spec(tmp_path / "out", "at rest ;", "at rest held;", sign=True)
    report = verify_directory(tmp_path / "out")
    assert report.outcome is Outcome.REFUTED
    assert "start held" in str(report.reason)
    assert np.abs(needed).max() > 3


@pytest.mark.parametrize("weight", ["", " gravity (0, -1) m/s^2;"])
def test_a_motor_without_current_holds_what_has_no_weight(tmp_path: Path, weight: str) -> None:
    """Volts change its current, and no torque at once."""
    (tmp_path / "m.srg").write_text(MOTOR, encoding="utf-8")
    with contextlib.redirect_stdout(io.StringIO()), contextlib.redirect_stderr(io.StringIO()):
        assert run(["synth", str(tmp_path / "m.srg"), "-o", str(tmp_path / "out"), "-q"]) == 0
    result_files.alter_spec(tmp_path / "out", "at rest;", f"at rest held;{weight}", sign=True)
    (tmp_path / "out" / "design.json").unlink()  # it has the digest of the other spec
    report = verify_directory(tmp_path / "out")
    assert report.outcome is (Outcome.REFUTED if weight else Outcome.VALID)
    assert not weight or "no input pushes against" in str(report.reason)


BIASED = """\
module B { role base; }
module J { role joint; dof q: revolute z in [-170, 170] deg; input b in BIAS N*m;
  torque(q) = u + b; }
module E { role effector; }
grammar G { start N; all: N -> B J E; }
semantics G { all {
  this.one = rot(z, J.q);
  solid(frame: this.one, mass: 1 kg, com: (0.5, 0) m, inertia: 0.1 kg*m^2);
  effector(frame: this.one * move(x, 1 m));
} }
workspace W { plane xy; bounds box [-2, 2] x [-2, 2] m;
  region S box [0.9, 1.1] x [-0.1, 0.1] m;
  target T box [-0.2, 0.2] x [0.9, 1.1] m; }
task Go { robot G; workspace W; start in S at rest held; reach T at rest;
  effort <= 10 N*m; gravity (0, -9.81) m/s^2; horizon 20 steps of 0.1 s; }
"""


def test_a_gain_that_may_be_anything_hides_no_balance(tmp_path: Path) -> None:
    """With torque u * b and b from 1 to 3, each pushes only as much as the other lets it."""
    text = BIASED.replace("BIAS N*m", "[1, 3]").replace("u + b", "u * b")
    (tmp_path / "b.srg").write_text(text, encoding="utf-8")
    with contextlib.redirect_stdout(io.StringIO()), contextlib.redirect_stderr(io.StringIO()):
        assert run(["synth", str(tmp_path / "b.srg"), "-o", str(tmp_path / "out"), "-q"]) == 0
    report = verify_directory(tmp_path / "out")
    assert report.outcome is Outcome.VALID
    assert 0 < margin(report) < 1


@pytest.mark.parametrize("bias", ["[1, 1]", "[-1, 1]"])
def test_a_small_or_fixed_input_leaves_the_load_to_the_other(tmp_path: Path, bias: str) -> None:
    """Where it is level, 4.9 N*m hold it: of equal parts the small input would break its bound."""
    (tmp_path / "b.srg").write_text(BIASED.replace("BIAS", bias), encoding="utf-8")
    with contextlib.redirect_stdout(io.StringIO()), contextlib.redirect_stderr(io.StringIO()):
        assert run(["synth", str(tmp_path / "b.srg"), "-o", str(tmp_path / "out"), "-q"]) == 0
    report = verify_directory(tmp_path / "out")
    assert report.outcome is Outcome.VALID
    level = 0.5 * 9.81 * np.cos(float(result_files.read(tmp_path / "out")["start"][0]))
    # Of a free bias each input takes a share of its square, of a fixed one u the rest.
    left = 1 - (level - 1) / 10 if bias == "[1, 1]" else 1 - 10 * level / 101
    assert margin(report) == pytest.approx(left, rel=1e-6)
