"""Results with feedback of robots that lack something: a joint without input, no joint at all."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

from tests.srgc.conftest import Ran

Run = Callable[..., Ran]
CART = """
module Cart { role base; dof s: prismatic x in [-2, 2] m; }
module Pend {
  role joint;
  dof q: revolute z in [-150, 150] deg;
  torque(q) = -5 N*m * q - 0.5 N*m*s * rate(q);
}
module Hand { role effector; }
grammar G { start R; r: R -> Cart Pend Hand; }
semantics G {
  r {
    this.c = move(x, Cart.s);
    point(frame: this.c, mass: 2 kg);
    this.t = this.c * rot(z, Pend.q) * move(x, 0.5 m);
    point(frame: this.t, mass: 1 kg);
    effector(frame: this.t);
  }
}
workspace W {
  plane xy;
  bounds box [-3, 3] x [-2, 2] m;
  region A box [0.2, 0.6] x [-0.3, 0.3] m;
  target B box [0.6, 1.2] x [-0.3, 0.3] m;
}
task T {
  robot G;
  workspace W;
  start in A;
  reach B;
  effort <= 20 N;
  horizon 5 steps of 0.2 s;
  control feedback;
  robust start 1 mm, 0.1 deg, 1 mm/s, 0.1 deg/s;
}
"""
STILL = """
module Base { role base; }
module Hand { role effector; }
grammar G { start R; r: R -> Base Hand; }
semantics G {
  r { this.t = move(x, 1 m); point(frame: this.t, mass: 1 kg); effector(frame: this.t); }
}
workspace W {
  plane xy;
  bounds box [-2, 2] x [-2, 2] m;
  region A box [0.5, 1.5] x [-0.5, 0.5] m;
}
task T {
  robot G;
  workspace W;
  start in A;
  reach A;
  horizon 5 steps of 0.1 s;
  CLAUSES
}
"""


def made(text: str, srgc: Run, tmp_path: Path) -> Path:
    spec, out = tmp_path / "spec.srg", tmp_path / "out"
    spec.write_text(text, encoding="utf-8")
    ran = srgc("synth", spec, "-o", out, "--quiet")
    assert ran.status == 0, ran.err
    return out


def test_what_mujoco_cannot_hold_is_said_and_the_rest_is_exported(
    srgc: Run, tmp_path: Path
) -> None:
    out = made(CART, srgc, tmp_path)
    ran = srgc("export", out, "--to", "mujoco", "-o", tmp_path / "mujoco")
    assert ran.status == 2
    assert "MJCF does not hold the dynamics of their own of Pend (symbol 1)" in ran.err
    assert not (tmp_path / "mujoco").exists()
    ran = srgc("export", out, "--to", "all", "-o", tmp_path / "all")
    assert ran.status == 0
    assert (tmp_path / "all/controller.c").exists()
    assert not (tmp_path / "all/replay.py").exists()


@pytest.mark.parametrize("clauses", ["robust mass 2 %;", "repeat;", "robust start 1 deg;"])
def test_a_robot_without_joints_has_a_report(srgc: Run, tmp_path: Path, clauses: str) -> None:
    out = made(STILL.replace("CLAUSES", clauses), srgc, tmp_path)
    page = tmp_path / "report.html"
    assert srgc("report", out, "-o", page).status == 0
    assert "found" in page.read_text(encoding="utf-8")
