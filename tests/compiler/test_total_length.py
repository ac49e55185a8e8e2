"""The total length of robots whose lengths are read off their words by hand."""

from __future__ import annotations

import numpy as np
import pytest

from compiler.robots.normal_form import RobotFamily
from compiler.words.structures import derivations_of
from grammar_lang.load import load_text
from srgc.results.pareto_table import total_length

FAMILY = """
module B { role base; } module J { role joint; dof q: revolute z; }
module P { role joint; dof s: prismatic x in [0, 3] m; }
module L { role link; param a in [0, 9] m; }
module K { role link; param a in [0, 9] m; param b in [0, 9] m; }
module R { role link; const arm = 2 m; }
module E { role effector; }
grammar G {
  start N; base: N -> B; joint: N -> N J; slide: N -> N P; link: N -> N L; bracket: N -> N K;
  weight: N -> N R; tool: N -> N E;
}
semantics G {
  base { this.frame = world; }
  joint { this.frame = N.frame * rot(z, J.q); }
  slide { this.frame = N.frame * move(x, P.s) * move(y, 1 m); }
  link { this.frame = N.frame * move(x, L.a); rod(frame: N.frame, axis: x, length: L.a,
         density: 1 kg/m); }
  bracket { this.frame = N.frame * move(x, K.a) * move(y, K.b); }
  weight { this.frame = N.frame; point(frame: N.frame * move(y, R.arm), mass: 1 kg); }
  tool { this.frame = N.frame; effector(frame: N.frame); }
}
"""


def length(word: str, *theta: float) -> float:
    loaded = load_text(FAMILY, "g.srg")
    assert loaded.program is not None, loaded.diagnostics
    family = RobotFamily(loaded.program, loaded.program.grammars["G"], 2)
    (derivation,) = derivations_of(family.language, tuple(word.split()))
    return total_length(family.built(derivation), np.array(theta))


@pytest.mark.parametrize(
    ("word", "theta", "expected"),
    [
        ("B E", (), 0.0),
        ("B J L E", (1.25,), 1.25),
        ("B J L J L E", (2.23, 3.35), 5.58),
        # Two links in a row, merged as a model, are as long as both.
        ("B J L L E", (1.0, 0.5), 1.5),
        # A bracket has two arms of 3 and 4 m, not one of 5.
        ("B J K E", (3.0, 4.0), 7.0),
        # The first link leads to both effectors and counts once.
        ("B J L E L E", (1.0, 0.5), 1.5),
        # What is behind the last joint or effector leads nowhere.
        ("B J L E L", (1.0, 7.0), 1.0),
        # The travel of a slide is no length; its offset of 1 m is one.
        ("B P L E", (2.0,), 3.0),
        # The way to a weight is none to a joint or an effector.
        ("B J R L E", (2.0,), 2.0),
        ("B L J E", (0.0,), 0.0),
    ],
)
def test_lengths(word: str, theta: tuple[float, ...], expected: float) -> None:
    assert length(word, *theta) == pytest.approx(expected, rel=1e-15)
