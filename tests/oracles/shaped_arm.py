"""An arm in space with a shape of every kind, drives and limits, and what these are by hand."""

from __future__ import annotations

import math
from pathlib import Path
from random import Random
from typing import Any

import numpy as np

from tests.oracles import result_files
from tests.oracles.found_folders import claim_found
from tests.oracles.mesh_files import WEDGE

SPEC = """\
module B { role base; }
module Z { role joint;
  dof q: revolute z in [-170, 160] deg rate in [-1.25, 1] rad/s accel <= 2.5 rad/s^2
    effort <= 75.5 N*m;
  drive q: gear 160 rotor 5.23e-5 kg*m^2 viscous 0.3 N*m*s; }
module Y { role joint; dof q: revolute y effort <= 40 N*m; }
module P { role joint; dof s: prismatic x in [0, 0.3] m rate in [-0.5, 0.4] m/s effort <= 90 N; }
module E { role effector; }
grammar G {
  start N;
  base: N -> B;
  turn: N -> N Z;
  tilt: N -> N Y;
  slide: N -> N P;
  tool: N -> N E;
  accept matches B Z Y P E;
}
semantics G {
  base { this.frame = world * move(z, 0.25 m);
    cylinder(frame: world, axis: z, length: 0.2 m, radius: 0.15 m); }
  turn { let f = N.frame * rot(z, Z.q);
    solid(frame: f, mass: 3 kg, com: (0, 0, 0.1) m,
      inertia: (0.05, 0.05, 0.02, 0, 0, 0));
    capsule(frame: f, axis: z, length: 0.3 m, radius: 0.06 m);
    sphere(frame: f * move(z, 0.3 m), radius: 0.09 m);
    this.frame = f * move(z, 0.3 m); }
  tilt { let f = N.frame * rot(y, Y.q);
    solid(frame: f, mass: 2 kg, com: (0.2, 0, 0) m,
      inertia: (0.01, 0.04, 0.04, 0, 0, 0));
    box(frame: f * move(x, 0.25 m), size: (0.3, 0.08, 0.1) m);
    this.frame = f * move(x, 0.4 m); }
  slide { let f = N.frame * move(x, P.s);
    solid(frame: f, mass: 1 kg, com: (0.1, 0, 0) m,
      inertia: (0.002, 0.006, 0.006, 0, 0, 0));
    hull(frame: f, file: "parts/wedge.obj", scale: 1 mm);
    this.frame = f * move(x, 0.25 m); }
  tool { this.frame = N.frame; effector(frame: N.frame); }
}
workspace W {
  space xyz;
  bounds box [-2, 2] x [-2, 2] x [-2, 2] m;
  region S box [-1, 1] x [-1, 1] x [-1, 1] m;
  obstacle O box [0.5, 0.7] x [-0.9, -0.5] x [0, 0.4] m;
  target T box [-1.5, 1.5] x [-1.5, 1.5] x [-1.5, 1.5] m;
}
task PickIt { robot G; workspace W; start in S at rest; reach T; avoid O with body;
  avoid self with body, margin 5 mm, except B P;
  gravity (0, 0, -9.81) m/s^2; horizon 6 steps of 0.125 s; }
"""
WORD = "B Z Y P E"
JOINTS, EFFECTORS = ("Z_1", "Y_2", "P_3"), ("E_4",)
LINKS = ("B_0", "Z_1_link", "Y_2_link", "P_3_link")
ARMATURE = (160**2 * 5.23e-5, 0.0, 0.0)
RANGES = ((math.radians(-170), math.radians(160)), None, (0.0, 0.3))
RATES, ACCELERATIONS, EFFORTS = (1.25, None, 0.5), (2.5, None, None), (75.5, 40.0, 90.0)
TOUCHING = {
    ("B_0", "Z_1_link"): "Adjacent", ("Z_1_link", "Y_2_link"): "Adjacent",
    ("Y_2_link", "P_3_link"): "Adjacent", ("B_0", "P_3_link"): "Exempt in the task",
}  # fmt: skip
CORNERS = np.array([[0, y, z] for y in (-30, 30) for z in (-20, 20)]
                   + [[250, y, z] for y in (-10, 10) for z in (-10, 10)]) / 1000  # fmt: skip
"""Of the wedge, in metres."""


def place(q: Any) -> np.ndarray:
    """Where the effector is, by hand."""
    reach = 0.4 + q[2] + 0.25
    level, height = reach * math.cos(q[1]), 0.55 - reach * math.sin(q[1])
    return np.array([level * math.cos(q[0]), level * math.sin(q[0]), height])


def shaped_arm(folder: Path, text: str = SPEC) -> Path:
    """A result folder that claims a random motion of it."""
    rng = Random(3)

    def drive(content: dict[str, Any]) -> None:
        start = ["0.3", "-0.4", "0.1", "0.5", "-0.2", "0.05"]
        content["start"] = start
        content["inputs"] = [
            [f"{rng.uniform(-3, 3):.6f}", f"{rng.uniform(-6, -4):.6f}", f"{rng.uniform(-3, 3):.6f}"]
            for _ in range(content["steps"])
        ]

    made = claim_found(folder, text, WORD, [], {"parts/wedge.obj": WEDGE.encode()})
    result_files.alter(made, drive, sign=True)
    return made
