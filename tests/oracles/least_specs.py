"""Small arms with what a task may want to be least of them; whole specifications from parts."""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction
from pathlib import Path

from solvers.verifier.report import Report
from solvers.verifier.verification import Outcome, verify_directory
from srgc.cli import run
from tests.oracles.result_files import read

QUICK = ("--paths", "2", "--evaluations", "3")
STANDING = "this.frame = Arm.frame;"


def link(length: str, *masses: str) -> str:
    """The block of a production that moves along the arm, with point masses at the end."""
    frame = f"Arm.frame * move(x, {length})"
    points = " ".join(f"point(frame: {frame}, mass: {mass});" for mass in masses)
    return f"this.frame = {frame}; {points}"


def spec(
    modules: Mapping[str, str],
    blocks: Mapping[str, tuple[str, str]],
    task: str,
    *,
    accept: str = "starts with Base eps Joint and ends with Hand",
    joint: str = "",
    hand: str = "",
    before: str = "",
    shelf: str = "box [-0.05, 0.05] x [0.45, 0.55] m",
    horizon: str = "horizon 10 steps of 0.2 s;",
) -> str:
    """A family of arms with a joint at the base, and a task for it.

    Args:
        modules: links by name, with what they declare.
        blocks: by label the right side of a production of an arm, after ``Arm``, and its block.
        task: clauses of the task.
        accept: the words of the family.
        joint: what the joint declares besides its angle.
        hand: what the hand declares.
        before: what comes before the grammar.
        shelf: the target of the task, which starts anywhere to the right of the base.
        horizon: that of the task.
    """
    declared = "\n".join(f"module {name} {{ role link; {own} }}" for name, own in modules.items())
    rules = "\n".join(f"  {label}: Arm -> Arm {right};" for label, (right, _) in blocks.items())
    semantics = "\n".join(f"  {label} {{ {block} }}" for label, (_, block) in blocks.items())
    return f"""\
module Base {{ role base; }}
module Joint {{ role joint; dof q: revolute z; {joint} }}
{declared}
module Hand {{ role effector; {hand} }}
edge eps;
{before}
grammar Arms {{
  start Arm;
  base: Arm -> Base;
  joint: Arm -> Arm eps Joint;
{rules}
  hand: Arm -> Arm eps Hand;
  accept {accept};
}}

semantics Arms {{
  base {{ this.frame = world; }}
  joint {{ this.frame = Arm.frame * rot(z, Joint.q); }}
{semantics}
  hand {{ {STANDING} effector(frame: Arm.frame); }}
}}

workspace Room {{
  plane xy;
  bounds box [-2, 2] x [-2, 2] m;
  region Home box [0.2, 1] x [-0.3, 0.3] m;
  region Shelf {shelf};
}}

task Reach {{
  robot Arms;
  workspace Room;
  start in Home at rest;
  reach Shelf;
  effort <= 20 N*m;
  control open loop;
  {horizon}
  {task}
}}
"""


def least(
    text: str, scratch: Path, *options: str
) -> tuple[list[tuple[Fraction, Fraction]], Report]:
    """The value and the least of each objective, as a valid certificate states them."""
    (scratch / "spec.srg").write_text(text, encoding="utf-8")
    asked = ["synth", str(scratch / "spec.srg"), "-o", str(scratch / "out"), "-q", *QUICK]
    assert run([*asked, *options]) == 0
    report = verify_directory(scratch / "out")
    assert report.outcome is Outcome.VALID, report.reason
    (claim,) = (c for c in read(scratch / "out")["claims"] if c["kind"] == "objectives")
    return [(Fraction(v["value"]), Fraction(v["least"])) for v in claim["values"]], report
