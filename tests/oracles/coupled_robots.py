"""Robots one of whose coordinates moves several frames, and where their effectors are by hand."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from tests.oracles import result_files
from tests.oracles.found_folders import claim_found
from tests.oracles.small_specs import TURNER, replaced

TASK = """\
workspace W {
  space xyz;
  bounds box [-2, 2] x [-2, 2] x [-2, 2] m;
  region S box [-1, 1] x [-1, 1] x [-1, 1] m;
  target T box [-1.5, 1.5] x [-1.5, 1.5] x [-1.5, 1.5] m;
}
task Go { robot G; workspace W; start in S at rest; reach T;
  effort <= 5 N*m; effort <= 5 N; horizon 6 steps of 0.125 s; }
"""
LINKAGE = replaced(
    TURNER.replace("{ this.frame", "{ this.turn = world; this.frame"),
    "this.turn = world; this.frame = N.frame * rot(z, JO.q);",
    "this.turn = rot(z, JO.q);this.frame = N.frame * this.turn * move(x, 1 m) * this.turn;",
)
"""In the plane: a crank of 1 m without mass, and a rod that turns twice as far."""
GRIPPER = (
    """\
module B { role base; }
module F { role joint; dof s: prismatic x in [0, 0.4] m; }
module E { role effector; }
grammar G { start N; all: N -> B F E; }
semantics G {
  all {
    this.slide = move(x, F.s);
    let other = move(z, 10 cm) * rot(z, 180 deg) * this.slide;
    solid(frame: this.slide, mass: 2 kg, com: (0, 0, 0) m, inertia: (0.01, 0.01, 0.01, 0, 0, 0));
    solid(frame: other, mass: 2 kg, com: (0, 0, 0) m, inertia: (0.01, 0.01, 0.01, 0, 0, 0));
    box(frame: this.slide * move(x, 5 cm), size: (4, 10, 2) cm);
    box(frame: other * move(x, 5 cm), size: (4, 10, 2) cm);
    effector(frame: this.slide * move(x, 5 cm));
    effector(frame: other * move(x, 5 cm));
  }
}
"""
    + TASK
)
"""Two fingers that one coordinate moves apart."""
WHEELS = (
    """\
module B { role base; }
module R { role joint; dof q: revolute z; }
module E { role effector; }
grammar G { start N; all: N -> B R E; }
semantics G {
  all {
    this.turn = rot(z, R.q);
    let crown = move((0.3, 0, 0.2) m) * rot(y, 90 deg) * this.turn;
    solid(frame: this.turn, mass: 1 kg, com: (0, 0, 0) m, inertia: (0.03, 0.03, 0.05, 0, 0, 0));
    solid(frame: crown, mass: 1 kg, com: (0, 0, 0) m, inertia: (0.02, 0.02, 0.03, 0, 0, 0));
    cylinder(frame: this.turn, axis: z, length: 2 cm, radius: 15 cm);
    cylinder(frame: crown, axis: z, length: 2 cm, radius: 10 cm);
    effector(frame: this.turn * move(x, 15 cm));
    effector(frame: crown * move(x, 10 cm));
  }
}
"""
    + TASK
)
"""A bevel gear: a second wheel whose axis is x turns as the first one does about z."""


def _linkage(q: float) -> np.ndarray:
    return np.array([[np.cos(q) + 1.5 * np.cos(2 * q), np.sin(q) + 1.5 * np.sin(2 * q), 0]])


def _gripper(s: float) -> np.ndarray:
    return np.array([[s + 0.05, 0, 0], [-s - 0.05, 0, 0.1]])


def _wheels(q: float) -> np.ndarray:
    c, s = np.cos(q), np.sin(q)
    # Turned by 90 degrees about y, x of the crown points down.
    return np.array([[0.15 * c, 0.15 * s, 0], [0.3, 0.1 * s, 0.2 - 0.1 * c]])


@dataclass(frozen=True)
class Coupled:
    """A robot whose coordinate is forced by ``effort`` from ``start`` and a rate on.

    ``inertia`` is what it resists by, None where that changes; ``links`` and ``effectors`` are
    names in exports.
    """

    text: str
    word: str
    values: tuple[str, ...]
    joint: str
    links: tuple[str, ...]
    effectors: tuple[str, ...]
    places: Callable[[float], np.ndarray]
    inertia: float | None
    start: float = 0.1
    rate: float = 0.2
    effort: float = 0.05

    def folder(self, path: Path) -> Path:
        """A result folder that claims this motion."""
        made = claim_found(path, self.text, self.word, list(self.values))

        def drive(content: dict[str, Any]) -> None:
            content["start"] = [str(self.start), str(self.rate)]
            content["inputs"] = [[str(self.effort)]] * content["steps"]

        result_files.alter(made, drive, sign=True)
        return made

    def coordinate(self, time: float) -> float:
        """Of a robot that resists by one number: the coordinate at a time, by hand."""
        assert self.inertia is not None
        return self.start + self.rate * time + self.effort / self.inertia * time**2 / 2


COUPLED = {
    "linkage": Coupled(
        LINKAGE, "B eps JO eps L eps EN", ("1.5",), "JO_2", ("B_0", "JO_2_link", "L_4"), ("EN_6",),
        _linkage, None,
    ),
    "gripper": Coupled(
        GRIPPER, "B F E", (), "F_1", ("B_0", "F_1_link", "F_1_link_no2"),
        ("effector_1", "effector_2"), _gripper, 2 + 2, effort=0.5,
    ),
    "wheels": Coupled(
        WHEELS, "B R E", (), "R_1", ("B_0", "R_1_link", "R_1_link_no2"),
        ("effector_1", "effector_2"), _wheels, 0.05 + 0.03,
    ),
}  # fmt: skip
