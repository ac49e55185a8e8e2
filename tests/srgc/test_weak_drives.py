"""What `why` says of limits of single joints: forces and accelerations by hand."""

from __future__ import annotations

import contextlib
import io
import re
from pathlib import Path

import pytest

from srgc.cli import run

pytestmark = pytest.mark.slow

SPEC = """\
module B { role base; }
module R { role joint; dof s: prismatic x in [-1, 3] m LIMIT; }
module S { role joint; dof s: prismatic y in [-1, 3] m effort <= 5 N; }
module E { role effector; }
grammar G { start N; all: N -> B R S E; }
semantics G { all {
  this.at = move(x, R.s) * move(y, S.s);
  point(frame: this.at, mass: 2 kg);
  effector(frame: this.at);
} }
workspace W {
  plane xy;
  bounds box [-2, 4] x [-1, 1] m;
  region S box [-0.01, 0.01] x [-0.1, 0.1] m;
  target T box [1, 1.02] x [-0.1, 0.1] m;
}
task Go { robot G; workspace W; start in S at rest; reach T at rest;
  horizon 30 steps of 0.1 s; }
"""
NEEDED = 4 * 2 * 0.99 / 3.0**2
"""N: half the time forwards, half of it backwards."""


def answer(folder: Path, limit: str) -> str:
    (folder / "s.srg").write_text(SPEC.replace("LIMIT", limit), encoding="utf-8")
    out = io.StringIO()
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(io.StringIO()):
        assert run(["synth", str(folder / "s.srg"), "-o", str(folder / "out"), "-q"]) in {3, 4}
        run(["why", str(folder / "out")])
    return out.getvalue()


@pytest.mark.parametrize("share", [0.3, 0.9])
def test_the_weak_drive_is_named_and_what_it_needs(tmp_path: Path, share: float) -> None:
    """Refuted, or only not found: the other joint, of 5 N, is not blamed."""
    said = answer(tmp_path, f"effort <= {share * NEEDED:.4f} N")
    found = re.search(r"with `effort <= ([0-9.]+) N` of `R.s`", said)
    assert found is not None, said
    assert NEEDED <= float(found[1]) <= 2 * NEEDED
    assert "of `S.s`: B" not in said


def test_a_limit_of_accelerations_is_named(tmp_path: Path) -> None:
    said = answer(tmp_path, "accel <= 0.1 m/s^2 effort <= 5 N")
    assert "the acceleration of `R.s`" in said
    found = re.search(r"with `accel <= ([0-9.]+) m/s\^2` of `R.s`: B R S E", said)
    assert found is not None, said
    assert NEEDED / 2 <= float(found[1]) <= NEEDED  # of 2 kg
