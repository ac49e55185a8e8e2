"""Claims of motions that nobody has searched for: random starts and torques of many robots.

Joints and effectors are in the order of the word, as certificates have them.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from random import Random
from typing import Any

from tests.oracles import result_files
from tests.oracles.found_folders import claim_found
from tests.oracles.small_specs import SLIDER, TURNER, replaced

CRANE = """\
module B { role base; }
module H { role joint; dof q: revolute -y in [-90, 45] deg rate in [-1, 2]; }
module P { role joint; dof s: prismatic x; }
module V { role joint; dof q: revolute z; }
module L { role link; param length in [1, 2] m; const mass = 3 kg; }
module EN { role effector; }
edge eps;
grammar Crane {
  start N;
  base: N -> B;
  hinge: N -> N eps H;
  slide: N -> N eps P;
  turn: N -> N eps V;
  link: N -> N eps L;
  tool: N -> N eps EN;
}
semantics Crane {
  base { this.frame = world * rot(x, 30 deg); }
  hinge { this.frame = N.frame * rot(-y, H.q); }
  slide { this.frame = N.frame * move(x, P.s); }
  turn { this.frame = N.frame * rot(z, V.q); }
  link {
    this.frame = N.frame * move(x, L.length);
    rod(frame: N.frame, axis: x, length: L.length, density: 1 kg/m, radius: 5 cm);
    solid(frame: N.frame, mass: L.mass, com: (0.5, 0, 0.1),
      inertia: (0.2, 0.3, 0.4, 0, 0.01, 0));
  }
  tool { this.frame = N.frame; effector(frame: N.frame); }
}
workspace Yard {
  space xyz;
  bounds box [-9, 9] x [-9, 9] x [-9, 9] m;
  region S box [1, 2] x [0, 1] x [0, 1] m;
  target T box [0, 1] x [1, 2] x [0, 1] m;
}
task Lift {
  robot Crane;
  workspace Yard;
  start in S at rest;
  reach T;
  effort <= 7 N*m;
  effort <= 20 N;
  horizon 5 steps of 0.0125 s;
  gravity (0, 1, -9.81) m/s^2;
}
"""
"""A robot in space that turns, tilts and slides, against gravity that is not along an axis."""

FRICTION = replaced(TURNER, "in [-180, 180] deg; }", "; torque(q) = u - 0.7 N*m*s*rate(q); }")


@dataclass(frozen=True)
class Driven:
    """A robot by its spec, word and parameters; the joints and effectors by the names exported."""

    text: str
    word: str
    values: tuple[str, ...]
    joints: tuple[str, ...]
    effectors: tuple[str, ...]
    torque: float = 3.0
    speed: float = 0.5
    effector: int = 0

    def folder(self, path: Path, seed: int = 1) -> Path:
        """A folder that claims a random motion."""
        rng, made = Random(seed), claim_found(path, self.text, self.word, list(self.values))

        def drive(content: dict[str, Any]) -> None:
            n = len(self.joints)
            speeds = [f"{rng.uniform(-self.speed, self.speed):.6f}" for _ in range(n)]
            content["start"] = [f"{rng.uniform(0.1, 0.3):.6f}" for _ in range(n)] + speeds
            content["effector"] = self.effector
            content["inputs"] = [
                [f"{rng.uniform(-self.torque, self.torque):.6f}" for _ in range(n)]
                for _ in range(content["steps"])
            ]

        result_files.alter(made, drive, sign=True)
        return made


TWO_ARM = (Path(__file__).parents[2] / "specs" / "two_arm.srg").read_text(encoding="utf-8")
CASES = {
    "space, turning and sliding": Driven(
        CRANE, "B eps V eps H eps L eps P eps L eps EN", ("1.5", "1.25"),
        ("V_2", "H_4", "P_8"), ("EN_12",),
    ),
    "branches": Driven(
        TWO_ARM, "B eps W eps T [ JO eps L eps JO eps L eps EN ] [ JO eps L eps EN ]",
        ("0.3", "0.4", "0.5"), ("W_2", "JO_6", "JO_10", "JO_17"), ("EN_14", "EN_21"), 0.2, 0.5, 1,
    ),
    "friction": Driven(FRICTION, "B eps JO eps L eps EN", ("1.5",), ("JO_2",), ("EN_6",)),
    "merged joints": Driven(
        TURNER, "B eps JO eps JO eps L eps JO eps L eps EN", ("1.5", "1.25"),
        ("JO_2_JO_4", "JO_8"), ("EN_12",), 0.5, 0.1,
    ),
    "a slide alone": Driven(SLIDER, "B eps P eps M eps EN", (), ("P_2",), ("EN_6",), 0.5, 0.05),
}  # fmt: skip
