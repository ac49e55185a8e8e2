"""Result folders of planar arms in motion, without a search, and the radius of their tubes."""

from __future__ import annotations

from fractions import Fraction
from math import sin
from pathlib import Path

from compiler.expressions.exact_numbers import decimal, exact_decimal
from solvers.verifier.certified_tube import certified_tube
from solvers.verifier.claims.certificate import (
    FoundClaim,
    ParameterClaim,
    spec_digest,
    to_text,
)

DT = Fraction(1, 10)
SPEC = """\
module B {{ role base; }}
module JO {{ role joint; dof q: revolute z; }}
module L {{ role link; param length in [0.2, 1] m; const density = 1 kg/m; }}
module EN {{ role effector; }}
edge eps;
grammar Arm {{
  start N;
  base: N -> B;
  joint: N -> N eps JO;
  link: N -> N eps L;
  tool: N -> N eps EN;
  accept matches B (eps JO eps L)+ eps EN;
}}
semantics Arm {{
  base {{ this.frame = world; }}
  joint {{ this.frame = N.frame * rot(z, JO.q); }}
  link {{
    this.frame = N.frame * move(x, L.length);
    rod(frame: N.frame, axis: x, length: L.length, density: L.density);
  }}
  tool {{ this.frame = N.frame; effector(frame: N.frame); }}
}}
workspace Hall {{ plane xy; bounds box [-9, 9] x [-9, 9] m; region R box [-9, 9] x [-9, 9] m; }}
task Swing {{
  robot Arm;
  workspace Hall;
  start in R at rest;
  reach R;
  {gravity}
  effort <= 20 N*m;
  horizon {steps} steps of 0.1 s;
}}
"""


def claimed_arm(scratch: Path, links: int, steps: int, *, gravity: bool) -> Path:
    """A result folder that claims that an arm of rods of different lengths swings in a hall.

    The inputs of four steps add up to nothing, so that the arm does not gather speed by itself.
    """
    name = f"{links}-{steps}{'-gravity' if gravity else ''}"
    folder = scratch / name
    (folder / "spec").mkdir(parents=True, exist_ok=True)
    pull = "gravity (0, -9.81) m/s^2;" if gravity else ""
    text = SPEC.format(steps=steps, gravity=pull)
    (folder / "spec" / "arm.srg").write_text(text, encoding="utf-8")
    word = ["B", *["JO", "L"] * links, "EN"]
    inputs = [[_torque(links, i, k) for i in range(links)] for k in range(steps)]
    peak = max(abs(u) for row in inputs for u in row)
    lengths = [Fraction(9 - i, 10) for i in range(links)]
    claim = FoundClaim(
        task="Swing",
        spec="arm.srg",
        spec_sha256=spec_digest({"arm.srg": text.encode()}),
        word=tuple(" eps ".join(word).split()),
        derivation=("tool", *("link", "joint") * links, "base"),
        parameters=tuple(
            ParameterClaim(4 * i + 4, "length", exact_decimal(length))
            for i, length in enumerate(lengths)
        ),
        effector=0,
        steps=steps,
        step=exact_decimal(DT),
        start=tuple(decimal(0.4 * (-1) ** i) for i in range(links)) + ("0",) * links,
        inputs=tuple(tuple(exact_decimal(u) for u in row) for row in inputs),
        path=(("R",) * (steps + 1),),
        effort_peak=exact_decimal(peak),
        robustness=exact_decimal(20 - peak),
    )
    (folder / "certificate.json").write_text(to_text(claim), encoding="utf-8")
    return folder


def _torque(links: int, joint: int, step: int) -> Fraction:
    """Less towards the tool, and there and back again within four steps."""
    sign = (1, -1, -1, 1)[step % 4]
    size = 0.5 * (links - joint) ** 2 * (1 + 0.2 * sin(0.7 * (step // 4) + joint))
    return sign * Fraction(round(1000 * size), 1000)


def end_radius(folder: Path) -> float:
    """The largest radius of a coordinate or rate at the end of the proved tube."""
    tube = certified_tube(folder)
    ends = tube.at(tube.times[-1])
    return float((ends[:, 1] - ends[:, 0]).max()) / 2
