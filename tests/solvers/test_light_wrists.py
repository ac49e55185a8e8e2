"""Arms whose links get lighter by orders of magnitude, with controllers."""

from __future__ import annotations

from pathlib import Path

import pytest

from solvers.verifier.verification import Outcome, verify_directory
from srgc.cli import run

AXES = "zyyxyx"
BOUNDS = (150, 150, 60, 8, 3, 1)
HEAD = """module B { role base; }
module EN { role effector; }
"""
TASK = """workspace Hall {
  space xyz; bounds box [-3, 3] x [-3, 3] x [-3, 3] m;
  region S box [-0.464, -0.364] x [-0.219, -0.119] x [0.282, 0.382] m;
  target T box [0.059, 0.159] x [-1.089, -0.989] x [0.450, 0.550] m;
  obstacle O box [0.3, 0.5] x [0.3, 0.5] x [-1, 0.3] m;
}
task Go {
  robot Arm; workspace Hall; start in S at rest; reach T at rest; avoid O with body;
  control feedback; gravity (0, 0, -9.81) m/s^2; horizon 30 steps of 0.05 s; modules <= 14;
}
"""


def arm() -> str:
    """Six joints; each link has 0.3 of the mass and 0.75 of the length of the one before it."""
    modules, productions, rules = list[str](), list[str](), list[str]()
    for i, (axis, bound) in enumerate(zip(AXES, BOUNDS, strict=True)):
        length, mass = 0.45 * 0.75**i, 12 * 0.3**i
        modules += [
            f"module L{i} {{ role link; const length = {length:.3f} m; const m = {mass:.5f} kg; }}",
            (
                f"module J{i} {{ role joint; dof q: revolute {axis};"
                f" input t in [-{bound}, {bound}] N*m; torque(q) = t; }}"
            ),
        ]
        productions += [f"j{i}: N -> N J{i};", f"l{i}: N -> N L{i};"]
        across = f"L{i}.m * L{i}.length^2 / 12 + L{i}.m"
        rules += [
            f"j{i} {{ this.frame = N.frame * rot({axis}, J{i}.q); }}",
            (
                f"l{i} {{ this.frame = N.frame * move(x, L{i}.length); solid(frame: N.frame,"
                f" mass: L{i}.m, com: (L{i}.length / 2, 0.01 m, 0.02 m),"
                f" inertia: (L{i}.m * 0.001 m^2,"
                f" {across} * 0.0005 m^2, {across} * 0.0007 m^2, 0, 0, 0)); }}"
            ),
        ]
    word = " ".join(f"J{i} L{i}" for i in range(len(AXES)))
    return "\n".join(
        [
            HEAD, *modules, "grammar Arm { start N; base: N -> B;", *productions,
            f"tool: N -> N EN; accept matches B {word} EN; }}",
            "semantics Arm { base { this.frame = world; }", *rules,
            "tool { this.frame = N.frame; effector(frame: N.frame); } }", TASK,
        ]
    )  # fmt: skip


@pytest.mark.slow
def test_six_joints_with_a_light_wrist_are_proved(tmp_path: Path) -> None:
    """Decision 86: an input on the wrist moves it 1e5 times as fast as one on the shoulder."""
    spec = tmp_path / "arm.srg"
    spec.write_text(arm(), encoding="utf-8")
    assert run(["synth", str(spec), "-o", str(tmp_path / "out"), "--quiet"]) == 0
    report = verify_directory(tmp_path / "out")
    assert report.outcome is Outcome.VALID
    assert report.control == "feedback"
