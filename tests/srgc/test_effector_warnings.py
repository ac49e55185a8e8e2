"""Whether a family has effectors is a matter of what its semantics emits."""

from __future__ import annotations

import json

import pytest

SPEC = """\
module A { role base; }
module J { role joint; dof q: revolute z; }
module L { role link; }
module E { role effector; }
grammar G { start S; arm: S -> A J %s; }
semantics G {
  arm { this.f = rot(z, J.q) * move(x, 1 m); point(frame: this.f, mass: 1 kg); %s }
}
"""


@pytest.mark.parametrize(
    ("last", "emitted", "warned"),
    [
        ("E", "effector(frame: this.f);", False),
        ("L", "effector(frame: this.f);", False),
        ("E", "", True),
        ("L", "", True),
    ],
)
def test_emissions_decide(srgc, spec, last, emitted, warned):
    ran = srgc("check", spec(SPEC % (last, emitted)), "--json")
    codes = [entry["code"] for entry in json.loads(ran.out)]
    assert ("SRG0406" in codes) == warned
