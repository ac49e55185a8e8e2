"""An arm of four light links in space on geared joints with friction, and its drives by hand.

Modules of that size (gears of 160 turns, rotors of 5.23e-5 kg m^2) have rotors that are felt more
than their links are.
"""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np

from tests.oracles.found_folders import claim_found

SPEC = """\
module Base { role base; }
module Big { role joint;
  dof q: revolute z in [-170, 170] deg rate in [-1.25, 1] rad/s accel <= 2.5 rad/s^2
    effort <= 75.5 N*m;
  drive q: gear 160 rotor 5.23e-5 kg*m^2 viscous 14 N*m*s coulomb 3.5 N*m;
}
module Small { role joint;
  dof q: revolute z effort <= 40 N*m;
  drive q: gear 120 rotor 0.375e-5 kg*m^2 viscous 6 N*m*s coulomb 1.2 N*m;
}
module Worn { role joint; dof q: revolute z effort <= 40 N*m; drive q: coulomb 1e-5 N*m; }
module E { role effector; }
grammar G { start N; all: N -> Base A:Big B:Big C:Small D:Worn E; }
semantics G {
  all {
    this.a = rot(z, A.q);
    solid(frame: this.a, mass: 3.9 kg, com: (0, 0.018, -0.082) m,
      inertia: (0.042799, 0.037801, 0.010997, 0, 0, 0));
    this.b = this.a * move((0, 0.1013, 0.1013) m) * rot(x, -90 deg) * rot(z, B.q);
    solid(frame: this.b, mass: 1.62 kg, com: (0, -0.175, 0.0132) m,
      inertia: (0.074338, 0.017132, 0.074338, 1e-6, -6e-6, 0.003742));
    this.c = this.b * move((0, -0.35, 0) m) * rot(x, 90 deg) * rot(z, C.q);
    solid(frame: this.c, mass: 1 kg, com: (-0.00018, 0.0477, 0.071) m,
      inertia: (0.013909, 0.010894, 0.003893, 3e-6, 6e-6, 0.001));
    this.d = this.c * move((0, 0.0748, 0.0748) m) * rot(x, -90 deg) * rot(z, D.q);
    solid(frame: this.d, mass: 1.4 kg, com: (0.02, 0, 0.04) m,
      inertia: (0.004, 0.0039, 0.0006, 0, 0, 0));
    effector(frame: this.d * move(z, 0.163 m));
  }
}
workspace Cell {
  space xyz;
  bounds box [-2, 2] x [-2, 2] x [-2, 2] m;
  region One box [-1, 1] x [-1, 1] x [-1, 1] m;
  target Two box [-1.5, 1.5] x [-1.5, 1.5] x [-1.5, 1.5] m;
}
task Turn {
  robot G; workspace Cell; start in One at rest; reach Two;
  gravity (0, 0, -9.81) m/s^2; horizon 4 steps of 0.125 s;
}
"""
WORD = "Base Big Big Small Worn E"
JOINTS = ("Big_1", "Big_2", "Small_3", "Worn_4")
ARMATURE = np.array([160**2 * 5.23e-5, 160**2 * 5.23e-5, 120**2 * 0.375e-5, 0])
VISCOUS = np.array([14.0, 14, 6, 0])
COULOMB = np.array([3.5, 3.5, 1.2, 1e-5])
ACCELERATION = (2.5, 2.5, None, None)
VELOCITY = (1.25, 1.25, None, None)
RANGE = math.radians(170)


def geared_arm(folder: Path) -> Path:
    """A result folder that claims it."""
    return claim_found(folder, SPEC, WORD, [])


FLYWHEEL = """\
module B { role base; }
module J { role joint; dof q: revolute z effort <= 9 N*m;
  drive q: gear 100 rotor 1e-4 kg*m^2 coulomb 1.2 N*m; }
module W { role link; }
module E { role effector; }
grammar G { start N; all: N -> B J W E; }
semantics G { all {
  this.turned = rot(z, J.q);
  solid(frame: this.turned, mass: 2 kg, com: (0, 0) m, inertia: 0.5 kg*m^2);
  effector(frame: this.turned * move(x, 0.25 m));
} }
workspace P { plane xy; bounds box [-1, 1] x [-1, 1] m;
  region S box [0.2, 0.3] x [-0.1, 0.1] m; target T box [-0.3, 0.3] x [-0.3, 0.3] m; }
task Spin { robot G; workspace P; start in S at rest; reach T; horizon 10 steps of 0.125 s; }
"""
"""A disc of 0.5 kg m^2 about its middle on a joint that feels 1 kg m^2 of its rotor."""


def flywheel(folder: Path, spec: str = FLYWHEEL) -> Path:
    """A result folder that claims it."""
    return claim_found(folder, spec, "B J W E", [])
